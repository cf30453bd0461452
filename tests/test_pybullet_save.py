"""PyBullet goes back to what was saved and on from there bit for bit, points of contact too."""

import gc

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, CONTACT_LEVELS, TUNED, Settings
from simcompare.scenarios import catalogue
from tests.saving import EDGE, bounces_as_before_the_impact, box, recorded, stepped

pytestmark = pytest.mark.engines("pybullet")

PYBULLET = engines.get("pybullet")


def scene(bounce=0.0):
    """Two boxes on one another of which the lower one slides, and a driven arm on a free body."""
    arm = {
        "mass_kg": 0.1, "inertia_kg_m2": [1e-4, 1e-4, 1e-4], "position_m": [0.05, 1, 1],
    }  # fmt: skip
    axle = {
        "type": "hinge", "parent": "root", "child": "arm", "axis": [0, 1, 0], "damping": 1e-3,
        "friction": 1e-3, "stiffness": 0.1, "armature": 2e-5,
    }  # fmt: skip
    drag = {"coefficient": 1, "area_m2": EDGE**2, "air_density_kg_m3": 1.2}
    return Scenario.model_validate({
        "name": "stack", "title": "Stack", "question": "Where does it slide?",
        "world": {"duration_s": 0.2, "step_s": 0.001},
        "bodies": {
            "floor": {"fixed": True, "shapes": [{"type": "plane"}]},
            "low": box(0, velocity_m_s=[0.8, 0.1, 0], rate_rad_s=[0, 0, 2], drag=drag),
            "top": box(1),
            "root": {**arm, "position_m": [0, 1, 1], "rate_rad_s": [1, 2, -1]}, "arm": arm,
        },
        "joints": {"axle": axle},
        "inputs": {"u": {"signal": "ramp", "end": 0.05, "end_s": 0.2}},
        "actuators": {"motor": {"type": "torque", "joint": "axle", "input": "u"}},
        "contacts": [
            {"pair": ["low", "floor"], "friction": 0.4, "restitution": bounce},
            {"pair": ["top", "low"], "friction": 0.16}, {"pair": ["top", "floor"], "friction": 0.4},
        ],
        "sensors": {"scale": {"type": "contact_force", "pair": ["low", "floor"]},
                    "bearing": {"type": "force", "joint": "axle"}},
    })  # fmt: skip


@pytest.mark.parametrize(
    ("level", "bounce"), [*((level, 0.0) for level in CONTACT_LEVELS), (TUNED, 0.5)]
)
@pytest.mark.parametrize("go_on", [stepped, recorded])
def test_boxes_that_slide_on_one_another_go_on_as_before(level, bounce, go_on):
    simulation = PYBULLET.open(scene(bounce), Settings(level))
    stepped(simulation, 30)
    saved = simulation.save()
    first = go_on(simulation, 40)
    assert (np.ptp(first, axis=0) > 1e-3).sum() > 10, "much moves, and forces change"
    for wandered in (1, 25):
        simulation.restore(saved)
        recorded(simulation, wandered)
        simulation.restore(saved)
        assert simulation.time_s == pytest.approx(0.03)
        assert np.array_equal(go_on(simulation, 40), first)
    simulation.close()


@pytest.mark.parametrize("name", ["robot", "robot_cylinder", "robot_motor", "cube_toss"])
def test_scenes_with_contacts_go_on_as_before(name):
    simulation = PYBULLET.open(catalogue.load(name).resolve({}), Settings(ASSISTED))
    stepped(simulation, 60)
    saved = simulation.save()
    first = stepped(simulation, 60)
    simulation.restore(saved)
    assert np.array_equal(stepped(simulation, 60), first)
    simulation.close()


@pytest.mark.parametrize("name", ["robot", "motor_step", "pendulum_servo"])
def test_the_start_can_be_gone_back_to(name):
    """Before the first step there are no points of contact; those of later are forgotten."""
    simulation = PYBULLET.open(catalogue.load(name).resolve({}), Settings(TUNED))
    start = simulation.save()
    first = stepped(simulation, 60)
    for _ in range(2):
        simulation.restore(start)
        assert np.array_equal(stepped(simulation, 60), first)
    simulation.close()


def test_a_token_is_good_for_a_simulation_that_was_put_elsewhere():
    """Only its points of contact are lost: where they were forgotten, pairs have new numbers."""
    simulation = PYBULLET.open(scene(), Settings(TUNED))
    start = simulation.state
    stepped(simulation, 30)
    saved = simulation.save()
    first = recorded(simulation, 10)
    simulation.set_state(start)
    recorded(simulation, 5)
    simulation.restore(saved)
    again = recorded(simulation, 10)
    simulation.close()
    np.testing.assert_allclose(again, first, rtol=0, atol=1e-5)


@pytest.mark.parametrize("level", CONTACT_LEVELS)
def test_a_plain_state_forgets_points_of_contact(level):
    """Two ways to the same state go on alike."""
    simulation = PYBULLET.open(scene(), Settings(level))
    start = simulation.state
    recorded(simulation, 30)
    state = simulation.state
    simulation.set_state(state)
    first = recorded(simulation, 10)
    simulation.set_state(start)
    recorded(simulation, 5)
    simulation.set_state(state)
    again = recorded(simulation, 10)
    simulation.close()
    np.testing.assert_allclose(again, first, rtol=0, atol=1e-12)


def test_a_ball_that_is_saved_within_an_impact_bounces_as_before():
    bounces_as_before_the_impact(PYBULLET)


def test_what_nobody_holds_any_more_is_freed(monkeypatch):
    import pybullet

    freed, remove = [], pybullet.removeState
    monkeypatch.setattr(
        pybullet,
        "removeState",
        lambda number, *a, **k: (freed.append(number), remove(number, *a, **k)),
    )
    simulation = PYBULLET.open(scene(), Settings(TUNED))
    saved, kept = simulation.save(), simulation.save()
    del saved
    gc.collect()
    assert len(freed) == 1
    simulation.restore(kept)
    simulation.close()
    del kept
    gc.collect()
    assert len(freed) == 1, "the client is gone, and another may have its number"
