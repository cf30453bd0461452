"""Every check of the interface can fail: for each there is an adapter with that one fault."""

import dataclasses

import numpy as np
import pytest

from simcompare.backends import conformance
from simcompare.engine import engines
from simcompare.engine.features import Feature
from simcompare.engine.simulation import Simulation
from simcompare.model.settings import TUNED, Settings
from simcompare.scenarios import catalogue
from tests.lies import Liar

pytestmark = pytest.mark.engines("pymunk")

#: a hinge with an input, and a free body
SCENES = ("pendulum_torque", "ball")


class Fault(Liar):
    """A backend that changes what it tells of a run, or the simulation that it opens.

    Args:
        run: trajectory -> the trajectory that is told.
        opened: hooks of the simulation, each a function (simulation, …).
    """

    def __init__(self, run=lambda trajectory: trajectory, **opened):
        super().__init__(engines.get("pymunk"))
        self._run, self._opened = run, opened

    def simulate(self, scenario, settings):
        return self._run(super().simulate(scenario, settings))

    def open(self, scenario, settings):
        simulation = super().open(scenario, settings)
        kind = type(simulation)
        simulation.__class__ = type("Faulty", (kind,), self._opened)
        return simulation


def changed(part, change):
    """Changes all signals of a name in a run."""

    def run(trajectory):
        signals = {
            name: change(values.copy()) if name.endswith(part) else values
            for name, values in trajectory.signals.items()
        }
        return dataclasses.replace(trajectory, signals=signals)

    return run


def without(part):
    def run(trajectory):
        kept = {n: v for n, v in trajectory.signals.items() if not n.endswith(part)}
        return dataclasses.replace(trajectory, signals=kept)

    return run


def audited(keep):
    return lambda run: dataclasses.replace(run, audit=tuple(filter(keep, run.audit)))


def late(trajectory):
    return dataclasses.replace(trajectory, time_s=trajectory.time_s + 0.001)


def misread(trajectory):
    rows = [dataclasses.replace(r, set_value=1.0, read_value=2.0) for r in trajectory.audit]
    return dataclasses.replace(trajectory, audit=tuple(rows))


def noisy():
    """Every run is a little different from the one before."""
    count = iter(range(1000))
    return lambda run: changed("velocity_m_s", lambda v: v + 1e-12 * next(count))(run)


def beyond_the_first(values):
    values[1:] += 1e-3
    return values


def shifted(simulation, body):
    return tuple(np.array(simulation.stored_motion(body)[0]) + 1e-3)


def deaf(simulation, inputs=None):
    """Takes every input, and nonsense too."""
    Simulation.step(simulation, None)


def unmoved(simulation, state):
    """Stays where it is when it is sent back."""


def off_zero(simulation):
    """Says that every joint begins a little away from where it is."""
    state = Simulation.state.fget(simulation)
    joints = {name: (position + 1e-3, rate) for name, (position, rate) in state.joints.items()}
    return dataclasses.replace(state, joints=joints)


def understated():
    fault = Fault()
    fault.features = fault.features - {Feature.HINGE, Feature.PLANE}
    return fault


FAULTS = {
    "names_and_shapes": Fault(without("rate_rad_s")),
    "clock": Fault(late),
    "starts_as_told": Fault(changed("position_m", lambda v: v + 1e-3)),
    "joints_start_as_told": Fault(state=property(off_zero)),
    "finite_and_rigid": Fault(changed("orientation_wxyz", lambda v: 1.01 * v)),
    "repeats_bit_for_bit": Fault(noisy()),
    "stepping_is_simulating": Fault(changed("position_m", beyond_the_first)),
    "state_can_be_restored": Fault(set_state=unmoved),
    "saving_is_exact": Fault(take_back=unmoved),
    "values_are_read_back": Fault(misread),
    "features_are_true": understated(),
    "bodies_hang_on_their_joints": Fault(origin_of=shifted),
    "inputs_drive_joints": Fault(step=deaf),
    "flies_freely": Fault(changed("position_m", lambda v: v * np.array([1.0, 1.0, 0.99]))),
}


def failed(backend):
    found = []
    for name in SCENES:
        found += conformance.faults(backend, catalogue.load(name).resolve(), Settings(TUNED))
    return found


@pytest.mark.parametrize("check", conformance.CHECKS, ids=lambda check: check.__name__)
def test_every_check_can_fail_and_is_named(check):
    names = [fault.partition(":")[0] for fault in failed(FAULTS[check.__name__])]
    assert check.__name__ in names


@pytest.mark.parametrize(
    "lost", ["mass_kg", "inertia_kg_m2", "radius_m", "gravity", "restitution", "friction", "hinge."]
)
def test_what_is_not_on_record_is_missed(lost):
    found = failed(Fault(audited(lambda row: lost not in row.quantity)))
    assert any(fault.startswith("values_are_read_back") for fault in found), found


def test_a_backend_without_faults_passes_and_its_faults_are_all_named_at_once():
    scenario = catalogue.load("ball").resolve()
    conformance.check(Fault(), scenario, Settings(TUNED))
    with pytest.raises(AssertionError, match=r"(?s)pymunk, ball, tuned: .*clock: .*stepping_is"):
        conformance.check(Fault(late), scenario, Settings(TUNED))
