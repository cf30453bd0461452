"""MATLAB files: version 4 to 7 with scipy, version 7.3 with h5py. Nothing in them is executed."""

from __future__ import annotations

import re
from collections.abc import Mapping as MappingOf
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import arrays, mat_tree, mat_v4
from simcompare.hardware.logs.binary.arrays import Block
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream
from simcompare.model.recording import INFO, Repair

TITLE = "a MATLAB file"

_TIME_WORD = re.compile(r"^(time|t|zeit)_?(.*)$|^(.*?)_?(time|t|zeit)$", re.IGNORECASE)
_MAX_SHOWN = 16
#: steps of a clock are as equal as single precision tells them
_EVEN = 1e-3


def recognises(head: Head) -> int:
    """By the text at the beginning and the mark of the byte order."""
    if head.start.startswith(b"MATLAB ") and b"MAT-file" in head.start[:124]:
        return 100
    return 90 if mat_v4.begins(head.start) else 0


@dataclass
class _Sorted:
    """What a file holds, by what can be made of it."""

    matrices: dict[str, np.ndarray] = field(default_factory=dict)
    cells: dict[str, list[np.ndarray]] = field(default_factory=dict)
    scalars: dict[str, object] = field(default_factory=dict)
    ignored: dict[str, str] = field(default_factory=dict)


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all numeric variables.

    Raises:
        InputError: the file is damaged, or holds nothing that could be a recording.
    """
    content = _Sorted()
    for name, value in mat_tree.load(path).items():
        _sort(name, value, content)
    log = RawLog([], ignored=content.ignored)
    cells = _cell_streams(content, log)
    blocks = _matrix_blocks(content)
    for block, names in blocks:
        block.name = arrays.stream_name(names, single=len(blocks) == 1 and not cells)
    log.streams = cells + [_stream(block, content, log) for block, _ in blocks]
    log.about |= {name: arrays.shorten(value) for name, value in content.scalars.items()}
    if not log.streams:
        reasons = [f"variable {name}: {why}" for name, why in content.ignored.items()]
        raise InputError(
            str(path),
            reasons or ["holds no vector or matrix of numbers; save one with a vector of times"],
        )
    return log


def _stream(block: Block, content: _Sorted, log: RawLog) -> RawStream:
    stream = arrays.stream_of(block, content.scalars)
    for repair in block.repairs:
        log.repairs.append(
            Repair(repair.rule, repair.severity, repair.text, block.name, repair.channel)
        )
    return stream


def _sort(name: str, value: Any, content: _Sorted) -> None:  # noqa: ANN401  (whatever a file may hold)
    if isinstance(value, mat_tree.Refused):
        content.ignored[name] = value.why
    elif isinstance(value, str):
        content.scalars[name] = value
    elif isinstance(value, dict):
        for key, inner in value.items():
            _sort(f"{name}.{key}", inner, content)
    elif isinstance(value, list):
        _sort_cells(name, value, content)
    else:
        _sort_array(name, value, content)


def _sort_cells(name: str, value: list[Any], content: _Sorted) -> None:
    """Cells of numbers stay together; others are gone through one by one."""
    numeric = all(isinstance(cell, np.ndarray) and _usable(cell) for cell in value)
    if value and numeric:
        content.cells[name] = value
        return
    for i, cell in enumerate(value):
        _sort(f"{name}.{i}", cell, content)


def _usable(array: np.ndarray) -> bool:
    return array.dtype.kind in "biuf" and array.ndim <= 2 and max(array.shape, default=0) > 1


def _sort_array(name: str, array: np.ndarray, content: _Sorted) -> None:
    if array.dtype.kind not in "biuf":
        content.ignored[name] = f"holds {array.dtype}, no real numbers"
    elif array.ndim > 2:
        shape = "×".join(map(str, array.shape))
        content.ignored[name] = f"has {array.ndim} dimensions ({shape}); save it as matrices"
    elif array.size == 0:
        content.ignored[name] = "is empty"
    elif array.size == 1:
        content.scalars[name] = array.reshape(-1)[0]
    elif array.ndim == 2 and array.shape[0] == array.shape[1]:
        shape = f"{array.shape[0]}×{array.shape[1]}"
        content.ignored[name] = f"is {shape}: rows or columns may be samples; save it as vectors"
        if array.size <= _MAX_SHOWN:
            content.scalars[name] = array
    elif min(array.shape) > arrays.MAX_COLUMNS:
        content.ignored[name] = f"has {min(array.shape)} components; at most {arrays.MAX_COLUMNS}"
    else:
        content.matrices[name] = array


def _length(array: np.ndarray) -> int:
    return int(max(array.shape))


def _columns(name: str, array: np.ndarray, block: Block) -> list[RawColumn]:
    """One column for each component; samples lie along the longer dimension."""
    table = np.atleast_2d(array)
    rows = table.T if table.shape[1] > table.shape[0] else table
    plain, unit = arrays.split_unit(name)
    if rows.shape[1] == 1:
        return [RawColumn(plain, arrays.floats(rows[:, 0], plain, block), unit)]
    names = arrays.component_names(plain, rows.shape[1], letters=False)
    return [
        RawColumn(full, arrays.floats(rows[:, i], full, block), unit)
        for i, full in enumerate(names)
    ]


def _matrix_blocks(content: _Sorted) -> list[tuple[Block, list[str]]]:
    """Vectors and matrices of equal length that stand beside each other."""
    groups: dict[tuple[str, int], list[str]] = {}
    for name, array in content.matrices.items():
        groups.setdefault((name.rpartition(".")[0], _length(array)), []).append(name)
    longest = max((n for _, n in groups), default=0)
    made = []
    for (_, n), names in groups.items():
        if n < arrays.MIN_SAMPLES <= longest:
            for name in names:
                content.scalars[name] = content.matrices[name]
                content.ignored[name] = (
                    f"has only {n} samples beside {longest}: kept as a parameter"
                )
            continue
        block = Block("")
        for name in names:
            block.columns += _columns(name, content.matrices[name], block)
        if len(names) == 1:
            _name_time(names[0], content.matrices[names[0]], block)
        made.append((block, names))
    return made


def _name_time(name: str, array: np.ndarray, block: Block) -> None:
    """The first row of a wide matrix is the time, where it increases in even steps."""
    if array.ndim != 2 or array.shape[0] < 2 or array.shape[0] >= array.shape[1]:
        return
    steps = np.diff(block.columns[0].values)
    if not (np.isfinite(steps).all() and (steps > 0).all()):
        return
    if np.ptp(steps) <= _EVEN * float(np.median(steps)):
        block.columns[0].name, block.columns[0].unit = "time", "s"
        text = f"the first row of {name} is taken as the time in s, as Simulink's To File writes it"
        block.repairs.append(Repair("first_row_time", INFO, text, block.name, "time"))


def _cell_streams(content: _Sorted, log: RawLog) -> list[RawStream]:
    """One stream for each cell; cells of times go with cells of data of equal lengths."""
    streams = []
    unpaired = dict(content.cells)
    for time in [name for name in content.cells if _stem(name) is not None]:
        if time not in unpaired:
            continue
        partners = _partners(time, unpaired)
        if not partners:
            continue
        members = [time, *partners]
        stem = _stem(time) or "cell"
        for name in members:
            del unpaired[name]
        for i in range(len(content.cells[time])):
            block = Block(f"{stem}.{i}")
            for name in members:
                block.columns += _columns(name, content.cells[name][i], block)
            streams.append(_paired(block, time, log))
    for name, cells in unpaired.items():
        streams += [_lone(name, i, cell, content, log) for i, cell in enumerate(cells)]
    return streams


def _stem(name: str) -> str | None:
    """What is left of the name of a variable without its word for time, ``None`` without one."""
    match = _TIME_WORD.match(name.rpartition(".")[2])
    if match is None:
        return None
    return (match[2] if match[1] else match[3]).strip("_")


def _partners(time: str, cells: MappingOf[str, list[np.ndarray]]) -> list[str]:
    """Cells of data that belong to a cell of times: equal lengths and the same ending."""
    stem = _stem(time) or ""
    lengths = [_length(cell) for cell in cells[time]]
    if any(min(np.atleast_2d(cell).shape) != 1 for cell in cells[time]):
        return []
    equal = [
        name
        for name, other in cells.items()
        if name != time and [_length(cell) for cell in other] == lengths and _stem(name) is None
    ]
    named = [
        name for name in equal if stem and re.search(rf"(^|[_.]){re.escape(stem)}([_.]|$)", name)
    ]
    others = [name for name in cells if name != time and _stem(name) is not None]
    # without a common name they can only belong together where there is one cell of times
    return named or ([] if others else equal)


def _paired(block: Block, time: str, log: RawLog) -> RawStream:
    stream = arrays.stream_of(block, {})
    stream.time = arrays.split_unit(time)[0]
    stream.clock = type(stream.clock)(f"column {time}", block.start)
    text = f"{time} is taken as the time of {', '.join(c.name for c in block.columns[1:])}"
    log.repairs.append(Repair("cells_paired", INFO, text, block.name, time))
    log.repairs += block.repairs
    return stream


def _lone(name: str, i: int, cell: np.ndarray, content: _Sorted, log: RawLog) -> RawStream:
    block = Block(f"{name}.{i}")
    block.columns = _columns(name, cell, block)
    return _stream(block, content, log)
