"""From named arrays (MATLAB, HDF5, NumPy, PyTorch) to streams of columns."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import numpy as np

from simcompare.hardware.raw import RawColumn, RawStream, room
from simcompare.model.recording import INFO, WARNING, Clock, Repair
from simcompare.model.trajectory import Array

#: more components than this are no channels
MAX_COLUMNS = 256
#: groups with fewer samples are parameters, where a longer group is there
MIN_SAMPLES = 8
#: whole numbers beyond it may have no float64
_EXACT = 1 << 53
#: nanoseconds since 1970 of the years 1973 to 2116
_EPOCH_NS = (10**17, 4_600_000_000_000_000_000)
_TIME = re.compile(
    r"^(t|time|times|timestamps?|time[_ ]?stamps?|stamps?|zeit|elapsed[_ ]?time)"
    r"(?:[_ ]*[\[(]?(s|ms|us|µs|ns|sec|seconds)[\])]?)?$",
    re.IGNORECASE,
)
_QUATERNION = re.compile(r"quat", re.IGNORECASE)
_UNIT = re.compile(r"^(.*?)\s*[\[(]([^\[\]()]+)[\])]\s*$")
_RATES = ("sampling_rate", "sample_rate", "sampling_frequency", "fs", "rate_hz", "samplerate",
          "sampling_rate_hz", "sample_rate_hz", "fs_hz")  # fmt: skip
_STEPS = ("dt", "dt_s", "sampling_interval", "sample_interval", "ts", "timestep", "time_step")


@dataclass
class Block:
    """Arrays that were sampled together.

    Attributes:
        name: of the stream.
        columns: all of them.
        repairs: what was noticed on the way.
        start: ISO 8601 time of the first sample, where the log says.
    """

    name: str
    columns: list[RawColumn] = field(default_factory=list)
    repairs: list[Repair] = field(default_factory=list)
    start: str = ""


def component_names(name: str, width: int, *, letters: bool) -> list[str]:
    """Names of the columns of a matrix; three and four components of a vector get letters."""
    if letters and width == 3:
        return [f"{name}.{letter}" for letter in "xyz"]
    if letters and width == 4 and _QUATERNION.search(name):
        return [f"{name}.{letter}" for letter in "wxyz"]
    return [f"{name}.{i}" for i in range(width)]


def quaternion_note(name: str, width: int, stream: str) -> list[Repair]:
    """What has to be known of a quaternion whose order the log does not say."""
    if width != 4 or not _QUATERNION.search(name):
        return []
    text = f"{name} has four components; they are called w, x, y, z in the order of the log"
    return [Repair("quaternion_order", INFO, text, stream, name)]


def split_unit(name: str) -> tuple[str, str]:
    """Name and unit of ``Pressure (hPa)`` or ``speed [m/s]``."""
    match = _UNIT.match(name)
    return (match[1], match[2].strip()) if match and match[1] else (name, "")


def time_of(names: Iterable[str]) -> tuple[str | None, str]:
    """The column that is called a time, and the unit in its name; none where several are."""
    times = [(name, match[2]) for name in names for match in [_TIME.match(name.strip())] if match]
    if len(times) != 1:
        return None, ""
    unit = (times[0][1] or "").lower()
    return times[0][0], {"sec": "s", "seconds": "s"}.get(unit, unit)


def increment_of(values: Mapping[str, object]) -> tuple[float | None, str]:
    """Time between samples that attributes or scalars tell, and the name that told it."""
    for name, value in values.items():
        key = name.rpartition("/")[2].rpartition(".")[2].lower().replace(" ", "_")
        number = _positive(value)
        if number is not None and key in _RATES:
            return 1 / number, name
        if number is not None and key in _STEPS:
            return number, name
    return None, ""


def _positive(value: Any) -> float | None:  # noqa: ANN401  (whatever a log may hold)
    try:
        array = np.asarray(value)
        if array.size != 1 or array.dtype.kind not in "iuf":
            return None
        number = float(array.reshape(-1)[0])
    except (TypeError, ValueError):
        return None
    return number if np.isfinite(number) and number > 0 else None


def floats(values: np.ndarray, name: str, block: Block) -> Array:
    """A writable float64 copy; what is lost by it is recorded.

    Raises:
        TypeError: the values are no numbers.
    """
    kind = values.dtype.kind
    if kind in "mM":
        return _instants(values, name, block)
    if kind not in "biuf" or values.dtype.itemsize > 8:
        raise TypeError(f"holds {values.dtype}, no numbers")
    if kind in "iu" and values.dtype.itemsize == 8 and len(values):
        low, high = int(values.min()), int(values.max())
        if max(-low, high) > _EXACT:
            return _large(values, name, block)
    copied = room(len(values))
    copied[:] = values
    return copied


def _large(values: np.ndarray, name: str, block: Block) -> Array:
    """Counts beyond 2^53: a time keeps its nanoseconds when it is counted from its first value."""
    if time_of([name])[0] is None:
        text = "has values beyond 2^53, which were rounded to 53 bits"
        block.repairs.append(Repair("rounded", WARNING, f"{name} {text}", block.name, name))
        return values.astype(np.float64)
    first = int(values[0])
    signed = values.astype(np.int64) if values.dtype.kind == "i" else values
    # unsigned differences must not wrap
    counts = np.where(signed >= first, signed - first, -(first - signed).astype(float))
    if _EPOCH_NS[0] < first < _EPOCH_NS[1]:
        block.start = iso_ns(first)
    text = f"{name} is counted from its first value {first}, so that float64 keeps every count"
    block.repairs.append(Repair("time_origin", INFO, text, block.name, name))
    return counts


def _instants(values: np.ndarray, name: str, block: Block) -> Array:
    """Instants and spans of time in seconds; instants from the first one on."""
    missing = np.isnat(values)
    if values.dtype.kind == "m":
        nanoseconds = values.astype("m8[ns]").astype(np.int64)
        first = 0
    else:
        nanoseconds = values.astype("M8[ns]").astype(np.int64)
        good = nanoseconds[~missing]
        first = int(good[0]) if len(good) else 0
        block.start = block.start or iso_ns(first)
        text = f"{name} is given in seconds from its first value, {iso_ns(first)}"
        block.repairs.append(Repair("time_origin", INFO, text, block.name, name))
    seconds = (nanoseconds - first) / 1e9
    seconds[missing] = np.nan
    return np.asarray(seconds, dtype=np.float64)


def iso_ns(ns: int) -> str:
    """An instant as ISO 8601 with nanoseconds."""
    seconds, rest = divmod(ns, 1_000_000_000)
    try:
        return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%dT%H:%M:%S}.{rest:09d}Z"
    except (OverflowError, ValueError, OSError):
        return ""


def field_columns(name: str, values: np.ndarray, block: Block) -> list[RawColumn]:
    """Columns of one field of a table; a field that holds no numbers has none."""
    plain, unit = split_unit(name)
    if values.dtype.kind not in "biufmM" or values.dtype.itemsize > 8 or values.ndim > 2:
        text = f"field {name} holds {values.dtype}, no numbers; it was left out"
        block.repairs.append(Repair("field_left_out", INFO, text, block.name, name))
        return []
    if values.ndim == 1:
        return [RawColumn(plain, floats(values, plain, block), unit)]
    names = component_names(plain, values.shape[1], letters=True)
    block.repairs += quaternion_note(plain, values.shape[1], block.name)
    return [
        RawColumn(full, floats(values[:, i], full, block), unit) for i, full in enumerate(names)
    ]


def ambiguous(name: str, shape: tuple[int, ...]) -> str:
    """The fault of a matrix whose axes cannot be told apart."""
    return (
        f"{name} has the shape {shape[0]}×{shape[1]}: samples may be its rows or its columns;"
        f" store it as (samples, components) beside a vector of times with as many entries"
    )


def stream_of(
    block: Block, scalars: Mapping[str, object], *, row_word: str = "sample"
) -> RawStream:
    """A stream of the columns of a block, with the clock that it or its scalars tell.

    Args:
        block: columns of equal length.
        scalars: attributes and single numbers that may hold the rate.
        row_word: what one row is.
    """
    name, unit = time_of(column.name for column in block.columns)
    if name is not None:
        column = next(column for column in block.columns if column.name == name)
        column.unit = column.unit or unit
        if any(r.rule == "time_origin" and "seconds from" in r.text for r in block.repairs):
            column.unit = "s"
        clock = Clock(f"column {name}", block.start)
        return RawStream(block.name, block.columns, name, clock=clock, row_word=row_word)
    step, source = increment_of(scalars)
    clock = Clock(f"{source} {1 / step:.6g} Hz" if step else "none", block.start)
    if step:
        text = f"no column is a time; samples are {step!r} s apart, as {source} says"
        block.repairs.append(Repair("even_samples", INFO, text, block.name))
    return RawStream(block.name, block.columns, None, 0.0, step, clock=clock, row_word=row_word)


def stream_name(names: Sequence[str], single: bool) -> str:
    """Name of a stream by its arrays: "log" where there is only one."""
    if single:
        return "log"
    return "+".join(names) if len(names) <= 3 else f"{names[0]}+{len(names) - 1}"


def shorten(value: Any) -> str:  # noqa: ANN401  (whatever a log may hold)
    """A value of a log as one short text."""
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    text = np.array2string(value, threshold=32) if isinstance(value, np.ndarray) else str(value)
    return text if len(text) <= 4000 else f"{text[:4000]}…"
