"""Columns of a ROS topic with their clock, units, frames and uncertainties."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simcompare.hardware.logs.bags.layout import Number
from simcompare.hardware.logs.bags.topic import EPOCH_NS, Table, Topic
from simcompare.hardware.logs.bags.types import JOINT_STATE
from simcompare.hardware.logs.binary.arrays import iso_ns
from simcompare.hardware.raw import MAX_ROWS, RawColumn, RawLog, RawStream
from simcompare.model.recording import INFO, WARNING, Clock, Repair, ranges
from simcompare.model.trajectory import Array

STAMP, RECEIVED, COUNTER = "header.stamp", "bag receive time", "header.seq"


def finish(topic: Topic, name: str, truncated: str, log: RawLog) -> None:
    """Adds the streams of a topic all of whose messages were taken, one for each frame.

    Args:
        topic: the topic.
        name: what its stream is called.
        truncated: what is missing at the end of the bag.
        log: what they are added to.
    """
    topic.flush()
    if topic.refused or not topic.tables:
        reason = topic.refused or (topic.broken[0][1] if topic.broken else "holds no messages")
        log.ignored[name] = f"{topic.connection.kind}: {reason}"
        if topic.broken or (topic.refused and topic.connection.schema and not topic.defined):
            text = f"no message of the topic {name} can be read: {reason}"
            log.repairs.append(Repair("topic_lost", WARNING, text, name, count=topic.count))
        return
    for table in topic.tables.values():
        frames = "".join(f"[{key}]" for key in (table.frame, table.child) if key)
        full = f"{name}{frames}" if len(topic.tables) > 1 else name
        _Stream(topic, table, full, truncated, log).make()
    if topic.broken:
        rows = [number for number, _ in topic.broken]
        log.repairs.append(
            Repair(
                "undecodable_message", WARNING,
                f"{len(rows)} messages do not fit their definition and were left out;"
                f" message {rows[0]} {topic.broken[0][1]}",
                name, rows=ranges(rows[:MAX_ROWS]), count=len(rows),
            )
        )  # fmt: skip
    if topic.source:
        text = (
            f"the bag does not define {topic.connection.kind}; ROS 2 {topic.source} does, and fits"
        )
        log.repairs.append(Repair("shipped_definition", INFO, text, name))


class _Stream:
    """One table on its way to a raw stream."""

    def __init__(self, topic: Topic, table: Table, name: str, truncated: str, log: RawLog) -> None:
        self.topic, self.table, self.name, self.log = topic, table, name, log
        number, self.received, self.stamps, *values = table.spool.columns()
        self.count = len(number)
        self.numbers = list(table.numbers.values())
        self.values = dict(zip(table.numbers, values, strict=True))
        self.first_row, self.rows = _rows(number)
        self.truncated = truncated
        self.columns: dict[str, RawColumn] = {}

    def make(self) -> None:
        """Adds the stream to the log, or says why there is none."""
        for number in self.numbers:
            if not number.of:
                frame = self.table.child if number.child else self.table.frame
                values = self.values[number.name]
                if number.infinite:
                    self._out_of_range(number, values)
                column = RawColumn(number.name, values, number.unit, frame)
                if self.topic.connection.kind == JOINT_STATE and not number.unit:
                    column.joint, _, column.quantity = number.name.rpartition(".")
                self.columns[number.name] = column
        self._covariances()
        self._limits()
        counter = self._counter()
        for path, why in self.table.skipped.items():
            self.log.ignored[f"{self.name}/{path}"] = why
        for path, why in self.table.notes.items():
            severity = WARNING if "rounded" in why else INFO
            self._note("number_kept", f"{path} {why}", severity, path)
        if self.count < 2 or not set(self.columns) - {COUNTER}:
            one = "holds a single message; a recording needs two"
            none = "holds no numbers"
            self.log.ignored[self.name] = one if self.count < 2 else none
            return
        time, clock = self._clock()
        stream = RawStream(
            self.name, [time, *self.columns.values()], time.name, counter=counter, clock=clock,
            row_word="message", first_row=self.first_row, rows=self.rows, truncated=self.truncated,
        )  # fmt: skip
        self.log.streams.append(stream)

    def _note(
        self,
        rule: str,
        text: str,
        severity: str,
        channel: str = "",
        rows: Sequence[int] | NDArray[np.int64] = (),
    ) -> None:
        indices = np.asarray(rows, dtype=np.int64)
        shown = indices[:MAX_ROWS]
        numbers = shown + self.first_row if self.rows is None else self.rows[shown]
        self.log.repairs.append(
            Repair(rule, severity, text, self.name, channel, ranges(numbers), len(indices))
        )

    def _clock(self) -> tuple[RawColumn, Clock]:
        table = self.table
        stands = self.count > 1 and float(np.ptp(self.stamps)) == 0.0
        if table.stamped and table.zeros < self.count and not stands:
            self._delay()
            return RawColumn(STAMP, self.stamps, "s"), Clock(STAMP, iso(table.first_ns[0]))
        if table.stamped:
            value = "always 0" if table.zeros == self.count else "the same in all messages"
            text = f"header.stamp is {value}; the time at which the bag received a message is used"
            self._note("no_header_stamp", text, WARNING)
        else:
            text = "its messages have no header; the time at which the bag received them is used"
            self._note("no_header_stamp", text, INFO)
        return RawColumn(RECEIVED, self.received, "s"), Clock(RECEIVED, iso(table.first_ns[1]))

    def _delay(self) -> None:
        """Says how much later than its stamp a message was received, before that is dropped."""
        origin = (self.table.origin_ns or 0) - self.topic.origin_ns
        delay = self.received - self.stamps - origin * 1e-9
        mean, spread = float(delay.mean()), float(delay.std())
        self.log.about[f"{self.name}: receipt after header.stamp"] = (
            f"{mean:.6g} s, standard deviation {spread:.3g} s"
        )

    def _counter(self) -> str | None:
        """``header.seq`` where it counts; several publishers of a topic count on their own."""
        column = self.columns.get(COUNTER)
        if column is None:
            return None
        low, high = _extremes(column.values)
        if low == high or len(self.topic.publishers) > 1 or len(self.topic.tables) > 1:
            del self.columns[COUNTER]
            self.log.ignored[f"{self.name}/{COUNTER}"] = (
                "is always the same" if low == high else "counts several publishers or frames"
            )
            return None
        return COUNTER

    def _out_of_range(self, number: Number, values: Array) -> None:
        samples = np.flatnonzero(np.isinf(values))
        if len(samples):
            values[samples] = np.nan
            text = "±inf means out of range; nothing was measured there (NaN)"
            self._note("out_of_range", text, INFO, number.name, samples)

    def _limits(self) -> None:
        """The limits of a range finder, which it sends with every message."""
        wanted = self.columns.get("range")
        ends = [self.columns.get(name) for name in ("min_range", "max_range")]
        if wanted is None or ends[0] is None or ends[1] is None:
            return
        (low, same_low), (high, same_high) = (_extremes(end.values) for end in ends if end)
        if low == same_low and high == same_high and low < high:
            wanted.limits = (low, high)
            del self.columns["min_range"], self.columns["max_range"]
            self.log.ignored[f"{self.name}/min_range, max_range"] = (
                f"are always {low:.6g} m and {high:.6g} m: the limits of range"
            )

    def _covariances(self) -> None:
        groups: dict[str, list[Number]] = {}
        for number in self.numbers:
            if number.of:
                groups.setdefault(number.name.rpartition(".")[0], []).append(number)
        for path, numbers in groups.items():
            if self.topic.connection.kind == "sensor_msgs/msg/Imu":
                self._absent(path, numbers)
            turned = [number for number in numbers if number.of.endswith("orientation")]
            for number in numbers:
                if number not in turned and number.of in self.columns:
                    self.columns[number.of].u = _uncertainty(self.values[number.name])
            if turned:
                self._orientation(path, turned)

    def _absent(self, path: str, numbers: list[Number]) -> None:
        """Leaves out what the message says it does not hold: its covariance begins with -1."""
        first = self.values[numbers[0].name]
        absent = np.flatnonzero(first == -1.0)
        if not len(absent):
            return
        targets = [n for n in self.columns if any(_belongs(n, number.of) for number in numbers)]
        for name in targets:
            if len(absent) == self.count:
                del self.columns[name]
                self.log.ignored[f"{self.name}/{name}"] = f"{path}[0] is -1: it is not measured"
            else:
                self.columns[name].values[absent] = np.nan
                text = f"{path}[0] is -1: nothing was measured there (NaN)"
                self._note("field_absent", text, INFO, name, absent)

    def _orientation(self, path: str, numbers: list[Number]) -> None:
        """Turns about three axes become an upper limit for the components of the quaternion."""
        sigmas = [_uncertainty(self.values[number.name]) for number in numbers]
        targets = [n for n in self.columns if _belongs(n, numbers[0].of)]
        if not targets or any(sigma is None for sigma in sigmas):
            return
        largest = np.maximum.reduce([np.asarray(sigma) for sigma in sigmas])
        half: float | Array = largest / 2 if largest.ndim else float(largest) / 2
        for name in targets:
            self.columns[name].u = half
        text = f"u of each component is half the largest standard deviation of a turn in {path}"
        self._note("orientation_uncertainty", text, INFO, numbers[0].of)


def iso(ns: int) -> str:
    """An instant as ISO 8601, empty where the clock does not count from 1970."""
    return iso_ns(ns) if ns >= EPOCH_NS else ""


def _belongs(name: str, of: str) -> bool:
    return name == of or name.startswith(f"{of}.")


def _rows(number: Array) -> tuple[int, NDArray[np.int64] | None]:
    """First message, and the numbers of all where some are missing between."""
    first = int(number[0])
    if int(number[-1]) - first + 1 == len(number):
        return first, None
    return first, np.asarray(number).astype(np.int64)


def _extremes(values: Array) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def _uncertainty(variance: Array) -> float | Array | None:
    """Square root of a variance: one number where it never changes; 0 and less mean unknown."""
    variance[~(variance > 0)] = np.nan
    np.sqrt(variance, out=variance)
    if np.isnan(variance).all():
        return None
    low, high = _extremes(variance)
    return low if low == high else variance
