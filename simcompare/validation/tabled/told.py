"""What a table of results itself tells: a parameter of the closed form, and an offset."""

from __future__ import annotations

import math

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.results.records.tabled import Told
from simcompare.validation.tabled.experiments import column
from simcompare.validation.tabled.rows import Rows
from simcompare.validation.tabled.simulated import ClosedForm

#: part of a parameter that it is moved for its slope: more than what samples of a motion scatter
_STEP = 1e-4
#: experiments with which an offset is sought
_MIN_FOR_OFFSET = 4


def told(rows: Rows, form: ClosedForm) -> list[Told]:
    """A parameter by weighted least squares of the closed form; besides with an offset."""
    said = form.setting.file.table
    if said is None or said.tells is None or not form.exists or len(rows.found) < 2:
        return []
    name, offset = said.tells, said.offset
    made = [_fit(rows, form, name, "")]
    lengths = {one.set.get(offset) for one in rows.found} if offset else set()
    if offset and None not in lengths and len(lengths) >= _MIN_FOR_OFFSET:
        made.append(_fit(rows, form, name, offset))
    return [one for one in made if one is not None]


def _fit(rows: Rows, form: ClosedForm, name: str, offset: str) -> Told | None:
    """Weighted least squares; ``None`` where no value within the parameter's bounds fits."""
    from scipy import optimize

    bounds = form.setting.file.parameters[name]
    start = form.setting.values(rows.found[0].set)[name]
    room = float(column(rows.found, offset).min()) if offset else math.inf
    count = 1 + bool(offset)

    def residuals(x: Array) -> Array:
        return np.asarray((rows.measured - _model(rows, form, name, offset, x)) / rows.own)

    try:
        fit = optimize.least_squares(
            residuals,
            [start, 0.0][:count],
            bounds=([bounds.min, -0.9 * room][:count], [bounds.max, 0.9 * room][:count]),
            x_scale=[start, room][:count],
            diff_step=[_STEP] * count,
        )
    except (InputError, ValueError):  # a value that is none, or no bounds about the start
        return None
    if np.any(fit.active_mask):
        return None
    scatter = math.sqrt(2 * float(fit.cost) / max(len(rows.found) - count, 1))
    inverse = np.linalg.pinv(np.asarray(fit.jac))
    covariance = inverse @ inverse.T * (scatter**2 if rows.by_scatter else 1.0)
    own = np.diag(covariance)
    for other, change in rows.common.items():
        if other != name:
            shift = inverse @ (change / rows.own)
            covariance = covariance + np.outer(shift, shift)
    whole = np.diag(covariance)
    expanded = [rows.k(*pair) * math.sqrt(pair[1]) for pair in zip(own, whole, strict=True)]
    return Told(
        name, units.unit_of(name), float(fit.x[0]), float(expanded[0]), offset,
        float(fit.x[1]) if offset else None, float(expanded[1]) if offset else None, scatter,
    )  # fmt: skip


def _model(rows: Rows, form: ClosedForm, name: str, offset: str, x: Array) -> Array:
    """What the closed form gives in every experiment.

    Raises:
        InputError: no scene can be built, or it gives no value.
    """
    moved = [{**one.set, name: float(x[0])} for one in rows.found]
    for row in moved if offset else ():
        row[offset] += float(x[1])
    values = [made[rows.entry.name] for made in form.of(moved)]
    if any(value is None for value in values):
        raise InputError(rows.entry.name, ["cannot be measured"])
    return np.array(values, dtype=float)
