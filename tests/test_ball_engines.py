"""The bar of the bouncing ball: what assisted engines must reach, and what defaults do."""

import numpy as np
import pytest

from simcompare.comparison.comparison import Repeat, scores_of
from simcompare.comparison.repeats import repeats_of
from simcompare.engine import engines
from simcompare.engine.simulation import sample_times
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.ball.reference import reference
from tests.present import need

ENGINES = engines.names()
FILE = catalogue.load("ball")


def scores(engine, contact="assisted", step_s=0.001, **parameters):
    from dataclasses import replace

    backend, repeats = engines.get(engine), []
    for scenario in repeats_of(FILE, parameters, None, step_s, None):
        times = sample_times(scenario)
        truth = Trajectory("closed form", times, reference(scenario.parameters, times))
        found = replace(backend.simulate(scenario, Settings(contact)), contact=contact)
        repeats.append(Repeat(scenario, found, truth))
    return {(s.measure, s.index): s for s in scores_of(repeats)}


#: restitution, height and step: each with each other; the longest drop not also in the most steps
DROPS = [
    (e, height, step_s)
    for e, height in ((0.5, 0.1), (0.5, 2.0), (0.8, 1.0), (0.95, 0.1), (0.95, 2.0))
    for step_s in (0.0005, 0.001)
    if (e, height, step_s) != (0.95, 2.0, 0.0005)
]


@pytest.mark.parametrize(("e", "height", "step_s"), DROPS)
@pytest.mark.parametrize("engine", ENGINES)
def test_mapped_engines_bounce_as_told(engine, e, height, step_s):
    found = scores(engine, step_s=step_s, restitution=e, drop_height_m=height)
    restitution, timing = found["restitution", None], found["impact_time_error", None]
    # the aim for engines with a coefficient, not the limit; the spring of the other keeps it too
    assert restitution.value == pytest.approx(e, rel=0.0005)
    assert timing.value < 0.003
    assert found["energy_gain", None].value <= 0.001
    assert restitution.repeats == 9


@pytest.mark.parametrize("engine", ENGINES)
def test_a_step_of_four_milliseconds_is_as_good(engine):
    found = scores(engine, step_s=0.004)
    assert found["restitution", None].value == pytest.approx(0.8, rel=0.001)
    assert found["impact_time_error", None].value < 0.004
    assert found["energy_gain", None].value <= 0.001


@pytest.mark.parametrize("engine", ENGINES)
def test_drag_acts_in_every_engine(engine):
    # 0.47 lowers the first rebound from 0.640 to 0.525 m; an engine without it would be 20 % high
    found = scores(engine, drag_coefficient=0.47)
    height = found["rebound_height", 1]
    assert height.truth == pytest.approx(0.5250, abs=1e-4)
    assert height.value == pytest.approx(height.truth, rel=0.002)
    assert found["impact_time_error", None].value < 0.003


@pytest.mark.parametrize("engine", ENGINES)
def test_with_its_defaults_the_ball_hardly_bounces(engine):
    found = scores(engine, contact="default")
    restitution = found["restitution", None].value  # none where it does not leave the floor
    assert restitution is None or restitution < 0.1
    assert {score.verdict for score in found.values()} == {"info"}


@pytest.mark.parametrize("engine", ENGINES)
def test_nothing_jumps_up_at_rest(engine):
    # changing the step while bodies touch has thrown a ball up at 3.8 m/s
    for step_s in (0.001, 0.004):
        scenario = FILE.resolve({"restitution": 0.5, "drop_height_m": 2.0}, step_s=step_s)
        world = scenario.world.model_copy(update={"duration_s": 3.0})
        scenario = scenario.model_copy(update={"world": world})
        found = engines.get(engine).simulate(scenario, Settings())
        height = found.signals["ball.position_m"][:, 2] - scenario.parameters["radius_m"]
        resting = height[found.time_s > 2.0]
        # hops of a few micrometres are left where an engine's bounce never quite ends
        assert np.abs(resting).max() < 1e-5


def test_failing_a_tolerance_is_told():
    from simcompare.model.scenario import Tolerance

    strict = {"restitution": Tolerance(relative=1e-12, reason="impossible on purpose")}
    scenario = FILE.resolve({}).model_copy(update={"tolerances": strict})
    times = sample_times(scenario)
    truth = Trajectory("closed form", times, reference(scenario.parameters, times))
    found = engines.get("pymunk").simulate(scenario, Settings())
    rows = {s.measure: s for s in scores_of([Repeat(scenario, found, truth)]) if s.index is None}
    assert rows["restitution"].verdict == "fail"
    assert rows["restitution"].u is None
    assert rows["settling_time"].verdict == "info"


def test_without_a_truth_events_are_measured_all_the_same():
    """Else a measurement held against such a scenario would find no event in any engine."""
    scenario = FILE.resolve({})
    found = engines.get("pymunk").simulate(scenario, Settings())
    rows = {(s.measure, s.index): s for s in scores_of([Repeat(scenario, found, None)])}
    first = rows["rebound_height", 1]
    assert first.value == pytest.approx(0.64, rel=1e-3)
    assert (first.truth, first.tolerance, first.verdict) == (None, None, "info")
    assert rows["resolved_bounces", None].value == 18


@pytest.mark.parametrize("contact", ["default", "assisted"])
@pytest.mark.parametrize("engine", ENGINES)
def test_drag_from_recorded_rows_is_that_of_the_motion_that_is_read(engine, contact):
    scenario = FILE.resolve({"drag_coefficient": 0.47})
    rows = []
    for record in (
        lambda simulation: simulation.record(50)[-1],
        lambda simulation: [(simulation.advance(1), simulation.row()) for _ in range(50)][-1][1],
    ):
        simulation = engines.get(engine).open(scenario, Settings(contact))
        rows.append([float(number) for number in record(simulation)])
        simulation.close()
    assert rows[0] == rows[1]


def test_where_drag_acts_alone_a_motion_is_read_once_a_step(monkeypatch):
    need("pymunk")
    scenario = FILE.resolve({"drag_coefficient": 0.47})
    simulation = engines.get("pymunk").open(scenario, Settings("default"))
    read, asked = simulation.get, []
    monkeypatch.setattr(simulation, "get", lambda body: asked.append(body) or read(body))
    simulation.record(50)
    assert len(asked) == 51
