"""What tests share: skips by engine, toy engines as packages, a toy scenario, the CLI."""

from __future__ import annotations

import errno
import gc
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import hypothesis
import pytest

from simcompare.hardware import confined
from simcompare.model import whole
from simcompare.running import runner
from simcompare.scenarios import trust
from tests.present import need, skipping_without_its_engine

# no test depends on the clock, also not on a busy machine
hypothesis.settings.register_profile("simcompare", deadline=None)
hypothesis.settings.load_profile("simcompare")

# the thread of pytest-xdist only waits for orders: logs are read in forks, which start faster
confined.fork_is_safe = lambda: sys.platform == "linux"


def pytest_configure(config):
    config.addinivalue_line("markers", "engines(*names): skipped where one of these is absent")


def pytest_collection_finish():
    """What is imported and collected by now is not looked through for garbage in every test."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item):
    need(*(name for marker in item.iter_markers("engines") for name in marker.args))
    with skipping_without_its_engine():
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    with skipping_without_its_engine():
        return (yield)


@pytest.fixture(scope="session", autouse=True)
def engine_processes():
    """Engines' processes are started once: to start one takes longer than most runs do.

    They have the environment and the import path of that moment: see ``own_processes``.
    """
    with runner.kept_processes():
        yield


@pytest.fixture
def own_processes():
    """Each run starts its processes anew, as a command does, with what is set then."""
    token = runner._waiting.set(None)
    yield
    runner._waiting.reset(token)


@pytest.fixture(scope="session")
def real():
    """The folder of real recordings."""
    folder = os.environ.get("SIMCOMPARE_DATA")
    if not folder:
        pytest.skip("SIMCOMPARE_DATA is not set: it names the folder of real recordings")
    return Path(folder)


#: a backend over the plain protocol, as somebody else's package would hold it; exact free fall
ENGINE = """
import os, sys, time
import numpy as np
from simcompare.kit import Feature, KnownLimit, Trajectory
{on_import}

class Toy:
    name = "{name}"
    features = frozenset(Feature)
    known_limits = (KnownLimit("It only falls.", "this file"),)
    mapping = "none"

    def version(self):
        return "1.0"

    def open(self, scenario, settings):
        raise NotImplementedError

    def simulate(self, scenario, settings):
        world = scenario.world
        times = np.arange(round(world.duration_s / world.step_s) + 1) * world.step_s
        signals = {{}}
        gravity = np.array(world.gravity_m_s2)
        for name, body in scenario.moving_bodies().items():
            t = times[:, None]
            start = np.array(body.position_m) + t * np.array(body.velocity_m_s)
            signals[name + ".position_m"] = start + gravity * t * t / 2
            signals[name + ".velocity_m_s"] = np.array(body.velocity_m_s) + gravity * t
        extra = {{}}
        {during}
        return Trajectory("{name}", times, signals, version="1.0", **extra)

BACKEND = Toy()
"""

FALL_YAML = """\
name: fall
title: Free fall
question: Does it fall as Galilei said?
parameters:
  height_m: {value: 1.0, min: 0.9, max: 20, text: "Height at release."}
world: {duration_s: 0.4, step_s: 0.001}
bodies:
  ball:
    mass_kg: 1
    inertia_kg_m2: [0.1, 0.1, 0.1]
    position_m: [0, 0, "${height_m}"]
    shapes: [{type: sphere, radius_m: 0.1}]
probes:
  height_m: {observe: ball.position_m, component: 2, label: Height, unit: m}
measures:
  - {function: bounces, probe: height_m}
tolerances:
  penetration: {absolute: 0.001, reason: "A body above the floor is not in it."}
"""

FALL_REFERENCE = """\
import numpy as np

def reference(parameters, time_s):
    zero = np.zeros(len(time_s))
    height = parameters["height_m"] - 9.80665 * time_s**2 / 2
    return {"ball.position_m": np.column_stack((zero, zero, height))}
"""


@pytest.fixture
def add_engine(tmp_path, monkeypatch, own_processes):
    """Installs a toy engine as a separate package: a module and its dist-info with entry point."""
    site = tmp_path / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(str(site))
    inherited = os.environ.get("PYTHONPATH")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, (str(site), inherited))))

    def add(name: str, during: str = "pass", *, on_import: str = "", code: str | None = None):
        module = f"{name}_engine"
        text = code or ENGINE.format(name=name, during=during, on_import=on_import)
        (site / f"{module}.py").write_text(text, encoding="utf-8")
        info = site / f"{module}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(
            f"[simcompare.backends]\n{name} = {module}:BACKEND\n"
        )

    yield add
    for module in [m for m in sys.modules if m.endswith("_engine")]:
        if str(site) in str(getattr(sys.modules[module], "__file__", "")):
            del sys.modules[module]


@pytest.fixture
def fall(tmp_path: Path) -> Path:
    """A user's scenario folder with a reference, on which every exact engine passes."""
    folder = tmp_path / "mine" / "fall"
    folder.mkdir(parents=True)
    (folder / "fall.yaml").write_text(FALL_YAML, encoding="utf-8")
    (folder / "reference.py").write_text(FALL_REFERENCE, encoding="utf-8")
    trust.allow(folder / "reference.py")
    return folder


@pytest.fixture(scope="module")
def one_motion():
    """Lets ``estimate`` simulate each motion once in a module, however often it is measured."""
    from simcompare.verbs import estimate as verb

    run, kept = verb.run_jobs, {}

    def once(jobs, **rest):
        asked = repr(jobs)
        if asked not in kept:
            kept[asked] = run(jobs, **rest)
        return kept[asked]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(verb, "run_jobs", once)
        yield


@pytest.fixture(scope="session")
def sweep(tmp_path_factory) -> tuple[Any, ...]:
    """Three stored runs of one engine from three heights; tests copy what they change."""
    import simcompare

    need("pymunk")
    out = tmp_path_factory.mktemp("sweep") / "runs"
    return tuple(
        simcompare.run("ball", engine="pymunk", seeds=3, set={"drop_height": height}, out=out)
        for height in ("1m", "0.3m", "2m")
    )


@pytest.fixture
def write(tmp_path: Path):
    """Writes a text file and returns its path."""

    def to(name: str, text: str | bytes) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return to


@pytest.fixture
def call(monkeypatch, capsys, tmp_path):
    """Runs the command line in this process: ``call("list") -> (exit code, stdout, stderr)``."""
    from simcompare.cli import main
    from simcompare.running import interruption

    def run(*words: object) -> tuple[Any, str, str]:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["simcompare", *map(str, words)])
        capsys.readouterr()
        handlers = {number: signal.getsignal(number) for number in interruption.SIGNALS}
        hook = sys.unraisablehook  # the command takes all of it over
        try:
            with pytest.raises(SystemExit) as stop:
                main()
        finally:
            sys.unraisablehook = hook
            for number, handler in handlers.items():
                signal.signal(number, handler)
        out, err = capsys.readouterr()
        return stop.value.code or 0, out, err

    return run


@pytest.fixture
def command(tmp_path):
    """Runs the command line in a process of its own."""

    def run(*words: object, timeout: float = 300, **more: Any) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "simcompare", *map(str, words)],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
            **more,
        )

    return run


@pytest.fixture(params=["a disk without locks", "a system without locks"])
def no_locks(monkeypatch, request):
    """Files that nobody can lock."""
    if request.param == "a system without locks":
        monkeypatch.setattr(whole, "fcntl", None)
        return

    def refused(*_):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(whole.fcntl, "flock", refused)
