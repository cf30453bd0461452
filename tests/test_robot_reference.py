"""The robot's closed forms against an integration of its bodies in space, and published numbers."""

import functools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from simcompare import measures
from simcompare.engine.simulation import sample_times
from simcompare.errors import InputError
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.robot import reference as robot
from simcompare.scenarios.robot.straight import Straight
from simcompare.scenarios.robot_motor import reference as motor
from simcompare.scenarios.robot_planar import reference as planar
from simcompare.scenarios.robot_ramp import reference as ramp
from simcompare.scenarios.robot_turn import reference as turn
from tests.multibody import Robot

NAMES = (
    "robot", "robot_cylinder", "robot_ramp", "robot_slip", "robot_turn", "robot_motor",
    "robot_planar",
)  # fmt: skip
PARTS = ("position_m", "orientation_wxyz", "velocity_m_s", "rate_rad_s")
#: another robot: heavier wheels, a track and a caster elsewhere
OTHER = {
    "body_mass_kg": 1.2, "wheel_mass_kg": 0.2, "wheel_radius_m": 0.045, "track_m": 0.2,
    "center_height_m": 0.06, "center_behind_m": 0.03, "caster_behind_m": 0.1, "gravity_m_s2": 9.0,
}  # fmt: skip


load = functools.cache(catalogue.load)


def scene(name, **changes):
    return load(name).resolve(changes)


def defaults(name="robot", **changes):
    """Parameters of a scenario, also beyond their bounds."""
    return {**{key: known.value for key, known in load(name).parameters.items()}, **changes}


def assert_same_motion(found, truth, tolerance=1e-9):
    for body, values in found.items():
        for part, got in zip(PARTS, values, strict=True):
            # rates and velocities of wheels are some tens, so the same digits are more
            np.testing.assert_allclose(
                truth[f"{body}.{part}"], got, rtol=tolerance, atol=tolerance,
                err_msg=f"{body}.{part}",
            )  # fmt: skip


def truth_of(name, **changes):
    """The reference of a scenario as a trajectory, over all of its samples."""
    file = load(name)
    scenario = file.resolve(changes)
    reference, times = catalogue.reference_of(file.path), sample_times(scenario)
    return scenario, Trajectory("closed form", times, reference(scenario.parameters, times, {}))


# --- straight ahead -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes",
    [{}, {"caster_friction": 0.3}, OTHER, {**OTHER, "caster_friction": 0.2, "torque_N_m": 0.06}],
    ids=str,
)
def test_agrees_with_three_bodies_joined_in_space(changes):
    scenario = scene("robot", **changes)
    bodies = Robot(scenario, lambda *_: scenario.parameters["torque_N_m"])
    t = np.linspace(0, 0.4, 9)
    truth = robot.reference(scenario.parameters, t)
    assert_same_motion(bodies.positions(t), truth)
    _, loads = bodies.solve(0.0, bodies.start())
    assert truth["caster.normal_force_N"] == pytest.approx(loads["chassis"], rel=1e-9)
    assert truth["left_tyre.normal_force_N"] == pytest.approx(loads["left_wheel"], rel=1e-9)
    assert truth["right_tyre.normal_force_N"] == pytest.approx(loads["right_wheel"], rel=1e-9)


@pytest.mark.parametrize(
    "changes",
    [
        {"torque_N_m": 0.06, "tyre_friction": 0.5},
        {"torque_N_m": 0.05, "caster_friction": 0.2},
        {**OTHER, "torque_N_m": 0.1, "tyre_friction": 0.3},
    ],
    ids=str,
)
def test_agrees_with_three_bodies_while_the_tyres_slide(changes):
    scenario = scene("robot", **changes)
    bodies = Robot(scenario, lambda *_: scenario.parameters["torque_N_m"], sliding=True)
    t = np.linspace(0, 0.02, 5)
    truth = robot.reference(scenario.parameters, t)
    assert_same_motion(bodies.positions(t), truth)
    _, loads = bodies.solve(0.0, bodies.start())
    assert truth["caster.normal_force_N"] == pytest.approx(loads["chassis"], rel=1e-9)
    assert truth["left_tyre.normal_force_N"] == pytest.approx(loads["left_wheel"], rel=1e-9)


@pytest.mark.parametrize(
    ("caster_friction", "acceleration"),
    [(0, 1.953602), (0.1, 1.6626), (0.3, 1.1546), (0.5, 0.7262)],
)
def test_known_accelerations_with_a_caster_that_rubs(caster_friction, acceleration):
    forces = Straight.of(defaults(caster_friction=caster_friction)).forces(0.02)
    assert forces.acceleration_m_s2 == pytest.approx(acceleration, abs=6e-5)


def test_known_loads_and_limits():
    found = Straight.of(defaults())
    assert found.forces(0.0).caster_N == pytest.approx(1.3239, abs=5e-5)
    assert found.mass_kg * 9.80665 - found.forces(0.0).caster_N == pytest.approx(4.5601, abs=5e-5)
    assert found.slip_torque == pytest.approx(0.035730, abs=5e-7)
    sliding = Straight.of(defaults(tyre_friction=0.5)).forces(0.06)
    assert sliding.acceleration_m_s2 == pytest.approx(2.44685, abs=5e-6)


def test_acceleration_is_force_over_felt_mass_without_a_caster_that_rubs():
    # a = (2τ/r)/(m + 2J/r²); the wheels' inertia counts as one wheel mass here
    expected = (2 * 0.02 / 0.0325) / (0.6 + 0.03)
    assert Straight.of(defaults()).forces(0.02).acceleration_m_s2 == pytest.approx(
        expected, rel=1e-13
    )


@given(
    torque=st.floats(0, 0.1),
    friction=st.floats(0.3, 1.5),
    caster=st.floats(0, 0.2),
    armature=st.sampled_from([0.0, 8e-5]),
)
def test_forces_hold_newtons_laws_in_every_regime(torque, friction, caster, armature):
    parameters = defaults(tyre_friction=friction, caster_friction=caster)
    found = Straight.of(parameters, armature)
    forces = found.forces(torque)
    r, weight = found.radius_m, found.mass_kg * found.gravity_m_s2
    inertia = found.wheel_inertia_kg_m2 + armature
    traction = (2 * torque - 2 * inertia * forces.spin_rad_s2) / r
    load = weight - forces.caster_N
    assert traction <= friction * load * (1 + 1e-12)
    assert load > 0
    if forces.acceleration_m_s2 > 0:
        drag = caster * forces.caster_N
        assert traction - drag == pytest.approx(found.mass_kg * forces.acceleration_m_s2, rel=1e-9)
    slides = r * forces.spin_rad_s2 - forces.acceleration_m_s2
    assert slides >= -1e-12
    if slides > 1e-9:
        assert traction == pytest.approx(friction * load, rel=1e-9)


def test_a_robot_that_its_caster_holds_stays_where_it_is():
    truth = robot.reference(defaults(caster_friction=0.5, torque_N_m=0.01), np.linspace(0, 1, 5))
    assert np.ptp(truth["chassis.position_m"][:, 0]) == 0
    assert Straight.of(defaults(caster_friction=0.5)).start_torque == pytest.approx(
        0.0107567, abs=1e-7
    )


def test_wheels_that_spin_on_the_spot_have_no_closed_form_and_say_so():
    weak = defaults(tyre_friction=0.3, caster_friction=0.5, center_behind_m=0.04, torque_N_m=0.1)
    with pytest.raises(InputError, match="spin on the spot"):
        robot.reference(weak, np.linspace(0, 1, 5))


# --- a torque that grows --------------------------------------------------------------------------


def test_a_ramp_agrees_with_three_bodies():
    scenario = scene("robot_ramp", ramp_s=0.5)
    p = scenario.parameters
    bodies = Robot(scenario, lambda t, *_: p["torque_N_m"] * min(t / p["ramp_s"], 1))
    t = np.linspace(0, 0.5, 11)
    assert_same_motion(bodies.positions(t), ramp.reference(p, t))


@pytest.mark.parametrize("caster_friction", [0.0, 0.2])
def test_a_ramp_through_every_threshold_agrees_with_an_integration(caster_friction):
    # from rest through rolling into sliding, and on at the end of the ramp
    p = defaults("robot_ramp", torque_N_m=0.05, ramp_s=0.3, caster_friction=caster_friction)
    found = Straight.of(p)
    assert found.start_torque < 0.01 < found.slip_torque < 0.05

    def motion(t, state):
        forces = found.forces(p["torque_N_m"] * min(t / p["ramp_s"], 1))
        return [state[1], forces.acceleration_m_s2, state[3], forces.spin_rad_s2]

    t = np.linspace(0, 0.5, 26)
    solution = solve_ivp(
        motion, (0, 0.5), np.zeros(4), "DOP853", t_eval=t, rtol=1e-12, atol=1e-12, max_step=1e-3
    )
    truth = ramp.reference(p, t)
    # each kink in the torque costs the integration some digits
    np.testing.assert_allclose(truth["chassis.position_m"][:, 0] + 0.02, solution.y[0], atol=1e-9)
    np.testing.assert_allclose(truth["left.angle_rad"], solution.y[2], atol=1e-7)
    loads = [found.forces(torque).caster_N for torque in truth["left_motor.torque_N_m"]]
    np.testing.assert_allclose(truth["caster.normal_force_N"], loads, rtol=1e-12)


def test_a_ramp_that_rolls_is_a_cubic():
    p = defaults("robot_ramp")
    truth = ramp.reference(p, np.array([0.25, 0.5, 1.0]))
    # a grows to 1.5·1.953602 in one second, so x = a·t³/6
    expected = 1.5 * 1.9536019536 * np.array([0.25, 0.5, 1.0]) ** 3 / 6
    np.testing.assert_allclose(truth["chassis.position_m"][:, 0] + 0.02, expected, rtol=1e-9)


# --- a curve --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes",
    [{}, {"left_torque_N_m": 0.012, "right_torque_N_m": 0.009}, {**OTHER, "left_torque_N_m": 0.0}],
    ids=str,
)
def test_a_curve_agrees_with_three_bodies(changes):
    scenario = scene("robot_turn", **changes)
    torques = {side: scenario.parameters[f"{side}_torque_N_m"] for side in ("left", "right")}
    bodies = Robot(scenario, lambda _, hinge, __: torques[hinge])
    t = np.linspace(0, 0.6, 7)
    found, truth = bodies.positions(t), turn.reference(scenario.parameters, t)
    assert_same_motion(found, truth)
    state = np.concatenate([part[-1] for body in found.values() for part in body])
    _, loads = bodies.solve(t[-1], state)
    assert truth["caster.normal_force_N"][-1] == pytest.approx(loads["chassis"], rel=1e-9)
    assert truth["left_tyre.normal_force_N"][-1] == pytest.approx(loads["left_wheel"], rel=1e-9)
    assert truth["right_tyre.normal_force_N"][-1] == pytest.approx(loads["right_wheel"], rel=1e-9)


def test_a_curve_that_the_tyres_cannot_hold_is_refused():
    p, t = defaults("robot_turn"), np.linspace(0, 0.8, 9)
    turn.reference(p, t)
    # by default a little over half of the friction is used
    turn.reference({**p, "tyre_friction": 0.33}, t)
    for changes in ({"tyre_friction": 0.32}, {"right_torque_N_m": 0.012}):
        with pytest.raises(InputError, match="cannot hold the robot"):
            turn.reference({**p, **changes}, t)


def test_yaw_inertia_is_that_of_the_real_robot():
    assert turn.yaw_inertia_kg_m2(defaults("robot_turn")) == pytest.approx(1.84984e-3, abs=5e-9)


def test_without_an_offset_of_the_load_both_accelerations_are_constant():
    p = defaults("robot_turn", center_behind_m=0.0)
    _, _, heading, speed, rate, left, right = turn.integrated(p, np.array([0.0, 0.5]))
    r, track, inertia = 0.0325, 0.12, turn.yaw_inertia_kg_m2(p)
    wheel = 0.03 * r**2 / 2
    assert speed[-1] == pytest.approx(0.5 * r * 0.021 / (0.6 * r**2 + 2 * wheel), rel=1e-10)
    turning = track * r * 0.001 / (2 * inertia * r**2 + wheel * track**2)
    assert rate[-1] == pytest.approx(0.5 * turning, rel=1e-9)
    assert heading[-1] == pytest.approx(0.125 * turning, rel=1e-9)
    assert right[-1] - left[-1] == pytest.approx(heading[-1] * track / r, rel=1e-9)


def test_equal_torques_drive_straight_ahead():
    p = defaults("robot_turn", left_torque_N_m=0.02, right_torque_N_m=0.02)
    t = np.linspace(0, 1, 11)
    straight, curved = robot.reference(defaults(), t), turn.reference(p, t)
    for name, values in curved.items():
        np.testing.assert_allclose(values, straight[name], rtol=1e-9, atol=1e-9, err_msg=name)


# --- gear motors ----------------------------------------------------------------------------------


def motor_law(p):
    """Torque that acts on the wheel at a rate, straight from the motor's equation."""
    k, n, share = p["torque_constant_N_m_A"], p["gear_ratio"], p["efficiency"]
    mass = p["body_mass_kg"] + 2 * p["wheel_mass_kg"]
    rolling = p["rolling_resistance"] * mass * p["gravity_m_s2"] * p["wheel_radius_m"] / 2

    def torque(_, __, rate):
        current = (p["voltage_V"] - k * n * rate) / p["resistance_Ohm"]
        friction = p["rotor_friction_N_m"] + p["rotor_damping_N_m_s_rad"] * n * rate
        return share * n * (k * current - friction) - rolling

    return torque, share * n**2 * p["rotor_inertia_kg_m2"]


@pytest.mark.parametrize("changes", [{}, {"caster_friction": 0.2}, {"voltage_V": 3.0}], ids=str)
def test_motors_agree_with_three_bodies(changes):
    scenario = scene("robot_motor", **changes)
    law, armature = motor_law(scenario.parameters)
    bodies = Robot(scenario, law, armature=armature)
    t = np.linspace(0, 0.5, 11)
    truth = motor.reference(scenario.parameters, t)
    found = bodies.positions(t)
    assert_same_motion(found, truth)
    for k in (0, 4):
        state = np.concatenate([part[k] for body in found.values() for part in body])
        _, loads = bodies.solve(t[k], state)
        assert truth["caster.normal_force_N"][k] == pytest.approx(loads["chassis"], rel=1e-9)
        assert truth["left_tyre.normal_force_N"][k] == pytest.approx(loads["left_wheel"], rel=1e-9)


def test_too_much_voltage_spins_the_wheels_until_the_robot_has_come_up():
    scenario = scene("robot_motor", voltage_V=6.0)
    law, armature = motor_law(scenario.parameters)
    rolls, slides = (Robot(scenario, law, sliding, armature) for sliding in (False, True))
    first, r = rolls.start(), 0.0325

    def motion(bodies):
        def change(_, y):
            state = first.copy()
            # only rates of wheels matter: they set the torque
            state[13 + 11] = state[26 + 11] = y[3]
            accelerations, _ = bodies.solve(0.0, state)
            return [y[1], accelerations[0], y[3], accelerations[6 + 4]]

        return change

    def grip(_, y):
        return r * y[3] - y[1] if y[0] > 1e-9 else 1.0

    grip.terminal = True
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
    one = solve_ivp(motion(slides), (0, 1), np.zeros(4), events=grip, dense_output=True, **options)
    assert 0.05 < one.t[-1] < 0.2
    two = solve_ivp(motion(rolls), (one.t[-1], 0.6), one.y[:, -1], dense_output=True, **options)
    for part, t in ((one, np.linspace(0, one.t[-1], 20)), (two, np.linspace(one.t[-1], 0.6, 20))):
        found = motor.motion_at(scenario.parameters, t)
        expected = part.sol(t)
        np.testing.assert_allclose(found.distance_m, expected[0], atol=1e-9)
        np.testing.assert_allclose(found.speed_m_s, expected[1], atol=1e-8)
        np.testing.assert_allclose(found.angle_rad, expected[2], atol=1e-8)


def test_known_numbers_of_the_gear_motor():
    p = defaults("robot_motor")
    drive = motor.Drive.of(p)
    found = Straight.of(p, drive.armature_kg_m2)
    r = found.radius_m
    felt = found.mass_kg + 2 * (found.wheel_inertia_kg_m2 + drive.armature_kg_m2) / r**2
    damping = 2 * drive.damping_N_m_s_rad / r**2
    assert felt == pytest.approx(0.782691, abs=5e-7)
    assert damping == pytest.approx(8.003560, abs=5e-7)
    assert 2 * drive.stall_N_m / r == pytest.approx(1.364166, abs=5e-7)
    late = motor.motion_at(p, np.array([20.0]))
    assert late.speed_m_s[0] == pytest.approx(0.170445, abs=5e-7)
    constant_s = felt / damping
    assert constant_s == pytest.approx(97.79e-3, abs=5e-6)
    then = motor.motion_at(p, np.array([constant_s]))
    assert then.speed_m_s[0] == pytest.approx(late.speed_m_s[0] * -math.expm1(-1), rel=1e-9)
    six = motor.motion_at({**p, "voltage_V": 6.0}, np.array([20.0]))
    assert six.speed_m_s[0] == pytest.approx(0.644080, abs=5e-7)


def test_the_robot_needs_its_start_voltage():
    for voltage, moves in ((0.560, False), (0.562, True)):
        truth = motor.motion_at(defaults("robot_motor", voltage_V=voltage), np.array([0.0, 1.0]))
        assert (truth.distance_m[-1] > 0) == moves


# --- one wheel for both, and all together ---------------------------------------------------------


def test_one_wheel_for_both_drives_like_two():
    t = np.linspace(0, 0.4, 9)
    scenario = scene("robot_planar")
    one, two = planar.reference(scenario.parameters, t), robot.reference(defaults(), t)
    for part in PARTS:
        np.testing.assert_array_equal(one[f"chassis.{part}"], two[f"chassis.{part}"])
    both = two["left_tyre.normal_force_N"] + two["right_tyre.normal_force_N"]
    np.testing.assert_allclose(one["tyre.normal_force_N"], both, rtol=1e-12)
    bodies = Robot(scenario, lambda *_: 2 * scenario.parameters["torque_N_m"])
    assert_same_motion(bodies.positions(t), one)


@pytest.mark.parametrize("name", NAMES)
def test_truth_begins_as_the_scene_is_drawn(name):
    scenario, truth = truth_of(name)
    for body_name, body in scenario.moving_bodies().items():
        for part in PARTS:
            got = truth.signals[f"{body_name}.{part}"][0]
            np.testing.assert_allclose(got, getattr(body, part), atol=1e-15, err_msg=part)


@pytest.mark.parametrize("name", NAMES)
def test_every_measure_finds_something_in_the_truth(name):
    scenario, truth = truth_of(name)
    for measure in scenario.measures:
        found = measures.take(measure, scenario, truth)
        assert all(value is not None for value in found.values.values()), measure.function
        assert found.values or found.series


@pytest.mark.parametrize("name", ["robot", "robot_planar", "robot_motor"])
@pytest.mark.parametrize("caster_friction", [0.0, 0.2])
def test_no_energy_is_missing_in_the_truth(name, caster_friction):
    scenario, truth = truth_of(name, caster_friction=caster_friction)
    for measure in scenario.measures:
        found = measures.take(measure, scenario, truth).values
        for imbalance in ("energy_imbalance", "motor_imbalance"):
            # trapezoids of 1 ms leave a hundred-thousandth where torques change
            assert abs(found.get(imbalance, 0.0)) < 2e-5


def test_the_truth_slips_only_where_it_should():
    slip = {"robot": 0.0, "robot_ramp": 0.0, "robot_motor": 0.0, "robot_slip": 0.77092}
    for name, expected in slip.items():
        scenario, truth = truth_of(name)
        measure = next(m for m in scenario.measures if m.function == "slip")
        found = measures.take(measure, scenario, truth).values["slip"]
        assert found == pytest.approx(expected, abs=1e-5)
