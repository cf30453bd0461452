"""A drop that was not fitted, as one law predicts it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.problem import usual
from simcompare.fitting.bounces.unknowns import OF_A_DROP, OF_THE_RECORDING, SPEED, base
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_holdout import HeldOutDrop, JudgedHeight
from simcompare.statistics.agreement import e_n


@dataclass(frozen=True)
class OfLaw:
    """One held-out drop as one law predicts it.

    Attributes:
        weight: of the law.
        predicted: the fit of its own height and release, everything else as it was fitted.
        again: the fit of its own restitution besides; ``None`` where none was fitted.
        row: what the record would say of it.
    """

    weight: float
    predicted: Fit
    again: Fit | None
    row: HeldOutDrop


def of_law(
    number: int, best: Fit, weight: float, drop: Impacts, fixed: Mapping[str, float]
) -> OfLaw:
    """One drop as one law predicts it.

    Args:
        number: of the drop, from 1.
        best: the law as it was fitted.
        weight: of the law.
        drop: what was measured.
        fixed: what was not fitted.
    """
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
        return OfLaw(weight, predicted, None, row)
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
    return OfLaw(weight, predicted, again, row)


def _u_of_kept(
    best: Fit, drop: Impacts, names: list[str], single: Mapping[str, float], value: float
) -> float:
    """What all that was fitted before contributes to e_held - e_fitted.

    The fitted restitution enters with -1; every other unknown that was kept, such as an exponent or
    a terminal speed, by how far the restitution of the held-out drop follows it.
    """

    def moved(name: str, step: float) -> Array:
        if name == "restitution":
            return np.array([-step])
        again = _fit_with(best, drop, names, single, name, step)
        return np.array([again.as_dict()["restitution"] - value])

    return float(_u_through(best, OF_A_DROP, moved, 1)[0])


def _fit_with(
    best: Fit, drop: Impacts, names: list[str], held: Mapping[str, float], name: str, step: float
) -> Fit:
    """A drop fitted with one of the unknowns that are held moved by a step."""
    value = float(best.values[best.names.index(name)])
    fixed = {**held, base(name): value + step}
    return fit(drop, best.model, unknowns=names, fixed=fixed, profiles=False)


def _u_through(
    best: Fit, apart: Sequence[str], moved: Callable[[str, float], Array], count: int
) -> Array:
    """Uncertainty (count,) of what moves with all that was fitted before, with its covariance."""
    slopes = np.zeros((len(best.names), count))
    for k, name in enumerate(best.names):
        if base(name) not in apart and math.isfinite(best.values[k]) and best.u[k] > 0:
            step = 0.1 * float(best.u[k])
            slopes[k] = moved(name, step) / step
    covariance = np.where(np.isfinite(best.covariance), best.covariance, 0.0)
    squares = np.einsum("kn,kl,ln->n", slopes, covariance, slopes)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


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
    # heights of flights go with gravity and clock, measured and predicted alike
    alike = (*OF_A_DROP, *(() if len(drop.heights_m) else OF_THE_RECORDING))

    def moved(name: str, step: float) -> Array:
        again = _fit_with(best, drop, alone, settled, name, step)
        return _predicted_heights(drop, again, numbers) - central

    own = _u_through(best, alike, moved, len(numbers))
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
    shown = predicted.problem.bounces(predicted.x, 0, max(numbers) + 1)
    at = np.array(numbers)
    if len(drop.heights_m):
        return np.asarray(np.ravel(shown.apex_m)[at], dtype=float)
    times = np.ravel(shown.impact_s)
    return np.asarray(_gravity(predicted) * (times[at] - times[at - 1]) ** 2 / 8)


def _gravity(one: Fit) -> float:
    return float(one.problem.fixed.get("gravity_m_s2", bounce_models.GRAVITY))
