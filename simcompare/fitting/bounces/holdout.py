"""Drops that were not fitted, predicted: the only thing that validates a fit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare.fitting.bounces.assisted_fit import AssistedFit
from simcompare.fitting.bounces.averaging import Averaged
from simcompare.fitting.bounces.engine_fit import EngineFit, TunedFit
from simcompare.fitting.bounces.held_out_law import OfLaw, of_law
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import Fit
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
    """One held-out drop as all laws together predict it.

    Attributes:
        drop: what was measured.
        laws: each law, that of the greatest weight first.
        row: what the record says of it.
    """

    drop: Impacts
    laws: tuple[OfLaw, ...]
    row: HeldOutDrop

    @property
    def predicted(self) -> Fit:
        """The drop as the law with the greatest weight predicts it."""
        return self.laws[0].predicted

    @property
    def again(self) -> list[tuple[float, Fit]]:
        """Each law fitted to the drop alone, with its weight; empty where none was."""
        return [(one.weight, one.again) for one in self.laws if one.again is not None]

    def apex_m(self) -> Array:
        """Heights of its apexes, the drop height first [m]."""
        count = self.drop.count
        fits = [one.predicted for one in self.laws]
        shown = [one.problem.bounces(one.x, 0, count).apex_m for one in fits]
        return np.asarray(sum(
            one.weight * np.ravel(apexes) for one, apexes in zip(self.laws, shown, strict=True)
        ))  # fmt: skip


def predict(
    laws: Averaged, held: Sequence[Impacts], fixed: Mapping[str, float]
) -> list[Prediction]:
    """How well closed forms predict drops that they have not seen.

    Height and release of a held-out drop are its own; with them alone fitted, and everything else
    as it was, its impacts are predicted. The restitution that the drop itself would give is held
    against the fitted one by E_n, and so is every rebound height against the predicted one. Each
    law predicts; what is told has the mean and the standard deviation of their mixture.

    Args:
        laws: what was fitted, each closed form by its weight.
        held: drops that were not fitted.
        fixed: what was not fitted.
    """
    found = []
    for number, drop in enumerate(held, start=1):
        own = tuple(of_law(number, one.fit, one.weight, drop, fixed) for one in laws.shares)
        found.append(Prediction(drop, own, _mixed_row(own)))
    return found


def _mixed_row(own: Sequence[OfLaw]) -> HeldOutDrop:
    """What all laws say of a drop."""
    first = own[0].row
    if len(own) == 1:
        return first
    heights = zip(*(one.row.heights for one in own), strict=True)
    row = replace(first, heights=tuple(_mixed_height(own, same) for same in heights))
    if first.restitution is None:
        return row
    value, u = _mixed(own, [(one.row.restitution, one.row.u_restitution) for one in own])
    fitted, u_fitted = _mixed(own, [(one.row.fitted, one.row.u_fitted) for one in own])
    # of the difference, law by law: what moves both alike is no part of it
    apart = [(_less(one.row.fitted, one.row.restitution), one.row.u_difference) for one in own]
    off, u_both = _mixed(own, apart)
    return replace(
        row, restitution=value, u_restitution=u, fitted=fitted, u_fitted=u_fitted,
        u_difference=u_both, e_n=e_n(off, 0.0, 2 * u_both, 0.0),
    )  # fmt: skip


def _less(one: float | None, other: float | None) -> float | None:
    return None if one is None or other is None else one - other


def _mixed_height(own: Sequence[OfLaw], same: Sequence[JudgedHeight]) -> JudgedHeight:
    first = same[0]
    p, u_p = _mixed(own, [(one.predicted, one.u_predicted) for one in same])
    u = first.u_measured
    judged = None if u is None else e_n(p, first.measured, 2 * u_p, 2 * u)
    return replace(first, predicted=p, u_predicted=u_p, e_n=judged)


def _mixed(
    own: Sequence[OfLaw], rows: Sequence[tuple[float | None, float | None]]
) -> tuple[float, float]:
    """Mean and standard deviation of a mixture of laws, each with its own."""
    return mixed([(one.weight, *row) for one, row in zip(own, rows, strict=True)])


def mixed(rows: Sequence[tuple[float, float | None, float | None]]) -> tuple[float, float]:
    """Mean and standard deviation of a mixture of (weight, mean, standard deviation)."""
    table = np.array(rows, dtype=float)
    weight, mean, u = table[:, 0] / table[:, 0].sum(), table[:, 1], table[:, 2]
    whole = float(weight @ mean)
    return whole, math.sqrt(float(weight @ (u**2 + (mean - whole) ** 2)))


def of_engines(closed: Sequence[Prediction], engines: Sequence[EngineFit]) -> Holdout:
    """What was predicted, by the closed form and by every engine.

    Args:
        closed: predictions of the closed forms.
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


def _assisted(one: EngineFit, closed: Prediction) -> EngineHoldout:
    """The engine shows its effective restitution at every drop; that is held against this one's."""
    assert one.effective is not None
    value = one.effective[0]
    own = math.hypot(one.effective[1], one.misfit)
    u_held, score, held = closed.row.u_difference, None, None
    if closed.again and u_held is not None:
        held = sum(weight * _mean_restitution(again) for weight, again in closed.again)
        # the engine was fitted to the same data: beside the closed form's only its own part counts
        score = e_n(value, held, 2 * own, 2 * u_held)
    return EngineHoldout(restitution=value, u=one.u_effective, held=held, u_held=u_held, e_n=score)


def _mean_restitution(one: Fit) -> float:
    """Mean over the impacts of the first drop."""
    return float(one.problem.bounces(one.x, 0, one.problem.drops[0].count).restitution.mean())


def _tuned(one: TunedFit, place: int, closed: Prediction) -> EngineHoldout:
    """The plain loop at the height of the held-out drop: its first bounce, and its heights."""
    deviation = one.held[place]
    value, phases = float(deviation.restitution[0]), math.sqrt(one.phases)
    # the mean over the phases, and over those in which the numbers were found
    own = math.hypot(math.sqrt(2) * float(deviation.u_restitution[0]) / phases, one.misfit)
    score = held = u_held = None
    if closed.again:
        speed = closed.again[0][1].speeds_m_s[1]
        held, u_held = mixed([(w, *again.restitution_at(speed)) for w, again in closed.again])
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
    apexes = closed.apex_m()
    for row in closed.row.heights:
        k = row.number
        if k > len(deviation.restitution):
            break
        part = float(one.held_m[place][k]) / float(apexes[k])
        predicted = row.predicted * part
        u = math.hypot(row.u_predicted * part, 2 * predicted * float(scatter[k - 1]))
        judged = None
        if row.u_measured is not None:
            judged = e_n(predicted, row.measured, 2 * u, 2 * row.u_measured)
        yield PredictedHeight(number=k, predicted=predicted, u_predicted=u, e_n=judged)
