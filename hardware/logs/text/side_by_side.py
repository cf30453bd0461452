"""Several runs beside each other in one table, each with its own time: a stream for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simcompare.hardware.logs.text import clocks
from simcompare.hardware.raw import RawColumn, RawLog, RawStream
from simcompare.model.recording import INFO, Repair


def blocks(columns: Sequence[RawColumn], times: Sequence[str]) -> list[list[RawColumn]]:
    """The columns of each run, its time first; nothing where the table is not made of runs.

    Args:
        columns: of the table, from left to right.
        times: names of those that may be the time.
    """
    starts = [i for i, column in enumerate(columns) if column.name in times]
    if len(starts) < 2 or starts[0] != 0:
        return []
    ends = [*starts[1:], len(columns)]
    made = [list(columns[start:end]) for start, end in zip(starts, ends, strict=True)]
    clock = {clocks.of_run(block[0].name)[1] for block in made}
    return made if len(clock) == 1 and min(map(len, made)) > 1 else []


def split(log: RawLog, times: Sequence[str]) -> None:
    """Makes a stream of each run, where the runs are named, or their times differ."""
    (stream,) = log.streams
    runs = blocks(stream.columns, times)
    told = [clocks.of_run(block[0].name)[0].strip("#()[] ") for block in runs]
    named = all(told) and not any(name.isdigit() for name in told)
    if not runs or (not named and _alike([block[0] for block in runs])):
        return
    names = [_slug(name) for name in told] if named else []
    if len(set(names)) < len(runs):
        names = [f"run_{number}" for number in range(1, len(runs) + 1)]
    log.streams = [_stream(stream, name, run) for name, run in zip(names, runs, strict=True)]
    text = f"{len(runs)} runs stand beside each other; each is a stream: {', '.join(names)}"
    log.repairs.append(Repair("side_by_side", INFO, text))


def _stream(whole: RawStream, name: str, columns: list[RawColumn]) -> RawStream:
    """One run, as far as it goes."""
    time = columns[0]
    time.unit = time.unit or clocks.unit_of_time(time.name)
    there = np.flatnonzero(np.isfinite(time.values))
    count = int(there[-1]) + 1 if len(there) else 0
    for column in columns:
        column.values = column.values[:count]
    rows = None if whole.rows is None else whole.rows[:count].copy()
    clock = replace(whole.clock, name=f"column {time.name}")
    return replace(whole, name=name, columns=columns, time=time.name, clock=clock, rows=rows)


def _alike(times: Sequence[RawColumn]) -> bool:
    return all(np.array_equal(one.values, times[0].values, equal_nan=True) for one in times)


def _slug(name: str) -> str:
    return "_".join(name.lower().replace("#", " ").split())
