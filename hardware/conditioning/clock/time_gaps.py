"""Samples that are missing between others."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals, sample_counter
from simcompare.hardware.conditioning.clock.intervals import Indices
from simcompare.hardware.conditioning.words import amount
from simcompare.hardware.conditioning.work import Work
from simcompare.model.trajectory import Array

#: a step of so many medians is too long
_LONG = 1.5
#: neighbouring steps that tell how long a step is there, on either side
_AROUND = 6
#: where these are longer than the median by so much, the rate was another one there
_SLOWER = 1.25
#: from this share of long steps on it matters whether they are multiples of the median
_MANY = 0.02
#: a longer step, in medians, is a pause between two parts of a log, no loss of samples
_PAUSE = 50.0
#: a log that loses more than this is told so
_MAX_MISSING = 0.05
#: steps below this are short, in medians; from this share of them on the clock has several speeds
_SHORT, _SEVERAL_SPEEDS = 0.75, 0.05
#: so many steps of one length are no accident
_OFTEN = 10
#: fewer stamps say nothing about what is usual
_MIN_SAMPLES = 10


def check(work: Work) -> None:
    """Marks gaps, by the counter of the samples where there is one, else by the clock."""
    if len(work.time_s) < _MIN_SAMPLES or (
        work.stream.time is None and work.stream.increment_s is not None
        and sample_counter.column_of(work) is None
    ):  # fmt: skip
        return
    median = intervals.typical(work.time_s)
    counted = _by_counter(work, median)
    if counted is None:
        _by_clock(work, median)


def _by_counter(work: Work, median: float) -> bool | None:
    """Gaps where the counter skips numbers; ``None`` where nothing counts the samples."""
    counter = sample_counter.column_of(work)
    if counter is None:
        return None
    wrap = sample_counter.wrap_of(counter)
    gaps = intervals.where(
        counter.values, lambda step: np.isfinite(step) & (sample_counter.increments(step, wrap) > 1)
    )
    steps = counter.values[gaps + 1] - counter.values[gaps]
    lost = sample_counter.increments(steps, wrap) - 1
    if len(gaps) and work.stream.time is None:
        later = np.zeros(len(work.time_s))
        later[gaps + 1] = lost
        work.time_s += np.cumsum(later) * (work.stream.increment_s or 0.0)
    if len(gaps):
        what = f"the counter {counter.name!r} skips"
        _mark(work, gaps, lost, what, "sequence_gap", counter.name)
    late = np.setdiff1d(intervals.where(work.time_s, lambda s: s > _LONG * median), gaps)
    if len(late):
        _say_late(work, late, median, f"the counter {counter.name!r} skips none there")
    return True


def _by_clock(work: Work, median: float) -> None:
    long, length, short = _long_steps(work.time_s, median, work.resolution_s)
    if not len(long):
        return
    spread = _spread(work.time_s, median)
    is_multiple = np.abs(length - np.round(length)) <= np.clip(3 * spread, 0.1, 0.25)
    missing = np.maximum(np.round(length) - 1, 0)
    loses = missing[length <= _PAUSE].sum() / (len(work.time_s) + missing[length <= _PAUSE].sum())
    many = len(long) + short > _MANY * len(work.time_s)
    if many and (np.mean(is_multiple) < 0.6 or loses > 0.5):
        _irregular(work, long, "and no multiples of it")
        return
    if loses > _MAX_MISSING and _several_speeds(work.time_s, median, length):
        _irregular(work, long, "as a device does that writes when it likes: its clock has several"
                   " speeds, and nothing says that samples are lost")  # fmt: skip
        return
    gap = is_multiple | (length >= 2)
    if gap.any():
        what = f"steps of the time are longer than {_LONG:g} times the median ({median:.6g} s)"
        _mark(work, long[gap], np.maximum(missing[gap], 1), what, "time_gap", "")
    if not gap.all():
        _say_late(work, long[~gap], median, "no whole sample is missing")


def _several_speeds(time_s: Array, median: float, length: Array) -> bool:
    """Whether steps are of several lengths by choice, and not longer where samples are lost.

    Losses make no step shorter, and longer steps are rarer the longer they are.
    """
    steps = intervals.sampled_steps(time_s)
    if np.mean((steps > 0) & (steps < _SHORT * median)) > _SEVERAL_SPEEDS:
        return True
    counts = np.bincount(np.round(length[length < _PAUSE]).astype(int), minlength=4)[2:]
    return bool(((counts[1:] > _OFTEN) & (counts[1:] > 2 * counts[:-1])).any())


def _long_steps(
    time_s: Array, median: float, resolution_s: float = 0.0
) -> tuple[Indices, Array, int]:
    """Steps that are long also against their neighbours, their length in medians.

    Returns:
        Indices, lengths, and how many more steps are long because all are at that place.
    """
    steps = np.diff(time_s)
    # stamps that are rounded say no more of a step than their own
    long = np.flatnonzero(steps > max(_LONG * median, median + 1.01 * resolution_s))
    around = long[:, None] + np.delete(np.arange(-_AROUND, _AROUND + 1), _AROUND)
    inside = (around >= 0) & (around < len(steps))
    near = np.where(inside, steps[np.clip(around, 0, len(steps) - 1)], np.nan)
    local = np.nanmedian(near, axis=1)
    is_long = steps[long] > _LONG * local
    # where the rate changes, what is usual there counts
    usual = np.where(local > _SLOWER * median, local, _period(time_s, median))
    lengths = steps[long] / usual
    return long[is_long], lengths[is_long], int((~is_long).sum())


def _period(time_s: Array, median: float) -> float:
    """Mean of the steps that are not long: of many, it is surer than the median."""
    steps = intervals.sampled_steps(time_s)
    usual = steps[(steps > median / _LONG) & (steps < _LONG * median)]
    return float(np.mean(usual)) if len(usual) else median


def _spread(time_s: Array, median: float) -> float:
    """Usual deviation of a step from the median, in medians."""
    steps = intervals.sampled_steps(time_s) / median
    return float(1.4826 * np.median(np.abs(steps - 1)))


def _mark(work: Work, gaps: Indices, lost: Array, what: str, rule: str, channel: str) -> None:
    time = work.time_s
    lasts = time[gaps + 1] - time[gaps]
    median = intervals.typical(time)
    short = lasts <= _PAUSE * median
    share = float(lost[short].sum() / (len(time) + lost[short].sum()))
    missing = int(lost.sum())
    text = (
        f"{what}: {amount(len(gaps), 'gap')}, about {amount(missing, 'sample')} not there (lost, or"
        f" never taken), the longest gap lasts {lasts.max():.6g} s"
    )
    if share > _MAX_MISSING:
        text += f". That is {100 * share:.1f} % of the samples; the stamps are taken as they are"
    work.gaps = sorted({*work.gaps, *gaps.tolist()})
    work.warn(
        rule, f"{text}; nothing was put there", samples=gaps + 1, channel=channel,
        before={"median_dt_s": median},
        after={"missing": float(missing), "longest_s": float(lasts.max())},
    )  # fmt: skip


def _irregular(work: Work, long: Indices, why: str) -> None:
    """A clock without a usual step: only what is long against all others is a gap."""
    usual = float(np.quantile(intervals.sampled_steps(work.time_s), 0.98))
    work.info(
        "irregular_clock", f"the samples are not evenly spaced ({len(long)} steps are longer than"
        f" {_LONG:g} times the median, {why}); the stamps are taken as they are",
        after={"median_dt_s": intervals.typical(work.time_s), "98_percent_dt_s": usual},
    )  # fmt: skip
    steps = work.time_s[long + 1] - work.time_s[long]
    gaps = long[steps > 2 * usual]
    if len(gaps):
        work.gaps = sorted({*work.gaps, *gaps.tolist()})
        work.warn(
            "time_gap", f"{amount(len(gaps), 'step')} of the time longer than twice what 98 % of"
            f" all steps keep to ({usual:.6g} s); nothing was put there", samples=gaps + 1,
        )  # fmt: skip


def _say_late(work: Work, late: Indices, median: float, why: str) -> None:
    steps = work.time_s[late + 1] - work.time_s[late]
    work.info(
        "late_sample", f"{amount(len(late), 'sample')} late, up to {steps.max():.6g} s after the"
        f" one before where {median:.6g} s is usual; {why}, and the stamps are taken as they are",
        samples=late + 1, after={"longest_s": float(steps.max())},
    )  # fmt: skip
