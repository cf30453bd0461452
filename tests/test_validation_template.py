"""The mapping file that validate writes: all keys, candidates, and taken when it is filled in."""

from __future__ import annotations

import re
import shlex

import numpy as np
import pytest
import yaml

from simcompare.errors import InputError
from simcompare.hardware import mapping as mappings
from simcompare.inference import plan as plans
from simcompare.inference.plan import (
    Calibration,
    ClockPlan,
    Compared,
    Driven,
    Happened,
    Known,
    Plan,
    ReadOff,
    Window,
)
from simcompare.scenarios import catalogue
from simcompare.verbs.validation_template import template
from tests.validated import swing

PARTS = (Plan, Known, ReadOff, Compared, Driven, Happened, Window, Calibration, ClockPlan)


@pytest.fixture
def log(tmp_path, monkeypatch):
    """A swing with units in its header."""
    monkeypatch.chdir(tmp_path)
    time_s = np.arange(0, 3, 0.01)
    rows = (f"{t:.2f},{0.5 * np.cos(8 * t):.5f},{t * 0:.1f}" for t in time_s)
    text = "t (s),hinge (rad),supply (V)\n" + "\n".join(rows) + "\n"
    (tmp_path / "swing.csv").write_text(text, encoding="utf-8")
    return "swing.csv"


def test_every_key_of_a_plan_is_in_the_template():
    text = "".join(template(name) for name in ("ball", "motor_step"))
    keys = {key for part in PARTS for key in part.model_fields} - {"parameters"}
    assert [key for key in sorted(keys) if not re.search(rf"\b{key}\b:", text)] == []
    assert "parameters:" in text


@pytest.mark.parametrize("name", catalogue.names())
def test_a_template_that_is_filled_in_is_a_plan_of_its_scenario(name):
    text = template(name)
    assert '"?"' in text
    tree = yaml.safe_load(text.replace('"?"', "some_channel"))
    mappings.of_tree(tree, "map.yaml")
    plan = plans.of_tree(tree["validate"], "map.yaml")
    scene = catalogue.load(name).resolve()
    plans.checked(plan, scene, "map.yaml")
    assert {*plan.compare} == {*scene.probes}
    assert {*plan.inputs} == {*scene.inputs}


def test_what_is_not_filled_in_is_told_with_its_line(call, log, tmp_path):
    text = template("pendulum")
    (tmp_path / "map.yaml").write_text(text, encoding="utf-8")
    code, _, err = call("validate", "pendulum", "-r", log, "--map", "map.yaml")
    assert code == 2
    line = 1 + next(i for i, row in enumerate(text.splitlines()) if "rate_rad_s:" in row)
    place = "validate.compare.rate_rad_s"
    assert f"line {line}, {place}: channel is still ?; write a channel, or delete the line" in err


def test_the_one_channel_in_a_unit_is_filled_in_and_others_are_named(log):
    text = template("motor_step", recording=log)
    compare = yaml.safe_load(text)["validate"]["compare"]
    assert compare["angle_rad"] == {"channel": "hinge_rad"}
    assert (
        '# current_A: {channel: "?"}   # Current of the motor [A]; no channel has this unit' in text
    )
    assert {*compare} == {"angle_rad"}
    assert 'supply: {channel: "?"}   # one of hinge_rad, supply_V' in text


def test_a_log_without_units_is_asked_for_them_in_the_same_file(tmp_path, monkeypatch, call):
    monkeypatch.chdir(tmp_path)
    rows = "\n".join(f"{i},{i % 7}" for i in range(40))
    (tmp_path / "raw.csv").write_text(f"t,a\n{rows}\n", encoding="utf-8")
    tree = yaml.safe_load(template("pendulum", recording="raw.csv"))
    assert tree["time"] == {"column": "t", "unit": "?"}
    assert tree["channels"] == {"a": {"column": "a", "unit": "?"}}
    # a channel without a unit may be anything; it is the only one, so it leads
    assert tree["validate"]["compare"] == {"angle_rad": {"channel": "a"}}
    assert {one["channel"] for one in tree["validate"]["start"].values()} == {"a"}


def test_a_template_of_a_log_with_other_units_leaves_the_choice_to_the_user(log):
    compare = yaml.safe_load(template("sliding_block", recording=log))["validate"]["compare"]
    assert compare == {name: {"channel": "?"} for name in ("position_m", "speed_m_s")}


@pytest.mark.parametrize(
    ("name", "starts"),
    [
        ("pendulum", {"start_angle_rad": 0, "start_rate_rad_s": 1}),
        ("sliding_block", {"start_position_m": 0, "start_speed_m_s": 1}),
        ("motor_step", {"start_rate_rad_s": 0}),
        ("odometry", {"start_x_m": 0, "start_y_m": 0}),
        ("ball", None),
    ],
)
def test_what_a_probe_shows_of_the_start_is_read_off_it(name, starts):
    plan = plans.of_tree(
        yaml.safe_load(template(name).replace('"?"', "some_channel"))["validate"], "map.yaml"
    )
    assert {key: one.derivative for key, one in plan.start.items()} == (starts or {})


def test_a_swing_without_units_is_validated_when_the_template_is_filled_in(call, tmp_path):
    time_s, angle = swing(0.5)
    rows = "\n".join(f"{t:.2f},{np.degrees(a):.4f}" for t, a in zip(time_s, angle, strict=True))
    raw, place = tmp_path / "raw.csv", tmp_path / "map.yaml"
    raw.write_text(f"t,a\n{rows}\n", encoding="utf-8")
    text = template("pendulum", recording=str(raw))
    filled = text.replace('unit: "?"', "unit: s", 1).replace('unit: "?"', "unit: deg", 1)
    place.write_text(filled, encoding="utf-8")
    known = ("length=0.25m", "damping=4e-4", "friction=0")
    code, out, err = call(
        "validate", "pendulum", "-r", raw, "--map", place, "--engine", "pymunk", "--no-report",
        "--out", tmp_path, *(word for one in known for word in ("--set", one)),
    )  # fmt: skip
    assert (code, err) == (0, "")
    assert float(re.search(r"is off by ([\d.]+)°", out)[1]) < 1


def test_the_command_of_the_message_makes_a_mapping_with_which_it_runs(call, log, tmp_path):
    words = ("validate", "pendulum", "-r", log, "--engine", "pymunk", "--no-report")
    code, _, err = call(*words)
    assert code == 2
    command = re.search(r"simcompare (validate .*)$", err, re.MULTILINE)
    assert command, err
    assert call(*shlex.split(command[1])) == (0, "pendulum_map.yaml\n", "")
    place = tmp_path / "pendulum_map.yaml"
    assert place.is_file()
    code, _, err = call(*words, "--map", "pendulum_map.yaml")
    assert (code, err) == (0, "")


def test_a_mapping_that_there_is_stands_first_and_is_not_written_over(call, log, tmp_path):
    mapping = tmp_path / "own.yaml"
    own = "channels:\n  angle: {column: hinge, unit: rad, u: 0.01}\n"
    mapping.write_text(own + "validate: {scenario: ball}\n", encoding="utf-8")
    words = ("validate", "pendulum", "-r", log, "--map", "own.yaml", "--template")
    code, out, _ = call(*words)
    assert code == 0
    assert out.split("\n", 1)[1].startswith(own + "validate:\n  scenario: pendulum\n")
    assert yaml.safe_load(out)["validate"]["compare"]["angle_rad"] == {"channel": "angle_rad"}
    code, _, err = call(*words, "-o", "own.yaml")
    assert code == 2
    assert "own.yaml: is another file, and is left as it is; choose another name" in err


def test_a_validation_without_a_recording_says_where_some_are(call):
    code, _, err = call("validate", "pendulum")
    assert code == 2
    assert "--recording: no recording is given; simcompare data list has some" in err


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("chanels: {}", "line 1, chanels: %s channels, "),
        ("channels:\n  a: {colunm: b, unit: m}", "line 2, channels.a.colunm: %s column, "),
        ("time: {column: t, units: s}", "time.units: %s unit"),
        ("validaet: []", "validaet: %s validate, "),
    ],
)  # fmt: skip
def test_an_unknown_key_of_a_mapping_is_answered_with_the_nearest(tmp_path, text, words):
    place = tmp_path / "map.yaml"
    place.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        mappings.read(place)
    assert words % "is not known here; known, the nearest first:" in str(caught.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"comapre": {}}, "validate.comapre: %s compare, "),
        ({"compare": {"angle_rad": {"chanel": "a", "channel": "a"}}},
         "validate.compare.angle_rad.chanel: %s channel, "),
        ({"window": {"begin_s": 1}}, "validate.window.begin_s: %s"),
        ({"calibrate": {"parameter": ["a"], "parameters": ["a"]}},
         "validate.calibrate.parameter: %s parameters, "),
        ({"events": {"serie": "a", "series": "a"}}, "%s series, event"),
        ({"parameters": {"length_m": {"valu": 1, "value": 1, "u": 0, "source": "ruler"}}},
         "validate.parameters.length_m.valu: %s value, "),
    ],
)  # fmt: skip
def test_an_unknown_key_of_a_plan_is_answered_with_the_nearest(change, words):
    tree = {"scenario": "pendulum", "compare": {"angle_rad": {"channel": "a"}}, **change}
    with pytest.raises(InputError) as caught:
        plans.of_tree(tree, "map.yaml")
    assert words % "is not known here; known, the nearest first:" in str(caught.value)


def test_a_log_that_begins_elsewhere_says_so_first_and_the_cure_works(call, log, tmp_path):
    place = tmp_path / "map.yaml"
    mapping = "validate:\n  scenario: pendulum\n  compare: {angle_rad: {channel: hinge}}\n"
    place.write_text(mapping, encoding="utf-8")
    words = ("validate", "pendulum", "-r", log, "--map", place, "--engine", "pymunk", "--no-report")
    code, out, err = call(*words)
    assert (code, err) == (0, "")
    told = " ".join(out.split())
    assert told.startswith("The simulation starts at 90°, the log at 28.6°: add start: ")
    assert "Next:" not in out
    cure = re.search(r"add (start: .*) under validate: in the mapping\.", told)[1]
    place.write_text(f"{mapping}  {cure}\n", encoding="utf-8")
    code, out, err = call(*words)
    assert (code, err) == (0, "")
    assert "starts at" not in out
    assert "Nothing was fitted." in out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--json"], "--json: does not go with --template, which writes YAML"),
        (["--map", "none.yaml"], "--map: none.yaml is of no log; name it with --recording"),
    ],
)
def test_options_that_would_do_nothing_are_refused(call, words, said):
    code, out, err = call("validate", "pendulum", "--template", *words)
    assert (code, out) == (2, "")
    assert said in err
