"""One stream while it is being conditioned: its columns, and what was noticed or changed."""

from __future__ import annotations

from collections.abc import Mapping as MappingOf
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simcompare.hardware.mapping import ChannelMap, Mapping
from simcompare.hardware.raw import MAX_ROWS, RawColumn, RawStream
from simcompare.model.recording import INFO, REPAIR, WARNING, Repair, ranges
from simcompare.model.trajectory import Array


@dataclass
class Work:
    """A stream under repair. Checks are functions ``check(work) -> None`` that change it.

    Samples are counted 0 … n-1 here; ``mark`` and ``fault`` turn them into rows of the log.

    Attributes:
        stream: the raw stream; its columns are changed in place.
        mapping: what the user says of the columns.
        assume_units: whether a unit that contradicts physics is replaced by the one that fits.
        time_s: times of the samples [s], once ``time_unit`` has made them; they begin with 0 and
            may lie in the memory of the column of times.
        gaps: samples after which some are missing.
        saturated: raw column -> samples at the end of its range.
        unsound: raw column -> why it is left out, in words.
        start_s: the log's own time at which ``time_s`` is 0 [s].
        u_time_s: standard uncertainty of a stamp [s].
        resolution_s: smallest step of the stamps [s].
        repairs: everything noticed or changed.
        faults: what cannot be repaired, in words.
    """

    stream: RawStream
    mapping: Mapping
    assume_units: bool = False
    time_s: Array = field(default_factory=lambda: np.empty(0))
    gaps: list[int] = field(default_factory=list)
    saturated: dict[str, NDArray[np.bool_]] = field(default_factory=dict)
    unsound: dict[str, str] = field(default_factory=dict)
    start_s: float = 0.0
    u_time_s: float = 0.0
    resolution_s: float = 0.0
    repairs: list[Repair] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    @property
    def data(self) -> list[RawColumn]:
        """All columns but that of the time."""
        return [column for column in self.stream.columns if column.name != self.stream.time]

    def wishes(self, column: RawColumn) -> ChannelMap | None:
        """What the mapping says of a column, ``None`` where it says nothing."""
        wishes = self.mapping.of_column(self.stream.name, column.name)
        return wishes[0][1] if wishes else None

    def row(self, sample: int) -> int:
        """Row of the log that a sample stands in."""
        if self.stream.rows is not None:
            return int(self.stream.rows[sample])
        return self.stream.first_row + int(sample)

    def place(self, sample: int) -> str:
        """The same in words: ``line 12``."""
        return f"{self.stream.row_word} {self.row(sample)}"

    def info(self, rule: str, text: str, **more: Any) -> None:  # noqa: ANN401
        """Records something that is no defect, such as a unit that was converted."""
        self._record(rule, INFO, text, **more)

    def warn(self, rule: str, text: str, **more: Any) -> None:  # noqa: ANN401
        """Records a defect that is left as it is and marked; ``--strict`` refuses it."""
        self._record(rule, WARNING, text, **more)

    def repair(self, rule: str, text: str, **more: Any) -> None:  # noqa: ANN401
        """Records a change; ``--strict`` refuses it.

        Args:
            rule: short name of the defect.
            text: what was found and what was done.
            more: samples (indices; of many, the first ``MAX_ROWS`` are enough if ``count`` says
                how many there are), channel (raw name), before and after (numbers by name).
        """
        self._record(rule, REPAIR, text, **more)

    def _record(
        self,
        rule: str,
        severity: str,
        text: str,
        *,
        samples: Array | NDArray[np.int64] | list[int] | None = None,
        channel: str = "",
        count: int | None = None,
        before: MappingOf[str, float] | None = None,
        after: MappingOf[str, float] | None = None,
    ) -> None:
        indices = np.asarray([] if samples is None else samples, dtype=np.int64)
        named = indices[:MAX_ROWS]
        if self.stream.rows is not None:
            rows = self.stream.rows[named]
        else:
            rows = named + self.stream.first_row
        number = len(indices) if count is None else count
        self.repairs.append(
            Repair(
                rule, severity, text, self.stream.name, channel, ranges(rows), number,
                dict(before or {}), dict(after or {}),
            )
        )  # fmt: skip

    def fault(self, text: str, sample: int | None = None, channel: str = "") -> None:
        """Records what cannot be repaired.

        Args:
            text: what was found, what was expected, what to do.
            sample: where.
            channel: raw name of the column.
        """
        places = [
            "" if self.stream.name == "log" else f"stream {self.stream.name}",
            "" if sample is None else self.place(sample),
            f"column {channel!r}" if channel else "",
        ]
        where = ", ".join(place for place in places if place)
        self.faults.append(f"{where}: {text}" if where else text)

    def keep(self, kept: NDArray[np.bool_]) -> None:
        """Drops all samples that are not kept, in every column; call ``mark`` before."""
        if kept.all():
            return
        if self.stream.rows is None:
            self.stream.rows = np.flatnonzero(kept)
            self.stream.rows += self.stream.first_row
        else:
            self.stream.rows = self.stream.rows[kept]
        for column in self.stream.columns:
            is_time = column.values is self.time_s
            column.values = _compressed(column.values, kept)
            if is_time:  # one memory for both: it must not be packed twice
                self.time_s = column.values
            if isinstance(column.u, np.ndarray):
                column.u = column.u[kept]
            if column.added_u is not None:
                column.added_u = column.added_u[kept]
        self.saturated = {name: mask[kept] for name, mask in self.saturated.items()}
        if len(self.time_s) == len(kept):
            self.time_s = _compressed(self.time_s, kept)


def _compressed(values: Array, kept: NDArray[np.bool_]) -> Array:
    """The values that are kept, moved to the front within the same memory."""
    packed = values[kept]
    values[: len(packed)] = packed
    return values[: len(packed)]
