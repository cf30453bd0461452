"""Forces through joints and between bodies in pymunk: signs, frames and instants."""

import math

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.model.settings import Settings
from tests.planar_scenes import FRAME, G, body, run, scene, signals, turned

LOAD_CELL = {"sensors": {"cell": {"type": "force", "joint": "bolt"}}}
BOLT = {"type": "fixed", "parent": "base", "child": "mass"}


@pytest.mark.parametrize("tilt", [0.0, math.pi / 6])
def test_a_load_cell_at_rest_reads_the_weight_in_the_frame_of_its_mass(tilt):
    bodies = {
        "base": {"fixed": True, "orientation_wxyz": turned(tilt)},
        "mass": body(0.2, 0.001, [0.05, 0, 0.1], orientation_wxyz=turned(tilt)),
    }
    force = signals(bodies, {"bolt": BOLT}, 0.05, **LOAD_CELL)["cell.force_N"]
    # about +y a body noses down: up then is backwards in its frame
    wanted = 0.2 * G * np.array([-math.sin(tilt), 0, math.cos(tilt)])
    np.testing.assert_allclose(force, np.tile(wanted, (len(force), 1)), atol=1e-9)


def test_a_load_cell_reads_nothing_in_free_fall():
    bodies = {"base": body(1.0), "mass": body(0.2, 0.001, [0.05, 0, 0.1])}
    force = signals(bodies, {"bolt": BOLT}, 0.05, **LOAD_CELL)["cell.force_N"]
    np.testing.assert_allclose(force, 0, atol=1e-11)


def test_a_load_cell_reads_the_acceleration_of_its_base():
    bodies = {**FRAME, "base": body(1.0), "mass": body(0.2, 0.001, [0.05, 0, 0.1])}
    slide = {"type": "slider", "parent": "frame", "child": "base", "axis": [1, 0, 0]}
    more = {
        "inputs": {"push": {"signal": "ramp", "start": 0, "end": 3.6, "start_s": 0, "end_s": 0.1}},
        "actuators": {"shaker": {"type": "force", "joint": "slide", "input": "push"}},
        **LOAD_CELL,
    }
    found = run(scene(bodies, {"slide": slide, "bolt": BOLT}, 0.2, **more))
    force = found.signals["cell.force_N"]
    # at the instants of the samples, the first one included
    np.testing.assert_allclose(force[:, 0], 0.6 * np.minimum(found.time_s / 0.1, 1), atol=1e-9)
    np.testing.assert_allclose(force[:, 2], 0.2 * G, atol=1e-9)


def test_a_load_cell_agrees_with_the_impulse_of_its_constraint():
    """The engine tells that impulse's magnitude; through a hinge, of which hangs one more body."""
    bodies = {**FRAME, "mass": body(at=[0.3, 0, 0]), "tail": body(0.4, 0.002, [0.5, 0, 0])}
    joints = {
        "bolt": {"type": "hinge", "parent": "frame", "child": "mass", "axis": [0, 1, 0]},
        "tail_hinge": {
            "type": "hinge", "parent": "mass", "child": "tail", "anchor_m": [0.1, 0, 0],
            "axis": [0, -1, 0], "damping": 0.01,
        },
    }  # fmt: skip
    simulation = engines.get("pymunk").open(scene(bodies, joints, **LOAD_CELL), Settings())
    (pivot,) = simulation.built.constraints["bolt"]
    for _ in range(20):
        simulation.step()
        read = np.linalg.norm(simulation.read()["cell.force_N"])
        assert read == pytest.approx(pivot.impulse / 0.001, rel=1e-9)


@pytest.mark.parametrize("free", [False, True])
def test_forces_are_right_from_the_first_sample_on_where_joints_move(free):
    """A mass swings as told at the start, alone and with a heavy body that it hangs on."""
    hinge = {"type": "hinge", "parent": "base", "child": "bob", "axis": [0, 1, 0], "rate": 5}
    root = body(1e9, 1e9) if free else {"fixed": True}
    bodies = {"base": root, "bob": body(1.0, 0.001, [0, 0, -0.5])}
    sensors = {"cell": {"type": "force", "joint": "hinge"}}
    force = signals(bodies, {"hinge": hinge}, sensors=sensors)["cell.force_N"]
    weight = 0 if free else G
    swing = 25 * 0.5
    np.testing.assert_allclose(force[:3, 2], weight + swing, rtol=2e-4)
    np.testing.assert_allclose(force[:3, 0], 0, atol=0.15)


def test_the_force_through_a_slider_counts_its_spring():
    tilt, stiffness, mass = 0.5, 200.0, 0.5
    rail = {"frame": {"fixed": True, "orientation_wxyz": turned(tilt)}}
    slider = {"type": "slider", "parent": "frame", "child": "mass", "axis": [1, 0, 0]}
    found = signals(
        {**rail, "mass": body(mass, 0.001, [0.1, 0, 0.2])},
        {"slider": {**slider, "stiffness": stiffness, "rest": 0.02}},
        sensors={"cell": {"type": "force", "joint": "slider"}},
    )
    force = found["cell.force_N"][:, [0, 2]]
    spring = -stiffness * (found["slider.position_m"] - 0.02)
    along, across = (math.cos(tilt), -math.sin(tilt)), (math.sin(tilt), math.cos(tilt))
    np.testing.assert_allclose(force @ along, spring, atol=1e-9)
    np.testing.assert_allclose(force @ across, mass * G * math.cos(tilt), rtol=1e-9)


FLOOR = {"floor": {"fixed": True, "shapes": [{"type": "plane"}]}}


def test_what_stands_on_a_floor_does_not_pull_at_its_joint():
    ball = body(0.3, 0.001, [0, 0, 0.05], shapes=[{"type": "sphere", "radius_m": 0.05}])
    guide = {"type": "slider", "parent": "frame", "child": "mass", "axis": [0, 0, 1]}
    sensors = {
        "cell": {"type": "force", "joint": "guide"},
        "scale": {"type": "contact_force", "pair": ["floor", "mass"]},
    }
    bodies = {**FRAME, **FLOOR, "mass": ball}
    found = signals(bodies, {"guide": guide}, 0.1, sensors=sensors)
    np.testing.assert_allclose(found["scale.normal_force_N"], 0.3 * G, rtol=1e-6)
    np.testing.assert_allclose(found["cell.force_N"], 0, atol=1e-6)


def rover(torque=0.04):
    """A chassis on a caster and one wheel, seen from its side."""
    r = 0.0325
    return scene(
        {
            **FLOOR,
            "chassis": body(
                0.54, 0.00077, [-0.02, 0, 0.04],
                shapes=[{"type": "sphere", "radius_m": 0.01, "position_m": [-0.06, 0, -0.03]}],
            ),
            "wheel": body(0.06, 0.03 * r**2, [0, 0, r], shapes=[{"type": "sphere", "radius_m": r}]),
        },
        {
            "axle": {
                "type": "hinge", "parent": "chassis", "child": "wheel", "axis": [0, 1, 0],
                "anchor_m": [0.02, 0, r - 0.04],
            }
        },
        contacts=[
            {"pair": ["wheel", "floor"], "friction": 0.6},
            {"pair": ["chassis", "floor"]},
        ],
        inputs={"drive": {"signal": "constant", "value": torque}},
        actuators={"motor": {"type": "torque", "joint": "axle", "input": "drive"}},
        sensors={
            "tyre": {"type": "contact_force", "pair": ["wheel", "floor"]},
            "caster": {"type": "contact_force", "pair": ["floor", "chassis"]},
        },
    )  # fmt: skip


def test_a_wheel_rolls_as_its_torque_says():
    found = run(rover())
    x, t = found.signals["chassis.position_m"][:, 0], found.time_s
    # total torque over radius, over all that speeds up, the wheel's turning included
    acceleration = 0.04 / 0.0325 / (0.6 + 0.03)
    assert 2 * np.polyfit(t, x, 2)[0] == pytest.approx(acceleration, rel=1e-7)
    np.testing.assert_allclose(x + 0.02, acceleration * t**2 / 2, atol=1e-8)
    tyre, caster = (found.signals[f"{name}.normal_force_N"] for name in ("tyre", "caster"))
    np.testing.assert_allclose(tyre + caster, 0.6 * G, rtol=1e-3)
    # moments about the wheel's contact: weight behind it, inertia above it, the wheel's spin
    moment = 0.02 * 0.54 * G + (0.54 * 0.04 + 0.06 * 0.0325) * acceleration
    moment += 0.03 * 0.0325 * acceleration
    np.testing.assert_allclose(caster[10:], moment / 0.08, rtol=1e-6)


def test_drag_acts_at_the_instant_of_the_positions():
    """Else a fall of a second would be a millimetre off at this step."""
    mass, factor = 0.0027, 0.5 * 1.2 * 0.47 * math.pi * 0.02**2
    drag = {"coefficient": 0.47, "area_m2": math.pi * 0.02**2, "air_density_kg_m3": 1.2}
    found = run(scene({"ball": body(mass, 1e-6, drag=drag)}, {}, 1.0))
    limit = math.sqrt(mass * G / factor)
    fallen = limit**2 / G * np.log(np.cosh(G * found.time_s / limit))
    np.testing.assert_allclose(found.signals["ball.position_m"][:, 2], -fallen, atol=1e-6)
