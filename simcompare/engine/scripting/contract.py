"""What an engine gives for a script: how it is built, stepped and read, as lines of source.

A backend that can be written as a script has a method ``script() -> EngineScript``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any, Protocol, runtime_checkable

from simcompare.engine.backend import EngineBackend
from simcompare.engine.drives import JointLaw
from simcompare.engine.scripting.merge import merged
from simcompare.engine.scripting.reading import Reading
from simcompare.engine.scripting.source import Style, Writer
from simcompare.engine.scripting.text import number
from simcompare.engine.scripting.trace import (
    Dialect,
    Event,
    Expression,
    Recorder,
    Result,
    expression_of,
)
from simcompare.errors import Unsupported
from simcompare.model.scenario import MOVABLE, Scenario
from simcompare.model.settings import Settings
from simcompare.model.tuning import TuningRow

#: names that the script uses itself
RESERVED = frozenset(
    # of the loop
    ("np", "sys", "phase", "step_s", "steps", "inputs", "k", "rows", "signals", "motion", "t",
     "seen", "felt", "half", "name", "body", "bodies", "link", "joint", "before", "momentum",
     "carried", "q", "v", "x", "z", "place", "turn", "velocity", "rate", "torque", "force", "axis",
     "drag", "update", "reaction", "motor", "part", "parts",
     # of what is measured
     "value", "exact", "run", "turned", "specific_force", "gyroscope", "gone", "angle_between",
     "rise", "low", "flights", "curve", "curves", "down", "ends", "pair", "roots", "span",
     "a", "b", "i", "start", "end", "speed", "e", "true", "impacts",
     "late", "moving", "rest_s", "apart", "told", "error", "still", "rest", "valid", "yaw", "w",
     "y", "f", "ratio", "omega", "s", "waves", "fits", "read", "moved", "felt", "u", "fade",
     "slope", "bend", "shaken", "size", "angle", "size_error", "turned_by", "below", "cutoff",
     "away", "up", "passes", "tops", "period", "small", "swings", "taus", "best", "edges",
     "areas", "amps", "volts", "fall", "idle", "growth", "idle_amps")
)  # fmt: skip


@dataclass(frozen=True)
class Effort:
    """What drives one joint.

    Attributes:
        joint: its name.
        law: what acts on it.
        given: source of the part that follows the inputs, in step ``k``; empty for none.
    """

    joint: str
    law: JointLaw
    given: str

    def text(self, position: str, rate: str) -> str:
        """Source of the whole effort, springs and dampers as efforts too."""
        text, law = self.given, self.law
        if law.stiffness:
            away = f"({position} - {number(law.rest)})" if law.rest else position
            text += f" - {number(law.stiffness)} * {away}"
        if law.damping:
            text += f" - {number(law.damping)} * {rate}"
        return text.removeprefix(" ").replace("- ", "-", 1) if not self.given else text


@dataclass(frozen=True)
class Plan:
    """What is to be written.

    Attributes:
        scenario: the scene at phase 0.
        shifted: the same at phase 1; ``None`` where nothing is dithered.
        settings: how it is run.
        efforts: of all driven joints.
        lacking: signals that the engine does not give.
        tuning: how the numbers for restitutions were found.
        by_hand: whether somebody typed them in.
    """

    scenario: Scenario
    shifted: Scenario | None
    settings: Settings
    efforts: Sequence[Effort]
    lacking: frozenset[str] = frozenset()
    tuning: Sequence[TuningRow] = ()
    by_hand: bool = False

    @property
    def sensed_joints(self) -> dict[str, str]:
        """Sensors of the force through a joint -> that joint; those that the engine gives."""
        found = self.scenario.sensed_joints().items()
        return {name: joint for name, joint in found if f"{name}.force_N" not in self.lacking}

    @property
    def sensed_pairs(self) -> dict[str, tuple[str, str]]:
        """Sensors of the normal force between two bodies -> these, likewise."""
        found = self.scenario.sensed_pairs().items()
        return {name: pair for name, pair in found if f"{name}.normal_force_N" not in self.lacking}

    @property
    def force_signals(self) -> list[str]:
        """What the engine's sensors read: normal forces, then forces through joints."""
        normals = [f"{name}.normal_force_N" for name in self.sensed_pairs]
        return [*normals, *(f"{name}.force_N" for name in self.sensed_joints)]

    @property
    def drags(self) -> dict[str, float]:
        """Bodies with air drag -> c in F = -c·|v|·v [kg/m]."""
        factors = {
            name: body.drag.factor_kg_m
            for name, body in self.scenario.moving_bodies().items()
            if body.drag is not None
        }
        return {name: factor for name, factor in factors.items() if factor > 0}


@dataclass(frozen=True)
class Parts:
    """The engine's share of a script, in lines.

    Attributes:
        imports: how it is imported.
        helpers: functions that the scene needs.
        scene: what builds the scene.
        reading: what reads one sample.
        forces: what reads the force sensors after a step.
        felt: what these read, in the order of :attr:`Plan.force_signals`.
        drive: what comes before each engine step ``k``.
        step: the engine step.
        lead: 0 where the forces of a step act at its start, 1 where at its end.
        before: what must be noted before a step for ``forces``.
    """

    imports: Sequence[str]
    scene: Sequence[str]
    reading: Reading
    step: str
    helpers: Sequence[str] = ()
    forces: Sequence[str] = ()
    felt: Sequence[str] = ()
    drive: Sequence[str] = ()
    lead: int = 0
    before: Sequence[str] = ()


@runtime_checkable
class EngineScript(Protocol):
    """Writes the engine's share of scripts."""

    def parts(self, backend: Any, plan: Plan) -> Parts:  # noqa: ANN401
        """What builds, steps and reads one scene; ``backend`` is the one that was asked."""


@dataclass
class Traced:
    """A scene that was built while it was watched, at one phase or at both.

    Attributes:
        simulation: what was built at phase 0.
        events: what happened.
    """

    simulation: Any
    events: Sequence[Event]
    _first: Sequence[Event] = field(default_factory=list)
    _names: dict[tuple[int, int | None], str] = field(default_factory=dict)

    def ref(self, value: Any) -> Expression:  # noqa: ANN401
        """The expression of something that was watched."""
        found = expression_of(value)
        if isinstance(found, Result):
            return Result(self.events[self._place(found)], found.index)  # type: ignore[arg-type]
        return found

    def name(self, value: Any, name: str) -> None:  # noqa: ANN401
        """Wants a name for something that was watched."""
        found = expression_of(value)
        if isinstance(found, Result):
            self._names.setdefault((self._place(found), found.index), name)

    def name_beside(self, value: Any, index: int, name: str) -> None:  # noqa: ANN401
        """Wants a name for another member of the call that returned something."""
        found = expression_of(value)
        if isinstance(found, Result):
            self._names.setdefault((self._place(found), index), name)

    def name_call(self, call: Event, name: str) -> None:
        """Wants a name for what a call returned."""
        place = next(i for i, event in enumerate(self.events) if event is call)
        self._names.setdefault((place, None), name)

    def _place(self, found: Result) -> int:
        return next(i for i, event in enumerate(self._first) if event is found.call)

    def writer(self, style: Style, wanted: Sequence[Any], taken: set[str]) -> Writer:
        """What writes the scene; ``wanted`` is what the rest of the script uses."""
        refs = [self.ref(value) for value in wanted]
        return Writer(self.events, style, self._names, taken | RESERVED, refs)


def traced(backend: EngineBackend, engine: ModuleType, dialect: Dialect, plan: Plan) -> Traced:
    """Builds the scene of a plan through its backend and watches."""
    first, simulation = _watched(backend, engine, dialect, plan.scenario, plan.settings)
    if plan.shifted is None:
        return Traced(simulation, merged(first, first), first)
    last, _ = _watched(backend, engine, dialect, plan.shifted, plan.settings)
    return Traced(simulation, merged(first, last), first)


def _watched(
    backend: EngineBackend,
    engine: ModuleType,
    dialect: Dialect,
    scenario: Scenario,
    settings: Settings,
) -> tuple[Sequence[Event], Any]:
    recorder = Recorder(dialect)
    simulation = backend.build(recorder.engine(engine), scenario, settings)
    events = list(recorder.events)
    simulation.close()
    return events, simulation


def script_of(backend: object) -> EngineScript:
    """What writes scripts of an engine.

    Raises:
        Unsupported: its backend has nothing for that.
    """
    method = getattr(backend, "script", None)
    script: EngineScript | None = None if method is None else method()
    if script is None:
        name = getattr(backend, "name", "this engine")
        error = Unsupported(
            f"the backend of {name} cannot be written as a script: it has no method script()"
            " (simcompare/engine/scripting/contract.py says what that returns)"
        )
        error.exit_code = 2
        raise error
    return script


def joint_parts(plan: Plan) -> Mapping[str, tuple[str, str]]:
    """Names of coordinate and rate of every movable joint, as signals."""
    return {
        name: (f"{name}.{MOVABLE[joint.type][0]}", f"{name}.{MOVABLE[joint.type][1]}")
        for name, joint in plan.scenario.movable_joints().items()
    }
