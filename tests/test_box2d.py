"""Box2D: what its steps, joints and contacts make of small scenes with a known answer."""

import math

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.errors import SimulationDiverged, Unsupported
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue
from tests.planar_scenes import FRAME, G, body, scene, turned

pytestmark = pytest.mark.engines("box2d")


def run(told, contact="tuned"):
    return engines.get("box2d").simulate(told, Settings(contact))


def opened(told, contact="tuned"):
    return engines.get("box2d").open(told, Settings(contact))


# --- steps ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("contact", "parts"), [("default", 4), ("tuned", 8)])
def test_velocities_come_first_in_every_substep(contact, parts):
    """So a fall is by half a substep of speed too long, and by no more than rounding besides."""
    found = run(scene({"ball": body(at=(0, 0, 1.0))}, {}), contact)
    t, step_s = found.time_s, 1e-3
    height = 1.0 - G * t**2 / 2 - G * t * step_s / parts / 2
    np.testing.assert_allclose(found.signals["ball.position_m"][:, 2], height, rtol=0, atol=5e-5)
    assert G * t[-1] * step_s / parts / 2 > 3e-4
    np.testing.assert_allclose(found.signals["ball.velocity_m_s"][:, 2], -G * t, rtol=3e-4)


def test_assisted_begins_half_a_substep_before_the_start_and_falls_on_the_parabola():
    found = run(scene({"ball": body(at=(0, 0, 1.0))}, {}), "assisted")
    t = found.time_s
    np.testing.assert_allclose(
        found.signals["ball.position_m"][:, 2], 1.0 - G * t**2 / 2, rtol=0, atol=5e-5
    )
    assert found.velocity_offset_s == -1e-3 / 16


def spinning(rate=0.0, step=1e-3, duration=0.5, **more):
    joints = {"hinge": {"type": "hinge", "parent": "frame", "child": "disk", "axis": (0, -1, 0)}}
    joints["hinge"]["rate"] = rate
    return scene({**FRAME, "disk": body()}, joints, duration, step, **more)


def pushed(torque):
    return {
        "inputs": {"push": {"signal": "constant", "value": torque}},
        "actuators": {"motor": {"type": "torque", "joint": "hinge", "input": "push"}},
    }


@pytest.mark.parametrize("rate", [300.0, -300.0])
def test_turns_are_counted_and_none_is_lost_in_a_substep(rate):
    angle = run(spinning(rate)).signals["hinge.angle_rad"]
    assert abs(rate * 0.5) > 20 * 2 * math.pi
    # it turns by atan(ω·h): with 4 substeps a six-hundredth would be missing
    assert angle[-1] == pytest.approx(rate * 0.5, rel=4e-4)
    assert run(spinning(rate), "default").signals["hinge.angle_rad"][-1] / angle[-1] < 0.9990


def test_turns_survive_a_state_and_a_token():
    simulation = opened(spinning(100.0))
    for _ in range(200):
        simulation.step()
    state, token = simulation.state, simulation.save()
    angle, _ = state.joints["hinge"]
    assert angle == pytest.approx(20.0, rel=1e-3)
    for back in (lambda: simulation.set_state(state), lambda: simulation.restore(token)):
        for _ in range(50):
            simulation.step()
        back()
        assert simulation.state.joints["hinge"][0] == pytest.approx(angle, abs=1e-6)
    simulation.close()


def test_what_would_be_slowed_down_is_refused_or_found_out():
    with pytest.raises(Unsupported, match=r"steps of at most 0\.000785 s, not 0\.001 s"):
        run(spinning(1000.0))
    run(spinning(1000.0, step=5e-4))
    # nobody can foresee what a torque without damping leads to
    with pytest.raises(SimulationDiverged, match=r"disk turned by .* try a smaller --step"):
        run(spinning(**pushed(20.0)))
    # also where it has slowed down again by the end
    swung = {"signal": "sine", "amplitude": 52.0, "frequency_Hz": 2.0}
    with pytest.raises(SimulationDiverged, match=r"disk turned by .* by t = 0\.[0-4]"):
        run(spinning(**{**pushed(20.0), "inputs": {"push": swung}}))


# --- joints ---------------------------------------------------------------------------------------


def two_rods(light, heavy):
    """A light rod that carries a heavy one, both let go level."""
    length = 0.3
    rods = {
        name: body(mass, mass * length**2 / 12, (x * length, 0, 0))
        for name, mass, x in (("light", light, 0.5), ("heavy", heavy, 1.5))
    }
    hinge = {"type": "hinge", "axis": (0, -1, 0)}
    joints = {
        "first": {**hinge, "parent": "frame", "child": "light"},
        "second": {**hinge, "parent": "light", "child": "heavy", "anchor_m": (length / 2, 0, 0)},
    }
    return scene({**FRAME, **rods}, joints, duration=1.0)


def lost(told, contact):
    """Energy that is lost, by what the scene could gain in falling."""
    found, energy, scale = run(told, contact).signals, 0.0, 0.0
    for name, rod in told.moving_bodies().items():
        speed, rate = found[f"{name}.velocity_m_s"], found[f"{name}.rate_rad_s"][:, 1]
        kinetic = rod.mass_kg * (speed**2).sum(axis=1) / 2 + rod.inertia_kg_m2[1] * rate**2 / 2
        energy = energy + kinetic + rod.mass_kg * G * found[f"{name}.position_m"][:, 2]
        scale += rod.mass_kg * G * 0.3
    return (energy[0] - energy[-1]) / scale


def test_hinges_are_stiff_where_everything_is_given():
    told = two_rods(0.01, 1.0)
    assert lost(told, "coefficients") > 0.15
    assert abs(lost(told, "tuned")) < 0.01


def test_dry_friction_of_a_hinge_brakes_and_holds():
    told = spinning(5.0, duration=2.0)
    hinge = told.joints["hinge"].model_copy(update={"friction": 0.05})
    told = told.model_copy(update={"joints": {"hinge": hinge}})
    found = run(told).signals
    stop_s = 5.0 * 0.01 / 0.05
    assert found["hinge.angle_rad"][-1] == pytest.approx(5.0 * stop_s / 2, rel=0.002)
    assert abs(found["hinge.rate_rad_s"][-500:]).max() < 1e-6


def test_what_turns_without_a_shape_falls_asleep_by_default():
    told = spinning(5.0, duration=1.0)
    assert run(told, "coefficients").signals["hinge.rate_rad_s"][-1] == 0.0
    assert run(told).signals["hinge.rate_rad_s"][-1] == pytest.approx(5.0, rel=1e-5)


def test_the_force_through_a_slider_holds_its_effort():
    """Of a cart that a motor lifts along a slope: across it the weight, along it the push."""
    slope, push = 0.4, 7.0
    along = (math.cos(slope), 0, math.sin(slope))
    told = scene(
        {**FRAME, "cart": body(0.5, orientation_wxyz=turned(-slope))},
        {"rail": {"type": "slider", "parent": "frame", "child": "cart", "axis": along}},
        inputs={"pull": {"signal": "constant", "value": push}},
        actuators={"motor": {"type": "force", "joint": "rail", "input": "pull"}},
        sensors={"cell": {"type": "force", "joint": "rail"}},
    )
    found = run(told).signals
    wanted = [push, 0.0, 0.5 * G * math.cos(slope)]
    np.testing.assert_allclose(found["cell.force_N"][-1], wanted, rtol=1e-3, atol=1e-6)
    moved = (push / 0.5 - G * math.sin(slope)) * found["cell.force_N"].shape[0] ** 2 * 5e-7
    assert found["rail.position_m"][-1] == pytest.approx(moved, rel=0.01)


@pytest.mark.parametrize("contact", ["tuned", "assisted"])
def test_an_armature_has_its_recoil_with_our_help_only(contact):
    """A free body starts a disk with an armature: all of it together keeps its momentum."""
    joint = {"type": "hinge", "parent": "base", "child": "disk", "axis": (0, -1, 0)}
    told = scene(
        {"base": body(1.0, 0.02), "disk": body(0.5, 0.004)}, {"hinge": {**joint, "armature": 0.01}},
        gravity=0.0, **pushed(0.1),
    )  # fmt: skip
    found = run(told, contact).signals
    base, disk = (-found[f"{name}.rate_rad_s"][-1, 1] for name in ("base", "disk"))
    # torque on either body alone, and the armature that resists only their difference
    change = np.linalg.solve([[0.004 + 0.01, -0.01], [-0.01, 0.02 + 0.01]], [0.1, -0.1]) * 0.5
    if contact == "assisted":
        assert (disk, base) == pytest.approx(tuple(change), rel=0.01)
    else:
        assert base == pytest.approx(-0.1 / 0.02 * 0.5, rel=0.01)


# --- contacts -------------------------------------------------------------------------------------

FLOOR = {"floor": {"fixed": True, "shapes": [{"type": "plane"}]}}
BOX = [{"type": "box", "size_m": (0.1, 0.1, 0.04)}]


def resting(at=(0, 0, 0.02), **pair):
    floor = {"pair": ("box", "floor"), **pair}
    return scene({**FLOOR, "box": body(0.2, 2e-4, at, shapes=BOX)}, {}, contacts=[floor])


def test_a_body_at_rest_sinks_in_by_micrometres_where_everything_is_given():
    for contact, least, most in (("coefficients", 5e-5, 2e-4), ("tuned", 0.0, 5e-6)):
        height = run(resting(friction=0.5), contact).signals["box.position_m"][:, 2]
        assert least <= 0.02 - height[-1] <= most
        assert np.ptp(height[-100:]) < 2e-5  # it comes to rest and does not tremble
    assert np.ptp(height[-100:]) < 1e-8


def test_a_plane_may_be_turned_in_its_body_or_with_it():
    slope = 0.3
    normal = (math.sin(slope), 0, math.cos(slope))
    start = {"at": tuple(0.02 * n for n in normal), "orientation_wxyz": turned(slope)}
    moved = []
    for ground in (
        {"fixed": True, "shapes": [{"type": "plane", "normal": normal}]},
        {"fixed": True, "shapes": [{"type": "plane"}], "orientation_wxyz": turned(slope)},
    ):
        box = body(0.2, 2e-4, start["at"], shapes=BOX, orientation_wxyz=turned(slope))
        pair = {"pair": ("box", "floor"), "friction": 0.1}
        told = scene({"floor": ground, "box": box}, {}, contacts=[pair])
        place = run(told).signals["box.position_m"]
        moved.append(place[-1] - place[0])
    way = G * (math.sin(slope) - 0.1 * math.cos(slope)) * 0.5**2 / 2
    for change in moved:
        np.testing.assert_allclose(
            change, [way * math.cos(slope), 0, -way * math.sin(slope)], rtol=0.005, atol=2e-5
        )


def test_values_of_bodies_that_give_no_pair_are_refused():
    other = {"pair": ("box", "other"), "friction": 0.9}
    told = resting(friction=0.5).model_dump()
    told["bodies"]["other"] = {**told["bodies"]["box"], "position_m": (0, 0, 0.06)}
    told["contacts"] = [*told["contacts"], other, {"pair": ("other", "floor"), "friction": 0.2}]
    with pytest.raises(Unsupported, match="friction per body and takes the root of the product"):
        run(type(resting()).model_validate(told))


def test_contact_forces_are_lacking_with_a_reason_and_nothing_else_is():
    found = run(catalogue.load("robot_planar").resolve({}))
    assert "has no contact forces" in found.lacks["tyre.normal_force_N"]
    way = found.signals["chassis.position_m"][:, 0]
    acceleration = 2 * (way[-1] - way[0]) / found.time_s[-1] ** 2
    assert acceleration == pytest.approx(1.9536, rel=0.003)


def test_a_bounce_is_that_of_the_scenario():
    found = run(catalogue.load("ball").resolve({})).signals
    height = found["ball.position_m"][:, 2] - 0.02
    apexes = [height[a:b].max() for a, b in ((452, 1174), (1174, 1752), (1752, 2214))]
    ratios = [math.sqrt(b / a) for a, b in zip([1.0, *apexes], apexes, strict=False)]
    np.testing.assert_allclose(ratios, 0.8, rtol=0.003)


# --- state ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["robot_planar", "imu_rest", "pendulum_double"])
@pytest.mark.parametrize("contact", ["coefficients", "tuned", "assisted"])
def test_a_token_brings_back_joints_and_contacts_bit_for_bit(name, contact):
    simulation = opened(catalogue.load(name).resolve({}), contact)
    for _ in range(60):
        simulation.step()
    token, ends = simulation.save(), []
    for _ in range(2):
        for _ in range(60):
            simulation.step()
        ends.append(simulation.state)
        simulation.restore(token)
    simulation.close()
    assert ends[0] == ends[1]


def test_worlds_are_given_back_and_too_many_are_refused():
    told = spinning()
    for _ in range(200):
        opened(told).close()
    held = []
    with pytest.raises(Unsupported, match="128 worlds at most: close some"):
        held.extend(opened(told) for _ in range(129))
    for simulation in held:
        simulation.close()
    opened(told).close()
