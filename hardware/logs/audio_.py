"""Sound recordings (WAV, FLAC): the waveform, and the onsets of impacts as events."""

from __future__ import annotations

import functools
import struct
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream, Spool, blocks
from simcompare.hardware.sensors import sound_onsets
from simcompare.model.recording import INFO, Clock, Event, Repair
from simcompare.model.trajectory import Array

TITLE = "a sound recording (WAV or FLAC)"
#: values that are read together; fewer near a damaged place
_BLOCKS = (1 << 18, 1 << 12, 1 << 6)
#: relative standard uncertainty of a sound card's or telephone's rate
U_RATE = 50e-6
#: bits that hold one sample, by libsndfile's name of the coding
_BITS = {"PCM_S8": 8, "PCM_U8": 8, "PCM_16": 16, "PCM_24": 24, "PCM_32": 32}
_MIN_RATE_HZ, _MAX_RATE_HZ = 2000.0, 2e6


def recognises(head: Head) -> int:
    """How certain it is that the file is a sound recording."""
    start = head.start
    if start.startswith(b"fLaC"):
        return 100
    return 100 if start[:4] in (b"RIFF", b"RF64", b"BW64") and start[8:12] == b"WAVE" else 0


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads the waveform and finds the impacts in it."""
    import soundfile

    try:
        with soundfile.SoundFile(path) as file:
            rate_Hz, coding, kind = float(file.samplerate), str(file.subtype), str(file.format)
            promised, channels = int(file.frames), int(file.channels)
        values, cut = _waveform(path, channels)
    except (soundfile.LibsndfileError, OSError) as error:
        raise InputError(
            str(path), [f"cannot be read as a sound recording: {error}; copy or convert it again"]
        ) from None
    truncated = _truncated(path, len(values[0]), promised, cut)
    if len(values[0]) < 2:
        raise InputError(
            str(path), [f"holds {len(values[0])} samples of sound; expected at least two"]
        )
    true_Hz = float((mapping.time and mapping.time.rate_Hz) or rate_Hz)
    for rate in (rate_Hz, true_Hz):
        if not _MIN_RATE_HZ <= rate <= _MAX_RATE_HZ:
            raise InputError(
                str(path),
                [f"has {rate:g} samples in a second; expected a sound with 2000 Hz to 2 MHz"],
            )
    columns = [
        RawColumn(name, column, "1", limits=_limits(coding))
        for name, column in zip(_names(len(values)), values, strict=True)
    ]
    stream = RawStream(
        "log", columns, increment_s=1 / true_Hz, clock=Clock(f"{true_Hz:g} Hz"),
        row_word="sample", truncated=truncated,
    )  # fmt: skip
    events, note = _impacts(columns, true_Hz, coding)
    about = {
        "coding": f"{kind} {coding}, {len(columns)} channel{'s' if len(columns) > 1 else ''}",
        "clock": f"{true_Hz:g} Hz "
        + (
            "from the mapping file"
            if true_Hz != rate_Hz
            else "as the header says; the true rate of a sound card or telephone differs by"
            f" {U_RATE * 1e6:.0f} ppm (standard uncertainty)"
        ),
    }
    return RawLog([stream], events, [note], about=about)


def _waveform(path: Path, channels: int) -> tuple[list[Array], str]:
    """All channels, and why reading ended early."""
    import soundfile

    spool, cut = Spool(channels), ""
    # where a file is damaged, a whole block is refused: what is whole of it comes in smaller ones
    for size in _BLOCKS:
        count = max(1, size // channels)
        with soundfile.SoundFile(path) as file:
            file.seek(len(spool))
            try:
                while len(frames := file.read(count, dtype="float64", always_2d=True)):
                    spool.append(frames)
            except soundfile.LibsndfileError as error:
                cut = str(error)
                continue
        return spool.columns(), ""
    return spool.columns(), cut


def _truncated(path: Path, count: int, promised: int, cut: str) -> str:
    """What is missing at the end, in words; empty for a whole file."""
    if count < promised < 1 << 62:
        why = f" ({cut})" if cut else ""
        return (
            f"{path.name}: the header promises {promised} samples of each channel,"
            f" {count} can be read{why}"
        )
    size, there, offset = _data_chunk(path)
    if size > there:
        return (
            f"{path.name}: byte {offset + there}: the file ends {size - there} bytes before the"
            f" end of its sound data ({size} bytes were promised)"
        )
    return f"{path.name}: reading ended early ({cut})" if cut else ""


def _data_chunk(path: Path) -> tuple[int, int, int]:
    """Size of a WAV file's sound data as promised and as it is there, and where they begin."""
    length = path.stat().st_size
    with path.open("rb") as file:
        if file.read(12)[:4] != b"RIFF":
            return 0, 0, 0
        while len(head := file.read(8)) == 8:
            name, size = struct.unpack("<4sI", head)
            if name == b"data":
                # recorders that were switched off leave 0 or all bits set: no promise
                promised = 0 if size >= 0xFFFFFF00 else size
                return promised, length - file.tell(), file.tell()
            file.seek(size + size % 2, 1)
    return 0, 0, 0


def _names(count: int) -> list[str]:
    if count == 1:
        return ["sound"]
    return ["left", "right"] if count == 2 else [f"sound_{i + 1}" for i in range(count)]


def _limits(coding: str) -> tuple[float, float] | None:
    bits = _BITS.get(coding)
    return None if bits is None else (-1.0, 1.0 - 2.0 ** (1 - bits))


def _impacts(columns: list[RawColumn], rate_Hz: float, coding: str) -> tuple[list[Event], Repair]:
    """Onsets in the channel that stands out most from its noise."""
    step = 2.0 ** (1 - _BITS.get(coding, 25))
    floor = step / 12**0.5
    best = max(columns, key=lambda column: _contrast(column.values, rate_Hz, floor))
    onsets = sound_onsets.onsets(
        functools.partial(_excerpt, best.values), len(best.values), rate_Hz, floor
    )
    events = [Event("impact", o.time_s, "log", o.u_s, o.peak) for o in onsets]
    alike = sum(o.alike > 0 for o in onsets)
    text = f"{len(onsets)} impacts were found in channel {best.name!r}"
    if onsets:
        worst = max(o.u_s for o in onsets) * 1e3
        text += (
            f"; {alike} of them sound alike and were laid over each other; largest standard"
            f" uncertainty {worst:.2g} ms beside a delay that all share"
        )
    return events, Repair("onsets", INFO, text, "log", best.name, count=len(onsets))


def _excerpt(values: Array, first: int, end: int) -> Array:
    return np.array(values[first:end])


def _contrast(values: Array, rate_Hz: float, floor: float) -> float:
    """Loudest millisecond over the median one."""
    loudest, usual = 0.0, []
    for part in blocks(len(values)):
        heard = sound_onsets.high_passed(np.array(values[part]), rate_Hz)
        width = max(8, round(sound_onsets.ENERGY_S * rate_Hz))
        end = len(heard) // width * width
        energy = (heard[:end].reshape(-1, width) ** 2).mean(axis=1)
        if len(energy):
            loudest = max(loudest, float(energy.max()))
            usual.append(float(np.median(energy)))
    return loudest / max(float(np.median(usual)) if usual else 0.0, floor**2)
