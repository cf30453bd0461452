"""What single precision makes of numbers is no fault where it is stated, and more than that is."""

import dataclasses

import numpy as np
import pytest

from simcompare.engine.state import BodyState, State, compare_start
from simcompare.errors import ReadBackMismatch
from simcompare.model.audit import Audit
from simcompare.model.scenario import Scenario
from simcompare.model.settings import TUNED, Settings
from tests.toy_engine import ToyBackend, ToySimulation

SINGLE = 1e-6


def swinging(x=0.3):
    body = {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1]}
    return Scenario.model_validate(
        {
            "name": "toy", "title": "Toy", "question": "?",
            "world": {"duration_s": 0.1, "step_s": 0.001},
            "bodies": {"base": {**body, "position_m": [x, 0, 0.1]}, "arm": body},
            "joints": {"hinge": {"type": "hinge", "parent": "base", "child": "arm", "rate": 0.7}},
        }
    )  # fmt: skip


def held(scenario, angle=0.0, shift=0.0):
    """What an engine in single precision holds of the start, a little wrong if asked for."""

    def single(values):
        return tuple(float(np.float32(value)) for value in values)

    states = {}
    for name, body in scenario.bodies.items():
        x, y, z = single(body.position_m)
        states[name] = BodyState(
            (x + shift, y, z), single(body.orientation_wxyz), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        )
    return State(0.0, states, joints={"hinge": (angle, float(np.float32(0.7)))})


def compare(scenario, state, precision):
    origins = {"arm": state.bodies["arm"].position_m}
    compare_start("toy", scenario, state, origins, precision)


def test_rounding_of_a_start_is_no_fault_in_single_precision():
    scenario = swinging()
    # an angle from the cosine and sine of two bodies, each rounded
    compare(scenario, held(scenario, angle=4.4e-8), SINGLE)
    with pytest.raises(
        ReadBackMismatch, match=r"hinge\.position\.z: set state = 0\.0 but it is 4\.4e"
    ):
        compare(scenario, held(scenario, angle=4.4e-8), 1e-12)


def test_far_from_the_origin_places_are_rounded_more():
    scenario = swinging(x=1000.3)
    compare(scenario, held(scenario), SINGLE)
    with pytest.raises(ReadBackMismatch, match=r"base\.position_m\.x"):
        compare(scenario, held(scenario, shift=0.1), SINGLE)


@pytest.mark.parametrize(("angle", "shift"), [(1e-5, 0.0), (0.0, 1e-5)])
def test_more_than_rounding_is_a_fault_in_single_precision_too(angle, shift):
    scenario = swinging()
    with pytest.raises(ReadBackMismatch):
        compare(scenario, held(scenario, angle, shift), SINGLE)


def test_an_audit_takes_the_rounding_that_is_stated():
    rounded = float(np.float32(0.36))
    for precision, fails in ((SINGLE, False), (1e-12, True)):
        audit = Audit("toy", relative=precision)
        audit.add("friction", 0.6, "mu", (0.36, rounded), "1")
        if fails:
            with pytest.raises(ReadBackMismatch, match="friction"):
                audit.finish()
        else:
            assert audit.finish()[0].read_value == rounded


class Held(ToySimulation):
    """Holds a place that single precision puts a little beside 0."""

    def held_of_body(self, body):
        table = super().held_of_body(body)
        place = [value - 3e-8 for value in table["position_m"].value]
        return {**table, "position_m": dataclasses.replace(table["position_m"], value=place)}


def test_a_place_at_zero_may_be_held_beside_it_by_rounding():
    from tests.test_kit import falling

    ToyBackend(Held, np.float32, precision=SINGLE).open(falling(), Settings(TUNED))
    with pytest.raises(ReadBackMismatch, match=r"position_m\.x: set place = 0\.0"):
        ToyBackend(Held).open(falling(), Settings(TUNED))


def test_a_state_is_taken_back_as_well_as_single_precision_holds_it():
    from tests.test_kit import falling

    simulation = ToyBackend(dtype=np.float32, precision=SINGLE).open(falling(), Settings(TUNED))
    for _ in range(20):
        simulation.step()
    middle, ends = simulation.state, []
    for _ in range(2):
        simulation.set_state(middle)
        assert simulation.state == middle
        for _ in range(20):
            simulation.step()
        ends.append(simulation.state)
    assert ends[0] == ends[1]
