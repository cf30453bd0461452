"""Values that are missing at samples that are there: a few are interpolated, most stay missing."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.clock.intervals import Indices, Mask
from simcompare.hardware.conditioning.units import quantity
from simcompare.hardware.conditioning.words import are
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import RawColumn, room
from simcompare.model.trajectory import Array

#: longest stretch that is interpolated
_MAX_FILLED = 3
#: good samples on either side by which it is
_SIDE = 2
#: error of such an interpolation, in standard deviations of the channel, from which on it is none
_ERROR = 0.1
#: share of single missing values that makes a channel unsound, positions apart
_MAX_MISSING = 0.05
#: longer stretches are outages (a covered marker, a sensor that was off), no scattered losses
_OUTAGE = 10


def check(work: Work) -> None:
    """Fills short gaps of smooth channels; says what stays missing."""
    for column in work.data:
        missing = np.isnan(column.values)
        if missing.any():
            _judge(work, column, missing)


def _judge(work: Work, column: RawColumn, missing: Mask) -> None:
    if missing.all():
        _empty(work, column)
        return
    inner = slice(int(np.argmin(missing)), len(missing) - int(np.argmin(missing[::-1])))
    there = int((~missing).sum())
    _say_edges(work, column, inner, len(missing))
    first, length = intervals.runs(missing[inner])
    first += inner.start
    if not len(first):
        return
    if len(first) > (there - 1) / 2:  # most values are followed by a hole
        work.info(
            "sparse_channel", f"has values at {there} of {len(missing)} samples only: it was"
            " sampled more slowly than the others. Nothing was put between", channel=column.name,
            after={"values": float(there)},
        )  # fmt: skip
        return
    scattered = int(length[length <= _OUTAGE].sum())
    seen = _is_position(column)
    if scattered > _MAX_MISSING * (inner.stop - inner.start) and not seen:
        share = 100 * scattered / (inner.stop - inner.start)
        samples = intervals.spread(first, length)
        _unsound(work, column, f"{scattered} values are missing here and there ({share:.1f} % of"
                 f" the samples, more than {100 * _MAX_MISSING:g} %)", samples)  # fmt: skip
        return
    filled = np.zeros(len(first), dtype=np.bool_)
    if not seen:
        filled = _fill(work, column, missing, first, length)
    still = intervals.spread(first[~filled], length[~filled])
    if len(still):
        outages = int((length[~filled] > _OUTAGE).sum())
        more = f" ({outages} times more than {_OUTAGE} in a row)" if outages else ""
        work.warn(
            "missing_values", f"{are(len(still), 'value')} missing{more}; they stay so",
            samples=still, channel=column.name, after={"missing": float(len(still))},
        )  # fmt: skip


def _is_position(column: RawColumn) -> bool:
    """Whether a column is a position: a camera that loses a body for some frames is sound."""
    return quantity.si_of(column.unit) == "m"


def _unsound(work: Work, column: RawColumn, what: str, samples: Indices) -> None:
    """Leaves a column out; one that the mapping wants is refused."""
    if work.wishes(column) is not None:
        work.fault(
            f"{what}; first at {work.place(int(samples[0]))}: the channel is not sound. Record"
            " again, or take the column out of the mapping file (missing_values)",
            sample=int(samples[0]), channel=column.name,
        )  # fmt: skip
        return
    work.unsound[column.name] = what
    work.warn(
        "missing_values", f"{what}: the channel is not sound, so it was left out",
        samples=samples, channel=column.name, after={"missing": float(len(samples))},
    )  # fmt: skip


def _empty(work: Work, column: RawColumn) -> None:
    if work.wishes(column) is not None:
        work.fault(
            "holds no values at all; name another column in the mapping file, or take this one out",
            channel=column.name,
        )
        return
    work.info("empty_channel", "holds no values at all", channel=column.name)


def _say_edges(work: Work, column: RawColumn, inner: slice, count: int) -> None:
    """A channel may begin later and end earlier than the log; that is no damage."""
    edges = np.concatenate((np.arange(inner.start), np.arange(inner.stop, count)))
    if not len(edges):
        return
    say = work.info if len(edges) <= max(2 * _MAX_FILLED, 0.01 * count) else work.warn
    say(
        "missing_at_ends", f"{are(len(edges), 'value')} missing before the first or after the"
        " last one; they stay so", samples=edges, channel=column.name,
        after={"missing": float(len(edges))},
    )  # fmt: skip


def _fill(work: Work, column: RawColumn, missing: Mask, first: Indices, length: Indices) -> Mask:
    """Interpolates where it is safe; tells which stretches."""
    filled = np.zeros(len(first), dtype=np.bool_)
    possible = np.flatnonzero(_between_good(work, column, missing, first, length))
    if not len(possible):
        return filled
    errors = {gap: _error(column, gap) for gap in range(1, _MAX_FILLED + 1)}
    worst, done = 0.0, []
    for at in possible.tolist():
        start, gap = int(first[at]), int(length[at])
        u, largest = errors[gap]
        step = abs(float(column.values[start + gap] - column.values[start - 1]))
        if u is None or step > largest:
            continue
        samples = np.arange(start, start + gap)
        column.values[samples] = _between(work.time_s, column.values, start, gap)
        _widen(column, samples, u)
        filled[at], worst = True, max(worst, u)
        done.append(samples)
    if done:
        samples = np.concatenate(done)
        work.repair(
            "interpolated", f"{are(len(samples), 'missing value')} put between good neighbours,"
            f" at most {_MAX_FILLED} in a row; the same done where values are known is wrong by"
            f" {worst:.3g} (rms)", samples=samples, channel=column.name,
            before={"missing": float(length.sum())},
            after={"missing": float(length[~filled].sum()), "u": worst},
        )  # fmt: skip
    return filled


def _between_good(
    work: Work, column: RawColumn, missing: Mask, first: Indices, length: Indices
) -> Mask:
    """Which stretches are short, with two good samples on either side and no gap of the clock."""
    good: Mask = (length <= _MAX_FILLED) & (first >= _SIDE)
    good &= first + length + _SIDE <= len(missing)
    bad = missing
    marked = work.saturated.get(column.name)
    if marked is not None:
        bad = missing | marked
    gaps = np.array(work.gaps, dtype=np.int64)
    for at in np.flatnonzero(good).tolist():
        start, stop = int(first[at]), int(first[at] + length[at])
        beside = bad[start - _SIDE : start].any() or bad[stop : stop + _SIDE].any()
        lost = np.searchsorted(gaps, start - _SIDE) < np.searchsorted(gaps, stop + _SIDE - 1)
        good[at] = not beside and not lost
    return good


def _error(column: RawColumn, gap: int) -> tuple[float | None, float]:
    """Error of interpolating so many samples where they are known, ``None`` where too large.

    Returns:
        The standard deviation of the error, and the largest usual step across such a stretch.
    """
    off: list[Array] = []
    across: list[Array] = []
    square, total, number = 0.0, 0.0, 0
    origin = float(column.values[np.argmax(np.isfinite(column.values))])
    for part in intervals.places(len(column.values)):
        values = np.asarray(column.values[part])
        count = len(values) - gap - 2 * _SIDE + 1
        if count < 1:
            continue
        at = np.arange(0, count, max(count // 2000, 1)) + _SIDE
        index = np.concatenate((np.arange(-_SIDE, 0), np.arange(gap, gap + _SIDE)))
        weights = _weights(index.astype(float), np.arange(gap, dtype=float))
        interpolated = values[at[:, None] + index] @ weights.T
        off.append((interpolated - values[at[:, None] + np.arange(gap)]).ravel())
        across.append(np.abs(values[at + gap] - values[at - 1]))
        finite = values[np.isfinite(values)] - origin
        square, total = square + float(finite @ finite), total + float(finite.sum())
        number += len(finite)
    wrong = np.concatenate(off) if off else np.empty(0)
    wrong, steps = wrong[np.isfinite(wrong)], np.concatenate(across) if across else np.empty(0)
    steps = steps[np.isfinite(steps)]
    if len(wrong) < 20 or not len(steps):
        return None, 0.0
    mean = total / number
    scatter = float(np.sqrt(max(square / number - mean * mean, 0.0)))
    u = float(np.sqrt(np.mean(wrong**2)))
    largest = float(np.quantile(steps, 0.99))
    return (u if u <= _ERROR * scatter or u == 0 else None), largest


def _between(time_s: Array, values: Array, start: int, gap: int) -> Array:
    """Cubic through two samples on either side."""
    index = np.concatenate((np.arange(start - _SIDE, start), start + gap + np.arange(_SIDE)))
    origin = float(time_s[start])
    weights = _weights(time_s[index] - origin, time_s[start : start + gap] - origin)
    return np.asarray(weights @ values[index])


def _weights(known: Array, wanted: Array) -> Array:
    """Weights of the values at ``known`` in the polynomial through them at ``wanted``."""
    rows = []
    for k in range(len(known)):
        others = np.delete(known, k)
        rows.append(np.prod((wanted[:, None] - others) / (known[k] - others), axis=1))
    return np.stack(rows, axis=1)


def _widen(column: RawColumn, samples: Indices, u: float) -> None:
    """What was interpolated is less sure than what was measured."""
    if column.added_u is None:
        column.added_u = room(len(column.values))
        column.added_u[:] = 0.0
    column.added_u[samples] = np.hypot(column.added_u[samples], u)
