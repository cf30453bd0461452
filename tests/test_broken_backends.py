"""A backend of somebody else's package that is broken: one sentence, and all others go on."""

from __future__ import annotations

import pytest

from simcompare.engine import engines
from simcompare.errors import EngineBroken

KIT = "from simcompare.kit import EngineBackend\n"
BROKEN = {
    "empty": (
        "class BACKEND: pass",
        "lacks name, features, known_limits, mapping, version(), open(), simulate();",
    ),
    "nothing": (
        "BACKEND = None",
        "lacks name, features, known_limits, mapping, version(), open(), simulate();",
    ),
    "half": (
        "class BACKEND:\n    name, features, known_limits, mapping = 'half', frozenset(), (), '-'\n"
        "    version = '1.0'\n    def open(self, scenario, settings): pass\n",
        "lacks version(), simulate(); simcompare.kit and CONTRIBUTING.md show",
    ),
    "on_kit": (KIT + "class BACKEND(EngineBackend):\n    name = 'on_kit'\n    features = ()\n",
               "lacks known_limits, mapping, simulation, library;"),
    "raises": ("raise RuntimeError('the driver is missing')",
               "cannot be loaded: RuntimeError: the driver is missing"),
    "other": ("ENGINE = 1", "cannot be loaded: AttributeError"),
    "typo": ("def f(:", "cannot be loaded: SyntaxError"),
    "leaves": ("raise SystemExit(1)", "cannot be loaded: SystemExit: 1"),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_backend_says_what_it_lacks_or_why_it_cannot_be_loaded(add_engine, name):
    code, words = BROKEN[name]
    add_engine(name, code=code)
    with pytest.raises(EngineBroken) as caught:
        engines.get(name)
    assert str(caught.value).startswith(f"the backend of {name} ({name}_engine:BACKEND) {words}")


@pytest.mark.parametrize("name", engines.names())
def test_our_own_backends_lack_nothing(name):
    assert engines.get(name).name == name


def test_broken_backends_are_rows_and_the_others_run(add_engine, call, fall):
    add_engine("toy")
    for name, (code, _) in BROKEN.items():
        add_engine(name, code=code)
    words = ("--engine", f"toy,{','.join(BROKEN)}", "--contact", "default", "--no-report")
    code, out, err = call("run", fall, *words)
    assert code == 3
    assert "Traceback" not in out + err
    text = " ".join(out.split())
    assert "toy" in text
    for name, (_, words) in BROKEN.items():
        assert f"the backend of {name} " in text
        assert words in text


@pytest.mark.parametrize(
    "words",
    [
        ("list",), ("doctor",), ("show", "ball"), ("characterize", "force", "--engine", "empty"),
        ("tune", "--restitution", "0.8", "--engine", "empty"),
        ("tune", "--engine", "empty", "--numbers", "1,2"),
        ("export", "ball", "--format", "script", "--engine", "empty"),
        ("run", "ball", "--engine", "empty", "--assist", "landing"),
        ("run", "ball", "--engine", "empty:rk4"),
        ("fit", "ball", "-r", "ittf_table_tennis_rebound", "--engine", "empty"),
        ("validate", "pendulum", "-r", "pendulum_free_swing", "--engine", "empty", "--no-report"),
    ],
    ids=" ".join,
)  # fmt: skip
def test_no_verb_ends_in_a_traceback_for_an_empty_backend(
    add_engine, call, words, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    add_engine("empty", code=BROKEN["empty"][0])
    _, out, err = call(*words)
    assert "Traceback" not in out + err
    assert "AttributeError" not in out + err
    if "empty" in words:
        assert "the backend of empty (empty_engine:BACKEND) lacks name" in " ".join(
            (out + err).split()
        )
