"""Joints, drives and force readings of DART, on scenes small enough for closed forms."""

import math

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.errors import SimulationDiverged, Unsupported
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue

pytest.importorskip("dartpy")

BACKEND = engines.get("dart")
ASSISTED, DEFAULT = Settings("assisted"), Settings("default")
G = 9.80665
SMALL = (1e-3, 2e-3, 2.5e-3)
FLOOR = {"fixed": True, "shapes": [{"type": "plane"}]}


def scene(bodies, joints, duration_s=0.5, step_s=0.001, **more):
    world = {"duration_s": duration_s, "step_s": step_s, **more.pop("world", {})}
    told = {"name": "small", "title": "small", "question": "what now?", "world": world}
    return Scenario.model_validate({**told, "bodies": bodies, "joints": joints, **more})


def run(scenario, settings=ASSISTED):
    return BACKEND.simulate(scenario, settings)


def about_y(angle):
    return (math.cos(angle / 2), 0.0, math.sin(angle / 2), 0.0)


def link(mass_kg=1.0, **more):
    return {"mass_kg": mass_kg, "inertia_kg_m2": SMALL, **more}


def slider(**joint):
    """A mass of 1 kg on a rail along x."""
    rail = {"type": "slider", "parent": "rail", "child": "mass", "axis": (1, 0, 0), **joint}
    return {"rail": {"fixed": True}, "mass": link()}, {"slide": rail}


def pendulum(angle, **joint):
    """A rod's end 0.3 m below its hinge about y, held out by an angle; the hinge at 1 m."""
    bob = (-0.3 * math.sin(angle), 0.0, 1 - 0.3 * math.cos(angle))
    hinge = {"type": "hinge", "parent": "wall", "child": "bob", "axis": (0, 1, 0), **joint}
    bodies = {
        "wall": {"fixed": True, "position_m": (0, 0, 1)},
        "bob": link(position_m=bob, orientation_wxyz=about_y(angle)),
    }
    return bodies, {"hinge": hinge}


# --- motion ---------------------------------------------------------------------------------------


def test_a_pendulum_swings_with_its_own_period():
    from scipy.special import ellipk

    angle = math.radians(60)
    found = run(scene(*pendulum(angle), duration_s=1.6))
    turned = angle + found.signals["hinge.angle_rad"]
    k = np.nonzero(turned[:-1] * turned[1:] < 0)[0][:2]
    crossings = found.time_s[k] + 0.001 * turned[k] / (turned[k] - turned[k + 1])
    inertia = SMALL[1] + 0.3**2
    period = 4 * math.sqrt(inertia / (G * 0.3)) * ellipk(math.sin(angle / 2) ** 2)
    assert 2 * np.diff(crossings)[0] == pytest.approx(period, rel=1e-4)


def test_a_driven_spring_and_damper_is_of_second_order_in_the_step():
    from scipy.integrate import solve_ivp

    # 2 N push at once, so the start counts as well
    push = {"signal": "sine", "amplitude": 3.0, "frequency_Hz": 4.0, "offset": 2.0}

    def law(t, y):
        return [y[1], 2 + 3 * math.sin(8 * math.pi * t) - 900 * y[0] - 12 * y[1]]

    exact = solve_ivp(law, (0, 0.4), (0, 0.1), rtol=1e-12, atol=1e-14).y[0, -1]
    errors = []
    for step_s in (0.002, 0.001):
        found = run(
            scene(
                *slider(stiffness=900, damping=12, rate=0.1), duration_s=0.4, step_s=step_s,
                inputs={"push": push},
                actuators={"motor": {"type": "force", "joint": "slide", "input": "push"}},
            )
        )  # fmt: skip
        errors.append(found.signals["slide.position_m"][-1] - exact)
    assert abs(errors[1]) < 1e-3 * abs(exact)
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)


def test_coulomb_friction_slows_evenly_and_then_holds():
    found = run(scene(*slider(rate=1.0, friction=4.0), duration_s=0.4))
    place, t = found.signals["slide.position_m"], found.time_s[:250]
    np.testing.assert_allclose(place[:250], t - 2 * t**2, atol=1e-9)
    np.testing.assert_allclose(found.signals["slide.velocity_m_s"][252:], 0, atol=1e-9)


def test_friction_holds_what_is_pushed_too_little():
    slope = about_y(math.radians(20))
    bodies, joints = slider(friction=4.0)
    for body in bodies.values():
        body["orientation_wxyz"] = slope
    found = run(scene(bodies, joints, duration_s=0.2))
    assert abs(found.signals["slide.position_m"][-1]) < 1e-9


def test_an_initial_rate_of_a_joint_moves_its_child():
    found = run(scene(*pendulum(0.0, rate=2.0), duration_s=0.01))
    assert found.signals["hinge.rate_rad_s"][0] == 2.0
    # below the hinge, turning from z to x is moving back
    np.testing.assert_allclose(found.signals["bob.velocity_m_s"][0], (-0.6, 0, 0), atol=1e-12)
    np.testing.assert_allclose(found.signals["bob.rate_rad_s"][0], (0, 2, 0), atol=1e-12)


def test_bodies_on_a_fixed_joint_fly_as_one():
    bodies = {
        "a": link(2.0, velocity_m_s=(1, 0, 1), rate_rad_s=(0, 0, 0.3)),
        "b": link(1.0, position_m=(0.3, 0, 0), orientation_wxyz=about_y(0.5)),
    }
    found = run(scene(bodies, {"weld": {"type": "fixed", "parent": "a", "child": "b"}}))
    a, b = (found.signals[f"{name}.position_m"] for name in "ab")
    np.testing.assert_allclose(np.linalg.norm(b - a, axis=1), 0.3, rtol=1e-12)
    center = (2 * a + b) / 3
    start = np.array((0.1, 0, 0)) + np.outer(found.time_s, (1, 0.03, 1))
    np.testing.assert_allclose(center[:, :2], start[:, :2], atol=1e-5)


def test_the_joint_of_a_free_body_is_in_the_frame_of_that_body():
    """A free root that is turned and that children hang on keeps its velocities in the world."""
    free = {
        "orientation_wxyz": about_y(1.0),
        "velocity_m_s": (0.3, 0.2, 0),
        "position_m": (0, 0, 1),
    }
    bodies = {"root": link(1e3, **free), "arm": link(1e-3, position_m=(0, 0, 1))}
    hinge = {"type": "hinge", "parent": "root", "child": "arm", "axis": (0, 1, 0), "rate": 1.0}
    found = run(scene(bodies, {"hinge": hinge}, world={"gravity_m_s2": (0, 0, 0)}))
    t = found.time_s[:, None]
    np.testing.assert_allclose(
        found.signals["root.position_m"], (0, 0, 1) + t * (0.3, 0.2, 0), atol=1e-6
    )


def test_substeps_are_smaller_steps():
    law = {"stiffness": 50.0, "damping": 3.0, "friction": 0.5, "rate": 2.0}
    whole = run(scene(*slider(**law), duration_s=0.2, step_s=0.001))
    parts = run(scene(*slider(**law), duration_s=0.2, step_s=0.004, world={"substeps": 4}))
    for name in ("slide.position_m", "slide.velocity_m_s"):
        np.testing.assert_array_equal(parts.signals[name], whole.signals[name][::4])


def test_what_hangs_on_nothing_common_is_recorded_each_by_itself():
    bodies, joints = pendulum(0.5, damping=0.2)
    alone = run(scene(bodies, joints, 0.1)).signals
    other = {"stone": link(position_m=(3, 0, 9), velocity_m_s=(1, 0, 0))}
    rail, slide = slider(rate=0.5)
    found = run(scene({**other, **bodies, **rail}, {**slide, **joints}, 0.1)).signals
    np.testing.assert_array_equal(found["hinge.angle_rad"], alone["hinge.angle_rad"])
    assert found["slide.position_m"][-1] == pytest.approx(0.05, rel=1e-12)
    np.testing.assert_allclose(found["stone.position_m"][-1, :2], (3.1, 0), rtol=1e-12)


# --- armature -------------------------------------------------------------------------------------

CONSTANT = {"push": {"signal": "constant", "value": 0.01}}
TWIST = {"motor": {"type": "torque", "joint": "hinge", "input": "push"}}


@pytest.mark.parametrize("axis", [(0, 1, 0), (1, 1, 0.5)])
def test_an_armature_is_sped_up_too(axis):
    bodies = {"wall": {"fixed": True}, "disk": link()}
    hinge = {"type": "hinge", "parent": "wall", "child": "disk", "axis": axis, "armature": 4e-3}
    told = scene(bodies, {"hinge": hinge}, 0.1, inputs=CONSTANT, actuators=TWIST)
    found = run(told)
    unit = np.array(axis) / np.linalg.norm(axis)
    angle = 0.01 * 0.1**2 / 2 / (np.sum(np.array(SMALL) * unit**2) + 4e-3)
    assert found.signals["hinge.angle_rad"][-1] == pytest.approx(angle, rel=1e-9)
    rows = {row.quantity: row for row in found.audit}
    assert rows["hinge.armature"].set_value == 4e-3
    moments = [rows[f"disk.inertia_kg_m2.{i}"].read_value for i in (1, 2, 3)]
    np.testing.assert_allclose(moments, SMALL + 4e-3 * unit**2, rtol=1e-12)


def test_a_driven_armature_pushes_back_on_its_parent():
    """It turns against its parent, so together they have no angular momentum of their own."""
    big = {"mass_kg": 1, "inertia_kg_m2": (0.02, 0.02, 0.02)}
    hinge = {"type": "hinge", "parent": "base", "child": "disk", "axis": (0, 1, 0)}
    told = scene(
        {"base": big, "disk": link()}, {"hinge": {**hinge, "armature": 1e-3}}, 0.2,
        inputs=CONSTANT, actuators=TWIST, world={"gravity_m_s2": (0, 0, 0)},
    )  # fmt: skip
    found = run(told).signals
    base, disk = (found[f"{name}.rate_rad_s"][-1, 1] for name in ("base", "disk"))
    own = 1e-3 * found["hinge.rate_rad_s"][-1]
    assert own > 5e-4
    assert abs(0.02 * base + SMALL[1] * disk) < 0.1 * own


def test_an_armature_on_a_slider_is_refused():
    with pytest.raises(Unsupported, match="would have weight"):
        BACKEND.open(scene(*slider(armature=0.1)), ASSISTED)


# --- forces ---------------------------------------------------------------------------------------


def weld_on(base, **more):
    bodies = {"base": base, "mass": link(0.5, **more)}
    return bodies, {"weld": {"type": "fixed", "parent": "base", "child": "mass"}}


CELL = {"cell": {"type": "force", "joint": "weld"}}


def test_the_force_on_a_mass_at_rest_is_its_weight_up():
    found = run(scene(*weld_on({"fixed": True}), 0.01, sensors=CELL))
    np.testing.assert_allclose(found.signals["cell.force_N"], [(0, 0, 0.5 * G)] * 11, atol=1e-12)


def test_the_force_is_in_the_frame_of_the_child():
    tilted = about_y(math.radians(30))
    bodies, joints = weld_on({"fixed": True}, orientation_wxyz=tilted)
    found = run(scene(bodies, joints, 0.01, sensors=CELL))
    # its front is down, so its x axis has a part of the weight that points back
    wanted = (-0.5 * G / 2, 0, 0.5 * G * math.sqrt(0.75))
    np.testing.assert_allclose(found.signals["cell.force_N"][-1], wanted, atol=1e-12)


def test_nothing_holds_what_falls_freely():
    found = run(scene(*weld_on(link(2.0), position_m=(0.1, 0, 0.2)), 0.1, sensors=CELL))
    np.testing.assert_allclose(found.signals["cell.force_N"], 0, atol=1e-12)


@pytest.mark.parametrize("substeps", [1, 3])
def test_a_force_is_that_of_the_instant_of_its_sample(substeps):
    bodies, joints = slider()
    bodies["load"] = link(0.5)
    joints["weld"] = {"type": "fixed", "parent": "mass", "child": "load"}
    told = scene(
        bodies, joints, 0.1, sensors=CELL, world={"substeps": substeps},
        inputs={"wave": {"signal": "sine", "amplitude": 3.0, "frequency_Hz": 20.0}},
        actuators={"push": {"type": "force", "joint": "slide", "input": "wave"}},
    )  # fmt: skip
    found = run(told)
    wanted = np.sin(40 * math.pi * found.time_s)  # a third of the force moves a third of the mass
    np.testing.assert_allclose(found.signals["cell.force_N"][:, 0], wanted, atol=1e-12)


def test_the_floor_carries_all_that_stands_on_it():
    ball = {"type": "sphere", "radius_m": 0.05}
    bodies = {
        "floor": FLOOR,
        "foot": link(1.0, position_m=(0, 0, 0.05), shapes=[ball]),
        "load": link(2.0, position_m=(0, 0, 0.3)),
    }
    # the load sinks at first and is held by its spring
    spring = {"type": "slider", "parent": "foot", "child": "load", "axis": (0, 0, 1)}
    joints = {"spring": {**spring, "stiffness": 2000.0, "damping": 120.0}}
    load = {"load_N": {"type": "contact_force", "pair": ("floor", "foot")}}
    told = scene(bodies, joints, 0.6, sensors=load)
    force = run(told).signals["load_N.normal_force_N"]
    assert force[1] < 1.3 * G
    assert force[-1] == pytest.approx(3.0 * G, rel=1e-4)
    assert force.min() >= 0


def test_a_link_touches_the_fixed_body_that_its_chain_hangs_on():
    """They are of one skeleton, and DART lets those pass through one another by default."""
    ball = {"type": "sphere", "radius_m": 0.05}
    bodies = {
        "floor": FLOOR,
        "lift": link(position_m=(0, 0, 0.5), shapes=[ball]),
        "foot": link(position_m=(0, 0, 0.051), shapes=[ball]),
    }
    up = {"type": "slider", "axis": (0, 0, 1)}
    joints = {
        "lower": {**up, "parent": "floor", "child": "lift"},
        "upper": {**up, "parent": "lift", "child": "foot"},
    }
    sensors = {"ground": {"type": "contact_force", "pair": ("foot", "floor")}}
    found = run(scene(bodies, joints, 0.2, sensors=sensors))
    assert found.signals["ground.normal_force_N"][-1] == pytest.approx(G, rel=1e-3)


def test_spinning_wheels_push_with_what_they_are_loaded_with():
    torque, mu = 0.035, 0.5
    told = catalogue.load("robot").resolve({"torque_N_m": torque, "tyre_friction": mu})
    told = told.model_copy(update={"world": told.world.model_copy(update={"duration_s": 0.3})})
    found = run(told)
    p = told.parameters
    total = p["body_mass_kg"] + 2 * p["wheel_mass_kg"]
    radius, caster = p["wheel_radius_m"], p["caster_behind_m"]
    behind, height = p["center_behind_m"], p["center_height_m"]
    carried = caster * total * G - behind * p["body_mass_kg"] * G - 2 * torque
    lever = caster * total + mu * (
        height * p["body_mass_kg"] - total * radius + 2 * p["wheel_mass_kg"] * radius
    )
    late = found.time_s > 0.05
    fit = np.polyfit(found.time_s[late], found.signals["chassis.position_m"][late, 0], 2)
    assert 2 * fit[0] == pytest.approx(mu * carried / lever, rel=1e-3)


# --- states and values ----------------------------------------------------------------------------


@pytest.mark.parametrize("contact", ["assisted", "default"])
def test_a_state_brings_joints_back_bit_for_bit(contact):
    told = scene(*pendulum(0.7, stiffness=2.0, damping=0.3, friction=0.05), 0.4)
    simulation = BACKEND.open(told, Settings(contact))
    for _ in range(100):
        simulation.step()
    start, ends = simulation.state, []
    for _ in range(2):
        simulation.set_state(start)
        for _ in range(50):
            simulation.step()
        ends.append(simulation.state)
    assert ends[0] == ends[1]
    for _ in range(250):
        simulation.step()
    straight = run(told, Settings(contact)).signals["hinge.angle_rad"][-1]
    assert simulation.state.joints["hinge"][0] == straight


def test_springs_and_dampers_are_forces_of_ours_and_by_default_the_engines_own():
    told = scene(*slider(stiffness=5.0, damping=0.3, friction=0.2), 0.01)
    assisted, default = (
        {row.quantity: row for row in run(told, settings).audit} for settings in (ASSISTED, DEFAULT)
    )
    for part, value in (("stiffness", 5.0), ("damping", 0.3)):
        assert assisted[f"slide.{part}"].read_value is None
        assert assisted[f"slide DART's own {part}"].read_value == 0
        assert default[f"slide.{part}"].read_value == value
    assert assisted["slide.friction"].read_value == default["slide.friction"].read_value == 0.2
    assert assisted["sleep"].read_value == 0
    assert default["sleep"].read_value == 1


def test_friction_that_no_smaller_of_two_gives_is_refused():
    ball = {"type": "sphere", "radius_m": 0.05}
    bodies = {
        "floor": FLOOR,
        "a": link(position_m=(0, 0, 0.1), shapes=[ball]),
        "b": link(position_m=(1, 0, 0.1), shapes=[ball]),
    }
    pairs = {("a", "floor"): 0.6, ("b", "floor"): 0.3, ("a", "b"): 0.5}
    contacts = [{"pair": pair, "friction": mu} for pair, mu in pairs.items()]
    with pytest.raises(Unsupported, match="takes the smaller"):
        BACKEND.open(scene(bodies, {}, contacts=contacts), ASSISTED)


@pytest.mark.parametrize("contact", ["assisted", "coefficients", "default"])
@pytest.mark.parametrize("named", [True, False])
def test_moving_bodies_touch_only_where_they_are_named(contact, named):
    ball = [{"type": "sphere", "radius_m": 0.05}]
    bodies = {
        "a": link(shapes=ball, velocity_m_s=(1, 0, 0)),
        "b": link(shapes=ball, position_m=(0.2, 0, 0)),
    }
    contacts = [{"pair": ("a", "b")}] if named else []
    found = run(scene(bodies, {}, 0.3, contacts=contacts), Settings(contact))
    moved = found.signals["b.position_m"][-1, 0] > 0.21
    assert moved == (named or contact == "default")


def test_numbers_without_sense_are_an_error():
    push = {"signal": "constant", "value": 1e12}
    drive = {"type": "force", "joint": "slide", "input": "push"}
    told = scene(*slider(), 0.1, inputs={"push": push}, actuators={"motor": drive})
    with pytest.raises(SimulationDiverged, match=r"slide\.velocity_m_s"):
        run(told)
