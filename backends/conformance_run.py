"""One scenario on one backend at one level, of which the interface checks share the whole run."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass

from simcompare.engine.backend import Backend
from simcompare.engine.scene import Traits
from simcompare.engine.simulation import Simulation, sample_times
from simcompare.engine.state import State
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.model.shapes import Vector
from simcompare.model.trajectory import Array, Trajectory

#: most steps that are taken by hand
MAX_STEPS = 600
#: steps after which a joint that gives way has given way
FEW_STEPS = 20


@dataclass(frozen=True)
class Walk:
    """The first half of a scenario, stepped by hand; then back to its middle, twice.

    Attributes:
        states: the state after so many steps.
        origins: where the engine itself has every body after ``FEW_STEPS`` steps [m].
        returns: after going back to the middle and stepping on as far as before.
        kept: some steps after a token was taken in the middle, and after it was taken back.
    """

    states: Mapping[int, State]
    origins: Mapping[str, Vector]
    returns: tuple[State, State]
    kept: tuple[State, State]


@dataclass(frozen=True)
class Run:
    """What the checks look at; whatever they share is simulated when it is first asked for.

    Attributes:
        backend: who simulates.
        scenario: what is simulated.
        settings: how.
    """

    backend: Backend
    scenario: Scenario
    settings: Settings

    @property
    def precision(self) -> float:
        """Relative rounding of the engine's numbers."""
        traits = getattr(self.backend, "traits", None)
        return traits.precision if isinstance(traits, Traits) else 1e-12

    @functools.cached_property
    def trajectory(self) -> Trajectory:
        """The whole run."""
        return self.backend.simulate(self.scenario, self.settings)

    def signal(self, name: str) -> Array:
        """A signal of the whole run; a sentence where it is not recorded."""
        assert name in self.trajectory.signals, f"{name} is not recorded"
        return self.trajectory.signals[name]

    @functools.cached_property
    def walk(self) -> Walk:
        """A part of the run, step by step."""
        simulation = self.backend.open(self.scenario, self.settings)
        try:
            return _walk(simulation, self.half)
        finally:
            simulation.close()

    @functools.cached_property
    def half(self) -> int:
        """Recorded steps of half the scenario, an even number, at most ``MAX_STEPS``."""
        return max(min((len(sample_times(self.scenario)) - 1) // 2, MAX_STEPS) // 2 * 2, 2)


def _walk(simulation: Simulation, steps: int) -> Walk:
    few = min(FEW_STEPS, steps)
    states, origins = {0: simulation.state}, {}
    for k in range(1, steps + 1):
        before_s = simulation.time_s
        simulation.step()
        assert simulation.time_s > before_s, "the clock stands still"
        if k in (1, few, steps // 2, steps):
            states[k] = simulation.state
        if k == few:
            origins = {body: simulation.origin_of(body) for body in states[k].bodies}
    returns = []
    for _ in range(2):
        simulation.set_state(states[steps // 2])
        for _ in range(steps - steps // 2):
            simulation.step()
        returns.append(simulation.state)
    simulation.set_state(states[steps // 2])
    token, kept = simulation.save(), []
    for _ in range(2):
        for _ in range(few):
            simulation.step()
        kept.append(simulation.state)
        simulation.restore(token)
    return Walk(states, origins, (returns[0], returns[1]), (kept[0], kept[1]))


def shorter(run: Run) -> Scenario:
    """The same scene for the steps of ``run.half``."""
    return with_world(run.scenario, duration_s=run.half * run.scenario.world.step_s)


def further_signals(scenario: Scenario) -> dict[str, int]:
    """What is recorded besides bodies, with the number of components."""
    signals = scenario.signals().items()
    return {name: n for name, n in signals if name.partition(".")[0] not in scenario.bodies}


def thrown(scenario: Scenario) -> Scenario:
    """The free bodies 100 m up, thrown within the x-z plane, for a fifth of a second, undragged.

    Recorded steps are divided once more than they are, so that all engine steps must be taken.
    """
    bodies = {}
    free = scenario.free_bodies()
    for name, body in scenario.bodies.items():
        if body.fixed:
            bodies[name] = body
        if name not in free:
            continue
        x, y, z = body.position_m
        moved = {"position_m": (x, y, z + 100), "velocity_m_s": (1.5, 0.0, 2.0), "drag": None}
        bodies[name] = body.model_copy(update=moved)
    contacts = tuple(
        contact.model_copy(update={"restitution": 0.0})  # nothing is to bounce up there
        for contact in scenario.contacts
        if all(name in bodies for name in contact.pair)
    )
    bare: dict[str, object] = {"joints": {}, "actuators": {}, "sensors": {}, "contacts": contacts}
    lifted = scenario.model_copy(update={"bodies": bodies, **bare})
    return with_world(lifted, duration_s=0.2, substeps=scenario.world.substeps + 1)


def with_world(scenario: Scenario, **changes: float) -> Scenario:
    """The scenario with other numbers of its world."""
    world = scenario.world.model_copy(update=changes)
    return scenario.model_copy(update={"world": world})
