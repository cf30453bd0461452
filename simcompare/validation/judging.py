"""Rows of a validation: waveforms, single values and what they are made of."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from simcompare.inference.plan import Plan
from simcompare.inference.segments import Case, as_trajectory, noise, shares
from simcompare.inference.simulated import (
    BEST,
    DOUBLE,
    FOURFOLD,
    HALF,
    NOMINAL,
    Both,
    Engine,
    measured_values,
    times,
)
from simcompare.model.resampling import interpolated
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory
from simcompare.statistics.agreement import birge_ratio, e_n, vv20, zeta
from simcompare.statistics.grid_convergence import gci
from simcompare.validation.gap import split
from simcompare.validation.waveform import waveform

#: draws of noise from which the uncertainty of a measured value is told
DRAWS = 16
#: formal order above which an observed order of convergence is not believed
_HIGHEST_ORDER = 2.3


@dataclass(frozen=True)
class Judged:
    """One case with all that its rows are made of.

    Attributes:
        case: what was measured, on the clock of the scenario.
        raw: the same before the clocks were aligned, ``None`` where they were not.
        scene: the scene with the best parameters.
        truth: the reference with the best parameters, by probe; ``None`` without a reference.
        nominal: the reference with the parameters known before.
        u_input: probe -> standard uncertainty of the reference from its parameters (n,).
        shifted: parameter, and what the reference gives when it moves by its standard uncertainty.
    """

    case: Case
    raw: Case | None
    scene: Scenario
    truth: Trajectory | None
    nominal: Trajectory | None
    shifted: tuple[tuple[str, Trajectory], ...] = ()

    def u_input(self, probe: str) -> Array | None:
        """Standard uncertainty from the parameters, at the reference's samples."""
        if self.truth is None:
            return None
        best = self.truth.signals[probe]
        parts = [run.signals[probe] - best for _, run in self.shifted]
        return np.sqrt(np.sum(np.square(parts), axis=0)) if parts else np.zeros_like(best)


def waveforms(
    engine: Engine, number: int, judged: Judged, plan: Plan, fitted: bool
) -> list[dict[str, Any]]:
    """How far an engine is from each measured signal, with and without fit and alignment."""
    rows = []
    variants = [(NOMINAL, "known before")] + ([(BEST, "fitted")] if fitted else [])
    for probe, seen in judged.case.seen.items():
        before = None if judged.raw is None else judged.raw.seen[probe]
        for variant, words in variants:
            run = engine.runs[number, variant]
            aligned = [(seen, judged.raw is not None)]
            aligned += [] if before is None else [(before, False)]
            for measured, is_aligned in aligned:
                found = waveform(
                    measured.values,
                    at(run, probe, measured.time_s, _jumps(judged, plan, run)),
                    u=noise(measured)[0] or None,
                )
                rows.append(
                    {
                        "source": engine.name,
                        "stream": judged.case.stream,
                        "probe": probe,
                        "unit": judged.scene.probes[probe].unit,
                        "judged": plan.compare[probe].judged,
                        "parameters": words,
                        "aligned": is_aligned,
                        **found.to_dict(),
                    }
                )
    return rows


def at(run: Trajectory, probe: str, time_s: Array, jumps_s: Array) -> Array:
    """A simulated signal at the times of a measurement; NaN outside, and next to impacts."""
    return interpolated(run.time_s, run.signals[probe], time_s, events_s=jumps_s)


def _jumps(judged: Judged, plan: Plan, run: Trajectory) -> Array:
    """Times of the impacts of a simulation, where the plan names them: nothing is smooth there."""
    if plan.events is None:
        return np.zeros(0)
    return times(judged.scene, run, plan.events.series)


def values(engine: Engine, number: int, judged: Judged) -> list[dict[str, Any]]:
    """Single values of both, with the three parts of their uncertainty (ASME V&V 20)."""
    probes = tuple(judged.case.seen)
    if not judged.case.seen:
        return []
    whole = as_trajectory(judged.case)
    measured = _within(whole, engine.runs[number, BEST])
    best = _resampled(engine.runs[number, BEST], measured)
    found = measured_values(judged.scene, best, measured, probes)
    u_data = _u_data(judged, best, measured, found)
    budget = _budget(judged, measured, found) or {}
    truth = _of_reference(judged, measured)
    others = {
        variant: measured_values(judged.scene, _resampled(run, measured), measured, probes)
        for (i, variant), run in engine.runs.items()
        if i == number and variant in (DOUBLE, FOURFOLD, HALF)
    }
    rows = []
    for name, (simulated, real, unit, probe, _) in found.items():
        own = {v: row[name] for v, row in others.items() if name in row}
        u_num, how = _u_num(simulated, own, truth.get(name))
        by_parameter = budget.get(name)
        u_input = None if by_parameter is None else math.hypot(*by_parameter.values())
        parts = (u_num, u_input, u_data[name])
        known = [0.0 if part is None else part for part in parts]
        judged_by = vv20(simulated, real, *known)
        known_all = None not in parts and judged_by.u_val > 0
        rows.append(
            {
                "source": engine.name,
                "stream": judged.case.stream,
                "measure": name,
                "probe": probe,
                "unit": unit,
                "simulated": simulated,
                "u_simulated": math.hypot(known[0], known[1]),
                "measured": real,
                **dict(zip(("u_num", "u_input", "u_data"), parts, strict=True)),
                "u_val": judged_by.u_val,
                "error": judged_by.error,
                "e_n": e_n(simulated, real, 2 * judged_by.u_val, 0.0) if known_all else None,
                "zeta": zeta(simulated, real, judged_by.u_val, 0.0) if known_all else None,
                "within_noise": judged_by.within_noise if known_all else None,
                "step_error": how,
                "budget": by_parameter or {},
            }
        )
    return rows


def _u_num(
    simulated: float, others: Mapping[str, Both], exact: float | None
) -> tuple[float | None, str | None]:
    """Standard uncertainty from the step, and how it was told.

    Where the scenario has a reference, the engine's deviation from it is known; the step error is
    not less than that. An order above 2 is chance, since no engine has one.
    """
    least = 0.0 if exact is None else abs(simulated - exact)
    if DOUBLE in others:
        longer = [others[v].simulated for v in (DOUBLE, FOURFOLD) if v in others]
        found = gci(simulated, *longer)
        if found.observed is not None and found.observed > _HIGHEST_ORDER:
            found = gci(simulated, longer[0])
        return max(found.u_num, least), found.text
    if HALF in others:
        # the error of the longer one of two steps is that of the shorter one times their ratio
        found = gci(others[HALF].simulated, simulated)
        text = f"{found.text} A longer step than the scenario's cannot be run."
        return max(2 * found.u_num, least), text
    return (None, None) if exact is None else (least, "deviation from the reference")


def _within(measured: Trajectory, simulated: Trajectory) -> Trajectory:
    """The part of a measurement that was simulated too."""
    times = measured.time_s
    inside = (times >= simulated.time_s[0]) & (times <= simulated.time_s[-1])
    signals = {name: values[inside] for name, values in measured.signals.items()}
    return Trajectory(measured.source, times[inside], signals)


def _resampled(run: Trajectory, measured: Trajectory) -> Trajectory:
    """A simulation sampled when the measurement was, so that a measure sees both alike."""
    signals = {
        name: interpolated(run.time_s, run.signals[name], measured.time_s)
        for name in measured.signals
    }
    return Trajectory(run.source, measured.time_s, signals, run.version, run.contact)


def _u_data(
    judged: Judged, best: Trajectory, measured: Trajectory, found: Mapping[str, Both]
) -> dict[str, float]:
    """What the uncertainty of the samples makes of a measured value.

    A part of a stated uncertainty is seen as noise from sample to sample; the rest is common to all
    samples of a record. Both are drawn anew, and so is a bias that noise makes (a path gets longer
    by it). Where the record itself scatters more, that counts instead.
    """
    generator = np.random.default_rng(0)
    drawn: dict[str, list[float]] = {name: [] for name in found}
    for _ in range(DRAWS):
        signals = {}
        for probe, signal in measured.signals.items():
            random, common = shares(judged.case.seen[probe])
            shift = generator.normal(0.0, common)
            signals[probe] = signal + shift + generator.normal(0.0, random, len(signal))
        again = measured_values(
            judged.scene, best, Trajectory("measured", measured.time_s, signals), tuple(signals)
        )
        for name in found:
            if name in again:
                drawn[name].append(again[name].measured)
    return {name: max(_spread(drawn[name], both.measured), both.u) for name, both in found.items()}


def _spread(drawn: Sequence[float], value: float) -> float:
    """Root mean square of what the draws make of a value, their bias included."""
    if len(drawn) < 2:
        return 0.0
    return float(np.sqrt(np.mean(np.square(np.array(drawn) - value))))


def _of_reference(judged: Judged, measured: Trajectory) -> dict[str, float]:
    """The same values of the reference; none where there is none."""
    if judged.truth is None:
        return {}
    run = _resampled(judged.truth, measured)
    probes = tuple(measured.signals)
    found = measured_values(judged.scene, run, measured, probes)
    return {name: both.simulated for name, both in found.items()}


def _budget(
    judged: Judged, measured: Trajectory, found: Mapping[str, Both]
) -> dict[str, dict[str, float]] | None:
    """Value -> parameter -> what its standard uncertainty does to that value of the reference."""
    if judged.truth is None:
        return None
    probes = tuple(measured.signals)
    best = _of_reference(judged, measured)
    moved = {
        name: measured_values(judged.scene, _resampled(run, measured), measured, probes)
        for name, run in judged.shifted
    }
    return {
        value: {
            name: abs(row[value].simulated - best[value])
            for name, row in moved.items()
            if value in row
        }
        for value in found
        if value in best
    }


def gaps(engine: Engine, number: int, judged: Judged, plan: Plan) -> list[dict[str, Any]]:
    """What the gap between an engine as known before and the measurement is made of."""
    rows = []
    for probe, seen in judged.case.seen.items():
        if not plan.compare[probe].judged:
            continue
        own = {variant: engine.runs[number, variant] for variant in (BEST, NOMINAL)}
        best, nominal = (
            at(run, probe, seen.time_s, _jumps(judged, plan, run)) for run in own.values()
        )
        numerical = None
        if judged.truth is not None:
            numerical = best - at(
                judged.truth, probe, seen.time_s, _jumps(judged, plan, judged.truth)
            )
        elif (number, DOUBLE) in engine.runs:  # no reference: what the next longer step changes
            longer = engine.runs[number, DOUBLE]
            numerical = best - at(longer, probe, seen.time_s, _jumps(judged, plan, longer))
        u_num = 0.0 if numerical is None else float(np.sqrt(np.nanmean(numerical**2)))
        u_input = judged.u_input(probe)
        moved = None
        if judged.truth is not None and u_input is not None:
            moved = interpolated(judged.truth.time_s, u_input, seen.time_s)
        found = split(seen.values, nominal, best, seen.u, u_num)
        rows.append(
            {
                "source": engine.name,
                "stream": judged.case.stream,
                "probe": probe,
                "unit": judged.scene.probes[probe].unit,
                "input": None if moved is None else float(np.sqrt(np.nanmean(moved**2))),
                "covered": _covered(best - seen.values, moved, math.hypot(found.noise, u_num)),
                **found.to_dict(),
            }
        )
    return rows


def _covered(left: Array, moved: Array | None, other: float) -> float | None:
    """Share of the samples whose difference is within twice all standard uncertainties."""
    if moved is None:
        return None
    known = np.isfinite(left) & np.isfinite(moved)
    return float(np.mean(np.abs(left[known]) <= 2 * np.hypot(moved[known], other)))


def agreement(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Whether the engines agree among themselves within their own step errors (Birge ratio)."""
    found = []
    for key in dict.fromkeys((row["stream"], row["measure"]) for row in rows):
        every = [row for row in rows if (row["stream"], row["measure"]) == key]
        own = [row for row in every if row["u_num"] is not None]
        if len(own) < 2:
            continue
        values = [row["simulated"] for row in own]
        # two numbers that are equal to rounding agree
        least = 1e-12 * max(map(abs, values)) or 1e-300
        ratio = birge_ratio(values, [max(row["u_num"], least) for row in own])
        found.append({"stream": key[0], "measure": key[1], "unit": own[0]["unit"],
                      "engines": [row["source"] for row in own],
                      "left_out": [row["source"] for row in every if row["u_num"] is None],
                      **ratio.to_dict()})  # fmt: skip
    return found


def spread(engines: Sequence[Engine], number: int, judged: Judged) -> list[dict[str, Any]]:
    """How far the engines are from each other: from their mean, over the measured samples."""
    found = []
    for probe, seen in judged.case.seen.items():
        runs = {
            engine.name: interpolated(run.time_s, run.signals[probe], seen.time_s)
            for engine in engines
            if (run := engine.runs.get((number, BEST))) is not None
        }
        if len(runs) < 2:
            continue
        table = np.stack(list(runs.values()))
        off = table - table.mean(axis=0)
        found.append(
            {
                "stream": judged.case.stream,
                "probe": probe,
                "engines": list(runs),
                "rms": float(np.sqrt(np.nanmean(off**2))),
            }
        )
    return found
