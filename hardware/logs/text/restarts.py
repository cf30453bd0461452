"""A device whose clock begins anew within a log, as after a reset of its board: a stream each."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from simcompare.hardware.conditioning.clock import clock_wrap
from simcompare.hardware.raw import RawLog, RawStream
from simcompare.model.recording import REPAIR, Repair
from simcompare.model.trajectory import Array

#: rows that make a run, and steps of the clock within which it begins again at its start
_MIN_ROWS, _NEAR = 5, 20


def split(log: RawLog) -> None:
    """Makes a stream of each run, where the only stream of a log holds several."""
    if len(log.streams) == 1:
        log.streams, told = after_restarts(log.streams[0])
        log.repairs += told


def after_restarts(stream: RawStream) -> tuple[list[RawStream], list[Repair]]:
    """A stream for each run of a device whose clock begins anew, as after a reset of its board."""
    if stream.time is None:
        return [stream], []
    at = _restarts(stream.column(stream.time).values)
    if not len(at):
        return [stream], []
    bounds = [0, *(at + 1).tolist(), len(stream)]
    parts = [_part(stream, k + 1, a, b) for k, (a, b) in enumerate(pairwise(bounds))]
    rows = stream.rows if stream.rows is not None else np.arange(len(stream)) + stream.first_row
    lines = [int(rows[i]) for i in bounds[1:-1]]
    text = (
        f"{stream.time} begins anew {len(lines)} times, as after a reset of the device; a stream"
        f" for each run: {', '.join(part.name for part in parts)}"
    )
    return parts, [
        Repair("restart", REPAIR, text, rows=tuple((n, n) for n in lines), count=len(lines))
    ]


def _restarts(times: Array) -> np.ndarray:
    """Rows after which the time begins anew near its start; none where it does anything else."""
    steps = np.diff(times)
    back = np.flatnonzero(steps < 0)
    forward = steps[steps > 0]
    none = np.empty(0, dtype=np.int64)
    if not len(back) or not len(forward) or not np.isfinite(times).all():
        return none
    near = _NEAR * float(np.median(forward))
    lengths = np.diff([0, *(back + 1), len(times)])
    begins = (times[back + 1] >= 0) & (times[back + 1] <= near + max(0.0, float(times[0])))
    wrapped = clock_wrap.period(times) is not None
    return back if lengths.min() >= _MIN_ROWS and begins.all() and not wrapped else none


def _part(stream: RawStream, number: int, first: int, end: int) -> RawStream:
    rows = None if stream.rows is None else stream.rows[first:end]
    columns = [replace(column, values=column.values[first:end].copy(), u=_cut(column.u, first, end))
               for column in stream.columns]  # fmt: skip
    clock = stream.clock if number == 1 else replace(stream.clock, start="")
    return replace(
        stream, name=f"run_{number}", columns=columns, rows=rows, clock=clock,
        first_row=stream.first_row + (first if rows is None else 0),
        truncated=stream.truncated if end == len(stream) else "",
    )  # fmt: skip


def _cut(u: float | Array | None, first: int, end: int) -> float | Array | None:
    return u[first:end] if isinstance(u, np.ndarray) else u
