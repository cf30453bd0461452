"""Single values of a simulation held against those of a segment, with their uncertainty."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simcompare.comparison.values import ValuePair, overlap, resampled, value_pairs
from simcompare.inference.evaluated import Evaluated
from simcompare.inference.segments import as_trajectory, shares
from simcompare.inference.simulated import BEST, DOUBLE, FOURFOLD, HALF, Engine
from simcompare.model.trajectory import Trajectory
from simcompare.statistics.agreement import VV20, rms, vv20
from simcompare.statistics.grid_convergence import gci

#: draws of noise that give the uncertainty of a measured value
DRAWS = 16
#: formal order above which an observed order of convergence is not believed
_MAX_ORDER = 2.3

Pairs = Mapping[str, ValuePair]


@dataclass(frozen=True, kw_only=True)
class ComparedValue(VV20):
    """A simulated value held against the measured one.

    Attributes:
        measure: what was measured.
        probe: at which probe.
        unit: of the value and all uncertainties.
        u_simulated: standard uncertainty of the simulated value, from step and parameters.
        step_error: how the uncertainty from the step was found; ``None`` where it is unknown.
        budget: parameter -> its part of the uncertainty.
    """

    measure: str
    probe: str
    unit: str
    u_simulated: float
    step_error: str | None = None
    budget: Mapping[str, float] = field(default_factory=dict)


def compared_values(engine: Engine, number: int, one: Evaluated) -> Iterator[ComparedValue]:
    """Single values of both, with the three parts of their uncertainty (ASME V&V 20).

    Args:
        engine: what it gave.
        number: of the segment.
        one: the segment.
    """
    if not one.segment.observed:
        return
    runs = {
        variant: run
        for (i, variant), run in engine.runs.items()
        if i == number and variant in (BEST, DOUBLE, FOURFOLD, HALF)
    }
    # clocks that were aligned may put a sample past the end of one of them
    measured = overlap(as_trajectory(one.segment), *runs.values())
    pairs = {variant: _pairs(one, run, measured) for variant, run in runs.items()}
    u_data = _u_data(one, resampled(runs[BEST], measured), measured, pairs[BEST])
    truth = {} if one.truth is None else _pairs(one, one.truth, measured)
    shifted = {name: _pairs(one, run, measured) for name, run in one.shifted}
    for name, pair in pairs[BEST].items():
        by_step = {v: by_name[name].simulated for v, by_name in pairs.items() if name in by_name}
        u_num, how = _u_num(by_step, truth[name].simulated if name in truth else None)
        budget = None
        if name in truth:
            budget = {
                parameter: abs(moved[name].simulated - truth[name].simulated)
                for parameter, moved in shifted.items()
                if name in moved
            }
        u_input = None if budget is None else math.hypot(*budget.values())
        value = vv20(
            pair.simulated, pair.measured, u_num=u_num, u_input=u_input, u_data=u_data[name]
        )
        yield ComparedValue(
            measure=name,
            probe=pair.probe,
            unit=pair.unit,
            u_simulated=math.hypot(u_num or 0.0, u_input or 0.0),
            step_error=how,
            budget=budget or {},
            **vars(value),
        )


def _pairs(one: Evaluated, run: Trajectory, measured: Trajectory) -> Pairs:
    return value_pairs(one.scene, resampled(run, measured), measured, tuple(measured.signals))


def _u_num(by_step: Mapping[str, float], exact: float | None) -> tuple[float | None, str | None]:
    """Standard uncertainty from the step, and how it was found.

    Where the scenario has a reference, the engine's deviation from it is known; the step error is
    not less than that. An order above 2 is chance, since no engine has one.
    """
    simulated = by_step[BEST]
    least = 0.0 if exact is None else abs(simulated - exact)
    if DOUBLE in by_step:
        longer = [by_step[v] for v in (DOUBLE, FOURFOLD) if v in by_step]
        index = gci(simulated, *longer)
        if index.observed is not None and index.observed > _MAX_ORDER:
            index = gci(simulated, longer[0])
        return max(index.u_num, least), index.text
    if HALF in by_step:
        # the error of the longer one of two steps is that of the shorter one times their ratio
        index = gci(by_step[HALF], simulated)
        text = f"{index.text} A longer step than the scenario's cannot be run."
        return max(2 * index.u_num, least), text
    return (None, None) if exact is None else (least, "deviation from the reference")


def _u_data(
    one: Evaluated, best: Trajectory, measured: Trajectory, pairs: Pairs
) -> dict[str, float]:
    """What the uncertainty of the samples makes of a measured value.

    A part of a stated uncertainty is seen as noise from sample to sample; the rest is common to all
    samples of a record. Both are drawn anew, and so is a bias that noise makes (a path gets longer
    by it). Where the record itself scatters more, that counts instead.
    """
    generator = np.random.default_rng(0)
    drawn: dict[str, list[float]] = {name: [] for name in pairs}
    for _ in range(DRAWS):
        signals = {}
        for probe, signal in measured.signals.items():
            random, common = shares(one.segment.observed[probe])
            shift = generator.normal(0.0, common)
            signals[probe] = signal + shift + generator.normal(0.0, random, len(signal))
        noisy = Trajectory("measured", measured.time_s, signals)
        again = value_pairs(one.scene, best, noisy, tuple(signals))
        for name in pairs.keys() & again.keys():
            drawn[name].append(again[name].measured)
    return {name: max(_spread(drawn[name], pair.measured), pair.u) for name, pair in pairs.items()}


def _spread(drawn: Sequence[float], value: float) -> float:
    """Root mean square of what the draws make of a value, their bias included."""
    return rms(np.array(drawn) - value) if len(drawn) >= 2 else 0.0
