"""NumPy's ``.npy`` and ``.npz``, and tensors in PyTorch's ``.pt``; no pickle is ever executed."""

from __future__ import annotations

import io
import math
import re
import tempfile
import tokenize
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, cast

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import arrays, torch_pickle, zip_guard
from simcompare.hardware.logs.binary.arrays import Block
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream
from simcompare.model.recording import INFO, Repair

TITLE = "NumPy arrays or PyTorch tensors"

_NPY = b"\x93NUMPY"
#: name of an array that has none
_UNNAMED = "data"
_LENGTHS = re.compile(r"^(.*_)?(lengths?|counts?|sizes?|n_samples)$", re.IGNORECASE)
#: what NumPy raises for a header that is none
_NO_HEADER = (ValueError, EOFError, SyntaxError, TypeError, KeyError, RecursionError,
              tokenize.TokenError, OverflowError)  # fmt: skip
_TOGETHER = 1 << 20
_MAX_SHOWN = 64


def recognises(head: Head) -> int:
    """By the signature, or by the members of a zip archive."""
    if head.start.startswith((_NPY, torch_pickle.MAGIC)):
        return 100
    if head.members and head.start.startswith(b"PK"):
        if all(name.endswith(".npy") for name in head.members):
            return 95
        if any(name.endswith("/data.pkl") for name in head.members):
            return 95
    return 0


@dataclass
class _Array:
    """A matrix (samples, components), or a table (samples,) with fields."""

    name: str
    shape: tuple[int, ...]
    values: np.ndarray
    truncated: str = ""


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all arrays of numbers.

    Raises:
        InputError: a damaged file, an array of objects, or axes that cannot be told apart.
    """
    log = RawLog([])
    content = _arrays(path, log)
    ragged = _ragged(content)
    if ragged is not None:
        log.streams = _items(content, *ragged, log)
    else:
        log.streams = _streams(path, content, log)
    if not log.streams:
        reasons = [f"array {name}: {why}" for name, why in log.ignored.items()]
        raise InputError(str(path), reasons or ["holds no array of numbers"])
    return log


def _arrays(path: Path, log: RawLog) -> dict[str, _Array]:
    with path.open("rb") as file:
        start = file.read(len(torch_pickle.MAGIC))
    content: dict[str, _Array] = {}
    faults: list[str] = []
    if start.startswith(_NPY):
        with path.open("rb") as file:
            _take(_UNNAMED, file, content, log, faults)
    elif start == torch_pickle.MAGIC:
        _tensors(path, content, log, faults)
    else:
        _archive(path, content, log, faults)
    if faults:
        raise InputError(str(path), faults)
    return content


def _archive(path: Path, content: dict[str, _Array], log: RawLog, faults: list[str]) -> None:
    try:
        with zipfile.ZipFile(path) as archive:
            members = archive.infolist()
            if any(member.filename.endswith("data.pkl") for member in members):
                _tensors(path, content, log, faults)
                return
            for member in members:
                with archive.open(member) as file:
                    name = member.filename.removesuffix(".npy")
                    _take(name, cast(BinaryIO, file), content, log, faults)
    except zip_guard.ERRORS as error:
        raise InputError(
            str(path), [f"is a damaged archive of arrays: {error}; copy it again"]
        ) from None


def _take(
    name: str, file: BinaryIO, content: dict[str, _Array], log: RawLog, faults: list[str]
) -> None:  # fmt: skip
    """One array in NumPy's format."""
    try:
        shape, fortran, dtype = _header(file)
    except _NO_HEADER as error:
        faults.append(f"array {name}: has no whole header: {str(error)[:200]}")
        return
    if dtype.hasobject:
        faults.append(
            f"array {name}: holds Python objects (a pickle), which are never loaded;"
            " save numbers with numpy.save"
        )
        return
    count = 0 if _refusal(shape, dtype) else math.prod(shape)
    _place(name, shape, fortran, _numbers(file, dtype, count), content, log, faults)


def _header(file: BinaryIO) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        return np.lib.format.read_array_header_1_0(file)
    if version == (2, 0):
        return np.lib.format.read_array_header_2_0(file)
    raise ValueError(f"version {version} is not known; expected 1.0 or 2.0")


def _refusal(shape: tuple[int, ...], dtype: np.dtype[Any]) -> str:
    if any(n < 0 for n in shape):
        return f"has the shape {shape}"
    if dtype.names:
        return "" if len(shape) == 1 else f"is a table with {len(shape)} dimensions"
    if dtype.kind not in "biufmM" or dtype.itemsize > 8:
        return f"holds {dtype}, no real numbers"
    if 0 in shape:
        return "is empty"
    full = [n for n in shape if n > 1]
    if len(full) > 2:
        return f"has {len(full)} dimensions {shape}; store it as (samples, components)"
    if len(full) == 2 and min(full) > arrays.MAX_COLUMNS:
        return f"has {min(full)} components; at most {arrays.MAX_COLUMNS}"
    return ""


def _numbers(file: BinaryIO, dtype: np.dtype[Any], count: int) -> np.ndarray:
    """As many numbers as there are; those of an archive are unpacked into an unnamed file."""
    missing = max(count, 0) * dtype.itemsize
    if not isinstance(file, io.BufferedReader):
        unpacked = tempfile.TemporaryFile()  # noqa: SIM115  (it vanishes with what looks into it)
        while missing and (piece := file.read(min(missing, _TOGETHER))):
            missing -= unpacked.write(piece)
        file = cast(BinaryIO, unpacked)
        file.seek(0)
    start = file.tell()
    there = min(count, (file.seek(0, 2) - start) // max(dtype.itemsize, 1))
    return np.memmap(file, dtype, "r", start, (there,)) if there > 0 else np.empty(0, dtype)


def _place(
    name: str, shape: tuple[int, ...], fortran: bool, numbers: np.ndarray,
    content: dict[str, _Array], log: RawLog, faults: list[str],
) -> None:  # fmt: skip
    """Gives the numbers of an array the form of a matrix or table, cut after its last whole row."""
    why = _refusal(shape, numbers.dtype)
    if why:
        log.ignored[name] = why
        return
    is_table = numbers.dtype.names is not None
    full = shape if is_table else tuple(n for n in shape if n > 1)
    if not full:
        if len(numbers):
            log.about[name] = arrays.shorten(numbers[0])
            log.ignored[name] = "is a single number: kept as a parameter"
        return
    rows, width = (*full, 1)[:2]
    if len(full) == 2 and (fortran or width > max(rows, arrays.MAX_COLUMNS)):
        if len(numbers) < rows * width:
            ends = f"the file ends after {len(numbers)} of {rows * width} numbers"
            faults.append(f"array {name}: is stored column by column and {ends}")
        else:
            matrix = numbers.reshape(full, order="F" if fortran else "C")
            content[name] = _Array(name, full, matrix)
        return
    samples = len(numbers) // width
    cut = f"the file ends after {samples} of {rows} samples" if samples < rows else ""
    if not samples:
        faults.append(f"array {name}: {cut}")
        return
    matrix = numbers[: samples * width].reshape(samples, width)
    content[name] = _Array(name, full, np.array(matrix[:, 0]) if is_table else matrix, cut)


def _tensors(path: Path, content: dict[str, _Array], log: RawLog, faults: list[str]) -> None:
    for name, tensor in torch_pickle.read(path).items():
        _place(name or _UNNAMED, tensor.shape, False, tensor.ravel(), content, log, faults)


def _ragged(content: dict[str, _Array]) -> tuple[str, list[str], str] | None:
    """Stacked items of different lengths: the vector of lengths, what is stacked, and the names."""
    for name, one in content.items():
        if one.values.dtype.names or len(one.shape) != 1 or not _LENGTHS.match(name):
            continue
        lengths = one.values[:, 0]
        counts = np.asarray(lengths, dtype=np.float64)
        if len(lengths) < 2 or (counts < 0).any() or (counts != np.floor(counts)).any():
            continue
        stacked = [
            other for other, a in content.items() if other != name and len(a.values) == counts.sum()
        ]
        beside = [
            other
            for other, a in content.items()
            if other not in (name, *stacked) and not a.values.dtype.names and len(a.shape) == 1
            and len(a.values) == len(lengths) == len(np.unique(a.values))
        ]  # fmt: skip
        if stacked:
            ids = [other for other in beside if re.search(r"id|number|index|name", other, re.I)]
            return name, stacked, (ids or beside or [""])[0]
    return None


def _items(
    content: dict[str, _Array], lengths: str, stacked: list[str], ids: str, log: RawLog
) -> list[RawStream]:
    """One stream for each stacked item."""
    stack = Block("")
    columns = [column for name in stacked for column in _columns(content[name], stack)]
    counts = content[lengths].values[:, 0].astype(np.int64).tolist()
    numbers = (
        content[ids].values[:, 0].astype(np.int64).tolist() if ids else list(range(len(counts)))
    )
    stem = re.sub(r"_?(id|ids|number|index)$", "", ids, flags=re.I) or "item"
    text = f"{', '.join(stacked)} was cut into {len(counts)} streams of the lengths in {lengths}"
    log.repairs += [Repair("stacked_items", INFO, text), *stack.repairs]
    for name in content:
        if name not in stacked:
            used = name in (lengths, ids)
            log.ignored[name] = "tells the items apart" if used else "belongs to no sample"
    streams = []
    start = 0
    for number, count in zip(numbers, counts, strict=True):
        block = Block(f"{stem}.{number}")
        block.columns = [
            RawColumn(c.name, c.values[start : start + count], c.unit) for c in columns
        ]
        stream = arrays.stream_of(block, {})
        stream.first_row = start + 1
        start += count
        if count:
            streams.append(stream)
            log.repairs += block.repairs
        else:
            log.ignored[block.name] = "has no samples"
    return streams


def _streams(path: Path, content: dict[str, _Array], log: RawLog) -> list[RawStream]:
    """One stream for each number of samples."""
    groups: dict[int, list[_Array]] = {}
    for one in content.values():
        groups.setdefault(len(_turned(path, one, content).values), []).append(one)
    longest = max(groups, default=0)
    kept = []
    for samples, members in groups.items():
        if samples < arrays.MIN_SAMPLES <= longest:
            for one in members:
                log.ignored[one.name] = (
                    f"has only {samples} samples beside {longest}: kept as a parameter"
                )
                if one.values.size <= _MAX_SHOWN and not one.values.dtype.names:
                    log.about[one.name] = arrays.shorten(np.array(one.values))
        else:
            kept.append(members)
    return [_stream(members, log, single=len(kept) == 1) for members in kept]


def _turned(path: Path, one: _Array, content: dict[str, _Array]) -> _Array:
    """An array with its samples as rows; whether they are is told by its shape or its neighbours.

    Raises:
        InputError: neither tells.
    """
    if len(one.shape) == 1 or one.shape[0] > one.shape[1]:
        return one
    others = {len(a.values) for a in content.values() if a is not one and len(a.shape) == 1}
    if one.shape[0] in others:
        return one
    if one.shape[1] not in others:
        raise InputError(str(path), [arrays.ambiguous(f"array {one.name}", one.shape)])
    one.values, one.shape = one.values.T, one.shape[::-1]
    return one


def _stream(members: list[_Array], log: RawLog, *, single: bool) -> RawStream:
    block = Block(arrays.stream_name([one.name for one in members], single=single))
    for one in members:
        block.columns += _columns(one, block)
    shortest = min(len(column.values) for column in block.columns)
    for column in block.columns:
        column.values = column.values[:shortest]
    scalars = {name: float(text) for name, text in log.about.items() if _number(text)}
    stream = arrays.stream_of(block, scalars)
    stream.truncated = next((one.truncated for one in members if one.truncated), "")
    log.repairs += block.repairs
    return stream


def _number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _columns(one: _Array, block: Block) -> list[RawColumn]:
    if one.values.dtype.names:
        fields = one.values.dtype.names
        return [c for name in fields for c in arrays.field_columns(name, one.values[name], block)]
    plain, unit = arrays.split_unit(one.name)
    width = one.values.shape[1]
    names = [plain]
    if width > 1:
        names = arrays.component_names(plain, width, letters=plain != _UNNAMED)
    block.repairs += arrays.quaternion_note(plain, width, block.name)
    return [
        RawColumn(name, arrays.floats(column, name, block), unit)
        for name, column in zip(names, one.values.T, strict=True)
    ]
