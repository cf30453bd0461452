"""What the closed form and engines give for the experiments of a table."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from simcompare import measures, units
from simcompare.comparison.repeats import truths_of
from simcompare.engine.calibration.plan import drop_plans
from simcompare.errors import InputError, SimcompareError
from simcompare.model.expressions import ExpressionError
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.model.tabled import Assumed
from simcompare.model.trajectory import Trajectory
from simcompare.propagation import results
from simcompare.running.jobs import FAILED, OK, Job, Outcome
from simcompare.running.runner import Progress, run_jobs
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.scenarios.tabled_faults import value_of as assumed_value
from simcompare.statistics.budget import u_of
from simcompare.statistics.stated import is_nothing, stated
from simcompare.validation.tabled.experiments import Experiment
from simcompare.validation.tabled.vocabulary import Entry

Values = dict[str, float | None]
Row = Mapping[str, float]
#: part by which a parameter is changed to see whether it matters; its square is nothing
_SMALL = 0.01


@dataclass(frozen=True)
class Setting:
    """What stands behind all experiments of a table.

    Attributes:
        file: the scenario.
        said: parameters that the user or the head of the table say, SI.
        step_s: time between samples [s]; the scenario's own where ``None``.
    """

    file: ScenarioFile
    said: Mapping[str, float] = field(default_factory=dict)
    step_s: float | None = None

    @property
    def assume(self) -> Mapping[str, Assumed]:
        """Parameter -> what is assumed where nothing says it."""
        return {} if self.file.table is None else self.file.table.assume

    def values(self, row: Mapping[str, float]) -> dict[str, float]:
        """All parameters of an experiment: those of its row, those said, and those assumed.

        Expressions see the values that hold, in the order in which they stand in the scenario.
        """
        known = {**self.said, **row}
        values = {name: one.value for name, one in self.file.parameters.items()} | known
        for name, one in self.assume.items():
            if name not in known:
                bounds = self.file.parameters[name]
                values[name] = min(max(_assumed(name, one, values), bounds.min), bounds.max)
        return values

    def scene(self, row: Mapping[str, float]) -> Scenario:
        """The scene of an experiment."""
        return self.file.resolve(self.values(row), step_s=self.step_s)

    def u_of_inputs(self, one: Experiment) -> dict[str, float]:
        """Standard uncertainty of every parameter of an experiment that is not exact, SI.

        What the row states comes first, then what is assumed, then what the scenario says of a
        class.
        """
        values, found = self.values(one.set), {}
        said = {} if self.file.uncertainty is None else self.file.uncertainty.inputs
        texts: dict[str, str | float] = {name: known.u for name, known in said.items()}
        for name, assumed in self.assume.items():
            if name not in one.set and name not in self.said:
                texts.pop(name, None)
                if assumed.u is not None:
                    texts[name] = assumed.u
        for name, text in texts.items():
            if not is_nothing(text, values[name]):
                known = stated(text, values[name], units.unit_of(name), name)
                found[name] = u_of(known.distribution)
        return {**found, **one.u_set}


def _assumed(name: str, one: Assumed, values: Mapping[str, float]) -> float:
    """What is assumed of a parameter.

    Raises:
        InputError: it follows from values with which it cannot be.
    """
    try:
        return assumed_value(one, values)
    except ExpressionError as error:
        raise InputError(name, [str(error)]) from None


def value_in(scene: Scenario, trajectory: Trajectory, entry: Entry) -> float:
    """A result of one run.

    Raises:
        InputError: it cannot be measured in that run.
    """
    if entry.event is None:
        return results.value_of(scene, trajectory, entry.name)
    for measure in scene.measures:
        for name, series in measures.take(measure, scene, trajectory).series.items():
            if measure.name_of(name) == entry.name and len(series) >= entry.event:
                return float(series[entry.event - 1])
    raise InputError(entry.name, [f"number {entry.event} is not seen in {trajectory.source}"])


@dataclass(frozen=True)
class ClosedForm:
    """Results as functions of what is set, by mathematics.

    Attributes:
        setting: what stands behind all experiments.
        entries: the results.
    """

    setting: Setting
    entries: Sequence[Entry]

    @functools.cached_property
    def exists(self) -> bool:
        """Whether the scenario has one."""
        return catalogue.has_reference(self.setting.file.path)

    def beyond(self, found: Iterable[Experiment]) -> tuple[str, ...]:
        """Why it does not hold for some experiments."""
        return tuple(
            dict.fromkeys(why for one in found for why in self.setting.scene(one.set).beyond)
        )

    def of(self, rows: Sequence[Mapping[str, float]]) -> list[Values]:
        """For each row: result -> value; ``None`` where it cannot be measured or does not hold."""
        scenes = [self.setting.scene(row) for row in rows]
        held = [scene for scene in scenes if self.exists and not scene.beyond]
        truths = iter(truths_of(self.setting.file.path, held))
        return [
            {one.name: _or_none(scene, truth, one) for one in self.entries}
            for scene in scenes
            for truth in [None if scene.beyond or not self.exists else next(truths)]
        ]

    def decisive(self, one: Experiment) -> list[str]:
        """Parameters that no row says and on which some result depends; those that are 0 do not."""
        values, moved = self.setting.values(one.set), {}
        for name, bounds in self.setting.file.parameters.items():
            if name not in one.set and values[name]:
                away = _SMALL if values[name] * (1 + _SMALL) <= bounds.max else -_SMALL
                moved[name] = {**one.set, name: values[name] * (1 + away)}
        rows = self._possible(moved)
        nominal, *found = self.of([one.set, *rows.values()])
        return [
            name
            for name, made in zip(rows, found, strict=True)
            if any(_differ(nominal[result], value) for result, value in made.items())
        ]

    def _possible(self, moved: Mapping[str, Row]) -> dict[str, Row]:
        """Rows with which a scene can be built: a number of teeth has no hundredth more."""
        found = {}
        for name, row in moved.items():
            with contextlib.suppress(InputError):
                self.setting.scene(row)
                found[name] = row
        return found

    def effects(self, one: Experiment, nominal: Values) -> dict[str, dict[str, float]]:
        """Input -> result -> by how much the input's standard uncertainty changes it."""
        values, signs, moved = self.setting.values(one.set), {}, {}
        for name, u in self.setting.u_of_inputs(one).items():
            bounds = self.setting.file.parameters[name]
            signs[name] = 1 if values[name] + u <= bounds.max else -1
            moved[name] = {**one.set, name: max(values[name] + signs[name] * u, bounds.min)}
        rows = self._possible(moved)
        found = {
            name: _changes(made, nominal, signs[name])
            for name, made in zip(rows, self.of([*rows.values()]), strict=True)
        }
        return {name: changes for name, changes in found.items() if any(changes.values())}


def _changes(moved: Values, nominal: Values, sign: int) -> dict[str, float]:
    return {
        result: (value - before) * sign
        for result, value in moved.items()
        if value is not None and (before := nominal[result]) is not None
    }


def _differ(one: float | None, other: float | None) -> bool:
    return one is None or other is None or abs(one - other) > _SMALL**2 * abs(one)


def _or_none(scene: Scenario, trajectory: Trajectory | None, entry: Entry) -> float | None:
    try:
        return None if trajectory is None else value_in(scene, trajectory, entry)
    except InputError:
        return None


@dataclass(frozen=True)
class EngineValues:
    """What one engine gave.

    Attributes:
        name: of the engine.
        status: "ok", or how the first bad run ended.
        reason: of that.
        version: the engine's version.
        values: of each experiment: result -> value.
    """

    name: str
    status: str
    reason: str | None
    version: str | None
    values: tuple[Values, ...]


def simulate(
    setting: Setting,
    found: Sequence[Experiment],
    entries: Sequence[Entry],
    engines: Sequence[str],
    *,
    contact: str,
    time_limit_s: float,
    progress: Progress | None,
) -> list[EngineValues]:
    """Runs every experiment on every engine."""
    scenes = [setting.scene(one.set) for one in found]
    jobs = [
        Job(name, scene, Settings(contact, drops=drop_plans(scene)), number)
        for name in engines
        for number, scene in enumerate(scenes)
    ]
    outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    count = len(scenes)
    return [
        _of_engine(name, outcomes[i * count : (i + 1) * count], entries)
        for i, name in enumerate(engines)
    ]


def _of_engine(name: str, outcomes: Sequence[Outcome], entries: Sequence[Entry]) -> EngineValues:
    bad = next((one for one in outcomes if one.status != OK), None)
    status, reason = (OK, None) if bad is None else (bad.status, bad.reason)
    values, why = [], ""
    for outcome in outcomes:
        made: Values = dict.fromkeys((one.name for one in entries), None)
        if outcome.status == OK and outcome.trajectory is not None:
            for entry in entries:
                try:
                    made[entry.name] = value_in(outcome.job.scenario, outcome.trajectory, entry)
                except SimcompareError as error:
                    why = why or str(error)
        values.append(made)
    if status == OK and not any(value is not None for row in values for value in row.values()):
        status, reason = FAILED, why
    return EngineValues(name, status, reason or why or None, outcomes[0].facts.version, (*values,))
