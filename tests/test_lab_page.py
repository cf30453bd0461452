"""The lab as its users meet it: in a browser, by mouse, by keys and by microphone."""

from __future__ import annotations

import gzip
import importlib.util
import re
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np
import pytest
import soundfile

from tests import lab_browser, lab_films
from tests.lab_browser import Page

Browser = Callable[..., AbstractContextManager[Page]]
LACKING = lab_browser.missing()
pytestmark = pytest.mark.skipif(bool(LACKING), reason=LACKING)
RATE_HZ, G_M_S2 = 48_000, 9.80665
#: what a page may weigh on its way
MOST_BYTES = 3_000_000
#: one engine answers soon
FAST = "pymunk"
DONE = "() => document.querySelector('#scores table') && !document.body.hasAttribute('aria-busy')"


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """Of a lab."""
    with lab_browser.lab() as found:
        yield found


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Opens browsers."""
    with lab_browser.browsers() as found:
        yield found


@pytest.fixture(scope="module")
def page(address: str, browser: Browser) -> Iterator[Page]:
    """A page of it, with one engine chosen."""
    with browser() as found:
        _begin(found, address)
        yield found


def _begin(page: Page, address: str, query: str = "") -> None:
    page.open(address + query)
    page.until("() => document.querySelectorAll('#engines input').length > 3")
    page.ask(
        """(fast) => document.querySelectorAll("#engines input").forEach((one) => {
            if (one.checked !== (one.value === fast)) one.click(); })""",
        FAST,
    )
    page.until(DONE)
    page.until(
        "(fast) => document.querySelector('#curve').data.some((one) => one.name === fast) &&"
        " document.querySelector('#curve').data.length === 2",
        FAST,
    )


def _heights(page: Page, name: str = FAST) -> list[float]:
    found: list[float] = page.ask(
        "(name) => document.querySelector('#curve').data.find((one) => one.name === name).y", name
    )
    return found


def _value(page: Page, number: int) -> float:
    """What a slider on the first screen says."""
    script = "(i) => document.querySelectorAll('#parameters input[type=number]')[i].value"
    return float(page.ask(script, number))


# ---- drop


def test_a_slider_moved_by_keys_changes_both_pictures(page: Page) -> None:
    before, seen = (
        _heights(page),
        page.ask("() => document.querySelector('#replay .stage').layout.scene.zaxis.range"),
    )
    page.focus("#parameters input[type=range]")
    for _ in range(3):
        page.press("ArrowRight")
    page.until("(first) => document.querySelector('#curve').data[1].y[0] > first", before[0])
    page.until(DONE)
    shown_m = _value(page, 0)
    assert shown_m > 1
    # rounded by the job to micrometres
    assert _heights(page)[0] == pytest.approx(shown_m, abs=1e-5)
    after = page.ask("() => document.querySelector('#replay .stage').layout.scene.zaxis.range")
    assert after[1] > seen[1]
    assert page.ask("() => performance.getEntriesByName('from change to picture').length") >= 2


def test_a_phone_that_is_out_of_reach_for_a_moment_asks_again(page: Page, address: str) -> None:
    _begin(page, address)
    page.ask(
        """() => { const there = window.fetch; window.lost = 0;
            window.fetch = (path, ...more) => {
                const isPoll = String(path).startsWith("/api/jobs/");
                if (!isPoll || window.lost > 1) return there(path, ...more);
                window.lost += 1;
                return Promise.reject(new TypeError("Failed to fetch")); }; }"""
    )
    page.put("#parameters input[type=number]", "2")
    page.until("() => document.querySelector('#curve').data[1].y[0] === 2")
    assert page.ask("() => window.lost") == 2
    assert page.ask("() => document.querySelector('#drop-faults').hidden")


def test_a_number_out_of_its_bounds_is_refused_in_words(page: Page) -> None:
    before = _heights(page)
    page.put("#parameters input[type=number]", "-3")
    assert "from 0.01 to 20 m" in page.text("#parameters .wrong")
    assert (
        page.ask("() => document.querySelector('#parameters input').getAttribute('aria-invalid')")
        == "true"
    )
    assert _heights(page) == before
    page.put("#parameters input[type=number]", "1")
    page.until("() => document.querySelector('#curve').data[1].y[0] === 1")


def test_the_expert_makes_an_engine_bounce_by_its_own_value(page: Page) -> None:
    page.click("#expert")
    hand = "#contact-values input[value=pymunk]"
    details = f"#contact-values details:has(input[value={FAST}])"
    page.click(f"{details} summary")
    page.put(f"{details} input[type=number]", "0.9")
    page.until("() => document.querySelector('#shown-level input[value=\"by hand\"]')")
    page.click("#shown-level input[value='by hand']")
    y = np.array(_heights(page))
    # the closed form of 0.9: the first flight goes to 0.81 of the height
    landed = int(np.argmin(y[: len(y) // 4]))
    assert y[landed:].max() == pytest.approx(0.81, abs=0.05)
    page.click(hand)
    page.until("() => !document.querySelector('#shown-level input[value=\"by hand\"]')")
    page.click("#expert")


def test_a_published_ball_is_held_against_and_fitted(page: Page, address: str) -> None:
    _begin(page, address)
    page.put("#published", "itf_tennis_rebound")
    page.until("() => document.querySelector('#scores').innerText.includes('1.35 to 1.47 m')")
    assert "International Tennis Federation" in page.text("#published-text")
    assert _value(page, 0) == 2.54
    page.click("#expert")
    details = f"#contact-values details:has(input[value={FAST}])"
    page.click(f"{details} summary")
    page.put(f"{details} input[type=number]", "0.5")
    page.click("#fit-for-me")
    page.until("() => document.querySelector('#hand-result table')")
    # as high as the centre of the rule: e = √(1.41/2.54)
    assert page.ask(
        f"() => document.querySelector('{details} input[type=number]').valueAsNumber"
    ) == (pytest.approx((1.41 / 2.54) ** 0.5, abs=0.002))
    # one that cannot be fitted is told beside the button
    page.put("#published", "jena_2021_table_tennis")
    page.click("#fit-for-me")
    page.until("() => document.querySelector('#hand-result').innerText.includes('needs one of')")
    page.put("#published", "itf_tennis_rebound")
    page.click("#expert")
    # who lets it fall from elsewhere is not held against it
    page.put("#parameters input[type=number]", "1")
    page.until("() => !document.querySelector('#scores').innerText.includes('published')")


def test_a_browser_without_webgl_shows_a_still(address: str, browser: Browser) -> None:
    with browser(("--disable-3d-apis",)) as page:
        _begin(page, address)
        assert page.until("() => document.querySelector('.stage img')?.naturalWidth") > 300
        assert "WebGL is off" in page.text(".stage")


def test_no_engine_is_said_in_words(page: Page) -> None:
    page.click(f"#engines input[value={FAST}]")
    page.until("() => document.querySelector('#drop-faults').innerText.includes('at least one')")
    page.click(f"#engines input[value={FAST}]")
    page.until("() => document.querySelector('#drop-faults').hidden")


def test_a_link_opens_its_scenario_and_preset_in_its_language(address: str, page: Page) -> None:
    _begin(page, address, "?scenario=ball&preset=tennis&lang=de")
    assert page.ask("() => document.documentElement.lang") == "de"
    assert page.text("#drop-head") == "Lass den Ball fallen"
    assert page.text("#parameters label") == "Fallhöhe"
    assert _value(page, 0) == 1
    assert _value(page, 1) == 0.7451
    page.click("nav a[lang=en]")
    page.until("() => document.documentElement.lang === 'en'")
    page.until("() => document.querySelector('#preset').value === 'tennis'")
    _begin(page, address, "?scenario=balll")
    assert "no experiment called balll" in page.until("() => document.body.innerText")


def test_nothing_moves_by_itself_for_who_wants_that(page: Page) -> None:
    page.click("#go")
    page.until(DONE)
    assert page.ask("() => document.querySelector('#replay [name=play]').innerText") == "▶ Play"
    page.click("#replay [name=play]")
    page.until("() => Number(document.querySelector('#replay [name=time]').value) > 0.05")
    page.click("#replay [name=play]")


# ---- weight, access, small screens


def test_a_motion_that_is_stopped_and_played_again_is_not_played_twice(
    page: Page, address: str
) -> None:
    _begin(page, address)
    drawn = page.ask(
        """() => { const frames = [], there = [window.requestAnimationFrame, Plotly.restyle];
            let drawn = 0;
            window.requestAnimationFrame = (one) => frames.push(one);
            Plotly.restyle = () => { drawn += 1; return new Promise(() => {}); };
            const play = document.querySelector("#replay [name=play]");
            for (let i = 0; i < 3; i += 1) play.click();
            frames.forEach((one) => one(performance.now()));
            play.click();
            [window.requestAnimationFrame, Plotly.restyle] = there;
            return drawn; }"""
    )
    assert drawn == 1


def test_the_page_weighs_little(address: str) -> None:
    """All that a browser loads before engines run, as it is sent."""
    seen: dict[str, int] = {}
    wanted = ["/"]
    while wanted:
        path = wanted.pop()
        if path in seen:
            continue
        asked = urllib.request.Request(address + path[1:], headers={"Accept-Encoding": "gzip"})
        with urllib.request.urlopen(asked, timeout=60) as answer:
            sent = answer.read()
            is_packed = answer.headers.get("content-encoding") == "gzip"
        seen[path] = len(sent)
        if "plotly" not in path:
            text = (gzip.decompress(sent) if is_packed else sent).decode("utf-8")
            wanted += re.findall(r"""["'](/static/[\w.]+)["']""", text)
    assert {"/static/plotly.js", "/static/replay.js", "/static/samples.js"} <= set(seen)
    assert sum(seen.values()) < MOST_BYTES


def _axe() -> Path | None:
    for name in ("axe_core_python", "axe_playwright_python"):
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.submodule_search_locations:
            return Path(spec.submodule_search_locations[0]) / "axe.min.js"
    return None


@pytest.mark.skipif(_axe() is None, reason="no axe: pip install axe-core-python")
@pytest.mark.parametrize("query", ["", "?lang=de"])
def test_no_serious_fault_of_access_is_found(
    address: str, page: Page, query: str, sound: Path
) -> None:
    _begin(page, address, query)
    page.click("#expert")
    page.ask("() => document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    page.send_file("#file", sound)
    page.until("() => document.querySelector('#impacts input')")
    script = _axe()
    assert script is not None
    page.ask(f"() => {{ {script.read_text(encoding='utf-8')}; return 1; }}")
    found = page.ask("async () => (await axe.run(document)).violations")
    told = [
        (one["impact"], one["id"], [node["html"][:200] for node in one["nodes"]]) for one in found
    ]
    assert [one for one in told if one[0] in ("serious", "critical")] == []


#: numbers all that can be used now, and gives the numbers; of radio buttons a key reaches one
NUMBER_CONTROLS = """() => {
    const all = [...document.querySelectorAll("input, select, button, a[href]")];
    const used = all.filter((one) => one.checkVisibility() && !one.disabled);
    const single = used.filter((one) => one.type !== "radio");
    return single.map((one, i) => (one.dataset.reached = String(i)));
}"""
#: texts that are smaller than so many pixels
SMALL = """(least) => {
    const isText = (node) => node.nodeType === Node.TEXT_NODE && node.textContent.trim();
    const all = [...document.querySelectorAll("body *")].filter((one) => one.checkVisibility());
    const said = all.filter((one) => [...one.childNodes].some(isText));
    const small = said.filter((one) => parseFloat(getComputedStyle(one).fontSize) < least);
    return small.map((one) => one.outerHTML.slice(0, 80));
}"""


def test_every_control_is_reached_by_keys(address: str, page: Page) -> None:
    _begin(page, address)
    wanted = set(page.ask(NUMBER_CONTROLS))
    page.ask("() => document.activeElement.blur()")
    reached = set()
    for _ in range(len(wanted) + 30):
        page.press("Tab")
        reached.add(page.ask("() => document.activeElement.dataset.reached"))
    missed = "(all) => all.map((i) => document.querySelector(`[data-reached='${i}']`).outerHTML)"
    assert page.ask(missed, sorted(wanted - reached)) == []


def test_a_phone_shows_it_all_without_scrolling_sideways(address: str, browser: Browser) -> None:
    with browser(size_px=(400, 800)) as page:
        _begin(page, address)
        assert page.ask("() => document.documentElement.scrollWidth") <= 400
        assert page.ask(SMALL, 11) == []


@pytest.mark.parametrize("size_px", [(1400, 900), (400, 800)])
def test_the_curve_is_in_sight_while_an_engines_own_value_is_moved(
    address: str, browser: Browser, size_px: tuple[int, int]
) -> None:
    with browser(size_px=size_px) as page:
        _begin(page, address)
        page.click("#expert")
        page.ask("() => document.querySelectorAll('details').forEach((one) => (one.open = true))")
        page.focus("#contact-values details:last-child input[type=range]")
        shown = "(s) => document.querySelector(s).getBoundingClientRect().toJSON()"
        curve, slider = page.ask(shown, "#curve"), page.ask(shown, ":focus")
        assert curve["top"] >= -1
        assert curve["bottom"] <= size_px[1]
        assert 0 <= slider["top"] < size_px[1]
        # on a phone it stands above the slider, and does not cover it
        is_beside = slider["right"] <= curve["left"]
        assert is_beside or curve["bottom"] <= slider["top"]


# ---- a real ball


def _drop(path: Path, restitution: float, height_m: float = 0.5) -> list[float]:
    """A sound of a ball: when each impact is heard, to a part of a sample."""
    span = 2 * np.sqrt(2 * height_m / G_M_S2) * restitution
    times = [3.0]  # the sound begins when the page asks for it, and the page listens a little later
    while span > 0.08 and len(times) < 10:
        times.append(times[-1] + span)
        span *= restitution
    random = np.random.default_rng(7)
    sound = 1e-4 * random.standard_normal(int((times[-1] + 5) * RATE_HZ))
    for n, time_s in enumerate(times):
        first = int(np.ceil(time_s * RATE_HZ))
        since = np.arange(first, first + RATE_HZ // 50) / RATE_HZ - time_s
        ring = np.exp(-since / 0.002) * np.sin(2 * np.pi * 3000 * since)
        sound[first : first + len(since)] += 0.6 * max(0.3, restitution**n) * ring
    soundfile.write(path, sound, RATE_HZ, subtype="PCM_16")
    return times


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with a ball of 0.75 in it."""
    path = tmp_path_factory.mktemp("sounds") / "ball.wav"
    _drop(path, 0.75)
    return path


def _microphone(path: Path) -> tuple[str, ...]:
    return (
        "--use-fake-ui-for-media-stream",
        "--use-fake-device-for-media-stream",
        f"--use-file-for-fake-audio-capture={path}%noloop",
    )


@pytest.mark.parametrize("restitution", [0.5, 0.75, 0.9])
def test_the_microphone_tells_how_a_ball_bounces(
    address: str, browser: Browser, tmp_path: Path, restitution: float
) -> None:
    times = _drop(tmp_path / "ball.wav", restitution)
    with browser(_microphone(tmp_path / "ball.wav")) as page:
        page.open(address)
        page.click("#record")
        page.until("() => document.querySelectorAll('#impacts input').length")
        assert "The browser hands on the sound as it is" in page.text("#granted")
        assert len(
            page.ask(
                "() => [...document.querySelectorAll('#impacts input')].map((one) => one.value)"
            )
        ) == len(times)
        said = re.search(r"0\.\d+", page.text("#restitution"))
        assert said is not None
        # a thousandth, which is asked of the instrument
        assert float(said[0]) == pytest.approx(restitution, rel=1e-3)


def test_a_microphone_that_is_not_allowed_is_told_with_a_way_out(
    address: str, browser: Browser
) -> None:
    flags = ("--use-fake-device-for-media-stream", "--deny-permission-prompts")
    with browser(flags) as page:
        page.open(address)
        page.click("#record")
        page.until("() => !document.querySelector('#real-faults').hidden")
        assert "was not allowed" in page.text("#real-faults")
        assert "send a sound file" in page.text("#real-faults")


def test_a_page_without_a_microphone_says_what_to_do(page: Page, address: str) -> None:
    """As on plain http of another machine, where browsers have none to give."""
    _begin(page, address)
    page.ask("() => { Object.defineProperty(navigator, 'mediaDevices', {value: undefined}); }")
    page.click("#record")
    page.until("() => !document.querySelector('#real-faults').hidden")
    assert "only to a secure page" in page.text("#real-faults")
    assert "simcompare lab --share" in page.text("#real-faults")


def test_a_file_is_heard_struck_and_fitted(page: Page, address: str, sound: Path) -> None:
    _begin(page, address)
    page.send_file("#file", sound)
    page.until("() => document.querySelectorAll('#impacts input').length > 4")
    page.focus("#impacts input")
    page.press("Space")
    assert page.ask("() => document.querySelector('#wave').data.at(-1).marker.symbol[0]") == "x"
    page.press("Space")
    assert (
        page.ask("() => document.querySelector('#wave').data.at(-1).marker.symbol[0]")
        == "triangle-down"
    )
    page.click("#fit")
    page.until(
        "() => document.querySelector('#fit-table table') &&"
        " !document.querySelector('#fitted').hidden"
    )
    assert FAST in page.text("#fit-table")
    # the ball that was heard, and the engine after the fit: before, it does not bounce
    heard, fitted = page.ask("() => document.querySelector('#bounces').data.map((one) => one.y)")
    assert heard == pytest.approx([0.75] * len(heard), abs=1e-3)
    # one step of 1 ms is a hundredth of the shortest flight
    assert fitted == pytest.approx(heard, rel=0.02)
    links = page.ask("() => [...document.querySelectorAll('#files a')].map((one) => one.href)")
    assert links
    for link in links:
        with urllib.request.urlopen(link, timeout=60) as answer:
            assert answer.read()
    # also after the page was closed, and the lab was started anew
    _begin(page, address)
    page.click("#stored button")
    page.until("() => document.querySelector('#fit-table').innerText.includes('elasticity')")
    assert page.ask("() => document.querySelectorAll('#impacts input').length") > 4
    assert "fitted" in page.text("#shown-level")


def test_a_table_of_bounces_is_fitted(page: Page, address: str, tmp_path: Path) -> None:
    rows = [f"{n},{0.5 * 0.8**n:.6f}" for n in range(1, 8)]
    (tmp_path / "flights.csv").write_text("\n".join(["Bounce,Time interval (s)", *rows]))
    _begin(page, address)
    page.send_file("#file", tmp_path / "flights.csv")
    page.until("() => document.querySelector('#restitution').innerText.includes('0.8000')")
    assert page.ask("() => document.querySelector('#wave-figure').hidden")
    page.click("#fit")
    page.until("() => document.querySelector('#fit-table table')")
    assert FAST in page.text("#fit-table")


def test_a_ball_is_held_against_falling_balls_alone(page: Page, address: str, sound: Path) -> None:
    _begin(page, address, "?scenario=sliding_block")
    page.send_file("#file", sound)
    # the page turns to the ball, which falls as high as the real one
    page.until("() => document.querySelector('#scores').innerText.includes('your ball')")
    assert page.ask("() => document.querySelector('#scenario').value") == "ball"
    assert _value(page, 0) == pytest.approx(0.5, rel=0.01)
    assert _value(page, 1) == pytest.approx(0.75, rel=1e-3)
    names = page.ask("() => document.querySelector('#curve').data.map((one) => one.name)")
    assert names[-1] == "your ball"
    page.ask(
        "() => { const one = document.querySelector('#scenario'); one.value = 'sliding_block';"
        " one.dispatchEvent(new Event('change')); }"
    )
    page.until(DONE)
    assert "your ball" not in page.text("#scores")
    assert page.text("#drop-head") == "Sliding block"


def test_only_engines_that_have_a_script_are_offered_for_one(page: Page, address: str) -> None:
    _begin(page, address)
    page.click("#engines input[value=box2d]")
    page.until(DONE)
    page.until("() => document.querySelector('#scores').innerText.includes('box2d')")
    options = "() => [...document.querySelectorAll('#take-engine option')].map((one) => one.value)"
    assert page.ask(options) == [FAST]


def test_a_film_is_scaled_by_keys_and_tracked(page: Page, address: str, tmp_path: Path) -> None:
    pytest.importorskip("cv2", reason="films need OpenCV: pip install 'simcompare[web]'")
    _begin(page, address)
    page.send_file("#file", lab_films.film(tmp_path / "ball.avi"))
    page.until("() => document.querySelector('#frame').naturalWidth")
    page.focus("[data-point='1']")
    page.press("ArrowDown")
    page.press("ArrowUp")
    # the points begin half a picture apart
    page.put("#metres", lab_films.HEIGHT / 2 / lab_films.METRE_PX)
    page.click("#scale-form button")
    page.until("() => document.querySelectorAll('#impacts span').length > 2")
    # impacts of a film follow from its flights: none can be struck out
    assert not page.ask("() => document.querySelectorAll('#impacts input').length")
    said = re.search(r"0\.\d+", page.text("#restitution"))
    assert said is not None
    # two pictures of a second with 60 are 1 % of the time of three flights
    assert float(said[0]) == pytest.approx(0.8, rel=0.02)


def test_what_is_no_recording_is_refused_in_words(
    page: Page, address: str, tmp_path: Path, sound: Path
) -> None:
    (tmp_path / "ball.wav").write_bytes(b"\x7fELF\x00\x01")
    _begin(page, address)
    # nothing of a recording from before stands under the refusal
    page.send_file("#file", sound)
    page.until("() => document.querySelector('#impacts input')")
    page.send_file("#file", tmp_path / "ball.wav")
    page.until("() => !document.querySelector('#real-faults').hidden")
    assert len(page.text("#real-faults")) > 20
    assert page.ask("() => document.querySelector('#heard').hidden")


def test_a_name_that_is_a_script_stays_a_name(page: Page, address: str) -> None:
    page.open(f"{address}?group={'%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E'}")
    page.until("() => document.querySelector('#group').value.includes('onerror')")
    assert page.ask("() => document.querySelectorAll('img[src=x]').length") == 0


def test_the_teacher_closes_the_queue_and_is_asked_again_for_a_pin(
    page: Page, address: str
) -> None:
    _begin(page, address)
    page.open(address + "teacher")
    page.until("() => document.querySelector('#groups').innerText.includes('group ')")
    for state in ("closed", "open"):
        page.click("#switch")
        page.until(f"() => document.querySelector('#state').innerText.includes('{state}')")
    # a lab that was started anew has another PIN
    page.ask(
        """() => { window.fetch = () => Promise.resolve(
            new Response('{"faults": ["This PIN is not right."]}', { status: 401 })); }"""
    )
    page.click("#switch")
    page.until("() => !document.querySelector('#enter').hidden")
    assert "not right" in page.text("#fault")
    page.ask("() => { window.fetch = () => Promise.reject(new TypeError('Failed to fetch')); }")
    page.click("#enter button")
    page.until("() => document.querySelector('#fault').innerText.includes('does not answer')")
