"""LabVIEW's TDMS: one stream for each group, or for each clock where its channels differ."""

from __future__ import annotations

import contextlib
import io
import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import arrays
from simcompare.hardware.logs.binary.arrays import Block
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream
from simcompare.model.recording import WARNING, Clock, Repair

TITLE = "a LabVIEW TDMS file"

_MAGIC, _INDEX = b"TDSm", b"TDSh"
_LEAD_IN = 28
_UNFINISHED = 0xFFFF_FFFF_FFFF_FFFF
_UNITS = ("unit_string", "NI_UnitDescription", "unit", "Unit", "units")
#: modules of npTDMS that say what they notice
_SOURCES = ("base_segment", "channel_data", "daqmx", "reader", "scaling", "tdms", "tdms_segment",
            "types")  # fmt: skip
_MAX_TEXTS = 20
#: properties that say when samples were taken
_WAVEFORM = ("wf_start_time", "wf_start_offset", "wf_increment", "wf_samples")


def recognises(head: Head) -> int:
    """By the signature."""
    return 100 if head.start.startswith((_MAGIC, _INDEX)) else 0


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all channels of numbers.

    Raises:
        InputError: the file is damaged, or holds no numbers.
    """
    import nptdms

    truncated = _missing(path)
    log = RawLog([])
    try:
        with _Bounded(path) as raw, _heard(log), nptdms.TdmsFile.open(raw) as file:
            _properties(file.properties, "", log)
            for group in file.groups():
                _group(group, log, truncated)
    except InputError:
        raise
    # npTDMS raises many kinds for damaged files
    except Exception as error:  # noqa: BLE001
        place = f" ({truncated})" if truncated else ""
        raise InputError(
            str(path), [f"is a damaged TDMS file: {type(error).__name__}: {error}{place}"]
        ) from None
    if not log.streams:
        reasons = [f"channel {name}: {why}" for name, why in log.ignored.items()]
        reasons += [truncated] if truncated else []
        raise InputError(str(path), reasons or ["holds no channels"])
    return log


class _Bounded(io.BufferedReader):
    """A file of which no more is asked for than there is, whatever length it claims."""

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path))
        self._size = path.stat().st_size

    def read(self, size: int | None = -1, /) -> bytes:
        """The next bytes.

        Raises:
            ValueError: a text is longer than the rest of the file.
        """
        rest = max(self._size - self.tell(), 0)
        if size is not None and size > max(rest, _LEAD_IN):
            raise ValueError(f"a text of {size} bytes at byte {self.tell()}; {rest} are left")
        return super().read(rest if size is None or size < 0 else min(size, rest))


@contextlib.contextmanager
def _heard(log: RawLog) -> Iterator[None]:
    """What npTDMS notices goes into the record, not onto the screen."""
    ear = _Ear()
    sources = [logging.getLogger(f"nptdms.{name}") for name in _SOURCES]
    before = [list(source.handlers) for source in sources]
    for source in sources:
        source.handlers[:] = [ear]
    try:
        yield
    finally:
        for source, handlers in zip(sources, before, strict=True):
            source.handlers[:] = handlers
        log.repairs += [Repair("damaged_record", WARNING, f"npTDMS: {text}") for text in ear.texts]


class _Ear(logging.Handler):
    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.texts: dict[str, None] = {}

    def emit(self, record: logging.LogRecord) -> None:
        """Keeps what is said once."""
        if len(self.texts) < _MAX_TEXTS:
            self.texts[record.getMessage()[:300]] = None


def _missing(path: Path) -> str:
    """What is missing at the end, by the lengths that the segments tell.

    Raises:
        InputError: it is the index of a TDMS file, or a segment is no segment.
    """
    size = path.stat().st_size
    at = 0
    with path.open("rb") as file:
        while at < size:
            file.seek(at)
            lead = file.read(_LEAD_IN)
            if lead[:4] == _INDEX and at == 0:
                name = path.name.removesuffix("_index")
                raise InputError(str(path), [f"is only an index; give the file {name} itself"])
            if lead[:4] != _MAGIC[: len(lead)]:
                fault = f"byte {at}: {lead[:4]!r} stands where a segment ('TDSm') should begin"
                if at == 0:
                    raise InputError(str(path), [fault])
                return f"{fault}; what follows was not read"
            if len(lead) < _LEAD_IN:
                return f"byte {at}: the last segment has only {len(lead)} bytes"
            length = int.from_bytes(lead[12:20], "little")
            if length == _UNFINISHED:
                return f"byte {at}: the last segment was never finished; its end may be missing"
            if at + _LEAD_IN + length > size:
                missing = at + _LEAD_IN + length - size
                return f"byte {at}: {missing} bytes of the last segment are missing"
            at += _LEAD_IN + length
    return ""


def _properties(properties: Any, prefix: str, log: RawLog) -> None:  # noqa: ANN401  (whatever a file may hold)
    for name, value in properties.items():
        log.about[f"{prefix}{name}"] = arrays.shorten(value)


def _group(group: Any, log: RawLog, truncated: str) -> None:  # noqa: ANN401  (npTDMS has few types)
    _properties(group.properties, f"{group.name}.", log)
    clocks: dict[tuple[Any, ...], list[Any]] = {}
    for channel in group.channels():
        full = f"{group.name}/{channel.name}"
        hidden = {k: v for k, v in channel.properties.items() if k not in (*_WAVEFORM, *_UNITS)}
        _properties(hidden, f"{full}.", log)
        why = _refusal(channel)
        if why:
            log.ignored[full] = why
            continue
        waveform = tuple(channel.properties.get(name) for name in _WAVEFORM[:3])
        clocks.setdefault((len(channel), *map(str, waveform)), []).append(channel)
    for channels in clocks.values():
        joined = arrays.stream_name([channel.name for channel in channels], single=False)
        name = group.name if len(clocks) == 1 else f"{group.name}/{joined}"
        log.streams.append(_stream(name, channels, log, truncated))


def _refusal(channel: Any) -> str:  # noqa: ANN401
    if len(channel) == 0:
        return "holds no samples"
    dtype = channel.dtype
    if dtype is None or np.dtype(dtype).kind not in "biufmM" or np.dtype(dtype).itemsize > 8:
        return f"holds {dtype}, no real numbers"
    return ""


def _stream(name: str, channels: list[Any], log: RawLog, truncated: str) -> RawStream:
    block = Block(name)
    for channel in channels:
        stated = next((str(channel.properties[u]) for u in _UNITS if channel.properties.get(u)), "")
        plain, unit = arrays.split_unit(channel.name)
        if np.dtype(channel.dtype).kind in "mM":
            stated = "s"
        values = arrays.floats(np.asarray(channel[:]), channel.name, block)
        block.columns.append(RawColumn(plain, values, stated or unit))
    stream = arrays.stream_of(block, {})
    _clock(stream, channels[0].properties, block)
    stream.truncated = truncated
    log.repairs += block.repairs
    return stream


def _clock(stream: RawStream, properties: Any, block: Block) -> None:  # noqa: ANN401
    """Evenly spaced samples where no channel is the time."""
    step = properties.get("wf_increment")
    start = properties.get("wf_start_time")
    first = (
        arrays.iso_ns(int(np.datetime64(start, "ns").astype(np.int64))) if start else block.start
    )
    if stream.time is not None or not isinstance(step, (int, float)) or not step > 0:
        stream.clock = Clock(stream.clock.name, block.start or first)
        return
    stream.increment_s = float(step)
    stream.start_s = float(properties.get("wf_start_offset") or 0.0)
    stream.clock = Clock(f"wf_increment {1 / float(step):.6g} Hz", first)
