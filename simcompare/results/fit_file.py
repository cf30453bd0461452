"""A stored fit, to be used again: each engine with its own fitted parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from simcompare.engine.assist import ALL, chosen
from simcompare.engine.calibration.plan import drop_plans
from simcompare.engine.helps import HELPS
from simcompare.errors import InputError, NoSuchFile, UnknownName
from simcompare.model import record_file
from simcompare.model.audit import AuditRow
from simcompare.model.fittable import BOUNCES, TOSSES, WAVEFORM
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, TUNED, PairNumbers, Settings
from simcompare.results.records.fit_engines import OneRestitution, RunWith, Tuned
from simcompare.results.records.fit_parts import Value
from simcompare.scenarios.scenario_file import ScenarioFile

#: contact level of engines with parameters from a fit
FITTED = "fitted"
FILE = "fit.json"
#: by how much a speed may leave the fitted range before it is told
_MARGIN = 1.05


@dataclass(frozen=True)
class _Valid:
    speed_m_s: tuple[float, float]
    step_s: float
    engine_step_s: float | None = None


@dataclass(frozen=True)
class _Form:
    parameters: Mapping[str, Value]


@dataclass(frozen=True)
class _Source:
    name: str
    status: str = ""
    reason: str | None = None
    native: tuple[AuditRow, ...] = ()


@dataclass(frozen=True, kw_only=True)
class _Stored:
    """What of fit.json is of use for another run, also in a fit of version 0.1."""

    by: str = BOUNCES
    scenario: str
    given: Mapping[str, float]
    contact: str = ASSISTED
    assist: str = ALL
    closed_form: _Form = _Form({})
    sources: tuple[_Source, ...]
    run_with: RunWith
    valid: _Valid
    one_number: OneRestitution | None = None


@dataclass(frozen=True)
class FitFile:
    """What fit.json holds of use for another run.

    Attributes:
        path: the file.
        scenario: name of the scenario that was fitted.
        given: parameters of the scenario that were not fitted.
        closed: parameters of the closed form, by the scenario's names.
        engines: engine -> parameters of the scenario that it must be given, where they differ.
        numbers: engine -> its own numbers for the restitution, in a plain loop.
        contact: level for which the fit holds: "tuned" or "assisted".
        assist: our helps that it was made with, as they are typed.
        speed_m_s: slowest and fastest impact that was fitted.
        step_s: time between samples that was fitted with.
        engine_step_s: step of the engines.
        drop_height_m: from how high the first drop fell that was fitted, where it was fitted.
        sources: what became of each engine, and the contact values that it held.
        one_number: the restitution of engines where the ball's own depends on the speed.
    """

    path: Path
    scenario: str
    given: Mapping[str, float]
    closed: Mapping[str, float]
    engines: Mapping[str, Mapping[str, float]]
    numbers: Mapping[str, tuple[Tuned, ...]]
    contact: str
    assist: str
    speed_m_s: tuple[float, float]
    step_s: float
    engine_step_s: float
    drop_height_m: float | None = None
    sources: tuple[_Source, ...] = ()
    one_number: OneRestitution | None = None

    def base(self, file: ScenarioFile) -> dict[str, float]:
        """Parameters of the scenario as the closed form has them.

        Raises:
            InputError: the fit is of another scenario.
        """
        if file.name != self.scenario:
            raise InputError(
                str(self.path), [f"is a fit of {self.scenario}, not of {file.name}; fit that first"]
            )
        return _known({**self.given, **self.closed}, file)

    def of_engine(self, engine: str, file: ScenarioFile) -> dict[str, float] | None:
        """Parameters in which an engine differs from ``base``, ``None`` where it was not fitted."""
        own = self.engines.get(engine)
        if own is None and self.contact == TUNED:
            return {} if engine in self.numbers else None
        return None if own is None else _known(own, file)

    @property
    def usual_step_s(self) -> float | None:
        """Time between samples where none is asked for [s]; ``None``: the scenario's own."""
        return self.step_s if self.contact == TUNED else None

    def drop(self, file: ScenarioFile) -> dict[str, float]:
        """The height of the first drop that was fitted, as a parameter of the scenario."""
        height = None if file.fit is None else file.fit.height
        if height is None or self.drop_height_m is None:
            return {}
        return {height: self.drop_height_m}

    def settings(self, engine: str, scene: Scenario) -> Settings:
        """How an engine is run with what was fitted.

        Tuned, the numbers of the fit are taken where step, restitution, size and gravity are those
        of the fit; else the engine is tuned anew, for the impacts of the scene.

        Args:
            engine: its name.
            scene: the nominal scene, which all repeats of a run share.
        """
        if self.contact != TUNED:
            helps = chosen(self.assist)
            return Settings(ASSISTED, helps=None if helps == frozenset(HELPS) else helps)
        drops = drop_plans(scene)
        plans = {frozenset(pair): plan for plan in drops for pair in plan.pairs}
        numbers = tuple(
            PairNumbers(pair, tuned.values)
            for tuned in self.numbers.get(engine, ()) if self._is_at_step(scene)
            for pair in tuned.pairs
            if frozenset(pair) in plans and tuned.suits(plans[frozenset(pair)])
        )  # fmt: skip
        return Settings(TUNED, numbers=numbers, drops=drops)

    def cautions(self, scene: Scenario, file: ScenarioFile) -> list[str]:
        """What lies outside of the range in which the fit is valid, each without a full stop."""
        said = []
        height = None if file.fit is None else scene.parameters.get(file.fit.height or "")
        if height is not None:
            speed = math.sqrt(2 * math.hypot(*scene.world.gravity_m_s2) * height)
            if speed > _MARGIN * self.speed_m_s[1]:
                said.append(
                    f"The first impact is at up to {speed:.2f} m/s; the fit saw"
                    f" {self.speed_m_s[0]:.2f} to {self.speed_m_s[1]:.2f} m/s"
                )
        if self.contact == TUNED:
            return said + self._tuned_anew(scene)
        if not math.isclose(scene.world.step_s, self.step_s, rel_tol=1e-6):
            said.append(
                f"The time between samples is {scene.world.step_s:g} s; the engines were fitted"
                f" with {self.step_s:g} s"
            )
        return said

    def _tuned_anew(self, scene: Scenario) -> list[str]:
        step_s = scene.world.engine_step_s
        if not self._is_at_step(scene):
            return [
                f"The step is {1e3 * step_s:.4g} ms; the numbers of the fit hold for"
                f" {1e3 * self.engine_step_s:.4g} ms, so the engines were tuned anew for this step"
            ]
        plans = {frozenset(pair): plan for plan in drop_plans(scene) for pair in plan.pairs}
        unsuited = any(
            frozenset(pair) in plans and not tuned.suits(plans[frozenset(pair)])
            for own in self.numbers.values() for tuned in own for pair in tuned.pairs
        )  # fmt: skip
        if not unsuited:
            return []
        return [
            "The restitution, the size of what bounces, or gravity is not that of the fit, so the"
            " engines were tuned anew for what is asked"
        ]

    def _is_at_step(self, scene: Scenario) -> bool:
        return math.isclose(scene.world.engine_step_s, self.engine_step_s, rel_tol=1e-6)


def _known(values: Mapping[str, float], file: ScenarioFile) -> dict[str, float]:
    """Those that are parameters of the scenario, but not the height, which is a drop's own."""
    names = set(file.parameters) - {file.fit.height if file.fit is not None else None}
    return {name: value for name, value in values.items() if name in names}


def _damaged(path: Path, said: str) -> InputError:
    """What is said of a file that is no fit, or was changed by hand."""
    fault = f"is no fit of simcompare fit, or is damaged ({said}); fit again and take its {FILE}"
    return InputError(str(path), [fault])


def find(text: str) -> Path | None:
    """The fit that a text names: the file, or the folder of the run that made it."""
    path = Path(text)
    try:
        if path.is_dir() and (path / FILE).is_file():
            return path / FILE
        return path if path.suffix == ".json" else None
    except OSError:  # a name too long for the file system
        return None


def read(path: Path) -> FitFile:
    """Reads fit.json.

    Raises:
        InputError: there is none, or it is damaged.
    """
    if path.is_dir():
        raise InputError(str(path), [f"is a folder without {FILE}; expected that of a fit"])
    if not path.exists():
        raise NoSuchFile(path, f"a {FILE} of simcompare fit")
    tree = record_file.read(path, f"fit again and take its {FILE}")
    _refuse_record(path, tree)
    try:
        fit = record_file.record(_Stored, tree, path, more=True)
        _check_plausible(fit)
    except InputError as error:
        raise _damaged(path, "; ".join(error.faults)) from None
    except (ValueError, UnknownName) as error:
        raise _damaged(path, str(error)) from None
    return FitFile(
        path, fit.scenario, fit.given, fit.run_with.closed, fit.run_with.engines,
        fit.run_with.numbers, fit.contact, fit.assist, fit.valid.speed_m_s, fit.valid.step_s,
        fit.valid.engine_step_s or fit.valid.step_s, _first_height(fit.closed_form), fit.sources,
        fit.one_number,
    )  # fmt: skip


def _refuse_record(path: Path, tree: object) -> None:
    """Says of what is no fit of use what it is, and where the fit is."""
    kind, by = (tree.get("kind"), tree.get("by")) if isinstance(tree, dict) else (None, None)
    if kind == "fit":
        raise InputError(str(path), [f"is the record of a fit; give {path.with_name(FILE)}"])
    if kind is not None:
        wrong = f"is the record of a {kind}, in which nothing was fitted"
        raise InputError(str(path), [f"{wrong}; give the {FILE} of simcompare fit"])
    if by == WAVEFORM:
        fault = "is a fit of signals over time; give its parameters with --set"
        raise InputError(str(path), [fault])


def _check_plausible(fit: _Stored) -> None:
    """Words that are known, and an engine's numbers as they can be.

    These are one coefficient, or the two of a spring and damper as typed in.

    Raises:
        ValueError, UnknownName: what is not.
    """
    if fit.by not in (BOUNCES, TOSSES):
        raise ValueError(f"by: {fit.by!r}; expected {BOUNCES} or {TOSSES}")
    if fit.contact not in (TUNED, ASSISTED):
        raise ValueError(f"contact: {fit.contact!r}; expected {TUNED} or {ASSISTED}")
    chosen(fit.assist)
    for engine, rows in fit.run_with.numbers.items():
        for values in (row.values for row in rows):
            one = len(values) == 1 and 0 < values[0] <= 1
            two = len(values) == 2 and all(math.isfinite(v) and v < 0 for v in values)
            if not (one or two):
                raise ValueError(
                    f"run_with.numbers.{engine}: {list(values)}; expected one number in 0 … 1, or"
                    " two below 0"
                )


def _first_height(form: _Form) -> float | None:
    for name in ("drop_height_m", "drop_height_m[1]"):
        if name in form.parameters:
            return form.parameters[name].value
    return None
