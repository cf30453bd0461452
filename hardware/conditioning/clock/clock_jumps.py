"""Clocks that were set while the log was written: the stamps jump, the signals do not."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals, sample_counter
from simcompare.hardware.conditioning.clock.intervals import Indices
from simcompare.hardware.conditioning.words import times
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import RawColumn
from simcompare.model.trajectory import Array

#: a step of so many medians may be a change of the clock
_FAR = 10.0
#: samples on either side by which it is judged whether a signal goes on
_WIDTH = 5
#: how often real pauses may look as continuous as the place in question
_CHANCE = 0.02
#: signals rest where they change less than this times this quantile of all their steps
_SLOW = (0.2, 1.5)
#: places with which a jump is compared
_COMPARED = 4000
#: faults that are named one by one
_NAMED = 5


def check(work: Work) -> None:
    """Joins the time again by the counter of the samples, or names the row of each jump."""
    time = work.time_s
    median = intervals.typical(time)
    back = intervals.where(time, lambda step: step < 0)
    far = intervals.where(time, lambda step: step > _FAR * median)
    # where long steps are usual, the log was written at events, not by a clock
    if len(far) > max(3, 0.01 * len(time)):
        far = far[:0]
    goes_on = _Continuity(work, np.union1d(back, far)) if len(far) else None
    far = np.array(
        [i for i in far.tolist() if goes_on and goes_on.at(i, (time[i + 1] - time[i]) / median)],
        dtype=np.int64,
    )
    jumps = np.union1d(back, far)
    if not len(jumps):
        return
    counter = sample_counter.column_of(work)
    if counter is None or not _joined(work, counter, jumps, median):
        _refuse(work, jumps, median)


def _joined(work: Work, counter: RawColumn, jumps: Indices, median: float) -> bool:
    """Shifts all stamps after each jump so that the counter and the time go together."""
    time = work.time_s
    went_on = sample_counter.increments(
        counter.values[jumps + 1] - counter.values[jumps], sample_counter.wrap_of(counter)
    )
    if not (np.isfinite(went_on) & (went_on >= 1) & (went_on <= 1e6)).all():
        return False
    were = time[jumps + 1] - time[jumps]
    _shift(time, jumps, went_on * median)
    # how far a step may be from the median is not known at the jump
    usual = intervals.sampled_steps(time)
    usual = usual[(usual > 0.5 * median) & (usual < 1.5 * median)]
    unsure = float(np.std(usual) * np.sqrt(went_on.sum())) if len(usual) else 0.0
    work.u_time_s = float(np.hypot(work.u_time_s, unsure))
    work.repair(
        "clock_jump",
        f"the clock was changed {times(len(jumps))} (by {_listed(were - went_on * median)}) while"
        f" the samples went on; later stamps were shifted by the counter {counter.name!r}",
        samples=jumps + 1,
        channel=work.stream.time or "",
        before={"largest_step_s": float(were[np.argmax(np.abs(were))])},
        after={"largest_step_s": float((went_on * median).max()), "u_time_s": work.u_time_s},
    )
    return True


def _shift(time: Array, jumps: Indices, steps: Array) -> None:
    """Moves each stretch after a jump so that it begins one given step after the one before."""
    starts = jumps + 1
    old = np.array(time[starts])
    new = np.empty(len(starts))
    moved = 0.0, 0.0  # where the stretch before began, and where it begins now
    for k, (jump, step) in enumerate(zip(jumps.tolist(), steps.tolist(), strict=True)):
        new[k] = (float(time[jump]) - moved[0]) + moved[1] + step
        moved = float(old[k]), float(new[k])
    segment = np.searchsorted(starts, np.arange(len(time)), side="right") - 1
    time[:] = np.where(segment < 0, time, (time - old[segment]) + new[segment])


def _refuse(work: Work, jumps: Indices, median: float) -> None:
    time = work.time_s
    rate = f"{1 / median:.6g}"
    for i in jumps[:_NAMED].tolist():
        step = float(time[i + 1] - time[i])
        if step < 0 and time[i + 1] <= time[0] + 2 * median:
            text = (
                f"the time begins anew here, at {work.start_s + time[i + 1]:.6g} s after"
                f" {work.start_s + time[i]:.6g} s: these are several logs in one file; split it"
            )
        else:
            how = f"goes back by {-step:.6g} s" if step < 0 else f"jumps ahead by {step:.6g} s"
            why = " while the signals go on without a break" if step > 0 else ""
            text = (
                f"the clock {how} from the {work.stream.row_word} before{why}; it was changed"
                " while the log was written, and no column counts the samples. Correct the stamps"
                " or, if the samples are evenly spaced, write into a mapping file (--map):"
                f" time: {{rate_Hz: {rate}}}"
            )
        work.fault(f"{text} (clock_jump)", sample=i + 1, channel=work.stream.time or "")
    if len(jumps) > _NAMED:
        more = jumps[_NAMED:]
        work.fault(f"the clock jumps at {intervals.shorten(more + 1, work)} as well (clock_jump)")


class _Continuity:
    """Whether the signals go on across a step of the clock as they do everywhere else.

    Lines through the samples before and after must meet, in value and in slope. How well they
    meet is compared with neighbouring samples, and with samples as far apart as the clock says: if
    these would meet as well, the signals (at rest, say) cannot tell, and the step is a pause.
    """

    def __init__(self, work: Work, steps: Indices) -> None:
        self._columns = [c for c in work.data if c.name != work.stream.counter]
        self._count = len(work.time_s)
        low, high = _WIDTH - 1, self._count - _WIDTH - 1
        places = np.unique(np.linspace(low, max(high, low), _COMPARED).astype(np.int64))
        self._steps = steps
        self._places = self._clear(places, 1)
        self._scales = [self._scale(column) for column in self._columns]
        self._usual = self._mismatch(self._places, self._places + 1)

    def at(self, i: int, medians: float) -> bool:
        """Whether a step from i to i+1, so many medians long, is a change of the clock."""
        if not _WIDTH - 1 <= i < self._count - _WIDTH or len(self._places) < 50:
            return False
        if self._rests(i):
            return False  # a sensor that writes on change is silent then
        here = float(self._mismatch(np.array([i]), np.array([i + 1]))[0])
        usual = self._usual[np.isfinite(self._usual)]
        if not len(usual) or not here <= 1.5 * np.quantile(usual, 0.99):
            return False
        apart = round(min(medians, self._count / 2))
        far = self._clear(self._places[self._places + apart < self._count - _WIDTH], apart)
        pauses = self._mismatch(far, far + apart)
        pauses = pauses[np.isfinite(pauses)]
        least = max(here, float(np.quantile(usual, 0.9)))
        return len(pauses) >= 50 and float(np.mean(pauses <= least)) < _CHANCE

    def _rests(self, i: int) -> bool:
        """Whether no signal moves at a place: a slow step into it, or one after it, of each."""
        for column in self._columns:
            steps = np.abs(column.values[self._places + 1] - column.values[self._places])
            if not np.isfinite(steps).any():
                continue
            slow = _SLOW[1] * float(np.nanquantile(steps, _SLOW[0]))
            here = np.abs(np.diff(column.values[i - 1 : i + 3]))
            if not (here[1] <= slow and min(here[0], here[2]) <= slow):
                return False
        return True

    def _clear(self, places: Indices, apart: int) -> Indices:
        """Places whose neighbourhoods hold no step of the clock."""
        clear = np.ones(len(places), dtype=np.bool_)
        for start, stop in ((-_WIDTH + 1, 1), (apart, apart + _WIDTH)):
            next_ = np.searchsorted(self._steps, places + start)
            later = np.append(self._steps, self._count * 2)[next_]
            clear &= later >= places + stop
        return places[clear & (places + apart < self._count - _WIDTH + 1)]

    def _scale(self, column: RawColumn) -> tuple[float, float]:
        value, slope = _meeting(column, self._places, self._places + 1)
        if not np.isfinite(value).any():
            return 0.0, 0.0
        return float(np.nanquantile(value, 0.9)), float(np.nanquantile(slope, 0.9))

    def _mismatch(self, i: Indices, j: Indices) -> Array:
        """How badly the signals meet, the worst of all channels (n,)."""
        worst = np.zeros(len(i))
        for column, scales in zip(self._columns, self._scales, strict=True):
            for distance, scale in zip(_meeting(column, i, j), scales, strict=True):
                if scale > 0:
                    worst = np.fmax(worst, distance / scale)
        return worst


def _meeting(column: RawColumn, i: Indices, j: Indices) -> tuple[Array, Array]:
    """Distances of value and slope between the line that ends at i and the one that begins at j."""
    at = np.arange(_WIDTH) - (_WIDTH - 1) / 2
    before = column.values[i[:, None] + np.arange(1 - _WIDTH, 1)]
    after = column.values[j[:, None] + np.arange(_WIDTH)]
    slopes = [block @ at / (at @ at) for block in (before, after)]
    half = _WIDTH / 2
    ends = before.mean(axis=1) + slopes[0] * half, after.mean(axis=1) - slopes[1] * half
    return np.abs(ends[1] - ends[0]), np.abs(slopes[1] - slopes[0])


def _listed(steps: Array) -> str:
    listed = ", ".join(f"{step:+.6g} s" for step in steps[:3])
    return listed + (", …" if len(steps) > 3 else "")
