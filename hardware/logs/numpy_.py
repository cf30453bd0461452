"""NumPy's ``.npy`` and ``.npz``, and tensors in PyTorch's ``.pt``; no pickle is ever executed."""

from __future__ import annotations

import io
import re
import tokenize
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO, cast

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import arrays, torch_pickle, zip_guard
from simcompare.hardware.logs.binary.arrays import Block
from simcompare.hardware.logs.hdf5_ import ambiguous, field_columns
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream, Spool
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
    """An array as columns: (n,) each, or a table with fields."""

    name: str
    shape: tuple[int, ...]
    columns: list[np.ndarray] = field(default_factory=list)
    table: np.ndarray | None = None
    truncated: str = ""

    @property
    def samples(self) -> int:
        return len(self.columns[0]) if self.table is None else len(self.table)


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all arrays of numbers.

    Raises:
        InputError: a damaged file, an array of objects, or axes that cannot be told apart.
    """
    log = RawLog([])
    found = _arrays(path, log)
    ragged = _ragged(found)
    if ragged is not None:
        log.streams = _items(found, *ragged, log)
    else:
        try:
            log.streams = _streams(found, log)
        except _Ambiguous as reason:
            raise InputError(str(path), [str(reason)]) from None
    if not log.streams:
        reasons = [f"array {name}: {why}" for name, why in log.ignored.items()]
        raise InputError(str(path), reasons or ["holds no array of numbers"])
    return log


def _arrays(path: Path, log: RawLog) -> dict[str, _Array]:
    with path.open("rb") as file:
        start = file.read(len(torch_pickle.MAGIC))
    found: dict[str, _Array] = {}
    faults: list[str] = []
    if start.startswith(_NPY):
        with path.open("rb") as file:
            _take(_UNNAMED, file, found, log, faults)
    elif start == torch_pickle.MAGIC:
        _tensors(path, found, log, faults)
    else:
        _archive(path, found, log, faults)
    if faults:
        raise InputError(str(path), faults)
    return found


def _archive(path: Path, found: dict[str, _Array], log: RawLog, faults: list[str]) -> None:
    try:
        with zipfile.ZipFile(path) as archive:
            members = archive.infolist()
            if any(member.filename.endswith("data.pkl") for member in members):
                _tensors(path, found, log, faults)
                return
            for member in members:
                with archive.open(member) as file:
                    name = member.filename.removesuffix(".npy")
                    _take(name, cast(BinaryIO, file), found, log, faults)
    except zip_guard.ERRORS as error:
        raise InputError(
            str(path), [f"is a damaged archive of arrays: {error}; copy it again"]
        ) from None


def _take(
    name: str, file: BinaryIO, found: dict[str, _Array], log: RawLog, faults: list[str]
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
    why = _refusal(shape, dtype)
    if why:
        log.ignored[name] = why
        return
    try:
        _fill(name, shape, fortran, dtype, file, found, log)
    except _Short as short:
        faults.append(f"array {name}: {short}")


class _Short(Exception):
    """An array of which nothing whole is there."""


class _Ambiguous(Exception):
    """An array whose axes cannot be told apart."""


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


def _fill(
    name: str, shape: tuple[int, ...], fortran: bool, dtype: np.dtype[Any],
    file: BinaryIO, found: dict[str, _Array], log: RawLog,
) -> None:  # fmt: skip
    """The values, in blocks of rows."""
    full = tuple(n for n in shape if n > 1)
    if not dtype.names and not full:
        data = file.read(dtype.itemsize)
        if len(data) == dtype.itemsize:
            log.about[name] = arrays.shorten(np.frombuffer(data, dtype)[0])
            log.ignored[name] = "is a single number: kept as a parameter"
        return
    width = 1 if dtype.names or len(full) == 1 else full[1]
    if fortran and len(full) == 2:
        values = _all(file, full[0] * full[1], dtype, name)
        found[name] = _of_matrix(name, values.reshape(full, order="F"))
        return
    rows = shape[0] if dtype.names else full[0]
    if dtype.names or dtype.kind in "mM" or (dtype.kind in "iu" and dtype.itemsize == 8):
        # these are made to float64 with more care, and all at once
        values, cut = _rows(file, rows, width, dtype)
        if not len(values):
            raise _Short(cut)
        if dtype.names:
            found[name] = _Array(name, full, table=values[:, 0], truncated=cut)
            return
        columns = [values[:, i] for i in range(width)]
        found[name] = _Array(name, full, columns, truncated=cut)
        return
    if width > max(rows, arrays.MAX_COLUMNS):
        found[name] = _of_matrix(name, _all(file, rows * width, dtype, name).reshape(full))
        return
    columns, text = _spooled(file, rows, width, dtype)
    found[name] = _Array(name, full, columns, truncated=text)


def _spooled(
    file: BinaryIO, rows: int, width: int, dtype: np.dtype[Any]
) -> tuple[list[np.ndarray], str]:
    """Columns of a matrix, and what is missing at its end."""
    spool = Spool(width)
    step = max(1, _TOGETHER // (width * dtype.itemsize))
    cut = ""
    while len(spool) < rows and not cut:
        values, cut = _rows(file, min(step, rows - len(spool)), width, dtype)
        spool.append(values.astype(np.float64))
    text = f"the file ends after {len(spool)} of {rows} samples" if cut else ""
    if not len(spool):
        raise _Short(text)
    return list(spool.columns()), text


def _rows(file: BinaryIO, rows: int, width: int, dtype: np.dtype[Any]) -> tuple[np.ndarray, str]:
    """Whole rows (k, width), and what is missing of them."""
    size = width * dtype.itemsize
    pieces: list[bytes] = []
    left = rows * size
    while left:
        piece = file.read(min(left, _TOGETHER))
        if not piece:
            break
        pieces.append(piece)
        left -= len(piece)
    data = b"".join(pieces)
    whole = len(data) // size
    cut = f"the file ends after {whole} of {rows} samples" if whole < rows else ""
    return np.frombuffer(data, dtype, whole * width).reshape(whole, width), cut


def _all(file: BinaryIO, count: int, dtype: np.dtype[Any], name: str) -> np.ndarray:
    values, cut = _rows(file, count, 1, dtype)
    if cut:
        raise _Short(f"is stored column by column and {cut.replace('samples', 'numbers')}")
    return values[:, 0]


def _of_matrix(name: str, matrix: np.ndarray) -> _Array:
    columns = [np.array(matrix[:, i]) for i in range(matrix.shape[1])]
    return _Array(name, matrix.shape, columns)


def _tensors(path: Path, found: dict[str, _Array], log: RawLog, faults: list[str]) -> None:
    for name, tensor in torch_pickle.read(path).items():
        buffer = io.BytesIO()
        np.lib.format.write_array(buffer, tensor, allow_pickle=False)
        buffer.seek(0)
        _take(name or _UNNAMED, buffer, found, log, faults)


def _ragged(found: dict[str, _Array]) -> tuple[str, list[str], str] | None:
    """Stacked items of different lengths: the vector of lengths, what is stacked, and the names."""
    for name, one in found.items():
        if one.table is not None or len(one.shape) != 1 or not _LENGTHS.match(name):
            continue
        lengths = one.columns[0]
        whole = np.asarray(lengths, dtype=np.float64)
        if len(lengths) < 2 or (whole < 0).any() or (whole != np.floor(whole)).any():
            continue
        stacked = [
            other for other, a in found.items() if other != name and a.samples == whole.sum()
        ]
        beside = [
            other
            for other, a in found.items()
            if other not in (name, *stacked) and a.table is None and len(a.shape) == 1
            and a.samples == len(lengths) and len(np.unique(a.columns[0])) == len(lengths)
        ]  # fmt: skip
        if stacked:
            ids = [other for other in beside if re.search(r"id|number|index|name", other, re.I)]
            return name, stacked, (ids or beside or [""])[0]
    return None


def _items(
    found: dict[str, _Array], lengths: str, stacked: list[str], ids: str, log: RawLog
) -> list[RawStream]:
    """One stream for each stacked item."""
    whole = Block("")
    columns = [column for name in stacked for column in _columns(found[name], whole)]
    counts = found[lengths].columns[0].astype(np.int64).tolist()
    numbers = found[ids].columns[0].astype(np.int64).tolist() if ids else list(range(len(counts)))
    stem = re.sub(r"_?(id|ids|number|index)$", "", ids, flags=re.I) or "item"
    text = f"{', '.join(stacked)} was cut into {len(counts)} streams of the lengths in {lengths}"
    log.repairs += [Repair("stacked_items", INFO, text), *whole.repairs]
    for name in found:
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


def _streams(found: dict[str, _Array], log: RawLog) -> list[RawStream]:
    """One stream for each number of samples."""
    groups: dict[int, list[_Array]] = {}
    for one in found.values():
        groups.setdefault(_turned(one, found).samples, []).append(one)
    longest = max(groups, default=0)
    kept = []
    for samples, members in groups.items():
        if samples < arrays.MIN_SAMPLES <= longest:
            for one in members:
                log.ignored[one.name] = (
                    f"has only {samples} samples beside {longest}: kept as a parameter"
                )
                if samples * len(one.columns) <= _MAX_SHOWN:
                    log.about[one.name] = arrays.shorten(np.column_stack(one.columns))
        else:
            kept.append(members)
    return [_stream(members, log, alone=len(kept) == 1) for members in kept]


def _turned(one: _Array, found: dict[str, _Array]) -> _Array:
    """An array with its samples as rows; whether they are is told by its shape or its neighbours.

    Raises:
        _Ambiguous: neither tells.
    """
    if one.table is not None or len(one.shape) == 1 or one.shape[0] > one.shape[1]:
        return one
    others = {a.samples for a in found.values() if a is not one and len(a.shape) == 1}
    if one.shape[0] in others:
        return one
    if one.shape[1] not in others:
        raise _Ambiguous(ambiguous(f"array {one.name}", one.shape))
    matrix = np.column_stack(one.columns)
    one.columns = [np.array(row) for row in matrix]
    one.shape = (one.shape[1], one.shape[0])
    return one


def _stream(members: list[_Array], log: RawLog, *, alone: bool) -> RawStream:
    block = Block(arrays.stream_name([one.name for one in members], alone=alone))
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
    if one.table is not None:
        fields = one.table.dtype.names or ()
        return [c for name in fields for c in field_columns(name, one.table[name], block)]
    plain, unit = arrays.split_unit(one.name)
    if len(one.columns) == 1:
        return [RawColumn(plain, arrays.floats(one.columns[0], plain, block), unit)]
    names = arrays.component_names(plain, len(one.columns), letters=plain != _UNNAMED)
    block.repairs += arrays.quaternion_note(plain, len(one.columns), block.name)
    return [
        RawColumn(name, arrays.floats(column, name, block), unit)
        for name, column in zip(names, one.columns, strict=True)
    ]
