"""A stored fit, to be used again: each engine with its own fitted parameters."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simcompare.engine.assist import ALL, chosen
from simcompare.engine.calibration.plan import drop_plans
from simcompare.engine.helps import HELPS
from simcompare.errors import InputError, UnknownName
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, TUNED, DropPlan, PairNumbers, Settings
from simcompare.scenarios.scenario_file import ScenarioFile

#: contact level of engines with parameters from a fit
FITTED = "fitted"
FILE = "fit.json"
#: by how much a speed may leave the fitted range before it is told
_MARGIN = 1.05


@dataclass(frozen=True)
class Tuned:
    """An engine's own numbers for the pairs of one restitution.

    Attributes:
        pairs: names of the bodies of each pair.
        restitution: that the numbers give.
        values: the numbers.
        size_m: smallest size of the body for which they were found.
        gravity_m_s2: along the normal of the contact.
    """

    pairs: tuple[tuple[str, str], ...]
    restitution: float
    values: tuple[float, ...]
    size_m: float
    gravity_m_s2: float

    def suits(self, plan: DropPlan) -> bool:
        """Whether the numbers were found for such drops, but for the speed of the impact."""
        return all(
            math.isclose(ours, asked, rel_tol=1e-6)
            for ours, asked in (
                (self.restitution, plan.restitution),
                (self.size_m, plan.size_m),
                (self.gravity_m_s2, plan.gravity_m_s2),
            )
        )


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
        drop_height_m: from how high the first drop fell that was fitted, where it was sought.
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
        if self.contact == TUNED:
            return {} if engine in self.numbers else None
        own = self.engines.get(engine)
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

    def cautions(
        self, scene: Scenario, file: ScenarioFile, engines: Sequence[str] = ()
    ) -> list[str]:
        """What lies outside of the range in which the fit is valid, one sentence each.

        Args:
            scene: the nominal scene.
            file: its scenario.
            engines: those that are run.
        """
        said = []
        others = [name for name in engines if self.of_engine(name, file) is None]
        if others:
            verb = "was" if len(others) == 1 else "were"
            said.append(
                f"{', '.join(others)} {verb} not fitted: what runs as fitted there has the closed"
                " form's parameters."
            )
        height = None if file.fit is None else scene.parameters.get(file.fit.height or "")
        if height is not None:
            speed = math.sqrt(2 * math.hypot(*scene.world.gravity_m_s2) * height)
            if speed > _MARGIN * self.speed_m_s[1]:
                said.append(
                    f"The first impact is at up to {speed:.2f} m/s; the fit saw"
                    f" {self.speed_m_s[0]:.2f} to {self.speed_m_s[1]:.2f} m/s."
                )
        if self.contact == TUNED:
            return said + self._tuned_anew(scene)
        if not math.isclose(scene.world.step_s, self.step_s, rel_tol=1e-6):
            said.append(
                f"The time between samples is {scene.world.step_s:g} s; the engines were fitted"
                f" with {self.step_s:g} s."
            )
        return said

    def _tuned_anew(self, scene: Scenario) -> list[str]:
        step_s = scene.world.engine_step_s
        if not self._is_at_step(scene):
            return [
                f"The step is {1e3 * step_s:.4g} ms; the numbers of the fit hold for"
                f" {1e3 * self.engine_step_s:.4g} ms, so the engines were tuned anew for this step."
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
            " engines were tuned anew for what is asked."
        ]

    def _is_at_step(self, scene: Scenario) -> bool:
        return math.isclose(scene.world.engine_step_s, self.engine_step_s, rel_tol=1e-6)


def _known(values: Mapping[str, float], file: ScenarioFile) -> dict[str, float]:
    """Those that are parameters of the scenario, but not the height, which is a drop's own."""
    names = set(file.parameters) - {file.fit.height if file.fit is not None else None}
    return {name: value for name, value in values.items() if name in names}


def contact_values(path: Path) -> str:
    """What each engine's own contact parameters were in the fit, as text to copy from.

    Raises:
        InputError: the file is no fit.
    """
    fit = read(path)
    how = (
        f"for a plain loop of one fixed step of {1e3 * fit.engine_step_s:.6g} ms"
        if fit.contact == TUNED
        else f"with {fit.step_s:g} s between samples and our helps ({fit.assist}); not for a plain"
        " loop"
    )
    lines = [
        f"# {fit.scenario}, fitted at {fit.speed_m_s[0]:.2f} to {fit.speed_m_s[1]:.2f} m/s, {how}"
    ]
    drag = {name: value for name, value in fit.closed.items() if "drag" in name and value}
    lines += [
        f"# fitted with air drag, {name} = {value:.6g}: a force -c·|v|·v of your own in each step"
        for name, value in drag.items()
    ]
    try:
        for source in json.loads(path.read_text(encoding="utf-8"))["sources"]:
            if source.get("status") != "ok":
                name, why = source["name"], source.get("reason") or source.get("status") or "failed"
                lines.append(f"# {name}: {str(why).removeprefix(f'{name}: ')}")
            rows = [row for row in source.get("native", ()) if _held(row) is not None]
            lines += [_line(source, row) for row in rows]
    except (KeyError, TypeError, AttributeError) as error:
        raise _damaged(path, error) from None
    return "\n".join(lines) + "\n"


def _damaged(path: Path, error: Exception) -> InputError:
    """What is said of a file that is no fit, or was changed by hand."""
    if isinstance(error, FileNotFoundError | IsADirectoryError):
        return InputError(
            str(path), ["there is no such file; expected a fit.json of simcompare fit"]
        )
    said = f"a key is missing: {error}" if isinstance(error, KeyError) else str(error)
    return InputError(
        str(path),
        [f"is no fit of simcompare fit, or is damaged ({said}); fit again and take its fit.json"],
    )


def _held(row: Mapping[str, Any]) -> float | None:
    """What the engine held, or was given where it cannot be read."""
    value: float | None = row["set_value"] if row["read_value"] is None else row["read_value"]
    return value


def _line(source: Mapping[str, Any], row: Mapping[str, Any]) -> str:
    unit = "" if row["unit"] in ("", "1") else f" {row['unit']}"
    note = f"  # {row['note']}" if row.get("note") else ""
    # all digits: a spring's two numbers belong together
    return f"{source['name']}: {row['engine_parameter']} = {_held(row)!r}{unit}{note}"


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
    try:
        tree = json.loads(path.read_text(encoding="utf-8"))
        if tree.get("by") == "waveform":
            raise InputError(
                str(path), ["is a fit of signals over time; give its parameters with --set"]
            )
        known = tree["run_with"]
        engines = {
            name: {n: float(v) for n, v in own.items()} for name, own in known["engines"].items()
        }
        values = {n: float(v) for n, v in known["closed"].items()}
        low, high = tree["valid"]["speed_m_s"]
        step_s = float(tree["valid"]["step_s"])
        contact, assist = tree.get("contact", ASSISTED), str(tree.get("assist", ALL))
        if contact not in (TUNED, ASSISTED):
            raise ValueError(f"contact: {contact!r}; expected {TUNED} or {ASSISTED}")
        chosen(assist)
        return FitFile(
            path, str(tree["scenario"]), {n: float(v) for n, v in tree["given"].items()},
            values, engines, _numbers(known.get("numbers", {})), contact, assist,
            (float(low), float(high)), step_s, float(tree["valid"].get("engine_step_s", step_s)),
            _first_height(tree),
        )  # fmt: skip
    except InputError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError, UnknownName) as error:
        raise _damaged(path, error) from None


def _plausible(engine: str, values: Sequence[Any]) -> tuple[float, ...]:
    """An engine's numbers: one coefficient, or the two of a spring and damper as typed in."""
    found = tuple(float(value) for value in values)
    one = len(found) == 1 and 0 < found[0] <= 1
    two = len(found) == 2 and all(math.isfinite(value) and value < 0 for value in found)
    if not (one or two):
        raise ValueError(
            f"run_with.numbers.{engine}: {list(values)}; expected one number in 0 … 1, or two"
            " below 0"
        )
    return found


def _first_height(tree: Mapping[str, Any]) -> float | None:
    sought = tree.get("closed_form", {}).get("parameters", {})
    for name in ("drop_height_m", "drop_height_m[1]"):
        if name in sought:
            return float(sought[name]["value"])
    return None


def _numbers(tree: Mapping[str, Any]) -> dict[str, tuple[Tuned, ...]]:
    return {
        name: tuple(
            Tuned(
                tuple((str(first), str(second)) for first, second in record["pairs"]),
                float(record["restitution"]),
                _plausible(name, record["values"]),
                float(record["size_m"]),
                float(record["gravity_m_s2"]),
            )
            for record in own
        )
        for name, own in tree.items()
    }
