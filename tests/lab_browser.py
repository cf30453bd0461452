"""A browser that tests can drive: Chromium by playwright or by selenium, whichever is there."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
DRIVER = shutil.which("chromedriver")
#: what the lab and its browser need
_WEB = ("starlette", "uvicorn", "segno", "trustme")
#: pictures in three dimensions without a graphics card
_FLAGS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--autoplay-policy=no-user-gesture-required",
)
#: longest time that a page is waited for, on a machine that does much else [s]
PATIENCE_S = 60.0
_STEP_S = 0.05
_SIZE_PX = (1400, 900)
Json = Any


def _there(name: str) -> bool:
    return importlib.util.find_spec(name) is not None


def missing() -> str:
    """Why no browser is driven here; empty where one is.

    A browser plays and records sound in real time, so these tests want a machine to themselves.
    """
    if not os.environ.get("SIMCOMPARE_BROWSER"):
        return "the lab in a browser is tested by itself: make browser"
    lacking = [name for name in _WEB if not _there(name)]
    if lacking:
        return f"the lab needs {', '.join(lacking)}: pip install 'simcompare[web]'"
    if CHROMIUM is None:
        return "there is no chromium: apt-get install chromium chromium-driver"
    if _there("playwright") or (_there("selenium") and DRIVER is not None):
        return ""
    return "nothing drives the browser: pip install selenium, apt-get install chromium-driver"


class Page:
    """A page, asked by JavaScript and by keys.

    Attributes:
        moved: what is raised while another page is loaded.
    """

    moved: type[Exception]

    def open(self, address: str) -> None:
        """Loads an address."""
        raise NotImplementedError

    def ask(self, script: str, *values: Json) -> Json:
        """Value of a function of JavaScript, such as ``(id) => document.title``."""
        raise NotImplementedError

    def press(self, key: str) -> None:
        """Presses a key, such as ``Tab``, ``ArrowRight``, ``Space`` or ``Enter``."""
        raise NotImplementedError

    def send_file(self, selector: str, path: Path) -> None:
        """Chooses a file in a field."""
        raise NotImplementedError

    def until(self, script: str, *values: Json) -> Json:
        """Waits for a function of JavaScript to give what counts as true, and gives it."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            with contextlib.suppress(self.moved):
                if found := self.ask(script, *values):
                    return found
            time.sleep(_STEP_S)
        seen = self.ask("() => document.body.innerText.slice(0, 2000)")
        raise AssertionError(f"never came: {script} {values}\n{seen}")

    def click(self, selector: str) -> None:
        """Clicks what a selector of CSS finds first."""
        self.until("(s) => document.querySelector(s)", selector)
        self.ask("(s) => document.querySelector(s).click()", selector)

    def focus(self, selector: str) -> None:
        """Gives it the keyboard."""
        self.ask("(s) => document.querySelector(s).focus()", selector)

    def text(self, selector: str) -> str:
        """What is read there."""
        return str(self.ask("(s) => document.querySelector(s).innerText", selector))

    def put(self, selector: str, value: object) -> None:
        """Types a value into a field."""
        script = """(s, v) => {
            const one = document.querySelector(s);
            one.value = v;
            for (const what of ["input", "change"])
                one.dispatchEvent(new Event(what, {bubbles: true}));
        }"""
        self.ask(script, selector, value)


class _Playwright(Page):
    def __init__(self, page: Any) -> None:
        from playwright.sync_api import Error

        self._page, self.moved = page, Error

    def open(self, address: str) -> None:
        self._page.goto(address)

    def ask(self, script: str, *values: Json) -> Json:
        return self._page.evaluate(f"(values) => ({script})(...values)", list(values))

    def press(self, key: str) -> None:
        self._page.keyboard.press(key)

    def send_file(self, selector: str, path: Path) -> None:
        self._page.set_input_files(selector, str(path))


class _Selenium(Page):
    def __init__(self, driver: Any) -> None:
        from selenium.common.exceptions import WebDriverException

        self._driver, self.moved = driver, WebDriverException

    def open(self, address: str) -> None:
        self._driver.get(address)

    def ask(self, script: str, *values: Json) -> Json:
        done = "const done = arguments[arguments.length - 1], given = [...arguments].slice(0, -1);"
        return self._driver.execute_async_script(
            f"{done} Promise.resolve(({script})(...given)).then(done);", *values
        )

    def press(self, key: str) -> None:
        from selenium.webdriver.common.action_chains import ActionChains
        from selenium.webdriver.common.keys import Keys

        name = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", key).upper()
        ActionChains(self._driver).send_keys(getattr(Keys, name)).perform()

    def send_file(self, selector: str, path: Path) -> None:
        from selenium.webdriver.common.by import By

        self._driver.find_element(By.CSS_SELECTOR, selector).send_keys(str(path))


Open = Callable[..., contextlib.AbstractContextManager[Page]]


@contextlib.contextmanager
def browsers() -> Iterator[Open]:
    """What opens a fresh browser with one page, in which nothing moves by itself.

    It takes further arguments of Chromium, and the size of the window in pixels.
    """
    flags = [*_FLAGS, "--force-prefers-reduced-motion"]
    if not _there("playwright"):
        yield lambda more=(), size_px=_SIZE_PX: _by_selenium([*flags, *more], size_px)
        return
    from playwright.sync_api import sync_playwright

    with sync_playwright() as player:
        yield lambda more=(), size_px=_SIZE_PX: _by_playwright(player, [*flags, *more], size_px)


@contextlib.contextmanager
def _by_playwright(player: Any, arguments: list[str], size_px: tuple[int, int]) -> Iterator[Page]:
    started = player.chromium.launch(executable_path=CHROMIUM, args=arguments)
    width, height = size_px
    context = started.new_context(
        viewport={"width": width, "height": height}, locale="en-US", reduced_motion="reduce"
    )
    page = context.new_page()
    page.set_default_timeout(PATIENCE_S * 1000)
    try:
        yield _Playwright(page)
    finally:
        started.close()


@contextlib.contextmanager
def _by_selenium(arguments: list[str], size_px: tuple[int, int]) -> Iterator[Page]:
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = str(CHROMIUM)
    for one in [*arguments, "--headless=new", "--lang=en-US"]:
        options.add_argument(one)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(str(DRIVER)))
    width, height = size_px
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    driver.set_script_timeout(PATIENCE_S)
    try:
        yield _Selenium(driver)
    finally:
        driver.quit()


@contextlib.contextmanager
def lab() -> Iterator[str]:
    """A lab of its own on a free port; gives its address."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-u", "-m", "simcompare", "lab", "--port", "0"]
        started = subprocess.Popen(
            [*command, "--folder", str(Path(folder) / "lab"), "--no-open"],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env={**os.environ, "COLUMNS": "200"},
        )  # fmt: skip
        try:
            yield _address(started)
        finally:
            started.terminate()
            started.wait(timeout=30)


def _address(started: subprocess.Popen[str]) -> str:
    """Where a lab that has begun says that it is."""
    assert started.stdout is not None
    said = []
    for line in started.stdout:
        said.append(line)
        found = re.search(r"http://[^/ ]+/", line)
        if found:
            return found[0]
    raise AssertionError("".join(said))
