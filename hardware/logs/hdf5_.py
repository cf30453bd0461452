"""HDF5 files: one stream for each group and number of samples."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import arrays
from simcompare.hardware.logs.binary.arrays import Block
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream, Spool
from simcompare.model.recording import INFO, Repair

TITLE = "an HDF5 file"

_MAGIC = b"\x89HDF\r\n\x1a\n"
_UNITS = ("unit", "units", "unit_string")
_MAX_DEPTH = 16
#: values that are read together, at least one chunk of the file
_TOGETHER = 1 << 18
_MAX_SHOWN = 64


def recognises(head: Head) -> int:
    """By the signature; a MATLAB file has it too, behind a text."""
    if head.start.startswith(b"MATLAB"):
        return 0
    # a block of the user's own may stand before it
    return 90 if any(head.start[at : at + 8] == _MAGIC for at in (0, 512, 1024, 2048)) else 0


@dataclass
class _Part:
    """A data set that becomes columns: name, and whether its samples lie along the second axis."""

    name: str
    item: Any
    turned: bool = False
    attributes: dict[str, object] = field(default_factory=dict)

    @property
    def samples(self) -> int:
        return int(self.item.shape[1 if self.turned else 0])

    @property
    def width(self) -> int:
        return 1 if len(self.item.shape) == 1 else int(self.item.shape[0 if self.turned else 1])

    def rows(self, part: slice) -> np.ndarray:
        """Samples as (k, width), or (k,) structured."""
        if self.turned:
            return np.asarray(self.item[:, part]).T
        return np.asarray(self.item[part])


@dataclass
class _File:
    """What a file holds."""

    groups: dict[str, list[Any]] = field(default_factory=dict)
    scalars: dict[str, dict[str, object]] = field(default_factory=dict)
    log: RawLog = field(default_factory=lambda: RawLog([]))
    faults: list[str] = field(default_factory=list)


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all data sets of numbers.

    Raises:
        InputError: the file is damaged, or a data set's axes cannot be told apart.
    """
    import h5py

    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise InputError(str(path), [f"cannot be opened as HDF5: {error}; copy it again"]) from None
    with file:
        content = _File()
        try:
            _collect(content, file, "", dict(file.attrs), 0)
            blocks = [part for name in content.groups for part in _sets(content, name)]
            for group, parts in blocks:
                name = _stream_name(group, parts, blocks)
                content.log.streams += _stream(content, group, name, parts)
        except (OSError, RuntimeError, KeyError, ValueError) as error:
            raise InputError(
                str(path), [f"is damaged: {type(error).__name__}: {error}; copy it again"]
            ) from None
    if not content.log.streams and not content.faults:
        reasons = [f"data set {name}: {why}" for name, why in content.log.ignored.items()]
        content.faults += reasons or ["holds no data set of numbers"]
    if content.faults:
        raise InputError(str(path), content.faults)
    return content.log


def _collect(
    content: _File,
    group: Any,  # noqa: ANN401  (h5py has no types)
    path: str,
    inherited: dict[str, object],
    depth: int,
) -> None:
    """Data sets of a group and the groups in it; links to other files are not followed."""
    import h5py

    content.scalars.setdefault(path, {}).update(inherited)
    for key, value in group.attrs.items():
        content.log.about[f"{path}{key}" if not path else f"{path}/{key}"] = arrays.shorten(value)
    for key in group:
        full = f"{path}/{key}" if path else key
        link = group.get(key, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            content.log.ignored[full] = f"is a link to another file ({link.filename})"
            continue
        if not isinstance(link, h5py.HardLink):
            continue  # a soft link shows what stands elsewhere in the file too
        item = group[key]
        if isinstance(item, h5py.Group) and depth < _MAX_DEPTH:
            _collect(content, item, full, {**inherited, **dict(item.attrs)}, depth + 1)
        elif isinstance(item, h5py.Dataset):
            _sort(content, path, key, full, item)


def _sort(content: _File, group: str, key: str, full: str, item: Any) -> None:  # noqa: ANN401
    why = _refusal(item)
    if why:
        content.log.ignored[full] = why
    elif item.shape == ():
        content.scalars[group][key] = item[()]
        content.log.about[full] = arrays.shorten(item[()])
    else:
        content.groups.setdefault(group, []).append((key, item))


def _refusal(item: Any) -> str:  # noqa: ANN401
    if item.external or item.is_virtual:
        return "keeps its data in another file"
    if item.dtype.names:
        kinds = {item.dtype[name].base.kind for name in item.dtype.names}
        return "" if kinds & set("biuf") else "holds no numbers"
    if item.shape is None or 0 in item.shape:
        return "is empty"
    if item.dtype.kind not in "biuf" or item.dtype.itemsize > 8:
        return f"holds {item.dtype}, no numbers"
    if len(item.shape) > 2:
        return f"has {len(item.shape)} dimensions; store it as (samples, components)"
    return ""


def _sets(content: _File, group: str) -> list[tuple[str, list[_Part]]]:
    """Data sets of a group that have equally many samples."""
    items = content.groups[group]
    lengths = {item.shape[0] for _, item in items if len(item.shape) == 1}
    lengths |= {s[0] for _, item in items for s in [item.shape] if len(s) == 2 and s[0] > s[1]}
    sets: dict[int, list[_Part]] = {}
    for key, item in items:
        turned = False
        if len(item.shape) == 2 and item.shape[0] <= item.shape[1] and item.shape[0] not in lengths:
            if item.shape[1] not in lengths:
                content.faults.append(arrays.ambiguous(f"{group}/{key}".strip("/"), item.shape))
                continue
            turned = True
        part = _Part(key, item, turned, dict(item.attrs))
        if part.width > arrays.MAX_COLUMNS:
            full = f"{group}/{key}".strip("/")
            content.log.ignored[full] = f"has {part.width} components; at most {arrays.MAX_COLUMNS}"
            continue
        sets.setdefault(part.samples, []).append(part)
    longest = max(sets, default=0)
    kept = []
    for samples, parts in sets.items():
        if samples < arrays.MIN_SAMPLES <= longest:
            for part in parts:
                full = f"{group}/{part.name}".strip("/")
                why = f"has only {samples} samples beside {longest}: kept as a parameter"
                content.log.ignored[full] = why
                if part.item.size <= _MAX_SHOWN:
                    content.log.about[full] = arrays.shorten(np.asarray(part.item[()]))
        else:
            kept.append((group, parts))
    return kept


def _stream_name(group: str, parts: list[_Part], blocks: list[tuple[str, list[_Part]]]) -> str:
    same = [one for one, _ in blocks if one == group]
    if len(same) == 1:
        return group or "log"
    short = arrays.stream_name([part.name for part in parts], single=False)
    return f"{group}/{short}" if group else short


def _stream(content: _File, group: str, name: str, parts: list[_Part]) -> list[RawStream]:
    block = Block(name)
    truncated = ""
    for part in parts:
        columns, cut = _columns(part, block)
        truncated = truncated or cut
        block.columns += columns
    shortest = min(len(column.values) for column in block.columns)
    if not shortest:
        content.faults.append(f"{name}: {truncated}")
        return []
    for column in block.columns:
        column.values = column.values[:shortest]
    scalars = dict(content.scalars[group])
    for part in parts:
        scalars |= {f"{part.name}.{key}": value for key, value in part.attributes.items()}
    stream = arrays.stream_of(block, scalars)
    stream.truncated = truncated
    content.log.repairs += block.repairs
    return [stream]


def _columns(part: _Part, block: Block) -> tuple[list[RawColumn], str]:
    """Columns of one data set, and what could not be read of it."""
    unit = next((str(_text(part.attributes[u])) for u in _UNITS if u in part.attributes), "")
    if part.item.dtype.names:
        return _fields(part, block), ""
    plain, in_name = arrays.split_unit(part.name)
    if part.item.dtype.kind in "iu" and part.item.dtype.itemsize == 8 and part.width == 1:
        values = [arrays.floats(part.rows(slice(None)).reshape(-1), plain, block)]
        cut = ""
    else:
        values, cut = _spooled(part)
    unit = unit or in_name or ("1" if part.item.dtype.kind == "b" else "")
    if len(part.item.shape) == 1:
        return [RawColumn(plain, values[0], unit)], cut
    if part.turned:
        text = f"{part.name} is stored as (components, samples) and was turned"
        block.repairs.append(Repair("turned_axes", INFO, text, block.name, part.name))
    block.repairs += arrays.quaternion_note(plain, part.width, block.name)
    names = arrays.component_names(plain, part.width, letters=True)
    pairs = zip(names, values, strict=True)
    return [RawColumn(full, column, unit) for full, column in pairs], cut


def _spooled(part: _Part) -> tuple[list[np.ndarray], str]:
    spool = Spool(part.width)
    chunk = (part.item.chunks or (1, 1))[1 if part.turned else 0]
    step = max(chunk, _TOGETHER // part.width // chunk * chunk, 1)
    cut = ""
    for start in range(0, part.samples, step):
        stop = min(start + step, part.samples)
        rows, cut = _intact_chunks(part, start, stop, chunk)
        for piece in rows:
            spool.append(piece.reshape(len(piece), part.width).astype(np.float64))
        if cut:
            break
    return list(spool.columns()), cut


def _intact_chunks(part: _Part, start: int, stop: int, chunk: int) -> tuple[list[np.ndarray], str]:
    """Samples of a range; where something in it is damaged, all chunks before that."""
    try:
        return [part.rows(slice(start, stop))], ""
    except (OSError, RuntimeError) as error:
        chunks = []
        for first in range(start, stop, chunk):
            try:
                chunks.append(part.rows(slice(first, min(first + chunk, stop))))
            except (OSError, RuntimeError):
                text = str(error).splitlines()[0][:200]
                where = f"data set {part.item.name} cannot be read from sample {first + 1} on"
                return chunks, f"{where} ({text})"
        return chunks, ""


def _fields(part: _Part, block: Block) -> list[RawColumn]:
    """A table: every numeric field is a column."""
    table = part.rows(slice(None))
    columns = []
    for name in table.dtype.names or ():
        columns += arrays.field_columns(name, table[name], block)
    return columns


def _text(value: Any) -> Any:  # noqa: ANN401
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value
