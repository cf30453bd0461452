"""Drops that were not fitted, predicted: the only thing that validates a fit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from simcompare.fitting.engine_fit import EngineFit, whole_u
from simcompare.fitting.impacts import Impacts
from simcompare.fitting.likelihood import Fit, fit
from simcompare.fitting.problem import SPEED, base
from simcompare.validation.scores import e_n

#: unknowns that belong to one drop alone and are found in the held-out drop itself
_OWN = ("drop_height_m", "release_time_s", "floor_m")


def predict(
    best: Fit,
    start: Fit,
    engines: Sequence[EngineFit],
    held: Sequence[Impacts],
    fixed: Mapping[str, float],
) -> dict[str, Any]:
    """How well what was fitted predicts drops that it has not seen.

    Height and release of a held-out drop are its own; with them alone fitted, and everything else
    as it was, its impacts are predicted. The restitution that the drop itself would give is held
    against the fitted one by E_n.

    Args:
        best: the closed form that was fitted.
        start: the closed form with the contact that engines have.
        engines: the engines that were fitted.
        held: drops that were not fitted.
        fixed: what was not sought.

    Returns:
        Plain values: ``drops`` for the closed form, ``engines`` for each engine.
    """
    if not held:
        return {"drops": [], "text": "No drop was held out, so nothing was validated."}
    rows = []
    for number, drop in enumerate(held, start=1):
        rows.append({"number": number, "source": drop.source, **_closed(best, drop, fixed)})
    for one in engines:
        if one.fit is None:
            continue
        for row, drop in zip(rows, held, strict=True):
            own = row if start is best else _closed(start, drop, fixed)
            row.setdefault("engines", {})[one.engine] = _engine(one, own)
    judged = [row["e_n"] for row in rows if row["e_n"] is not None]
    good = sum(abs(value) <= 1 for value in judged)
    text = (
        f"{good} of {len(judged)} held-out drops agree with the fitted restitution within"
        " the noise level (|E_n| ≤ 1, k = 2)."
    )
    return {"drops": rows, "text": text}


def _closed(best: Fit, drop: Impacts, fixed: Mapping[str, float]) -> dict[str, Any]:
    own = [n for n in best.problem.model.own if n != SPEED or SPEED not in fixed]
    kept = {
        base(n): float(v)
        for n, v in zip(best.names, best.values, strict=True)
        if base(n) not in _OWN and math.isfinite(v)
    }
    usual = {**fixed, **kept}
    alone = [n for n in ("drop_height_m", "release_time_s") if n not in fixed]
    alone += ["floor_m"] if drop.track is not None else []
    predicted = fit(drop, best.model, unknowns=alone, fixed=usual, profiles=False)
    if "restitution" not in best.names:  # it was not sought: nothing but the prediction is judged
        return {"rms": dict(predicted.rms), "chi2": predicted.chi2, "count": predicted.count,
                "drop_height_m": predicted.as_dict().get("drop_height_m"), "restitution": None,
                "u_restitution": None, "fitted": None, "u_fitted": None, "e_n": None,
                "unknowns": own, "speeds_m_s": list(predicted.speeds_m_s)}  # fmt: skip
    # what this drop says of the restitution by itself, everything else as fitted
    single = {n: v for n, v in usual.items() if n != "restitution"}
    asked = ["restitution", *alone]
    again = fit(drop, best.model, unknowns=asked, fixed=single, profiles=False)
    value, u = again.as_dict()["restitution"], float(again.u[again.names.index("restitution")])
    k = best.names.index("restitution")
    known, u_known = float(best.values[k]), float(best.u[k])
    u_both = math.hypot(u, _u_of_kept(best, drop, asked, single, value))
    return {
        "rms": dict(predicted.rms),
        "chi2": predicted.chi2,
        "count": predicted.count,
        "drop_height_m": predicted.as_dict().get("drop_height_m"),
        "restitution": value,
        "u_restitution": u,
        "fitted": known,
        "u_fitted": u_known,
        "u_difference": u_both,
        "e_n": e_n(known, value, 2 * u_both, 0.0),
        "unknowns": own,
        "speeds_m_s": list(again.speeds_m_s),
    }


def _u_of_kept(
    best: Fit, drop: Impacts, asked: list[str], single: Mapping[str, float], value: float
) -> float:
    """What all that was fitted before contributes to e_held - e_fitted, with its covariance.

    The fitted restitution enters with -1; every other unknown that was kept, such as an exponent or
    a terminal speed, by how far the restitution of the held-out drop follows it.
    """
    slopes = np.zeros(len(best.names))
    for k, name in enumerate(best.names):
        if base(name) in _OWN or not math.isfinite(best.values[k]) or not best.u[k] > 0:
            continue
        if name == "restitution":
            slopes[k] = -1.0
            continue
        step = 0.1 * float(best.u[k])
        moved = {**single, base(name): float(best.values[k]) + step}
        again = fit(drop, best.model, unknowns=asked, fixed=moved, profiles=False)
        slopes[k] = (again.as_dict()["restitution"] - value) / step
    covariance = np.where(np.isfinite(best.covariance), best.covariance, 0.0)
    return math.sqrt(max(0.0, float(slopes @ covariance @ slopes)))


def _engine(one: EngineFit, row: Mapping[str, Any]) -> dict[str, Any]:
    """The engine shows its effective restitution at every drop; that is held against this one's."""
    assert one.effective is not None
    assert one.fit is not None
    value, whole = one.effective[0], whole_u(one)
    own = math.hypot(one.effective[1], one.u_num.get("restitution", 0.0))
    if row["restitution"] is None:
        return {"restitution": value, "u": whole, "e_n": None}
    return {
        "restitution": value,
        "u": whole,
        # the engine was fitted to the same data: beside the closed form's only its own part counts
        "e_n": e_n(value, row["restitution"], 2 * own, 2 * row["u_difference"]),
    }
