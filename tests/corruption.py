"""Clean synthetic logs, and each defect of a log made on purpose, with the rows it stands in.

``clean()`` makes a stream as an importer would; each function of ``DEFECTS`` spoils a copy of it
and tells what must be found: which rule, in which rows of the log, in which column, and whether
the log can be repaired at all.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.mapping import NOTHING, of_tree
from simcompare.hardware.raw import RawColumn, RawLog, RawStream
from simcompare.model.recording import Provenance, Repair

#: the first sample stands in this line: a header of three lines is above
FIRST_ROW = 4
RATE_HZ = 100.0
#: period of the channel "sine" [s]
PERIOD_S = 1.3


@dataclass
class Damaged:
    """A spoilt log and what must be said of it.

    Attributes:
        stream: the log.
        rule: that must be recorded, or named in the fault.
        rows: of the log, that the record or the fault names.
        severity: "repair", "warning", or "fault" where nothing can be done.
        channel: raw name, where the defect is one of a column.
        mapping: that is needed for it.
        truth: the log before, whose values repaired ones are compared with.
        lost: samples (counted from 0, in ``truth``) that are no longer there.
        tells: a rule that says something as well, without being a defect of its own.
    """

    stream: RawStream
    rule: str
    rows: list[int]
    severity: str
    channel: str = ""
    mapping: object = NOTHING
    truth: RawStream | None = None
    lost: list[int] = field(default_factory=list)
    tells: tuple[str, ...] = ()


def about(mode: str = "repair") -> Provenance:
    """The provenance of a log that is no file."""
    return Provenance("test.csv", "0" * 64, 0, "test", "0", mode)


def conditioned(stream: RawStream, mode: str = "repair", mapping=NOTHING, **more):
    """The recording that a stream becomes."""
    return condition(RawLog([copy(stream)]), mapping, about(mode), **more)


def found(recording, rule: str) -> list[Repair]:
    """Everything that was recorded under a rule."""
    return [repair for repair in recording.provenance.repairs if repair.rule == rule]


def rows_of(repair: Repair) -> list[int]:
    """Rows of a record, one by one."""
    return [row for first, last in repair.rows for row in range(first, last + 1)]


def defects_in(recording) -> list[str]:
    """Rules that were recorded as defects, information left out."""
    return [repair.rule for repair in recording.provenance.repairs if repair.severity != "info"]


def copy(stream: RawStream) -> RawStream:
    """A stream that may be spoilt."""
    columns = [
        replace(
            c, values=np.array(c.values), u=np.array(c.u) if isinstance(c.u, np.ndarray) else c.u
        )
        for c in stream.columns
    ]
    rows = None if stream.rows is None else np.array(stream.rows)
    return replace(stream, columns=columns, rows=rows)


def clean(count=2000, seed=1, noise=0.002, jitter=0.02):
    """A good log: a clock with a little jitter, a sine, a slope, a walk and an amplitude."""
    chance = np.random.default_rng(seed)
    ideal = np.arange(count) / RATE_HZ
    late = chance.normal(0, jitter / RATE_HZ, count)
    late[0] = 0.0
    time = ideal + late
    return of_columns(
        time,
        sine=np.sin(2 * np.pi * time / PERIOD_S) + chance.normal(0, noise, count),
        slope=0.5 + 0.3 * time + chance.normal(0, noise, count),
        walk=np.cumsum(chance.normal(0, 0.1, count)),
        amplitude=2.0 + 0.5 * np.sin(0.7 * time) + chance.normal(0, noise, count),
    )


def of_columns(time, unit="s", **columns):
    """A stream of a column of times and others, all in volts."""
    made = [RawColumn("t", np.array(time, dtype=float), unit)]
    made += [RawColumn(name, np.array(v, dtype=float), "V") for name, v in columns.items()]
    return RawStream("log", made, time="t", first_row=FIRST_ROW)


def counted(count=2000, **more):
    """A good log with a column that counts the packets, from 1000 on."""
    stream = clean(count, **more)
    stream.columns.append(RawColumn("packet", 1000.0 + np.arange(count), "1"))
    stream.counter = "packet"
    return stream


def row(sample) -> int:
    """Row of the log in which a sample of a clean log stands."""
    return int(sample) + FIRST_ROW


def rows(samples) -> list[int]:
    return [row(sample) for sample in samples]


def without(stream: RawStream, samples) -> RawStream:
    """A stream in which samples were never logged."""
    kept = np.ones(len(stream), dtype=bool)
    kept[np.asarray(samples, dtype=int)] = False
    for column in stream.columns:
        column.values = column.values[kept]
    return stream


def taken(stream: RawStream, order) -> RawStream:
    """A stream with its rows in another order, or some of them twice."""
    for column in stream.columns:
        column.values = column.values[np.asarray(order)]
    return stream


def values(stream: RawStream, name: str):
    return stream.column(name).values


# --- defects of the clock -------------------------------------------------------------------------


def gap() -> Damaged:
    """Seven samples were never logged: two single ones and five in a row."""
    lost = [100, 700, *range(1200, 1205)]
    # a sample after a gap, in rows of the log, which hold no lost samples
    after = rows([100, 699, 1198])
    truth = clean()
    return Damaged(without(clean(), lost), "time_gap", after, "warning", truth=truth, lost=lost)


def many_gaps() -> Damaged:
    """Every twelfth sample was lost."""
    lost = list(range(12, 1990, 12))
    after = rows([sample - k for k, sample in enumerate(lost)])
    return Damaged(without(clean(), lost), "time_gap", after, "warning", truth=clean(), lost=lost)


def stale_first_row() -> Damaged:
    """The first row is one of the run before."""
    damaged, truth = clean(), clean()
    values(damaged, "t")[0] = 2317.0
    return Damaged(damaged, "stale_first_row", [row(0)], "repair", "t", truth=truth, lost=[0])


def sequence_gap() -> Damaged:
    """Three packets were lost, as their counter says."""
    lost = [300, 301, 900]
    return Damaged(
        without(counted(), lost), "sequence_gap", rows([300, 898]), "warning", "packet",
        truth=counted(), lost=lost,
    )  # fmt: skip


def duplicate_row() -> Damaged:
    """Rows that were sent twice."""
    order = np.sort(np.concatenate((np.arange(2000), [50, 800, 1999])))
    # the copies come one, two and three rows later than in the clean log
    return Damaged(
        taken(clean(), order), "duplicate_row", [row(51), row(802), row(2002)], "repair",
        truth=clean(),
    )  # fmt: skip


def duplicate_time() -> Damaged:
    """Two different samples with one stamp."""
    stream = taken(clean(), np.sort(np.append(np.arange(2000), 499)))
    for column in stream.columns[1:]:
        column.values[500] += 1.0
    return Damaged(stream, "duplicate_time", [row(500)], "repair", "t", truth=clean())


def late_row() -> Damaged:
    """A row arrived three rows late, and one a row late."""
    order = list(range(2000))
    order.insert(403, order.pop(400))
    order.insert(1001, order.pop(1000))
    return Damaged(taken(clean(), order), "time_order", rows([403, 1001]), "repair", truth=clean())


def wrong_stamp() -> Damaged:
    """A single stamp is nonsense."""
    stream = clean()
    values(stream, "t")[640] = 3.0
    values(stream, "t")[1500] = 99.0
    return Damaged(stream, "time_outlier", rows([640, 1500]), "repair", "t", truth=clean())


def missing_stamp() -> Damaged:
    """Two stamps are missing, the values are there."""
    stream = clean()
    values(stream, "t")[[77, 1300]] = np.nan
    return Damaged(stream, "time_missing", rows([77, 1300]), "repair", "t", truth=clean())


def clock_back() -> Damaged:
    """The clock was set back by 0.7 s."""
    stream = clean()
    values(stream, "t")[1100:] -= 0.7
    return Damaged(stream, "clock_jump", [row(1100)], "fault", "t")


def clock_ahead() -> Damaged:
    """The clock was set ahead by 0.9 s; the signals go on."""
    stream = clean()
    values(stream, "t")[1100:] += 0.9
    return Damaged(stream, "clock_jump", [row(1100)], "fault", "t")


def clock_back_with_counter() -> Damaged:
    """The clock was set back, but the packets were counted."""
    stream = counted()
    values(stream, "t")[1100:] -= 0.7
    return Damaged(stream, "clock_jump", [row(1100)], "repair", "t", truth=counted())


def clock_ahead_with_counter() -> Damaged:
    """The clock was set ahead, but the packets were counted."""
    stream = counted()
    values(stream, "t")[1100:] += 0.9
    return Damaged(stream, "clock_jump", [row(1100)], "repair", "t", truth=counted())


def two_logs() -> Damaged:
    """The log begins anew in the middle."""
    stream = clean()
    values(stream, "t")[900:] -= values(stream, "t")[900]
    return Damaged(stream, "clock_jump", [row(900)], "fault", "t")


def bursts() -> Damaged:
    """Samples came through a buffer of eight; each has the stamp of its reading, 1 ms unsure."""
    chance = np.random.default_rng(5)
    stream = clean(jitter=0.0)
    time = values(stream, "t")
    last = np.minimum(np.arange(2000) // 8 * 8 + 7, 1999)
    stamps = time[last] + np.repeat(chance.normal(0, 1e-3, 250), 8)
    shared = [i for i in range(2000) if i % 8 != 7]
    time[:] = stamps
    return Damaged(stream, "burst_time", rows(shared), "repair", "t", truth=clean(jitter=0.0))


def coarse_clock() -> Damaged:
    """A clock of 15.625 ms stamps samples that come every 10 ms."""
    stream = clean(jitter=0.0)
    time = values(stream, "t")
    time[:] = np.floor(time / 0.015625) * 0.015625
    return Damaged(
        stream, "time_quantised", rows(range(2000)), "repair", "t", truth=clean(jitter=0.0)
    )


def millisecond_clock() -> Damaged:
    """A clock of 1 ms stamps frames that come every 16.67 ms."""
    stream = clean(jitter=0.0)
    time = values(stream, "t")
    for column in stream.columns[1:]:
        column.values = np.sin(np.arange(2000) / 60 * 3)
    truth = copy(stream)
    values(truth, "t")[:] = np.arange(2000) / 60
    time[:] = np.round(np.arange(2000) / 60, 3)
    return Damaged(stream, "time_quantised", rows(range(2000)), "repair", "t", truth=truth)


def milliseconds() -> Damaged:
    """Times in milliseconds in a column that does not say so."""
    stream = clean()
    values(stream, "t")[:] *= 1e3
    stream.columns[0].unit = ""
    return Damaged(stream, "time_unit", [], "fault", "t")


def said_to_be_seconds() -> Damaged:
    """Microseconds since 1970 in a column that is said to be in seconds."""
    stream = clean()
    values(stream, "t")[:] = (1.7e9 + values(stream, "t")) * 1e6
    return Damaged(stream, "time_unit", [], "fault", "t")


# --- defects of the values ------------------------------------------------------------------------


def sentinel() -> Damaged:
    """-999 where nothing was measured, too long to be interpolated."""
    samples = [*range(210, 214), *range(1500, 1510)]
    stream = clean()
    values(stream, "sine")[samples] = -999.0
    return Damaged(
        stream, "sentinel", rows(samples), "repair", "sine", truth=clean(), lost=samples,
        tells=("missing_values",),
    )  # fmt: skip


def full_sentinel() -> Damaged:
    """65535 where a packet was lost: single samples, which can be interpolated."""
    samples = [333, 1444]
    stream = clean()
    values(stream, "sine")[samples] = 65535.0
    return Damaged(
        stream, "sentinel", rows(samples), "repair", "sine", truth=clean(),
        tells=("interpolated",),
    )  # fmt: skip


def told_sentinel() -> Damaged:
    """The mapping says that 0.25 means: nothing measured."""
    samples = list(range(600, 606))
    stream = clean()
    values(stream, "sine")[samples] = 0.25
    mapping = of_tree(
        {"channels": {"sine": {"column": "sine", "unit": "V", "sentinels": [0.25]}}}, "map"
    )
    return Damaged(
        stream, "sentinel", rows(samples), "repair", "sine", mapping, truth=clean(), lost=samples,
        tells=("missing_values",),
    )  # fmt: skip


def infinite() -> Damaged:
    """Infinite values, as a division by zero leaves them."""
    samples = [*range(40, 45), 1700]
    stream = clean()
    values(stream, "slope")[samples[:-1]] = np.inf
    values(stream, "slope")[1700] = -np.inf
    return Damaged(
        stream, "infinite", rows(samples), "repair", "slope", truth=clean(),
        lost=list(range(40, 45)), tells=("interpolated", "missing_values"),
    )  # fmt: skip


def short_holes() -> Damaged:
    """Up to three values are missing in a row, between good ones."""
    samples = [150, 500, 501, 1000, 1001, 1002]
    stream = clean()
    values(stream, "sine")[samples] = np.nan
    return Damaged(stream, "interpolated", rows(samples), "repair", "sine", truth=clean())


def long_hole() -> Damaged:
    """Forty values are missing in a row."""
    samples = list(range(800, 840))
    stream = clean()
    values(stream, "sine")[samples] = np.nan
    return Damaged(
        stream, "missing_values", rows(samples), "warning", "sine", truth=clean(), lost=samples
    )


def wrapped() -> Damaged:
    """An encoder of 16 bits begins again."""
    return _wrapping(16, 150.0)


def wrapped_8() -> Damaged:
    """A counter of 8 bits begins again."""
    return _wrapping(8, 3.0)


def _wrapping(bits: int, speed: float) -> Damaged:
    stream, range_ = clean(), 2.0**bits
    turned = np.floor(100 + speed * np.arange(2000) + 20 * np.sin(np.arange(2000) / 50))
    truth = copy(stream)
    truth.columns.append(RawColumn("encoder", turned, "1"))
    stream.columns.append(RawColumn("encoder", np.mod(turned, range_), "1"))
    again = np.flatnonzero(np.diff(np.floor(turned / range_)) != 0) + 1
    return Damaged(stream, "counter_wrap", rows(again), "repair", "encoder", truth=truth)


def told_wrap() -> Damaged:
    """An encoder of 4096 counts, as the mapping says."""
    stream = clean()
    turned = np.floor(50 + 300.0 * np.arange(2000))
    truth = copy(stream)
    truth.columns.append(RawColumn("encoder", turned, "1"))
    stream.columns.append(RawColumn("encoder", np.mod(turned, 4096), "1"))
    mapping = of_tree(
        {"channels": {"encoder": {"column": "encoder", "unit": "1", "wraps": 4096}}}, "map"
    )
    again = np.flatnonzero(np.diff(np.floor(turned / 4096)) != 0) + 1
    return Damaged(stream, "counter_wrap", rows(again), "repair", "encoder", mapping, truth=truth)


def too_fast_wrap() -> Damaged:
    """An encoder that turns by nearly half its counts between two samples."""
    stream = clean()
    turned = np.floor(50 + 1900.0 * np.arange(2000))
    stream.columns.append(RawColumn("encoder", np.mod(turned, 4096), "1"))
    mapping = of_tree(
        {"channels": {"encoder": {"column": "encoder", "unit": "1", "wraps": 4096}}}, "map"
    )
    return Damaged(stream, "counter_wrap", [row(1)], "fault", "encoder", mapping)


def signed_number() -> Damaged:
    """A signed number of 16 bits was logged as an unsigned one."""
    stream, truth = clean(), clean()
    load = np.round(300 * np.sin(np.arange(2000) / 90))
    truth.columns.append(RawColumn("load", load, "1"))
    stream.columns.append(RawColumn("load", np.mod(load, 65536), "1"))
    return Damaged(
        stream, "signed_number", rows(np.flatnonzero(load < 0)), "repair", "load", truth=truth
    )


def clipped() -> Damaged:
    """A sine with noise is cut off at 0.8, where the sensor ends; nobody says so."""
    stream = clean()
    sine = values(stream, "sine")
    over = sine >= 0.8
    sine[over] = 0.8
    return Damaged(
        stream, "saturation", rows(_long_runs(over)), "warning", "sine", truth=clean(),
        lost=np.flatnonzero(over).tolist(),
    )  # fmt: skip


def at_limits() -> Damaged:
    """The sensor ends at ±0.9, as the log says."""
    stream = clean()
    column = stream.column("sine")
    column.limits = (-0.9, 0.9)
    over = np.abs(column.values) >= 0.9
    column.values = np.clip(column.values, -0.9, 0.9)
    return Damaged(
        stream, "saturation", rows(_long_runs(over)), "warning", "sine", truth=clean(),
        lost=np.flatnonzero(over).tolist(),
    )  # fmt: skip


def _long_runs(mask) -> list[int]:
    """Samples of the stretches of a mask that are at least three long."""
    edge = np.flatnonzero(np.diff(np.concatenate(([0], mask.astype(int), [0]))))
    return [
        i for a, b in zip(edge[::2], edge[1::2], strict=True) if b - a >= 3 for i in range(a, b)
    ]


def cut_short() -> Damaged:
    """The importer met the end of the file in the middle of a row."""
    stream = clean()
    stream.truncated = "line 2004 has 3 of 5 columns"
    return Damaged(stream, "truncated", [row(1999)], "warning", truth=clean())


DEFECTS: dict[str, Callable[[], Damaged]] = {
    made.__name__: made
    for made in (
        gap, many_gaps, stale_first_row, sequence_gap, duplicate_row, duplicate_time, late_row,
        wrong_stamp, missing_stamp, clock_back, clock_ahead, clock_back_with_counter,
        clock_ahead_with_counter, two_logs, bursts, coarse_clock, millisecond_clock,
        milliseconds, said_to_be_seconds,
        sentinel, full_sentinel, told_sentinel, infinite, short_holes, long_hole,
        wrapped, wrapped_8, told_wrap, too_fast_wrap, signed_number, clipped, at_limits, cut_short,
    )
}  # fmt: skip
#: defects of the clock; the others are of the values
OF_TIME = tuple(DEFECTS)[: tuple(DEFECTS).index("sentinel")]
OF_VALUES = tuple(DEFECTS)[len(OF_TIME) :]
