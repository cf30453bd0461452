"""Engines that cannot run here: each is named with its reason and with what a user can do."""

from __future__ import annotations

import json
import shlex
import subprocess

import pytest

from simcompare.engine import elsewhere, engines
from simcompare.errors import EngineElsewhere, UnknownName
from simcompare.exporters.twins import FORMATS

NAMED = ["agx", "chrono", "coppeliasim", "gazebo", "newton", "raisim", "vortex"]
ACCELERATION_M_S2 = 1.9536
RESULTS = {
    "robot.csv": "time (s),speed (m/s)\n"
    + "".join(f"{0.01 * i:.2f},{ACCELERATION_M_S2 * 0.01 * i:.6f}\n" for i in range(101)),
    "bounces.csv": "bounce,rebound_height (m)\n1,0.64\n2,0.41\n",
}


@pytest.fixture
def one_backend(monkeypatch):
    """Only pymunk is built in, so that doctor is quick."""
    kept = {"pymunk": engines.targets()["pymunk"]}
    monkeypatch.setattr(engines, "_built_in", lambda: kept)


# --- the data ---------------------------------------------------------------------------------


def test_the_engines_that_people_ask_for_are_there():
    assert set(NAMED) <= set(elsewhere.names())


@pytest.mark.parametrize("engine", elsewhere.ENGINES, ids=lambda engine: engine.name)
def test_an_entry_gives_reasons_with_references_and_a_format_that_is_written(engine):
    for text in (engine.title, engine.why_reference, engine.way_reference):
        assert text.strip()
    for sentence in (engine.why, engine.way):
        assert sentence.endswith(".")
    assert engine.file_format in FORMATS
    assert bool(engine.contains) == bool(engine.contains_reference)
    assert not engine.contains or engine.contains in engines.names()


def test_no_name_means_two_engines_or_a_backend():
    words = [word for engine in elsewhere.ENGINES for word in (engine.name, *engine.also_called)]
    assert len(words) == len(set(words))
    assert all(word.isalnum() and word.islower() for word in words)
    assert all(elsewhere.find(name) is None for name in [*engines.names(), "all"])


# --- asked for by name ------------------------------------------------------------------------


def test_all_does_not_mean_them():
    assert not set(NAMED) & set(engines.select("all"))


@pytest.mark.parametrize("engine", elsewhere.ENGINES, ids=lambda engine: engine.name)
def test_to_run_one_is_refused_with_its_reason_and_what_to_do(call, engine):
    code, out, err = call("run", "ball", "--engine", engine.name)
    assert (code, out) == (2, "")
    assert err.startswith(f"simcompare: {engine.title} cannot run here. {engine.why}")
    assert engine.command in err
    assert f"[{engine.way_reference}]" in err
    assert f"engines of simcompare: {', '.join(engines.names())}" in err
    assert "did you mean" not in err


@pytest.mark.parametrize(
    ("typed", "title"),
    [
        ("CoppeliaSim", "CoppeliaSim"),
        ("copeliasim", "CoppeliaSim"),
        ("V-REP", "CoppeliaSim"),
        ("Newton Dynamics", "Newton Dynamics"),
        ("pychrono", "Project Chrono"),
        ("gz-sim", "Gazebo"),
        ("vortex_studio", "Vortex Studio"),
    ],
)
def test_other_spellings_are_understood(typed, title):
    for ask in (engines.get, engines.select, lambda text: engines.select(f"pymunk,{text}")):
        with pytest.raises(EngineElsewhere, match=f"^{title} cannot run here"):
            ask(typed)


@pytest.mark.parametrize("typed", ["mujco", "dort", "al", "", "nonsense", "-"])
def test_other_wrong_names_are_told_as_before(typed):
    assert elsewhere.find(typed) is None
    with pytest.raises(UnknownName, match="no engine is called"):
        engines.get(typed)


def test_somebodys_own_backend_of_that_name_runs(add_engine, call, fall, one_backend):
    add_engine("chrono")
    code, _, err = call("run", fall, "--engine", "chrono", "--contact", "default", "--no-report")
    assert code == 0, err
    _, out, _ = call("list", "--json")
    assert "chrono" in json.loads(out)["engines"]
    assert "chrono" not in json.loads(out)["engines_elsewhere"]
    _, out, _ = call("doctor", "--json")
    assert "chrono" not in [one["engine"] for one in json.loads(out)["engines_elsewhere"]]


# --- list and doctor --------------------------------------------------------------------------


def test_list_names_them_in_a_line_of_their_own(call):
    code, out, _ = call("list")
    assert code == 0
    assert f"Not to be run here: {', '.join(elsewhere.names())} (" in " ".join(out.split())
    _, out, _ = call("list", "--json")
    assert json.loads(out)["engines_elsewhere"] == elsewhere.names()
    assert not set(NAMED) & set(json.loads(out)["engines"])


def test_doctor_gives_each_its_reason_and_its_way_and_is_well(call, one_backend):
    code, out, _ = call("doctor", "-v")
    assert code == 0
    flat = " ".join(out.split())
    for engine in elsewhere.ENGINES:
        assert f"{engine.name} ({engine.title})" in out
        assert f"why: {engine.why} [{engine.why_reference}]" in flat
        assert f"{engine.way} [{engine.way_reference}]" in out
        assert engine.command in out
        assert engine.here in out
    for sentence, commands in elsewhere.BACK:
        assert sentence in flat
        assert all(f"\n    {command}\n" in out for command in commands)


def test_doctor_as_json_keeps_backends_and_these_apart(call, one_backend):
    code, out, _ = call("doctor", "--json")
    assert code == 0
    told = json.loads(out)
    assert [one["engine"] for one in told["engines"]] == ["pymunk"]
    assert [one["engine"] for one in told["engines_elsewhere"]] == elsewhere.names()
    for one in told["engines_elsewhere"]:
        assert one["why"]
        assert one["way_reference"]
        assert one["commands"][0].startswith("simcompare export ")
        assert "simcompare import robot.csv" in one["commands_back"]


# --- what is printed can be pasted ------------------------------------------------------------


@pytest.mark.parametrize("command", sorted({engine.command for engine in elsewhere.ENGINES}))
def test_the_command_that_carries_a_scene_works(call, command, tmp_path):
    program, *words = shlex.split(command)
    code, out, err = call(*words)
    assert (program, code) == ("simcompare", 0), err
    assert (tmp_path / out.strip()).read_text(encoding="utf-8").startswith("<?xml")


def test_what_they_contain_of_ours_can_run_that_scene(call):
    for command in {engine.here for engine in elsewhere.ENGINES if engine.here}:
        code, _, err = call(*shlex.split(command)[1:], "--no-report", "--contact", "tuned")
        assert code == 0, err


def test_the_commands_that_bring_results_back_work(call, write, tmp_path):
    """With the tables whose headers are told, in the order in which they are told."""
    told = " ".join(sentence for sentence, _ in elsewhere.BACK)
    for name, text in RESULTS.items():
        assert f"{name} with the header: {text.splitlines()[0]}" in told
        write(name, text)
    told_back = ""
    for command in [command for _, commands in elsewhere.BACK for command in commands]:
        program, verb, *words = shlex.split(command)
        if program == "echo":
            subprocess.run(["sh", "-c", command], cwd=tmp_path, check=True)
            continue
        # one engine is enough here
        quick = [] if verb == "import" else ["--engine", "mujoco", "--no-report"]
        code, out, err = call(verb, *words, *quick)
        assert (program, code) == ("simcompare", 0), (command, err)
        told_back += out
    assert "Forward speed of the robot" in told_back
    assert "rebound_height 1" in told_back
