"""Where the truth of a scenario does not hold: nothing is judged, and that is said first."""

import json
from dataclasses import replace

import pytest

import simcompare
from simcompare.errors import InputError
from simcompare.reports.run import answer, runs
from simcompare.reports.run.key_numbers import key_numbers
from simcompare.reports.run.lead_table import lead_table
from simcompare.reports.run.short import short
from simcompare.results import store
from simcompare.scenarios import catalogue, scenario_file
from simcompare.scenarios.robot.straight import Straight
from tests import records
from tests.test_answer import SCENE
from tests.test_headline import answered, level

HOLDS = """
holds_while:
  - {value: "${2 * 3}", at_most: 5, unit: m, otherwise: "it falls: {value} is more than {limit}"}
"""


@pytest.fixture
def read(tmp_path):
    def write(old="", new=""):
        assert old in HOLDS
        (tmp_path / "slide.yaml").write_text(SCENE + HOLDS.replace(old, new), encoding="utf-8")
        return scenario_file.read(tmp_path / "slide.yaml")

    return write


def test_a_condition_that_is_broken_is_a_sentence_with_both_numbers(read):
    assert read().resolve().beyond == ("It falls: 6 m is more than 5 m.",)
    assert read("at_most: 5", "at_most: 6").resolve().beyond == ()


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [("{limit}", "{most}", "{most} stands for nothing"),
     ("{limit}", "{", "a { or } stands alone"),
     ("2 * 3", "2 * length", "length"),
     ("it falls: {value} is more than {limit}", "no", "otherwise")],
)  # fmt: skip
def test_faults_of_a_condition_are_told_with_their_place(read, old, new, sentence):
    with pytest.raises(InputError) as caught:
        read(old, new)
    assert sentence in str(caught.value)
    assert "holds_while" in str(caught.value)


@pytest.mark.parametrize("name", ["robot", "robot_planar", "robot_ramp", "robot_accelerometer"])
@pytest.mark.parametrize(
    "changes",
    [{}, {"tyre_friction": 1.1, "caster_friction": 0.2, "center_height_m": 0.1},
     {"wheel_radius_m": 0.05, "caster_behind_m": 0.2, "body_mass_kg": 3.0, "wheel_mass_kg": 0.4}],
)  # fmt: skip
def test_tyres_slip_above_the_torque_of_the_closed_form(name, changes):
    (condition,) = catalogue.load(name).resolve(changes).holds_while
    parameters = catalogue.load(name).resolve(changes).parameters
    assert condition.at_most == pytest.approx(Straight.of(parameters).slip_torque, rel=1e-12)
    assert condition.value == parameters["torque_N_m"]


@pytest.mark.parametrize("name", ["robot_slip", "robot_motor", "robot_turn"])
def test_a_variant_whose_truth_knows_sliding_has_no_such_limit(name):
    assert catalogue.load(name).resolve().holds_while == ()


@pytest.mark.engines("rapier")
@pytest.mark.parametrize(("torque", "slips"), [("35mN*m", False), ("37mN*m", True)])
def test_tyres_of_an_engine_slip_where_the_condition_says(torque, slips, tmp_path):
    run = simcompare.run("robot", engine="rapier", contact="tuned", set={"torque": torque},
                         out=tmp_path)  # fmt: skip
    slip = runs.score_of(run, "rapier", "tuned", "left_slip")
    assert (slip.value > 0.1) == slips
    assert bool(run.record.beyond) == slips
    if slips:
        assert {score.verdict for score in run.record.scores} == {"info"}
        assert run.exit_code == 0
        assert runs.truth(run) is None
    # it is stored, and a run that was stored before there were conditions still loads
    assert store.load(run.folder).record.beyond == run.record.beyond
    stored = run.folder / "run.json"
    plain = json.loads(stored.read_text(encoding="utf-8"))
    del plain["beyond"]
    stored.write_text(json.dumps(plain), encoding="utf-8")
    assert store.load(run.folder).record.beyond == ()


def beyond():
    run = answered(level("tuned", north=0.7, south=-1e-15), truth=None)
    run = records.changed(run, tolerances={}, beyond=("It falls.",))
    scores = tuple(replace(score, scatter=None) for score in run.record.scores)
    return records.changed(run, scores=scores)


def test_that_the_truth_does_not_hold_is_said_first():
    assert short(beyond()) == (
        "It falls.",
        "Tuned, the ball bounces with 0 to 0.7 in north and south.",
    )
    first, *_, last = answer.sentences(beyond())
    assert (first, last) == ("It falls.", "Nothing is judged: there the truth does not hold.")
    assert lead_table(beyond()).title.endswith("not judged, for the truth does not hold here")
    assert [number.label for number in key_numbers(beyond())] == ["tuned"]
