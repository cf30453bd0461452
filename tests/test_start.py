"""Motion from the start on: velocities are stored half a step off, and begin so."""

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings

ENGINES = engines.names()


def rounding(engine):
    """How far places of about a metre may be off by rounding alone, after many steps [m]."""
    return max(1e-9, 2 * engines.get(engine).traits.precision)


def pushed(**joint):
    """A mass of 2 kg on a slider, pushed with 3 N from rest or from 0.5 m/s, without weight."""
    tree = {
        "name": "pushed",
        "title": "Pushed",
        "question": "Where is it?",
        "world": {"duration_s": 0.5, "step_s": 0.01, "gravity_m_s2": [0, 0, 0]},
        "bodies": {
            "rail": {"fixed": True},
            "cart": {"mass_kg": 2.0, "inertia_kg_m2": [1, 1, 1]},
        },
        "joints": {
            "slide": {"type": "slider", "parent": "rail", "child": "cart", "axis": [1, 0, 0]}
            | joint
        },
        "inputs": {"force": {"signal": "constant", "value": 3.0}},
        "actuators": {"push": {"type": "force", "joint": "slide", "input": "force"}},
    }
    return Scenario.model_validate(tree)


@pytest.mark.parametrize("rate", [0.0, 0.5])
@pytest.mark.parametrize("engine", ENGINES)
def test_mapped_motion_is_on_the_parabola_and_does_not_run_ahead(engine, rate):
    found = engines.get(engine).simulate(pushed(rate=rate), Settings())
    t = found.time_s
    # half a step of the acceleration would be 7.5 mm/s, and 3.7 mm at the end
    moved, slack = rate * t + 0.75 * t**2, rounding(engine)
    np.testing.assert_allclose(found.signals["slide.position_m"], moved, rtol=1e-7, atol=slack)


@pytest.mark.parametrize("engine", ENGINES)
def test_damped_motion_from_the_start_is_of_second_order(engine):
    errors = []
    for step_s in (0.01, 0.005):
        scenario = pushed(damping=4.0)
        world = scenario.world.model_copy(update={"step_s": step_s})
        found = engines.get(engine).simulate(
            scenario.model_copy(update={"world": world}), Settings()
        )
        t = found.time_s
        # m·a = F - d·v: speed 3/4·(1 - exp(-2t))
        truth = 0.75 * (t - (1 - np.exp(-2 * t)) / 2)
        errors.append(np.abs(found.signals["slide.position_m"] - truth).max())
    assert errors[0] < 1e-4  # half a step of the first acceleration would be 3.7e-3
    assert 3.3 < errors[0] / errors[1] < 4.8


@pytest.mark.parametrize("engine", ENGINES)
def test_the_first_sample_is_the_start_as_it_is_told(engine):
    found = engines.get(engine).simulate(pushed(rate=0.5), Settings())
    assert found.signals["slide.velocity_m_s"][0] == pytest.approx(0.5)
    assert found.signals["slide.position_m"][0] == 0


@pytest.mark.parametrize("engine", ENGINES)
def test_going_back_to_the_start_begins_anew(engine):
    backend = engines.get(engine)
    simulation = backend.open(pushed(rate=0.5), Settings())
    try:
        start, ends = simulation.state, []
        for _ in range(2):
            simulation.set_state(start)
            for _ in range(10):
                simulation.step()
            ends.append(simulation.state.joints["slide"])
    finally:
        simulation.close()
    assert ends[0] == ends[1]
    assert ends[0][0] == pytest.approx(0.5 * 0.1 + 0.75 * 0.01, abs=rounding(engine))


@pytest.mark.parametrize("engine", ENGINES)
def test_drag_in_free_flight_is_of_second_order(engine):
    from scipy.integrate import solve_ivp

    ball = {
        "mass_kg": 0.0027, "inertia_kg_m2": [1e-6, 1e-6, 1e-6], "velocity_m_s": [5, 0, 3],
        "drag": {"coefficient": 0.5, "area_m2": 1.2566e-3, "air_density_kg_m3": 1.2},
    }  # fmt: skip
    errors = []
    for step_s in (0.004, 0.002):
        tree = {
            "name": "thrown", "title": "Thrown", "question": "How far?",
            "world": {"duration_s": 0.4, "step_s": step_s}, "bodies": {"ball": ball},
        }  # fmt: skip
        scenario = Scenario.model_validate(tree)
        found = engines.get(engine).simulate(scenario, Settings())
        factor = scenario.bodies["ball"].drag.factor_kg_m / 0.0027

        def fall(_, y, factor=factor):
            return [*y[2:], *(-factor * np.hypot(*y[2:]) * y[2:] + [0, -9.80665])]

        truth = solve_ivp(
            fall, (0, 0.4), [0, 0, 5, 3], t_eval=found.time_s[-1:], rtol=1e-11, atol=1e-12
        ).y[:2, 0]
        errors.append(np.abs(found.signals["ball.position_m"][-1, [0, 2]] - truth).max())
    assert 3.0 < errors[0] / errors[1] < 5.0 or errors[0] < 10 * rounding(engine)
    assert errors[1] < 5e-5
