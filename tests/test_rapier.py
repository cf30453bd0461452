"""What is Rapier's own: its solver's energy, its forces, its friction, its rounding."""

import math

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.errors import SimulationDiverged
from simcompare.fitting.bounces.engine_fit import contact_rows
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue

pytest.importorskip("rapier3d")

BACKEND = engines.get("rapier")
DEFAULT, TUNED, ASSISTED = Settings("default"), Settings("tuned"), Settings("assisted")
G = 9.80665


def scene(bodies, joints=(), duration_s=0.5, **more):
    world = {"duration_s": duration_s, "step_s": 0.001, **more.pop("world", {})}
    told = {"name": "small", "title": "small", "question": "what now?", "world": world}
    return Scenario.model_validate({**told, "bodies": bodies, "joints": dict(joints), **more})


def link(mass_kg=1.0, **more):
    return {"mass_kg": mass_kg, "inertia_kg_m2": (1e-3, 2e-3, 2.5e-3), **more}


WALL = {"fixed": True, "position_m": (0.1, -0.2, 1.0)}


def pendulum(**joint):
    """A link 0.3 m beside a leaning hinge, so that no axis of its frame is along the arm."""
    axis = np.array((0.2, 1.0, 0.3))
    arm = np.array((0.25, -0.08, 0.12))
    hinge = {"type": "hinge", "parent": "wall", "child": "bob", "axis": axis.tolist(), **joint}
    bob = link(position_m=(np.array(WALL["position_m"]) + arm).tolist())
    return {"wall": WALL, "bob": bob}, {"hinge": hinge}


def test_a_pendulum_keeps_its_swing_when_tuned_and_loses_it_by_default():
    scenario = catalogue.load("pendulum").resolve({"damping_N_m_s_rad": 0, "friction_N_m": 0})
    first, second = (BACKEND.simulate(scenario, level) for level in (TUNED, DEFAULT))
    tuned, default = (run.signals["hinge.angle_rad"][3000:].max() for run in (first, second))
    assert abs(tuned) < 1e-3  # it starts at 0, from which it falls
    assert default < -0.02


def test_the_force_through_a_leaning_hinge_is_what_moves_its_bob():
    bodies, joints = pendulum(rate=3.0)
    sensors = {"pull": {"type": "force", "joint": "hinge"}}
    run = BACKEND.simulate(scene(bodies, joints, sensors=sensors), TUNED)
    velocity = run.signals["bob.velocity_m_s"]
    wanted = np.diff(velocity, axis=0) / 0.001 + (0, 0, G)
    turn = run.signals["bob.orientation_wxyz"][:-1]
    found = np.array(
        [rotated(q, f) for q, f in zip(turn, run.signals["pull.force_N"], strict=False)]
    )
    assert np.abs(found - wanted).mean() < 0.02 * G  # the scatter of single precision
    np.testing.assert_allclose(found.mean(axis=0), wanted.mean(axis=0), atol=1e-3 * G)


def rotated(quaternion, vector):
    w, *axis = quaternion
    twice = 2 * np.cross(axis, vector)
    return vector + w * twice + np.cross(axis, twice)


def test_friction_of_a_slider_is_a_part_of_the_force_through_it():
    rail = {"type": "slider", "parent": "wall", "child": "cart", "axis": (1, 0, 0), "rate": 1.0}
    scenario = scene(
        {"wall": {"fixed": True}, "cart": link()},
        {"rail": {**rail, "friction": 0.5}},
        sensors={"pull": {"type": "force", "joint": "rail"}},
    )
    run = BACKEND.simulate(scenario, TUNED)
    np.testing.assert_allclose(run.signals["pull.force_N"][1:], [(-0.5, 0, G)] * 500, atol=2e-3)
    assert run.signals["cart.velocity_m_s"][-1, 0] == pytest.approx(0.75, abs=5e-5)


@pytest.mark.parametrize("name", ["robot", "robot_cylinder"])
def test_wheels_roll_without_sinking_in(name):
    run = BACKEND.simulate(catalogue.load(name).resolve(), TUNED)
    assert np.ptp(run.signals["left_wheel.position_m"][:, 2]) < 1e-5
    time_s, x = run.time_s[100:1001], run.signals["chassis.position_m"][100:1001, 0]
    assert 2 * np.polyfit(time_s, x, 2)[0] == pytest.approx(1.9536, rel=1e-3)


@pytest.mark.parametrize("name", ["cube_toss", "robot_cylinder", "sliding_block"])
def test_a_saved_state_goes_on_bit_for_bit_in_contact(name):
    simulation = BACKEND.open(catalogue.load(name).resolve(), TUNED)
    for _ in range(150):
        simulation.step()
    saved, ends = simulation.save(), []
    for _ in range(2):
        for _ in range(150):
            simulation.step()
        ends.append(simulation.state)
        simulation.restore(saved)
    assert ends[0] == ends[1]
    # the same through plain values, which know of no impulses, is only about the same
    simulation.restore(saved)
    simulation.set_state(simulation.state)
    for _ in range(150):
        simulation.step()
    for body, motion in simulation.state.bodies.items():
        np.testing.assert_allclose(motion.position_m, ends[0].bodies[body].position_m, atol=1e-4)


def test_a_ball_bounces_by_its_restitution_where_it_is_landed():
    run = BACKEND.simulate(catalogue.load("ball").resolve(), ASSISTED)
    heights = run.signals["ball.position_m"][:, 2]
    bottom = heights.min()
    apexes = [h for a, h, b in zip(heights, heights[1:], heights[2:], strict=False) if a < h >= b]
    drops = np.sqrt((np.array(apexes) - bottom) / (heights[0] - bottom))
    np.testing.assert_allclose(drops[:5], 0.8 ** np.arange(1, 6), rtol=1e-3)


def test_a_run_tells_of_turns_that_are_too_small():
    axle = {"type": "hinge", "parent": "wall", "child": "wheel", "axis": (0, 0, 1)}
    bodies = {"wall": {"fixed": True}, "wheel": link()}
    for rate, turn, told in ((20.0, 0.02, False), (400.0, 2 * math.atan(0.2), True)):
        run = BACKEND.simulate(scene(bodies, {"axle": {**axle, "rate": rate}}), TUNED)
        assert any("wheel turns by up to 0.4 rad in a step" in note for note in run.notes) == told
        angle = run.signals["axle.angle_rad"][-1]
        assert angle == pytest.approx(500 * turn, rel=1e-4)


def test_numbers_that_overflow_are_told():
    thrown = {"body": link(velocity_m_s=(3e7, 0, 0))}
    with pytest.raises(SimulationDiverged):
        BACKEND.simulate(scene(thrown, duration_s=5.0), TUNED)


def test_points_of_a_contact_that_are_not_solved_carry_nothing():
    def box(mass_kg, z):
        more = {"position_m": (0, 0, z), "shapes": [{"type": "box", "size_m": (0.1, 0.1, 0.1)}]}
        return link(mass_kg, **{**more, "inertia_kg_m2": (mass_kg / 600,) * 3})

    bodies = {"floor": {"fixed": True, "shapes": [{"type": "plane"}]}}
    bodies |= {"low": box(0.1, 0.05), "high": box(10, 0.15)}
    pairs = [("low", "floor"), ("high", "low"), ("high", "floor")]
    scenario = scene(
        bodies,
        contacts=[{"pair": pair, "restitution": 0, "friction": 0.3} for pair in pairs],
        sensors={"load": {"type": "contact_force", "pair": ("high", "low")}},
    )
    run = BACKEND.simulate(scenario, TUNED)
    np.testing.assert_allclose(run.signals["load.normal_force_N"][300:], 10 * G, rtol=2e-3)


def turned(axis, angle):
    unit = np.array(axis) / np.linalg.norm(axis)
    return (math.cos(angle / 2), *(unit * math.sin(angle / 2)).tolist())


OFF = {"type": "box", "size_m": (0.1, 0.2, 0.3), "position_m": (0.2, 0.1, 0)}


@pytest.mark.parametrize("moments", [(2.5e-3, 1e-3, 2e-3), (4e-3, 1.25e-3, 4e-3), (1e-3,) * 3])
@pytest.mark.parametrize("shape", [OFF, {**OFF, "orientation_wxyz": turned((1, 2, 3), 0.8)}])
def test_a_shape_off_the_middle_leaves_the_moments_where_they_are(moments, shape):
    body = {"mass_kg": 1.0, "inertia_kg_m2": moments, "rate_rad_s": (3, 2, 1)}
    world = {"gravity_m_s2": (0, 0, 0)}
    ends = [
        BACKEND.simulate(scene({"body": {**body, "shapes": shapes}}, world=world), TUNED)
        for shapes in ([shape], [])
    ]
    first, second = (run.signals["body.orientation_wxyz"][-1] for run in ends)
    np.testing.assert_allclose(first, second, atol=5e-4)  # other roots of gyroscopic torques
    held = {row.quantity: row.read_value for row in ends[0].audit}
    found = [held[f"body.inertia_kg_m2.{part}"] for part in (1, 2, 3)]
    np.testing.assert_allclose(found, moments, rtol=1e-6)


def test_a_cylinder_on_its_side_rolls_down():
    down = {"gravity_m_s2": (G * math.sin(0.2), 0, -G * math.cos(0.2))}
    side = {"type": "cylinder", "radius_m": 0.05, "length_m": 0.1}
    wheel = link(
        inertia_kg_m2=(2e-3, 1.25e-3, 2e-3),
        position_m=(0, 0, 0.05),
        shapes=[{**side, "orientation_wxyz": turned((1, 0, 0), math.pi / 2)}],
    )
    scenario = scene(
        {"floor": {"fixed": True, "shapes": [{"type": "plane"}]}, "wheel": wheel},
        contacts=[{"pair": ("wheel", "floor"), "restitution": 0, "friction": 1.0}],
        world=down,
    )
    run = BACKEND.simulate(scenario, TUNED)
    speed = run.signals["wheel.velocity_m_s"][-1, 0]
    assert speed == pytest.approx(G * math.sin(0.2) / 1.5 * 0.5, rel=2e-3)


def test_all_that_is_set_for_a_contact_is_listed():
    run = BACKEND.simulate(catalogue.load("ball").resolve(), TUNED)
    listed = {row.engine_parameter: row for row in contact_rows(run)}
    both = [row for name, row in listed.items() if name.startswith("restitution of ")]
    assert math.prod(row.read_value for row in both) == pytest.approx(0.8, rel=5e-3)
    assert [row.note.endswith("MULTIPLY") for row in both] == [True, True]
    for kind in ("contact_softness", "static_contact_softness"):
        assert listed[f"{kind}.natural_frequency"].read_value == pytest.approx(1000)
        assert listed[f"{kind}.damping_ratio"].read_value == 1
    assert listed["activation.linear_threshold"].read_value == -1
    by_default = BACKEND.simulate(catalogue.load("ball").resolve(), DEFAULT)
    assert all(
        row.set_value is None for row in by_default.audit if "contact" in row.engine_parameter
    )
