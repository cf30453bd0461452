"""Installs simcompare step by step into the environment that runs this, with a line for each step.

Usage: ``python tools/install.py ENGINES [EXTRA …]``, engines separated by commas, or ``all``;
with ``check`` in place of extras it only looks at the names.
An engine that cannot be installed costs its own line and nothing else. Engines are taken as wheels
only: to build one takes a compiler and minutes, so the line says how, and leaves it to the user.
"""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PIP = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
#: what an extra is, for people
MEANING = {
    "hardware": "readers of logs", "web": "the lab in the browser", "test": "tools of the tests",
    "gym": "environments to learn in",
}  # fmt: skip
#: time between two looks at how far a step is
EVERY_S = 2.0
PYTHON = f"{sys.version_info[0]}.{sys.version_info[1]}"


def main() -> int:
    """Installs what the command line names; not 0 where anything but an engine failed."""
    names, extras = sys.argv[1], sys.argv[2:]
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    optional = tomllib.loads(text)["project"]["optional-dependencies"]
    known = [name for name in optional if has_backend(name)]
    engines = known if names == "all" else names.split(",")
    for name in engines:
        if name not in known:
            print(f"ENGINES={names}: no engine {name!r}; expected all or some of {','.join(known)}")
            return 2
    if extras == ["check"]:
        return 0
    if not install("simcompare and what it computes with", ["--editable", str(ROOT)]):
        return 1
    for extra in extras:
        # what it names of simcompare itself is a step of its own
        needed = [part for part in optional[extra] if not part.startswith("simcompare")]
        if not install(MEANING.get(extra, extra), needed):
            return 1
    for name in engines:
        install(
            name, ["--only-binary", ":all:", *optional[name]], cure=how_to_build(optional[name])
        )
    return 0


def has_backend(name: str) -> bool:
    """Whether an extra is an engine's: that has a file of its name, or a folder."""
    places = (f"{name}_.py", f"{name}/backend.py")
    return any((ROOT / "backends" / place).is_file() for place in places)


def install(what: str, words: list[str], cure: str = "") -> bool:
    """One step of pip and its line: size and time, or why not and what to do."""
    print(f"{what:40s} … ", end="", flush=True)
    started, before = time.monotonic(), size_mb()

    def so_far() -> str:
        return f"{size_mb() - before:5.0f} MB, {time.monotonic() - started:3.0f} s"

    failed, told = run([*PIP, *words], lambda: f"{what:40s} … {so_far()}")
    if not failed:
        print(so_far(), flush=True)
        return True
    faults = [line for line in told.splitlines() if line.startswith("ERROR")]
    if cure and "No matching distribution" in told:
        print(f"left out: no wheel for Python {PYTHON} on this machine.\n    {cure}", flush=True)
    else:
        print("failed: " + "\n    ".join(faults or told.splitlines()[-3:]), flush=True)
    return False


def run(command: list[str], line: Callable[[], str]) -> tuple[bool, str]:
    """Whether a command failed, and what it told; in a terminal a line grows while it runs."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while True:
        try:
            _, told = process.communicate(timeout=EVERY_S if sys.stdout.isatty() else None)
            break
        except subprocess.TimeoutExpired:
            print(f"\r{line()}", end="", flush=True)
    if sys.stdout.isatty():  # what comes now stands where size and time were
        print(f"\r{line().partition(' … ')[0]} … ", end="", flush=True)
    return process.returncode != 0, told


def how_to_build(requirements: list[str]) -> str:
    """One line on how to get an engine that has no wheel here."""
    pip = os.path.relpath(Path(sys.prefix, "bin", "pip"))
    command = f"apt-get install g++ python{PYTHON}-dev && {pip} install {shlex.join(requirements)}"
    sudo = "" if os.geteuid() == 0 else "sudo "
    return f"To build it, in about ten minutes: {sudo}{command}"


def size_mb() -> float:
    """Size of the environment's packages [MB]."""
    files = (Path(top, name) for top, _, names in os.walk(sys.prefix) for name in names)
    return sum(path.lstat().st_size for path in files) / 1e6


if __name__ == "__main__":
    sys.exit(main())
