"""ODE on scenes with known answers, and what its library needs of us."""

import hashlib
import math
import subprocess
import sys

import numpy as np
import pytest

from simcompare.engine import engines, library
from simcompare.errors import (
    EngineBroken,
    EngineMissing,
    ReadBackMismatch,
    SimulationDiverged,
    Unsupported,
)
from simcompare.model.audit import Audit
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED, Settings
from simcompare.scenarios import catalogue

G = 9.80665
FLOOR = {"fixed": True, "shapes": [{"type": "plane"}]}
WALL = {"fixed": True, "position_m": [0, 0, 1]}
pytestmark = pytest.mark.engines("ode")


def scene(bodies, joints=None, duration_s=0.5, step_s=0.001, substeps=1, gravity=G, **more):
    world = {"duration_s": duration_s, "step_s": step_s, "substeps": substeps}
    world["gravity_m_s2"] = [0, 0, -gravity]
    told = {"name": "small", "title": "Small", "question": "What now?", "world": world}
    return Scenario.model_validate({**told, "bodies": bodies, "joints": joints or {}, **more})


def simulate(scenario, contact=TUNED):
    return engines.get("ode").simulate(scenario, Settings(contact))


def begin(scenario, contact=TUNED):
    return engines.get("ode").open(scenario, Settings(contact))


def body(mass_kg=1.0, inertia=0.01, at=(0, 0, 0), **more):
    return {"mass_kg": mass_kg, "inertia_kg_m2": [inertia] * 3, "position_m": at, **more}


def ball(height_m, **more):
    shapes = [{"type": "sphere", "radius_m": 0.05}]
    return body(0.1, 1e-4, (0, 0, 0.05 + height_m), shapes=shapes, **more)


def block(at=(0, 0, 0.025), **more):
    shapes = [{"type": "box", "size_m": [0.2, 0.2, 0.05]}]
    return {**body(1.0, 0.01, at, shapes=shapes), "inertia_kg_m2": [0.0035, 0.0035, 0.0067], **more}


# --- contacts -------------------------------------------------------------------------------------


def drop(restitution, contact=TUNED):
    """Heights of a ball that was dropped from 1 m."""
    contacts = [{"pair": ["ball", "floor"], "restitution": restitution}]
    made = scene({"floor": FLOOR, "ball": ball(1.0)}, contacts=contacts, duration_s=1.2)
    return simulate(made, contact).signals["ball.position_m"][:, 2] - 0.05


@pytest.mark.parametrize("restitution", [0.5, 0.8])
def test_a_ball_bounces_as_its_restitution_says(restitution):
    height = drop(restitution)
    impact = np.flatnonzero(height <= 0)[0]
    assert math.sqrt(height[impact:].max()) == pytest.approx(restitution, rel=3e-3)


def test_what_must_not_bounce_stays_down_when_it_is_pushed_out_of_the_floor():
    height = drop(0.0)
    impact = np.flatnonzero(height <= 0)[0]
    assert height[impact:].max() < 1e-5
    assert abs(height[-1]) < 1e-6
    assert drop(0.0, COEFFICIENTS)[impact:].max() > 0.02  # ODE as it comes throws it up


def slide(heading, contact=TUNED, friction=0.4):
    """Where a block stops that slides away with 1 m/s."""
    velocity = [math.cos(heading), math.sin(heading), 0]
    contacts = [{"pair": ["block", "floor"], "friction": friction}]
    bodies = {"floor": FLOOR, "block": block(velocity_m_s=velocity)}
    return simulate(scene(bodies, contacts=contacts), contact).signals["block.position_m"][-1]


@pytest.mark.parametrize("degrees", [0, 20, 45])
def test_friction_stops_a_block_alike_in_all_directions(degrees):
    heading = math.radians(degrees)
    x, y, _ = slide(heading)
    assert math.hypot(x, y) == pytest.approx(1 / (2 * 0.4 * G), rel=5e-3)
    assert math.atan2(y, x) == pytest.approx(heading, abs=1e-3)


def test_by_default_nothing_slips_and_the_audit_says_that_friction_is_endless():
    assert np.hypot(*slide(0.0, DEFAULT)[:2]) < 1e-5
    bodies = {"floor": FLOOR, "block": block()}
    (row,) = [r for r in begin(scene(bodies), DEFAULT).audit if r.quantity.endswith("friction")]
    assert (row.set_value, row.read_value, row.note) == (None, None, "engine's default: inf")


@pytest.mark.parametrize("name", ["mode", "soft_erp", "soft_cfm", "slip1", "slip2"])
def test_another_surface_than_was_given_is_noticed(name):
    simulation = begin(catalogue.load("ball").resolve({}))
    surface = simulation._touches[0][1].points[0].surface
    setattr(surface, name, getattr(surface, name) * 2)
    audit = Audit("ode")
    simulation.own_parameters(audit)
    with pytest.raises(ReadBackMismatch, match=rf"surface\.{name}"):
        audit.finish()
    simulation.close()


def test_moving_bodies_touch_where_they_are_named_only():
    bodies = {"left": ball(1), "right": ball(1)}
    bodies["left"] |= {"position_m": [-0.2, 0, 0], "velocity_m_s": [1, 0, 0]}
    bodies["right"]["position_m"] = [0, 0, 0]
    through = simulate(scene(bodies, gravity=0)).signals["left.position_m"][-1, 0]
    assert through == pytest.approx(0.3, abs=1e-9)
    contacts = [{"pair": ["left", "right"], "restitution": 1.0}]
    stopped = simulate(scene(bodies, gravity=0, contacts=contacts)).signals
    assert stopped["left.velocity_m_s"][-1, 0] == pytest.approx(0, abs=1e-3)
    assert stopped["right.velocity_m_s"][-1, 0] == pytest.approx(1, rel=1e-3)


def test_a_step_that_ode_does_not_solve_is_told_and_not_printed(capfd):
    bodies, contacts = {"floor": FLOOR}, []
    for i in range(10):
        bodies[f"box{i}"] = block((0, 0, 0.025 + 0.05 * i))
        below = f"box{i - 1}" if i else "floor"
        contacts.append({"pair": [f"box{i}", below], "friction": 0.5})
    found = simulate(scene(bodies, contacts=contacts, duration_s=0.3), COEFFICIENTS)
    assert any("LCP internal error" in note for note in found.notes)
    assert capfd.readouterr().err == ""


# --- joints ---------------------------------------------------------------------------------------


def spinning(rate, **more):
    joint = {"type": "hinge", "parent": "wall", "child": "rotor", "axis": [1, 2, 2], "rate": rate}
    return scene({"wall": WALL, "rotor": body(at=[0, 0, 1])}, {"hinge": joint}, gravity=0, **more)


def test_a_hinge_counts_its_turns_from_zero_as_drawn():
    angle = simulate(spinning(-40.0)).signals["hinge.angle_rad"]
    assert angle[0] == pytest.approx(0, abs=1e-12)
    assert angle[-1] == pytest.approx(-20.0, rel=1e-6)  # more than three turns back


def test_turns_are_counted_where_several_pass_in_one_recorded_step():
    angle = simulate(spinning(800.0, substeps=20, step_s=0.02)).signals["hinge.angle_rad"]
    assert angle[1] == pytest.approx(16.0, rel=1e-6)
    assert angle[-1] == pytest.approx(400.0, rel=1e-6)


def test_states_and_tokens_know_the_turns():
    simulation = begin(spinning(40.0))
    for _ in range(200):
        simulation.step()
    state, token = simulation.state, simulation.save()
    for _ in range(200):
        simulation.step()
    for back in (lambda: simulation.set_state(state), lambda: simulation.restore(token)):
        back()
        assert simulation.state.joints["hinge"][0] == pytest.approx(8.0, rel=1e-6)
        simulation.step()
        assert simulation.state.joints["hinge"][0] == pytest.approx(8.04, rel=1e-6)
    simulation.close()


def test_a_weight_on_a_weld_is_borne_upwards_in_the_frame_of_the_child():
    weld = {"type": "fixed", "parent": "wall", "child": "load"}
    sensors = {"gauge": {"type": "force", "joint": "weld"}}
    turned = body(2.0, at=[0.1, 0, 0.9], orientation_wxyz=[math.sqrt(0.5), 0, math.sqrt(0.5), 0])
    found = simulate(scene({"wall": WALL, "load": turned}, {"weld": weld}, sensors=sensors))
    # the child's x axis points down
    np.testing.assert_allclose(
        found.signals["gauge.force_N"][5:], [[-2 * G, 0, 0]] * 496, atol=1e-4
    )


def test_a_pushed_slider_feels_its_effort_less_friction_and_the_floor_its_weight():
    rail = {"type": "slider", "parent": "wall", "child": "cart", "axis": [1, 0, 0], "friction": 0.5}
    found = simulate(
        scene(
            {"wall": WALL, "cart": body(2.0, at=[0, 0, 1])},
            {"rail": rail},
            inputs={"push": {"signal": "constant", "value": 3.0}},
            actuators={"motor": {"type": "force", "joint": "rail", "input": "push"}},
            sensors={"gauge": {"type": "force", "joint": "rail"}},
        )
    )
    assert found.signals["rail.position_m"][-1] == pytest.approx(2.5 / 2 * 0.5**2 / 2, rel=3e-3)
    np.testing.assert_allclose(found.signals["gauge.force_N"][5], (2.5, 0, 2 * G), rtol=1e-4)


def test_contact_forces_are_those_of_the_pair():
    contacts = [{"pair": ["ball", "floor"]}]
    sensors = {"scale": {"type": "contact_force", "pair": ["floor", "ball"]}}
    made = scene({"floor": FLOOR, "ball": ball(0.0)}, contacts=contacts, sensors=sensors)
    load = simulate(made).signals["scale.normal_force_N"]
    np.testing.assert_allclose(load[5:], 0.1 * G, rtol=1e-4)


# --- worlds ---------------------------------------------------------------------------------------


def walk(simulation, steps):
    for _ in range(steps):
        simulation.step()
    return simulation.row()


def test_worlds_that_are_open_together_do_not_disturb_one_another():
    robot, cylinder = (catalogue.load(n).resolve() for n in ("robot", "robot_cylinder"))
    alone = []
    for made in (robot, cylinder):
        simulation = begin(made)
        alone.append(walk(simulation, 60))
        simulation.close()
    one, two, three = begin(robot), begin(cylinder), begin(robot, DEFAULT)
    for _ in range(6):
        walk(three, 10)
        walk(one, 10)
        walk(two, 10)
    three.close()
    three.close()  # once more does no harm
    assert [one.row(), two.row()] == alone
    one.close()
    two.close()


@pytest.mark.parametrize("name", ["cube_toss", "robot_cylinder", "pendulum_double"])
def test_a_token_brings_everything_back_bit_for_bit(name):
    level = ASSISTED if name == "cube_toss" else TUNED
    simulation = begin(catalogue.load(name).resolve(), level)
    walk(simulation, 150)
    token = simulation.save()
    ends = []
    for _ in range(2):
        ends.append(walk(simulation, 150))
        simulation.restore(token)
    simulation.close()
    assert ends[0] == ends[1]


CODE = """
import hashlib
from simcompare.engine import engines
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue
found = engines.get("ode").simulate(catalogue.load("robot_turn").resolve(), Settings("tuned"))
print(hashlib.sha256(found.signals["chassis.position_m"].tobytes()).hexdigest())
"""


def test_runs_are_alike_in_every_process():
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    found = simulate(catalogue.load("robot_turn").resolve()).signals["chassis.position_m"]
    assert done.stdout.strip() == hashlib.sha256(found.tobytes()).hexdigest()


def test_what_runs_away_is_stopped_before_ode_ends_the_process():
    joint = {"type": "hinge", "parent": "wall", "child": "rotor", "axis": [0, 1, 0], "rate": 1.0}
    bodies = {"wall": WALL, "rotor": body(inertia=1e-5, at=[0, 0, 1])}
    with pytest.raises(SimulationDiverged, match="what acts on hinge went beyond"):
        simulate(scene(bodies, {"hinge": {**joint, "damping": 10.0}}))
    dragged = body(velocity_m_s=[1e7, 0, 0])
    dragged["drag"] = {"coefficient": 1, "area_m2": 1, "air_density_kg_m3": 1}
    with pytest.raises(SimulationDiverged, match="what acts on stone went beyond"):
        simulate(scene({"stone": dragged}))
    with pytest.raises(SimulationDiverged, match=r"stone\.rate_rad_s went beyond"):
        begin(scene({"stone": body(rate_rad_s=[1e200, 0, 0])}))


def test_a_centre_of_mass_beside_the_origin_is_refused():
    with pytest.raises(Unsupported, match="centre of mass of stone is not at its origin"):
        begin(scene({"stone": body(center_of_mass_m=[0.1, 0, 0])}))


# --- the library ----------------------------------------------------------------------------------


def test_without_the_library_one_sentence_says_how_to_get_it(monkeypatch):
    monkeypatch.setattr(library, "_opens", lambda file: False)
    for ask in (engines.get("ode").version, engines.get("ode").load):
        with pytest.raises(EngineMissing, match=r"ode is not installed .*install libode8$"):
            ask()


def test_a_build_in_single_precision_is_refused(monkeypatch):
    class Single:
        def dCheckConfiguration(self, token):  # noqa: N802
            return 0

    monkeypatch.setattr(library, "_opened", lambda file, declarations: (None, Single()))
    with pytest.raises(EngineBroken, match="single precision"):
        engines.get("ode").load()
