"""What acts on joints: constants of a motor, and efforts that are of second order in the step."""

import math

import numpy as np
import pytest

from simcompare.engine.drives import Drive, felt_inertia, input_values, laws_of, open_loop
from simcompare.errors import Unsupported
from simcompare.model.scenario import Scenario

MOTOR = {
    "type": "dc_motor", "joint": "hinge", "input": "voltage", "resistance_Ohm": 6.0,
    "torque_constant_N_m_A": 5.5e-3, "gear_ratio": 48, "efficiency": 0.35,
    "rotor_friction_N_m": 4e-4, "rotor_damping_N_m_s_rad": 2e-7, "rotor_inertia_kg_m2": 1e-7,
}  # fmt: skip


def scene(joint=None, actuator=None, value=0.0):
    tree = {
        "name": "toy",
        "title": "Toy",
        "question": "Does it turn?",
        "world": {"duration_s": 1.0, "step_s": 0.001, "gravity_m_s2": [0, 0, 0]},
        "bodies": {
            "frame": {"fixed": True},
            "disk": {"mass_kg": 1.0, "inertia_kg_m2": [1.0, 1.0, 1.0]},
        },
        "joints": {
            "hinge": {"type": "hinge", "parent": "frame", "child": "disk", "axis": [0, 1, 0]}
            | (joint or {})
        },
        "inputs": {"voltage": {"signal": "constant", "value": value}},
        "actuators": {"motor": actuator} if actuator else {},
    }
    return Scenario.model_validate(tree)


def test_a_geared_motor_becomes_gain_damping_friction_and_armature():
    law = laws_of(scene(actuator=MOTOR))["hinge"]
    assert law.gains["voltage"] == pytest.approx(0.35 * 48 * 5.5e-3 / 6)
    # D·r²/2 of the robot with two of these motors, D = 8.003560 N·s/m at r = 32.5 mm
    assert 2 * law.damping / 0.0325**2 == pytest.approx(8.003560, rel=1e-6)
    assert law.friction == pytest.approx(0.35 * 48 * 4e-4)
    assert law.armature == pytest.approx(0.35 * 48**2 * 1e-7)


def test_what_the_joint_has_itself_is_added():
    law = laws_of(scene({"damping": 0.5, "friction": 0.2, "armature": 0.1}, MOTOR))["hinge"]
    alone = laws_of(scene(actuator=MOTOR))["hinge"]
    assert law.damping == pytest.approx(alone.damping + 0.5)
    assert law.friction == pytest.approx(alone.friction + 0.2)
    assert law.armature == pytest.approx(alone.armature + 0.1)


def test_a_data_sheet_with_a_missing_constant_is_refused_by_its_name():
    with pytest.raises(ValueError, match="rotor_inertia_kg_m2"):
        scene(actuator={k: v for k, v in MOTOR.items() if k != "rotor_inertia_kg_m2"})


@pytest.mark.parametrize(
    ("kind", "joint"), [("force", {}), ("torque", {"type": "slider", "axis": [1, 0, 0]})]
)
def test_a_drive_of_the_wrong_kind_is_refused(kind, joint):
    from simcompare.scenarios.scenario_checks import faults_between_parts

    wrong = scene(joint, {"type": kind, "joint": "hinge", "input": "voltage"})
    assert f"a {kind} drives a" in faults_between_parts(wrong)["actuators.motor"]


def decayed(step_s, exact, rate=10.0):
    """Speed at 0.1 s of a disk with viscous damping, by leapfrog as engines do."""
    drive = Drive(scene({"damping": rate}), step_s, 0, exact)
    angle, speed, angles = 0.0, 1.0, [0.0]
    for _ in range(round(0.1 / step_s)):
        (torque,) = drive.efforts([angle], [speed])
        speed += step_s * torque
        angle += step_s * speed
        angles.append(angle)
    return (angles[-1] - angles[-2]) / step_s / ((angles[1] - angles[0]) / step_s)


def test_rates_at_the_instant_of_positions_make_the_damper_second_order():
    # between the middles of the first and the last step
    errors = {}
    for exact in (True, False):
        for step_s in (0.004, 0.002, 0.001):
            truth = math.exp(-10.0 * (0.1 - step_s))
            errors[exact, step_s] = abs(decayed(step_s, exact) / truth - 1)
    assert 3.3 < errors[True, 0.004] / errors[True, 0.002] < 4.7
    assert 3.3 < errors[True, 0.002] / errors[True, 0.001] < 4.7
    assert 1.8 < errors[False, 0.002] / errors[False, 0.001] < 2.2
    assert errors[True, 0.001] < errors[False, 0.001] / 50


def test_a_lead_evaluates_springs_and_inputs_where_the_forces_act():
    ramp = scene({"stiffness": 3.0}, {"type": "torque", "joint": "hinge", "input": "voltage"})
    ramp = ramp.model_copy(update={"inputs": {"voltage": _ramp()}})
    plain, led = (Drive(ramp, 0.01, lead, True) for lead in (0, 1))
    assert plain.efforts([0.5], [2.0]) == [pytest.approx(0.0 - 3.0 * 0.5)]
    assert led.efforts([0.5], [2.0]) == [pytest.approx(0.01 - 3.0 * (0.5 + 0.01 * 2.0))]


def test_held_inputs_replace_the_signals_until_they_are_let_go():
    drive = Drive(scene(value=1.0, actuator=MOTOR), 0.001, 0, True)
    drive.hold({"voltage": 6.0})
    gain = laws_of(scene(actuator=MOTOR))["hinge"].gains["voltage"]
    assert drive.efforts([0.0], [0.0]) == [pytest.approx(6 * gain)]
    drive.hold(None)
    assert drive.efforts([0.0], [0.0]) == [pytest.approx(gain)]


def test_rows_are_the_open_loop_part_in_order_and_move_on():
    ramp = scene(actuator={"type": "torque", "joint": "hinge", "input": "voltage", "gear": 2.0})
    ramp = ramp.model_copy(update={"inputs": {"voltage": _ramp()}})
    drive = Drive(ramp, 0.01, 0, True)
    np.testing.assert_allclose(drive.rows(3)[:, 0], [0, 0.02, 0.04])
    np.testing.assert_allclose(drive.rows(2)[:, 0], [0.06, 0.08])
    drive.go_to(1, None)
    np.testing.assert_allclose(drive.rows(1)[:, 0], [0.02])


def test_two_actuators_on_one_joint_add_up():
    both = scene(value=1.0, actuator=MOTOR).model_dump()
    both["actuators"]["second"] = {"type": "torque", "joint": "hinge", "input": "voltage"}
    scenario = Scenario.model_validate(both)
    inputs = input_values(scenario, np.array([0.0]))
    gain = laws_of(scene(actuator=MOTOR))["hinge"].gains["voltage"]
    assert open_loop(laws_of(scenario), inputs, 1)[0, 0] == pytest.approx(1 + gain)


def _ramp():
    from simcompare.model.signals import Ramp

    return Ramp(signal="ramp", start=0.0, end=1.0, start_s=0.0, end_s=1.0)


@pytest.mark.parametrize(
    "joint", [{"damping": 1200.0}, {"stiffness": 4e6}], ids=["damper", "spring"]
)
def test_what_is_too_stiff_for_the_step_is_refused_with_the_step_that_would_do(joint):
    drive = Drive(scene(joint), 0.001, 0, True)
    with pytest.raises(Unsupported, match=r"hinge is too stiff .* use a step of 0.00075 s or less"):
        drive.efforts([0.0], [0.0])
    Drive(scene(joint), 0.0007, 0, True).efforts([0.0], [0.0])


def test_what_an_effort_meets_is_the_product_over_the_sum_of_both_bodies():
    assert felt_inertia(scene(), "hinge") == 1.0
    tree = scene().model_dump()
    tree["bodies"]["frame"] = {"mass_kg": 3.0, "inertia_kg_m2": [3.0, 3.0, 3.0]}
    assert felt_inertia(Scenario.model_validate(tree), "hinge") == pytest.approx(0.75)
