"""How far every source is from a table of results, and what the table itself tells."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from simcompare.results.records.tabled import (
    AGREES,
    CLOSED_FORM,
    DISAGREES,
    OPEN,
    Point,
    TabledResult,
    Verdict,
)
from simcompare.running.jobs import OK
from simcompare.validation.tabled.experiments import (
    Experiment,
    basis_of,
    column,
    varied,
)
from simcompare.validation.tabled.rows import Rows, rows_of
from simcompare.validation.tabled.simulated import ClosedForm, EngineValues, Values
from simcompare.validation.tabled.told import told
from simcompare.validation.tabled.vocabulary import Entry

#: residuals of experiments within the uncertainty, in units of u
_WITHIN = 2.0
#: a time is that of many where it is so many times as long, to this part
_MANY = 0.1
#: places at which the closed form is drawn
_DRAWN = 31


def judged(
    entry: Entry,
    found: Sequence[Experiment],
    form: ClosedForm,
    closed: Sequence[Values],
    engines: Sequence[EngineValues],
) -> TabledResult:
    """One result of a table against all sources.

    Args:
        entry: the result.
        found: the experiments.
        form: the closed form.
        closed: what it gives for each experiment.
        engines: what engines give.
    """
    places = [i for i, one in enumerate(found) if entry.name in one.readings]
    measured = [found[i] for i in places]
    values = {CLOSED_FORM: [closed[i][entry.name] for i in places]} if form.exists else {}
    values |= {one.name: [one.values[i][entry.name] for i in places] for one in engines}
    basis = basis_of(measured, entry.name)
    rows = rows_of(entry, measured, basis, form, [closed[i] for i in places], values)
    known = not form.exists or all(value is None for value in values[CLOSED_FORM])
    points = [
        Point(
            one.lines,
            one.set,
            float(rows.measured[i]),
            len(one.readings[entry.name].values),
            float(rows.u_measured[i]),
            None if known else float(rows.u_input[i]),
            {name: row[i] for name, row in values.items()},
        )
        for i, one in enumerate(measured)
    ]
    verdicts = [_verdict(CLOSED_FORM, values[CLOSED_FORM], rows)] if form.exists else []
    for one in engines:
        made = _verdict(one.name, values[one.name], rows)
        verdicts.append(_with_status(made, one))
    timed = _timed(entry, verdicts)
    degrees = rows.degrees_of_freedom if math.isfinite(rows.degrees_of_freedom) else None
    return TabledResult(
        entry.name, entry.unit, varied(measured)[0], basis.kind, degrees, tuple(points),
        tuple(verdicts), () if timed else tuple(told(rows, form)), timed, _shares(rows),
        tuple(_curve(rows, form)),
    )  # fmt: skip


def _curve(rows: Rows, form: ClosedForm) -> Iterator[tuple[float, float]]:
    """The closed form between the lowest and the highest of what was set."""
    names = varied(rows.found)
    if len(names) > 1 or not form.exists:
        return
    set_to = column(rows.found, names[0])
    places = np.linspace(set_to.min(), set_to.max(), _DRAWN).tolist()
    for x, made in zip(
        places, form.of([{**rows.found[0].set, names[0]: x} for x in places]), strict=True
    ):
        y = made[rows.entry.name]
        if y is not None:
            yield x, y


def _shares(rows: Rows) -> dict[str, float]:
    """Input -> by what part of the result its u changes it, over all rows."""
    size = float(np.linalg.norm(rows.measured)) or 1.0
    return {
        name: float(np.linalg.norm(change)) / size
        for name, change in {**rows.of_columns, **rows.common}.items()
    }


def _with_status(made: Verdict, one: EngineValues) -> Verdict:
    return Verdict(**{**vars(made), "status": one.status, "reason": one.reason,
                      "version": one.version})  # fmt: skip


# ---- verdicts ----------------------------------------------------------------------------------


def _verdict(source: str, values: Sequence[float | None], rows: Rows) -> Verdict:
    """By the ratio of measured to simulated over all experiments, and by what it leaves."""
    known = np.array([value is not None for value in values])
    if not known.any():
        return Verdict(source)
    x = np.array([value for value in values if value is not None])
    y, own = rows.measured[known], rows.own[known]
    u = np.sqrt(own**2 + sum((c[known] ** 2 for c in rows.common.values()), np.zeros(1)))
    within = int((np.abs(y - x) <= _WITHIN * u).sum())
    weights = 1 / own**2
    size = float(weights @ x**2)
    if size == 0:
        return Verdict(source, points=len(x), within=within)
    ratio = float(weights @ (x * y)) / size
    shared = [float(weights @ (x * c[known])) / size for c in rows.common.values()]
    variance = 1 / size + sum(one * one for one in shared)
    scattered = float((weights * x * rows.u_measured[known] / size) @ (weights * x / size
                      * rows.u_measured[known]))  # fmt: skip
    expanded = rows.k(scattered, variance) * math.sqrt(variance)
    left = (y - ratio * x) / own
    degrees = max(len(x) - 1, 1)
    scatter = math.sqrt(float(left @ left) / degrees)
    agrees = abs(ratio - 1) <= expanded and _is_usual(scatter, degrees, rows.degrees_of_freedom)
    return Verdict(source, OK, None, None, AGREES if agrees else DISAGREES, len(x), within, ratio,
                   expanded, scatter)  # fmt: skip


def _is_usual(scatter: float, degrees: int, behind_u: float) -> bool:
    """Whether residuals are no larger than their u lets one expect in 99 of 100 tables."""
    from scipy import stats

    if math.isinf(behind_u):
        return scatter**2 * degrees <= float(stats.chi2.ppf(0.99, degrees))
    return scatter**2 <= float(stats.f.ppf(0.99, degrees, behind_u))


def _timed(entry: Entry, verdicts: Sequence[Verdict]) -> int | None:
    """How many were timed together, where the ratio says so and the heading did not."""
    ratios = [one.ratio for one in verdicts if one.ratio is not None and one.verdict != OPEN]
    if not entry.counted or not ratios:
        return None
    ratio = float(np.median(ratios))
    many = round(ratio)
    return many if many > 1 and abs(ratio / many - 1) < _MANY else None
