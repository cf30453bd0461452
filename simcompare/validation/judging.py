"""Rows of a validation: waveforms, single values and what they are made of."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from simcompare.scenario import Scenario
from simcompare.trajectory import Array, Trajectory
from simcompare.validation.cases import Case, Seen
from simcompare.validation.filtering import interpolated
from simcompare.validation.gap import measured_noise, split
from simcompare.validation.grid import gci
from simcompare.validation.plan import Plan
from simcompare.validation.scores import birge_ratio, vv20
from simcompare.validation.simulated import (
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
from simcompare.validation.waveform import waveform

#: draws of noise from which the uncertainty of a measured value is told
DRAWS = 16


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


def noise(seen: Seen) -> tuple[float, str]:
    """Standard uncertainty of one sample and where it comes from."""
    if seen.u is not None:
        return float(np.sqrt(np.mean(np.square(seen.u)))), "stated"
    found = measured_noise(seen.values)
    return found.value, found.text


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
    others = {
        variant: measured_values(judged.scene, _resampled(run, measured), measured, probes)
        for (i, variant), run in engine.runs.items()
        if i == number and variant in (DOUBLE, FOURFOLD, HALF)
    }
    rows = []
    for name, (simulated, real, unit, probe, _) in found.items():
        u_num, how = _u_num(simulated, {v: row[name] for v, row in others.items() if name in row})
        shares = budget.get(name)
        u_input = None if shares is None else math.hypot(*shares.values())
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
                "e_n": judged_by.error / (2 * judged_by.u_val) if known_all else None,
                "zeta": judged_by.error / judged_by.u_val if known_all else None,
                "within_noise": judged_by.within_noise if known_all else None,
                "step_error": how,
                "budget": shares or {},
            }
        )
    return rows


def _u_num(simulated: float, others: Mapping[str, Both]) -> tuple[float | None, str | None]:
    """Standard uncertainty from the step, and how it was told."""
    if DOUBLE in others:
        longer = [others[v].simulated for v in (DOUBLE, FOURFOLD) if v in others]
        found = gci(simulated, *longer)
        return found.u_num, found.text
    if HALF in others:
        # the error of the longer one of two steps is that of the shorter one times their ratio
        found = gci(others[HALF].simulated, simulated)
        return 2 * found.u_num, f"{found.text} A longer step than the scenario's cannot be run."
    return None, None


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


def as_trajectory(case: Case) -> Trajectory:
    """What was measured as a trajectory: the probes that have the clock of the leading one."""
    seen = list(case.seen.values())
    times = seen[0].time_s
    same = {
        probe: one.values
        for probe, one in case.seen.items()
        if len(one.time_s) == len(times) and np.array_equal(one.time_s, times)
    }
    return Trajectory("measured", times, same)


def _u_data(
    judged: Judged,
    best: Trajectory,
    measured: Trajectory,
    found: Mapping[str, Both],
) -> dict[str, float]:
    """How much a measured value scatters: when noise is drawn anew, and within the record."""
    generator = np.random.default_rng(0)
    drawn: dict[str, list[float]] = {name: [] for name in found}
    for _ in range(DRAWS):
        signals = {
            probe: signal + generator.normal(0.0, noise(judged.case.seen[probe])[0], len(signal))
            for probe, signal in measured.signals.items()
        }
        again = measured_values(
            judged.scene, best, Trajectory("measured", measured.time_s, signals), tuple(signals)
        )
        for name in found:
            if name in again:
                drawn[name].append(again[name].measured)
    noisy = {name: np.std(own, ddof=1) if len(own) > 1 else 0.0 for name, own in drawn.items()}
    return {name: math.hypot(float(noisy[name]), both.u) for name, both in found.items()}


def _budget(
    judged: Judged, measured: Trajectory, found: Mapping[str, Both]
) -> dict[str, dict[str, float]] | None:
    """Value -> parameter -> what its standard uncertainty does to that value of the reference."""
    if judged.truth is None:
        return None
    probes = tuple(measured.signals)
    best = measured_values(judged.scene, _resampled(judged.truth, measured), measured, probes)
    moved = {
        name: measured_values(judged.scene, _resampled(run, measured), measured, probes)
        for name, run in judged.shifted
    }
    return {
        value: {
            name: abs(row[value].simulated - best[value].simulated)
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
        own = [row for row in rows if (row["stream"], row["measure"]) == key and row["u_num"]]
        if len(own) < 2:
            continue
        ratio = birge_ratio([row["simulated"] for row in own], [row["u_num"] for row in own])
        found.append({"stream": key[0], "measure": key[1], "unit": own[0]["unit"],
                      "engines": [row["source"] for row in own], **ratio.to_dict()})  # fmt: skip
    return found
