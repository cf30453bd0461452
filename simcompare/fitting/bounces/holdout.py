"""Drops that were not fitted, predicted: the only thing that validates a fit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.assisted_fit import AssistedFit
from simcompare.fitting.bounces.engine_fit import EngineFit
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.problem import usual
from simcompare.fitting.bounces.tuned_fit import TunedFit
from simcompare.fitting.bounces.unknowns import OF_A_DROP, OF_THE_RECORDING, SPEED, base
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_holdout import (
    EngineHoldout,
    HeldOutDrop,
    Holdout,
    JudgedHeight,
    PredictedHeight,
)
from simcompare.statistics.agreement import e_n


@dataclass(frozen=True)
class Prediction:
    """One held-out drop as the closed form predicts it.

    Attributes:
        drop: what was measured.
        predicted: the fit of its own height and release, everything else as it was fitted.
        again: the fit of its own restitution besides; ``None`` where none was fitted.
        row: what the record says of it.
    """

    drop: Impacts
    predicted: Fit
    again: Fit | None
    row: HeldOutDrop


def predict(best: Fit, held: Sequence[Impacts], fixed: Mapping[str, float]) -> list[Prediction]:
    """How well a closed form predicts drops that it has not seen.

    Height and release of a held-out drop are its own; with them alone fitted, and everything else
    as it was, its impacts are predicted. The restitution that the drop itself would give is held
    against the fitted one by E_n, and so is every rebound height against the predicted one.

    Args:
        best: the closed form that was fitted.
        held: drops that were not fitted.
        fixed: what was not fitted.
    """
    return [_closed(number, best, drop, fixed) for number, drop in enumerate(held, start=1)]


def of_engines(closed: Sequence[Prediction], engines: Sequence[EngineFit]) -> Holdout:
    """What was predicted, by the closed form and by every engine.

    Args:
        closed: predictions of the closed form.
        engines: the engines that were fitted.
    """
    rows = []
    for place, one in enumerate(closed):
        found: dict[str, EngineHoldout] = {}
        for engine in engines:
            if isinstance(engine, AssistedFit) and engine.fit is not None:
                found[engine.engine] = _assisted(engine, one)
            elif isinstance(engine, TunedFit) and engine.fit is not None:
                found[engine.engine] = _tuned(engine, place, one)
        rows.append(replace(one.row, engines=found))
    return Holdout(tuple(rows))


def _closed(number: int, best: Fit, drop: Impacts, fixed: Mapping[str, float]) -> Prediction:
    own = [n for n in best.problem.model.own if n != SPEED or SPEED not in fixed]
    kept = {
        base(n): float(v)
        for n, v in zip(best.names, best.values, strict=True)
        if base(n) not in OF_A_DROP and math.isfinite(v)
    }
    settled = {**fixed, **kept}
    alone = [n for n in usual([drop], best.problem.model) if n in OF_A_DROP and n not in fixed]
    predicted = fit(drop, best.model, unknowns=alone, fixed=settled, profiles=False)
    row = HeldOutDrop(
        number=number, source=drop.source, heights=_heights(best, drop, alone, settled, predicted),
        rms=dict(predicted.rms), chi2=predicted.chi2, count=predicted.count,
        drop_height_m=predicted.as_dict().get("drop_height_m"), unknowns=tuple(own),
        speeds_m_s=predicted.speeds_m_s,
    )  # fmt: skip
    if "restitution" not in best.names:  # it was not fitted: nothing but the prediction is judged
        return Prediction(drop, predicted, None, row)
    # what this drop says of the restitution by itself, everything else as fitted
    single = {n: v for n, v in settled.items() if n != "restitution"}
    names = ["restitution", *alone]
    again = fit(drop, best.model, unknowns=names, fixed=single, profiles=False)
    value, u = again.as_dict()["restitution"], float(again.u[again.names.index("restitution")])
    k = best.names.index("restitution")
    known, u_known = float(best.values[k]), float(best.u[k])
    u_both = math.hypot(u, _u_of_kept(best, drop, names, single, value))
    row = replace(
        row, restitution=value, u_restitution=u, fitted=known, u_fitted=u_known,
        u_difference=u_both, e_n=e_n(known, value, 2 * u_both, 0.0), speeds_m_s=again.speeds_m_s,
    )  # fmt: skip
    return Prediction(drop, predicted, again, row)


def _u_of_kept(
    best: Fit, drop: Impacts, names: list[str], single: Mapping[str, float], value: float
) -> float:
    """What all that was fitted before contributes to e_held - e_fitted, with its covariance.

    The fitted restitution enters with -1; every other unknown that was kept, such as an exponent or
    a terminal speed, by how far the restitution of the held-out drop follows it.
    """
    slopes = np.zeros(len(best.names))
    for k, name in enumerate(best.names):
        if base(name) in OF_A_DROP or not math.isfinite(best.values[k]) or not best.u[k] > 0:
            continue
        if name == "restitution":
            slopes[k] = -1.0
            continue
        step = 0.1 * float(best.u[k])
        moved = {**single, base(name): float(best.values[k]) + step}
        again = fit(drop, best.model, unknowns=names, fixed=moved, profiles=False)
        slopes[k] = (again.as_dict()["restitution"] - value) / step
    covariance = np.where(np.isfinite(best.covariance), best.covariance, 0.0)
    return math.sqrt(max(0.0, float(slopes @ covariance @ slopes)))


def _heights(
    best: Fit, drop: Impacts, alone: list[str], settled: Mapping[str, float], predicted: Fit
) -> tuple[JudgedHeight, ...]:
    """Measured and predicted rebound heights with their E_n.

    Where no heights were measured, they are those of the flights between impacts, g·T²/8, of the
    measurement and of the closed form alike.
    """
    numbers, measured, u = _measured_heights(drop, predicted)
    if not numbers:
        return ()
    central = _predicted_heights(drop, predicted, numbers)
    # the uncertainty of everything that was fitted before, through the heights that it predicts
    slopes = np.zeros((len(best.names), len(numbers)))
    # heights of flights go with gravity and clock, measured and predicted alike
    alike = (*OF_A_DROP, *(() if len(drop.heights_m) else OF_THE_RECORDING))
    for k, name in enumerate(best.names):
        if base(name) in alike or not math.isfinite(best.values[k]) or not best.u[k] > 0:
            continue
        step = 0.1 * float(best.u[k])
        moved = {**settled, base(name): float(best.values[k]) + step}
        again = fit(drop, best.model, unknowns=alone, fixed=moved, profiles=False)
        slopes[k] = (_predicted_heights(drop, again, numbers) - central) / step
    covariance = np.where(np.isfinite(best.covariance), best.covariance, 0.0)
    own = np.sqrt(np.maximum(np.einsum("kn,kl,ln->n", slopes, covariance, slopes), 0.0))
    found = []
    for n, *row in zip(numbers, measured, u, central, own, strict=True):
        m, u_m, p, u_p = map(float, row)
        stated = math.isfinite(u_m)
        found.append(
            JudgedHeight(
                number=n, measured=m, u_measured=u_m if stated else None, predicted=p,
                u_predicted=u_p, e_n=e_n(p, m, 2 * u_p, 2 * u_m) if stated else None,
            )
        )  # fmt: skip
    return tuple(found)


def _measured_heights(drop: Impacts, predicted: Fit) -> tuple[list[int], Array, Array]:
    """Numbers of the bounces whose height is known, the heights and their u [m]."""
    if len(drop.heights_m):
        kept = [k for k, number in enumerate(drop.height_numbers) if number > 0]
        numbers = [drop.height_numbers[k] for k in kept]
        return numbers, drop.heights_m[kept], drop.u_heights_m[kept]
    gravity, flights = _gravity(predicted), drop.flights
    lengths = flights.lengths_s
    u = (
        np.sqrt(np.diag(flights.covariance_s2))
        if flights.u_known
        else np.full(len(lengths), np.nan)
    )
    return flights.numbers.tolist(), gravity * lengths**2 / 8, gravity * lengths / 4 * u


def _predicted_heights(drop: Impacts, predicted: Fit, numbers: Sequence[int]) -> Array:
    values = predicted.problem.values(predicted.x, 0)
    shown = bounce_models.bounces(predicted.problem.model, values, max(numbers) + 1)
    at = np.array(numbers)
    if len(drop.heights_m):
        return np.asarray(np.ravel(shown.apex_m)[at], dtype=float)
    times = np.ravel(shown.impact_s)
    return np.asarray(_gravity(predicted) * (times[at] - times[at - 1]) ** 2 / 8)


def _gravity(one: Fit) -> float:
    return float(one.problem.fixed.get("gravity_m_s2", bounce_models.GRAVITY))


def _assisted(one: EngineFit, closed: Prediction) -> EngineHoldout:
    """The engine shows its effective restitution at every drop; that is held against this one's."""
    assert one.effective is not None
    value = one.effective[0]
    own = math.hypot(one.effective[1], one.misfit)
    u_held, score, held = closed.row.u_difference, None, None
    if closed.again is not None and u_held is not None:
        held = _mean_restitution(closed.again)
        # the engine was fitted to the same data: beside the closed form's only its own part counts
        score = e_n(value, held, 2 * own, 2 * u_held)
    return EngineHoldout(restitution=value, u=one.u_effective, held=held, u_held=u_held, e_n=score)


def _mean_restitution(one: Fit) -> float:
    """Mean over the impacts of the first drop."""
    values, count = one.problem.values(one.x, 0), one.problem.drops[0].count
    return float(bounce_models.bounces(one.problem.model, values, count).restitution.mean())


def _tuned(one: TunedFit, place: int, closed: Prediction) -> EngineHoldout:
    """The plain loop at the height of the held-out drop: its first bounce, and its heights."""
    deviation = one.held[place]
    value, phases = float(deviation.restitution[0]), math.sqrt(one.phases)
    # the mean over the phases, and over those in which the numbers were found
    own = math.hypot(math.sqrt(2) * float(deviation.u_restitution[0]) / phases, one.misfit)
    score = held = u_held = None
    if closed.again is not None:
        speed = closed.again.speeds_m_s[1]
        held, u_held = closed.again.restitution_at(speed)
        score = e_n(value, held, 2 * own, 2 * math.hypot(u_held, one.restitution[1]))
    return EngineHoldout(
        restitution=value, u=math.hypot(own, one.restitution[1]), held=held, u_held=u_held,
        e_n=score, heights=tuple(_engine_heights(one, place, closed)),
        late_s=tuple(deviation.late_s.tolist()), scatter_s=tuple(deviation.scatter_s.tolist()),
    )  # fmt: skip


def _engine_heights(one: TunedFit, place: int, closed: Prediction) -> Iterator[PredictedHeight]:
    """Rebound heights of a plain loop: those of the closed form, moved as the engine moves them."""
    deviation = one.held[place]
    # errors of several bounces add up
    each = math.sqrt(2 / one.phases) * deviation.u_restitution + one.misfit
    scatter = np.cumsum(each / deviation.restitution)
    values = closed.predicted.problem.values(closed.predicted.x, 0)
    shown = bounce_models.bounces(closed.predicted.problem.model, values, closed.drop.count)
    for row in closed.row.heights:
        k = row.number
        if k > len(deviation.restitution):
            break
        part = float(one.held_m[place][k]) / float(np.ravel(shown.apex_m)[k])
        predicted = row.predicted * part
        u = math.hypot(row.u_predicted * part, 2 * predicted * float(scatter[k - 1]))
        judged = None
        if row.u_measured is not None:
            judged = e_n(predicted, row.measured, 2 * u, 2 * row.u_measured)
        yield PredictedHeight(number=k, predicted=predicted, u_predicted=u, e_n=judged)
