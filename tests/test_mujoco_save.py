"""MuJoCo goes back to what was saved and on from there bit for bit, its solver's memory too."""

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.model.scenario import Scenario
from simcompare.model.settings import CONTACT_LEVELS, TUNED, Settings
from tests.saving import EDGE, bounces_as_before_the_impact, box, recorded, stepped

pytest.importorskip("mujoco")

MUJOCO = engines.get("mujoco")


def tower(air_density_kg_m3=0.0):
    """Three boxes on one another, of which the lowest slides, and beside them a driven wheel."""
    drag = {"coefficient": 1, "area_m2": EDGE**2, "air_density_kg_m3": air_density_kg_m3}
    wheel = {"mass_kg": 0.1, "inertia_kg_m2": [1e-4, 1e-4, 1e-4], "position_m": [0, 1, 1]}
    axle = {
        "type": "hinge", "parent": "wall", "child": "wheel", "axis": [0, 1, 0],
        "anchor_m": [0, 1, 1], "damping": 1e-3, "friction": 1e-3, "stiffness": 0.1,
    }  # fmt: skip
    tree = {
        "name": "tower", "title": "Tower", "question": "Where does it fall?",
        "world": {"duration_s": 0.2, "step_s": 0.001},
        "bodies": {
            "floor": {"fixed": True, "shapes": [{"type": "plane"}]}, "wall": {"fixed": True},
            "low": box(0, velocity_m_s=[0.8, 0.1, 0], rate_rad_s=[0, 0, 2], drag=drag),
            "mid": box(1), "top": box(2), "wheel": wheel,
        },
        "joints": {"axle": axle},
        "inputs": {"u": {"signal": "ramp", "end": 0.05, "end_s": 0.2}},
        "actuators": {"motor": {"type": "torque", "joint": "axle", "input": "u"}},
        "contacts": [
            {"pair": ["low", "floor"], "friction": 0.4}, {"pair": ["mid", "low"], "friction": 0.3},
            {"pair": ["top", "mid"], "friction": 0.3},
        ],
        "sensors": {"scale": {"type": "contact_force", "pair": ["low", "floor"]},
                    "bearing": {"type": "force", "joint": "axle"}},
    }  # fmt: skip
    return Scenario.model_validate(tree)


@pytest.mark.parametrize("level", CONTACT_LEVELS)
@pytest.mark.parametrize("air_density_kg_m3", [0.0, 1.2])
@pytest.mark.parametrize("go_on", [stepped, recorded])
def test_boxes_that_slide_on_one_another_go_on_as_before(level, air_density_kg_m3, go_on):
    simulation = MUJOCO.open(tower(air_density_kg_m3), Settings(level))
    stepped(simulation, 30)
    saved = simulation.save()
    first = go_on(simulation, 40)
    assert (np.ptp(first, axis=0) > 1e-3).sum() > 10, "much moves, and forces change"
    for wandered in (1, 25):
        recorded(simulation, wandered)
        simulation.restore(saved)
        assert simulation.time_s == pytest.approx(0.03)
        assert np.array_equal(go_on(simulation, 40), first)
    simulation.close()


def test_a_token_is_good_for_a_simulation_that_was_put_elsewhere():
    simulation = MUJOCO.open(tower(), Settings(TUNED))
    start = simulation.state
    stepped(simulation, 30)
    saved = simulation.save()
    first = stepped(simulation, 10)
    simulation.set_state(start)
    stepped(simulation, 5)
    simulation.restore(saved)
    assert np.array_equal(stepped(simulation, 10), first)
    simulation.close()


def test_a_plain_state_forgets_what_the_solver_remembers():
    """Two ways to the same state go on alike, bit for bit."""
    simulation = MUJOCO.open(tower(), Settings(TUNED))
    stepped(simulation, 30)
    state = simulation.state
    simulation.set_state(state)
    first = stepped(simulation, 10)
    simulation.set_state(state)
    assert np.array_equal(stepped(simulation, 10), first)
    simulation.close()


def test_a_ball_that_is_saved_within_an_impact_bounces_as_before():
    bounces_as_before_the_impact(MUJOCO)
