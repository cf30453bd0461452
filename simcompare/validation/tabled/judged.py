"""How far every source is from a table of results, and what the table itself tells."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.results.records.tabled import (
    AGREES,
    CLOSED_FORM,
    DISAGREES,
    OPEN,
    Point,
    TabledResult,
    Told,
    Verdict,
)
from simcompare.running.jobs import OK
from simcompare.statistics.budget import coverage_factor
from simcompare.validation.tabled.experiments import (
    SCATTER,
    Basis,
    Experiment,
    basis_of,
    column,
    u_of,
    varied,
)
from simcompare.validation.tabled.simulated import ClosedForm, EngineValues, Values
from simcompare.validation.tabled.vocabulary import Entry

#: residuals of experiments within the uncertainty, in units of u
_WITHIN = 2.0
#: a time is that of many where it is so many times as long, to this part
_MANY = 0.1
#: part of a parameter that it is moved for its slope: more than what samples of a motion scatter
_STEP = 1e-4
#: places at which the closed form is drawn
_DRAWN = 31
#: experiments with which an offset is sought
_MIN_FOR_OFFSET = 4


@dataclass(frozen=True)
class Rows:
    """All experiments in which a result was measured, as arrays.

    Attributes:
        entry: the result.
        found: the experiments.
        measured: means (n,).
        own: standard uncertainty of each alone: of the measurement and of what its row sets (n,).
        common: input that is the same in all rows -> change of the result by its u (n,).
        of_columns: the same of inputs that stand in a column.
        u_measured: of the measurement alone (n,).
        degrees_of_freedom: behind that.
        by_scatter: whether all rows together tell it.
    """

    entry: Entry
    found: Sequence[Experiment]
    measured: Array
    own: Array
    common: Mapping[str, Array]
    of_columns: Mapping[str, Array]
    u_measured: Array
    degrees_of_freedom: float
    by_scatter: bool

    @property
    def u_input(self) -> Array:
        """Of the simulated value by all inputs (n,)."""
        squares = self.own**2 - self.u_measured**2
        return np.sqrt(squares + sum((c**2 for c in self.common.values()), np.zeros(1)))

    def k(self, of_measurement: float, whole: float) -> float:
        """Coverage factor for 95 %, by the formula of Welch and Satterthwaite.

        Args:
            of_measurement: part of a variance that the scatter of measurements makes.
            whole: the variance.
        """
        degrees = self.degrees_of_freedom * (whole / of_measurement) ** 2
        return coverage_factor(degrees if of_measurement > 0 else math.inf)


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
    rows = _rows(entry, measured, basis, form, [closed[i] for i in places], values)
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
        tuple(verdicts), () if timed else tuple(_told(rows, form)), timed, _shares(rows),
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


# ---- uncertainties -----------------------------------------------------------------------------


def _rows(
    entry: Entry,
    found: Sequence[Experiment],
    basis: Basis,
    form: ClosedForm,
    closed: Sequence[Values],
    values: Mapping[str, Sequence[float | None]],
) -> Rows:
    measured = np.array([one.readings[entry.name].mean for one in found])
    degrees = basis.degrees_of_freedom
    if basis.kind == SCATTER:
        counts = np.array([len(one.readings[entry.name].values) for one in found])
        u = _about(measured, _standard(values), basis.least) / np.sqrt(counts)
        degrees = max(len(found) - 1, 1)
    else:
        u = np.array([u_of(one.readings[entry.name], basis) for one in found])
    common: dict[str, Array] = {}
    of_columns: dict[str, Array] = {}
    effects = [
        {} if before[entry.name] is None else form.effects(one, before)
        for one, before in zip(found, closed, strict=True)
    ]
    for name in dict.fromkeys(name for row in effects for name in row):
        change = np.array([row.get(name, {}).get(entry.name, 0.0) for row in effects])
        (of_columns if name in found[0].set else common)[name] = change
    own = np.sqrt(u**2 + sum((change**2 for change in of_columns.values()), np.zeros(1)))
    return Rows(
        entry, found, measured, own, common, of_columns, u, degrees, basis.kind == SCATTER
    )  # fmt: skip


def _standard(values: Mapping[str, Sequence[float | None]]) -> Array:
    """What the rows are held against to see their scatter: the closed form, else all engines."""
    rows = np.array([[math.nan if one is None else one for one in row] for row in values.values()])
    if CLOSED_FORM in values and np.isfinite(rows[0]).all():
        return np.asarray(rows[0])
    good = rows[np.isfinite(rows).all(axis=1)]
    return np.asarray(good.mean(axis=0)) if len(good) else np.full(rows.shape[1], math.nan)


def _about(measured: Array, standard: Array, least: float) -> float:
    """Scatter of the rows about a multiple of what they are held against."""
    if not np.isfinite(standard).all() or not (standard @ standard):
        return max(float(measured.std(ddof=1)), least)
    left = measured - standard * (standard @ measured) / (standard @ standard)
    return max(math.sqrt(float(left @ left) / max(len(left) - 1, 1)), least)


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


# ---- what the table tells ----------------------------------------------------------------------


def _told(rows: Rows, form: ClosedForm) -> list[Told]:
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
