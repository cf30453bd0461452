"""Recordings that are not what they are said to be: told in a validation, with what to write."""

import math

import numpy as np
import pytest
import yaml

import simcompare
from simcompare.hardware.recordings import registry
from simcompare.inference import sources, suspicions
from simcompare.inference.reference_model import model_of
from simcompare.model.signals import Table
from simcompare.scenarios import catalogue
from simcompare.statistics.suspicions import Change, suspected
from tests import validated
from tests.test_windows import of_length, plan_of


def known(value, u=1e-6):
    return {"value": value, "u": u, "source": "made up so"}


def pendulum_log(folder, change, seed=0, **mapping):
    """A pendulum driven by a torque, its log with one mistake, and the mapping that knows none."""
    file = catalogue.load("pendulum_torque")
    time_s = np.arange(0, 6, 0.01)
    torque = 0.9 * np.sin(2.1 * time_s + 0.3 * time_s**1.5) + 0.4
    table = Table(signal="table", time_s=tuple(time_s), value=tuple(torque))
    scene = file.resolve({"start_angle_rad": 0.2}, inputs={"torque": table})
    truth = model_of(file).truth(scene, time_s)
    angle = truth.signals["hinge.angle_rad"] + 0.2
    angle = angle + np.random.default_rng(seed).normal(0, 1e-3, len(angle))
    rows = np.column_stack((time_s, change(angle), torque))
    np.savetxt(folder / "log.csv", rows, delimiter=",", comments="", header="t,a,u")
    plan = {
        "scenario": "pendulum_torque",
        "parameters": {
            n: known(file.parameters[n].value)
            for n in ("mass_kg", "length_m", "inertia_kg_m2", "damping_N_m_s_rad", "friction_N_m")
        },
        "start": {
            "start_angle_rad": {"channel": "angle", "over_s": 0.1},
            "start_rate_rad_s": {"channel": "angle", "derivative": 1, "over_s": 0.1},
        },
        "inputs": {"torque": {"channel": "torque"}},
        "compare": {"angle_rad": {"channel": "angle"}},
    }
    tree = {
        "time": {"column": "t", "unit": "s"},
        "channels": {
            "angle": {"column": "a", "unit": "rad", **mapping},
            "torque": {"column": "u", "unit": "N*m"},
        },
        "validate": plan,
    }
    (folder / "map.yaml").write_text(yaml.safe_dump(tree))
    return folder / "log.csv", folder / "map.yaml"


def asked(log, mapping, scenario="pendulum_torque", **overrides):
    source = sources.find(str(log), mapping=mapping)
    plan = plan_of(source, scenario)
    model = model_of(catalogue.load(scenario))
    return suspicions.suspected(model, plan, source.recording, plan.streams, overrides, {})


@pytest.mark.parametrize("seed", range(3))
def test_a_right_recording_is_not_suspected(tmp_path, seed):
    assert asked(*pendulum_log(tmp_path, lambda angle: angle, seed)) is None


@pytest.mark.parametrize(
    ("change", "says", "mend"),
    [
        (lambda a: -a, "the sign of angle reversed", {"sign": -1}),
        (lambda a: a + math.pi, "angle turned by", {"offset": -math.pi}),
        (lambda a: np.degrees(a), "angle in deg", {"unit": "deg"}),
        (lambda a: a + 0.5, "angle turned by -28", {"offset": -0.5}),
    ],
    ids=["sign", "half turn", "degrees", "zero"],
)
def test_a_mistake_is_told_as_what_it_is_and_its_cure_works(tmp_path, change, says, mend):
    found = asked(*pendulum_log(tmp_path, change))
    assert found is not None
    assert len(found.says) == 1
    assert says in found.says[0]
    assert "in the mapping file" in found.cures[0]
    assert asked(*pendulum_log(tmp_path, change, **mend)) is None


def test_a_validation_tells_it(tmp_path):
    log, mapping = pendulum_log(tmp_path, lambda angle: -angle)
    found = simcompare.validate("pendulum_torque", recording=log, mapping=mapping, engine="mujoco")
    record = found.record.validation
    assert record.suspected is not None
    (told,) = [one for one in record.sentences if "suspected" in one]
    # a pendulum that is driven the other way round is the same
    assert "With the sign of angle reversed (or as well the sign of torque reversed) it is" in told
    assert "Nothing was changed; to try it, write sign: -1 for the channel angle" in told


def test_a_validation_of_a_right_log_tells_nothing(tmp_path):
    made = validated.make(tmp_path)
    found = simcompare.validate(
        "pendulum", recording=made / "swing.csv", mapping=made / "known.yaml", engine="pymunk"
    )
    assert found.record.validation.suspected is None
    assert not [one for one in found.record.validation.sentences if "suspected" in one]


@pytest.mark.parametrize(
    ("name", "scenario"),
    [("odometry_plaza", "odometry"), ("pendulum_torque_limited", "pendulum_torque"),
     ("pendulum_free_swing", "pendulum"), ("servo_pendulum_xl330", "pendulum_servo"),
     ("robot_labyrinth_exchanged", "odometry")],
)  # fmt: skip
def test_public_recordings_are_not_suspected(name, scenario):
    if registry.place(name) is None:
        pytest.skip(f"{name} is not on this machine")
    assert asked(name, None, scenario) is None


def test_a_heading_that_is_half_a_turn_off_is_suspected():
    if registry.place("odometry_plaza") is None:
        pytest.skip("odometry_plaza is not on this machine")
    source = sources.find("odometry_plaza")
    plan = of_length(plan_of(source, "odometry"), 60)  # s: a minute tells it, and is quick
    turned = suspicions._changed("heading", 1.0, math.pi, "", suspicions.Read(source.recording))
    model = model_of(catalogue.load("odometry"))
    found = suspicions.suspected(model, plan, turned.value.recording, plan.streams, {}, {})
    assert found is not None
    assert found.says == ("heading turned by 180°",)


def plus(by):
    return lambda value: Change(value + by, f"{by:+d}", f"write {by:+d}")


def test_the_first_of_those_that_fit_alike_is_told_and_a_pair_where_none_does_alone():
    def off(goal):
        return lambda value: abs(value - goal) + 0.01

    assert suspected(0, [plus(3), plus(5)], off(0)) is None
    assert suspected(0, [plus(3), plus(5), plus(5)], off(5)).says == ("+5",)
    assert suspected(0, [plus(3), plus(50)], off(53)).says == ("+3", "+50")


@pytest.mark.parametrize(
    ("name", "wrong", "says"),
    [
        ("start_heading_rad", 0.0, "start_heading_rad = 3.14"),
        ("track_m", 0.0785, "track_m = 0.157"),
    ],
)
def test_a_wrong_number_of_a_robot_is_told_with_what_to_type(name, wrong, says):
    recording = "robot_labyrinth_exchanged"
    if registry.place(recording) is None:
        pytest.skip(f"{recording} is not on this machine")
    found = asked(recording, None, "odometry", **{name: wrong})
    assert found is not None
    assert found.says[0].startswith(says)
    typed, value = found.cures[0].removeprefix("add --set ").split("=")
    assert asked(recording, None, "odometry", **{typed: float(value)}) is None
