"""Joints, drives and force sensors of PyBullet against closed forms, and its defaults."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from simcompare.engine import engines
from simcompare.errors import SimulationDiverged, Unsupported
from simcompare.model.rotations import conjugate, rotate
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue

pytestmark = pytest.mark.engines("pybullet")
BACKEND = engines.get("pybullet")
G = 9.81
GROUND = {"fixed": True, "shapes": [{"type": "plane", "normal": (0, 0, 1)}]}


def body(mass=1.0, inertia=0.01, **more):
    moments = inertia if isinstance(inertia, tuple) else (inertia,) * 3
    return {"mass_kg": mass, "inertia_kg_m2": moments, **more}


def scene(bodies, joints=(), duration=0.5, step=1e-3, substeps=1, gravity=G, **more):
    return Scenario.model_validate(
        {
            "name": "toy",
            "title": "Toy",
            "question": "Is it right?",
            "world": {
                "duration_s": duration,
                "step_s": step,
                "substeps": substeps,
                "gravity_m_s2": (0, 0, -gravity),
            },
            "bodies": bodies,
            "joints": dict(joints),
            **more,
        }
    )


def run(scenario, contact="assisted"):
    return BACKEND.simulate(scenario, Settings(contact))


def driven(joint, kind="torque", value=1.0, **signal):
    """One drive of one joint by one input."""
    given = signal or {"signal": "constant", "value": value}
    return {
        "inputs": {"u": given},
        "actuators": {"drive": {"type": kind, "joint": joint, "input": "u"}},
    }


def hinge(parent="base", child="arm", **more):
    return {"type": "hinge", "parent": parent, "child": child, "axis": (0, 1, 0), **more}


def slider(parent="base", child="cart", **more):
    return {"type": "slider", "parent": parent, "child": child, "axis": (1, 0, 0), **more}


def about(axis, angle):
    unit = np.array(axis) / np.linalg.norm(axis)
    return (math.cos(angle / 2), *(math.sin(angle / 2) * unit).tolist())


def test_a_pendulum_of_large_amplitude_has_its_period():
    length, inertia = 0.2, 0.01
    bodies = {"base": {"fixed": True}, "arm": body(1.0, inertia, position_m=(length, 0, 0))}
    t = run(scene(bodies, {"pivot": hinge()}, duration=2.4, step=1e-3))
    down = t.signals["pivot.angle_rad"] - math.pi / 2
    places = np.flatnonzero(np.diff(np.sign(down)))
    crossings = t.time_s[places] - down[places] * 1e-3 / np.diff(down)[places]
    omega = math.sqrt(G * length / (inertia + length**2))
    assert 2 * np.diff(crossings)[0] == pytest.approx(4 * ellipk(0.5) / omega, rel=2e-6)


@pytest.mark.parametrize(("contact", "ratio"), [("assisted", 4), ("default", None)])
def test_a_damped_spring_is_exact_to_second_order(contact, ratio):
    k, d, force, omega = 40.0, 0.6, 3.0, 15.0
    bodies = {"base": {"fixed": True}, "cart": body(0.5)}
    joint = {"rail": slider(stiffness=k, damping=d, rest=0.02)}
    drive = driven(
        "rail", "force", signal="sine", amplitude=force, frequency_Hz=omega / (2 * math.pi),
        offset=-0.02 * k,
    )  # fmt: skip
    exact = solve_ivp(
        lambda t, y: (y[1], (force * math.sin(omega * t) - k * y[0] - d * y[1]) / 0.5),
        (0, 0.5), (0, 0), method="DOP853", rtol=1e-12, atol=1e-14, t_eval=(0.5,),
    ).y[0, -1]  # fmt: skip
    errors = [
        run(scene(bodies, joint, step=step, **drive), contact).signals["rail.position_m"][-1]
        - exact
        for step in (2e-3, 1e-3)
    ]
    if ratio is None:
        assert abs(errors[1]) > 0.01, "by default a motor holds the joint"
    else:
        assert abs(errors[1]) < 1e-5
        assert errors[0] / errors[1] == pytest.approx(ratio, abs=0.3)


def test_coulomb_friction_slows_evenly_and_then_holds():
    bodies = {"base": {"fixed": True}, "cart": body(0.2)}
    t = run(scene(bodies, {"rail": slider(rate=1.0, friction=0.5)}))
    x, rate = t.signals["rail.position_m"], t.signals["rail.velocity_m_s"]
    early = t.time_s < 0.39
    assert 2 * np.polyfit(t.time_s[early], x[early], 2)[0] == pytest.approx(-2.5, rel=1e-9)
    assert x[-1] == pytest.approx(0.2, abs=1e-3)
    np.testing.assert_allclose(rate[t.time_s > 0.41], 0, atol=1e-12)


def test_armature_is_added_to_the_moment_about_the_hinge():
    turned = about((1, 0, 0), -math.pi / 2)  # the child's z along the axle
    bodies = {"base": {"fixed": True}, "arm": body(1.0, (0.5, 0.6, 0.2), orientation_wxyz=turned)}
    t = run(scene(bodies, {"pivot": hinge(armature=0.3)}, **driven("pivot")))
    angle = t.signals["pivot.angle_rad"][-1]
    assert angle == pytest.approx((1 / 0.5) * 0.5**2 / 2, rel=1e-9)
    (row,) = (row for row in t.audit if row.quantity == "pivot.armature")
    assert (row.set_value, row.read_value) == (0.5, 0.5)


def test_armature_pushes_back_on_what_carries_it():
    scenario = catalogue.load("robot_motor").resolve()
    values, t = scenario.parameters, run(scenario)
    chassis, wheel = scenario.bodies["chassis"], scenario.bodies["left_wheel"]
    radius, gravity = values["wheel_radius_m"], values["gravity_m_s2"]
    height, behind, to_caster = (
        values[n] for n in ("center_height_m", "center_behind_m", "caster_behind_m")
    )
    x = t.signals["chassis.position_m"][:, 0]
    acceleration = np.gradient(np.gradient(x, t.time_s), t.time_s)[100]
    # moments about the line on which the wheels stand; the rotors are not turned by the floor
    moment = behind * chassis.mass_kg * gravity + acceleration * (
        chassis.mass_kg * height + 2 * wheel.mass_kg * radius + 2 * wheel.inertia_kg_m2[1] / radius
    )
    load = t.signals["caster.normal_force_N"][100]
    assert load == pytest.approx(moment / to_caster, rel=5e-4)


@pytest.mark.parametrize(
    ("joint", "reason"),
    [
        (slider(child="arm", armature=0.1), "slider"),
        (hinge(axis=(0, 1, 1), armature=0.1), "principal axes"),
    ],
)
def test_armature_that_cannot_be_added_is_refused(joint, reason):
    bodies = {"base": {"fixed": True}, "arm": body()}
    with pytest.raises(Unsupported, match=reason):
        run(scene(bodies, {"joint": joint}))


def welded(base, **more):
    """A mass of 2 kg, 0.1 m off, on a force sensor."""
    offset = rotate(np.array([base.get("orientation_wxyz", (1, 0, 0, 0))]), np.array([[0.1, 0, 0]]))
    pose = {k: v for k, v in base.items() if k == "orientation_wxyz"}
    bodies = {"base": base, "mass": body(2.0, position_m=tuple(offset[0].tolist()), **pose)}
    weld = {"type": "fixed", "parent": "base", "child": "mass", "anchor_m": (0.1, 0, 0)}
    sensors = {"cell": {"type": "force", "joint": "weld"}}
    return scene(bodies, {"weld": weld}, duration=0.01, sensors=sensors, **more)


def test_a_force_sensor_reads_weight_upwards_in_the_childs_frame():
    upright = run(welded({"fixed": True})).signals["cell.force_N"]
    np.testing.assert_allclose(upright, np.tile((0, 0, 2 * G), (11, 1)), atol=1e-12)
    tilted = run(welded({"fixed": True, "orientation_wxyz": about((0, 1, 0), math.pi / 6)}))
    wanted = (-2 * G * math.sin(math.pi / 6), 0, 2 * G * math.cos(math.pi / 6))
    np.testing.assert_allclose(tilted.signals["cell.force_N"][5], wanted, atol=1e-12)


def test_a_force_sensor_reads_nothing_in_free_fall():
    falling = run(welded(body(velocity_m_s=(1.0, 2.0, 3.0))))
    np.testing.assert_allclose(falling.signals["cell.force_N"], 0, atol=1e-12)


@pytest.mark.parametrize("friction", [0.0, 1.5])
def test_a_force_sensor_reads_what_accelerates_a_mass_also_on_a_slider(friction):
    bodies = {"base": {"fixed": True}, "cart": body(4.0), "mass": body(1.0)}
    joints = {
        "rail": slider(friction=friction),
        "weld": {"type": "fixed", "parent": "cart", "child": "mass"},
    }
    sensors = {n: {"type": "force", "joint": j} for n, j in (("whole", "rail"), ("cell", "weld"))}
    given = driven("rail", "force", 10.0)
    t = run(scene(bodies, joints, duration=0.02, sensors=sensors, **given))
    push = 10.0 - friction
    np.testing.assert_allclose(t.signals["cell.force_N"][3], (push / 5, 0, G), atol=1e-10)
    np.testing.assert_allclose(t.signals["whole.force_N"][3], (push, 0, 5 * G), atol=1e-9)


def chain(fixed, **more):
    """Bodies of all kinds of joints, turned anyhow, on a base that may tumble."""
    pose = {"orientation_wxyz": about((1, 2, 3), 0.5)}
    tumble = {"velocity_m_s": (1, 2, -3), "rate_rad_s": (2, -1, 1.5)}
    rest = {
        "a": body(0.5, (3e-3, 4e-3, 5e-3), position_m=(0.2, 0.1, -0.1)),
        "b": body(0.3, (3e-3, 2e-3, 4e-3), position_m=(0.4, 0.15, 0.1)),
        "c": body(0.2, (1e-3, 2e-3, 15e-4), position_m=(0.5, 0.25, 0.2)),
        "d": body(0.15, (1e-3, 2e-3, 15e-4), position_m=(-0.3, 0.25, 0.2)),
    }
    for i, part in enumerate(rest.values()):
        part["orientation_wxyz"] = about((i, 1, 1 - i), 0.8 - 0.7 * i)
    base = {"fixed": True, **pose} if fixed else body(0.8, (0.01, 0.012, 0.015), **pose, **tumble)
    joints = {
        # out of order, and so that links are not numbered as they are listed
        "j3": {"type": "fixed", "parent": "b", "child": "c", "anchor_m": (0.1, 0, 0.02)},
        "j1": hinge("base", "a", anchor_m=(0.1, 0.05, 0), axis=(1, 1, -1), rate=3.0),
        "j4": hinge(
            "base", "d", anchor_m=(-0.1, 0.05, 0), axis=(0, 1, -1), rate=-4.0, friction=0.02
        ),
        "j2": slider("a", "b", anchor_m=(0.1, 0.05, 0.02), axis=(0, 1, -1), rate=2.0),
    }
    sensors = {f"s{name}": {"type": "force", "joint": name} for name in joints}
    given = driven("j2", "force", 2.0)
    return scene({"base": base, **rest}, joints, sensors=sensors, **given, **more)


@pytest.mark.parametrize("fixed", [True, False])
def test_forces_are_those_that_newtons_law_wants_where_bodies_move_on_each_other(fixed):
    step = 1e-5
    scenario = chain(fixed, duration=20 * step, step=step)
    t = run(scenario)
    for name, joint in scenario.joints.items():
        below, wanted = [joint.child], 0
        for other in below:
            below += [j.child for j in scenario.joints.values() if j.parent == other]
            felt = np.diff(t.signals[f"{other}.position_m"], 2, axis=0) / step**2 + (0, 0, G)
            wanted = wanted + scenario.bodies[other].mass_kg * felt
        turned = conjugate(t.signals[f"{joint.child}.orientation_wxyz"][1:-1])
        got = t.signals[f"s{name}.force_N"][1:-1]
        np.testing.assert_allclose(got, rotate(turned, wanted), atol=2e-3, err_msg=name)


def test_forces_are_refused_where_the_friction_of_a_slider_spoils_them():
    scenario = chain(fixed=True)
    joints = dict(scenario.joints)
    joints["j2"] = joints["j2"].model_copy(update={"friction": 0.1})
    with pytest.raises(Unsupported, match="j2, a slider with friction"):
        run(scenario.model_copy(update={"joints": joints}))


def test_the_contact_force_of_what_rests_is_its_weight_and_ends_when_it_leaves():
    shapes = {
        "ball": {"type": "sphere", "radius_m": 0.1},
        "box": {"type": "box", "size_m": (0.2,) * 3},
    }
    places = {"ball": 0.0, "box": 1.0}
    bodies = {"floor": GROUND} | {
        name: body(0.5, position_m=(places[name], 0, 0.1), shapes=[shape])
        for name, shape in shapes.items()
    }
    sensors = {
        "under_ball": {"type": "contact_force", "pair": ("floor", "ball")},
        "under_box": {"type": "contact_force", "pair": ("box", "floor")},
    }
    scenario = scene(bodies, duration=0.1, sensors=sensors)
    t = run(scenario)
    # the box begins on one corner, as Bullet finds a point in each step
    for name, first, off in (("under_ball", 0, 1e-12), ("under_box", 60, 1e-4)):
        np.testing.assert_allclose(t.signals[f"{name}.normal_force_N"][first:], G / 2, rtol=off)
    simulation = BACKEND.open(scenario, Settings())
    simulation.step()
    resting = simulation.state
    rising = replace(resting.bodies["ball"], velocity_m_s=(0.0, 0.0, 0.5))
    simulation.set_state(replace(resting, bodies={**resting.bodies, "ball": rising}))
    simulation.step()
    simulation.step()
    assert simulation.read()["under_ball.normal_force_N"] == 0
    simulation.close()


def test_a_state_with_joints_can_be_restored():
    scenario = catalogue.load("robot").resolve()
    simulation = BACKEND.open(scenario, Settings())

    def steps(count):
        for _ in range(count):
            simulation.step()
        return simulation.state

    start = steps(40)
    end = steps(60)
    simulation.set_state(start)
    again = steps(60)
    simulation.close()
    for name, held in end.joints.items():
        assert again.joints[name] == pytest.approx(held, abs=1e-12)
    for name, held in end.bodies.items():
        np.testing.assert_allclose(again.bodies[name].position_m, held.position_m, atol=1e-12)


def test_a_joint_starts_at_its_rate_and_its_child_where_it_is_drawn():
    scenario = chain(fixed=True)
    simulation = BACKEND.open(scenario, Settings())
    for name, drawn in scenario.moving_bodies().items():
        np.testing.assert_allclose(simulation.origin_of(name), drawn.position_m, atol=1e-12)
    simulation.close()
    bodies = {"base": {"fixed": True}, "arm": body()}
    t = run(scene(bodies, {"pivot": hinge(rate=150.0)}))
    np.testing.assert_allclose(t.signals["pivot.angle_rad"], 150 * t.time_s, rtol=1e-12)


def test_the_engine_has_every_body_where_its_joints_put_it():
    scenario = chain(fixed=False, duration=0.2)
    t, simulation = run(scenario), BACKEND.open(scenario, Settings())
    for _ in range(200):
        simulation.step()
    for name in scenario.moving_bodies():
        wanted = t.signals[f"{name}.position_m"][-1]
        np.testing.assert_allclose(simulation.origin_of(name), wanted, atol=1e-10)
    simulation.close()


def test_substeps_are_smaller_steps():
    fine = run(chain(fixed=True, duration=0.04, step=2.5e-4))
    coarse = run(chain(fixed=True, duration=0.04, step=1e-3, substeps=4))
    for name, values in coarse.signals.items():
        if not name.startswith(("j", "sj")):
            continue
        np.testing.assert_array_equal(values, fine.signals[name][::4], err_msg=name)


def test_only_pairs_that_are_to_touch_do_so_within_one_articulated_body():
    ball = [{"type": "sphere", "radius_m": 0.1}]
    bodies = {
        "base": {"fixed": True, "shapes": ball},
        "arm": body(shapes=ball, position_m=(0.15, 0, 0)),
        "tip": body(shapes=ball, position_m=(0.15, 0, 0.3)),
    }
    joints = {
        "pivot": slider(child="arm"),  # overlaps its parent, which is no contact
        "rail": slider("arm", "tip", axis=(0, 0, 1), rate=-1.0),
    }
    sensors = {"touch": {"type": "contact_force", "pair": ("base", "tip")}}
    t = run(scene(bodies, joints, gravity=0.0, sensors=sensors))
    assert t.signals["touch.normal_force_N"].max() > 0
    assert abs(t.signals["pivot.position_m"][100]) < 1e-9
    apart = t.signals["tip.position_m"] - t.signals["arm.position_m"]
    assert np.linalg.norm(apart, axis=1).min() < 0.05, (
        "tip and arm are jointed, so they may overlap"
    )


def test_by_default_motors_hold_the_joints_and_cylinders_are_the_engines_own():
    t = run(catalogue.load("robot_cylinder").resolve(), "default")
    assert abs(t.signals["chassis.position_m"][-1, 0] + 0.02) < 1e-4
    notes = {row.quantity: row for row in t.audit}
    assert notes["left.friction"].set_value is None
    assert "left on" in notes["left.friction"].note
    assert notes["left_wheel.length_m"].engine_parameter == "getCollisionShapeData"


def test_wheels_of_rims_roll_straight():
    t = run(catalogue.load("robot_cylinder").resolve())
    x, y, _ = t.signals["chassis.position_m"][-1]
    torque, mass, radius, rim = 0.02, 0.6, 0.0325, 1.584375e-5
    acceleration = 2 * torque / radius / (mass + 2 * rim / radius**2)
    # where bodies touch, the first step pushes for the whole of it
    assert x + 0.02 == pytest.approx(0.5 * acceleration * 1.02 * 1.021, rel=2e-6)
    assert abs(y) < 1e-5
    sizes = [row for row in t.audit if row.quantity == "left_wheel.length_m"]
    assert [row.read_value for row in sizes] == pytest.approx([0.002, 0.002], rel=1e-12)
    assert all("two rims" in row.note and row.scenario_value is None for row in sizes)


def test_rims_are_at_the_ends_of_the_cylinder_that_they_stand_for():
    simulation = BACKEND.open(catalogue.load("robot_cylinder").resolve(), Settings())
    place = simulation.built.bodies["left_wheel"]
    one, other = simulation.built.bullet.getCollisionShapeData(*place)
    simulation.close()
    outer = one[3][0] / 2 + other[3][0] / 2 + math.dist(one[5], other[5])
    assert outer == pytest.approx(0.02, rel=1e-12)
    assert (one[3][1], other[3][1]) == pytest.approx((0.0325, 0.0325), rel=1e-12)


@pytest.mark.parametrize("contact", ["assisted", "coefficients", "default"])
@pytest.mark.parametrize("named", [True, False])
def test_moving_bodies_touch_only_where_they_are_named(contact, named):
    ball = [{"type": "sphere", "radius_m": 0.05}]
    bodies = {
        "a": body(shapes=ball, velocity_m_s=(1, 0, 0)),
        "b": body(shapes=ball, position_m=(0.2, 0, 0)),
    }
    contacts = [{"pair": ("a", "b")}] if named else []
    scenario = scene(bodies, duration=0.3, contacts=contacts)
    simulation = BACKEND.open(scenario, Settings(contact))
    simulation.set_state(replace(simulation.state))  # which PyBullet has no copy of
    for _ in range(300):
        simulation.step()
    moved = simulation.state.bodies["b"].position_m[0] > 0.21
    simulation.close()
    assert moved == (named or contact == "default")


def test_numbers_without_sense_are_an_error():
    bodies = {"base": {"fixed": True}, "cart": body()}
    with pytest.raises(SimulationDiverged, match=r"rail\.velocity_m_s"):
        run(scene(bodies, {"rail": slider()}, **driven("rail", "force", 1e15)))
