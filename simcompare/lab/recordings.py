"""Recordings of a ball that were sent to the lab: what bounces in them, and how well it is seen."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.fitting.bounces import reading, tables
from simcompare.fitting.bounces.bounce_models import GRAVITY
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.lab.contents import SOUND
from simcompare.lab.envelope import envelope
from simcompare.lab.faults import for_page
from simcompare.lab.numbers import shortened
from simcompare.model.plain import Plain
from simcompare.model.recording import Channel, Event, Recording
from simcompare.verbs.import_log import import_log

#: what is said where no impact is heard
_NOTHING = (
    "No impact of a ball is heard: there are only voices, noise or music. Drop the ball on a hard"
    " floor near the microphone, where it is quiet, and record again."
)
#: what is said where impacts are not those of one ball, of which there are more than so many
_MIXED = (
    "These impacts are not those of one ball: is there music, a voice or a second ball? Drop one"
    " ball where it is quiet, and record again."
)
_FEW = 3
#: part of full scale at which a sound is cut off, and how many samples there make it clipped
_FULL, _CLIPPED = 0.999, 20
#: largest value of a sound in which nothing is heard
_SILENT = 1e-3
#: so many impacts are told with their times; part of them that must belong to one ball
_MOST, _ENOUGH = 400, 0.7
_AGAIN = "record again"
#: how compressed sounds begin
_COMPRESSED = (b"OggS", b"ID3", b"\xff\xfb", b"\xff\xf3", b"\xff\xf2", b"\x1aE\xdf\xa3")
#: folder beside a file in which what was read of it is stored
IMPORTED = "imported"
#: notes of single impacts that are told
_TOLD = 3


def received(path: Path, kind: str) -> Plain:
    """What is in a sound or a table of a bouncing ball.

    Args:
        path: the file.
        kind: "sound" or "table".

    Returns:
        Impacts with times and standard uncertainties, the waveform, and notes: what is wrong with
        it, or must be known, in sentences. Where nothing bounces, there are notes and no ``drop``.

    Raises:
        InputError: it is no recording that can be read.
    """
    if kind == SOUND:
        return _of_sound(path)
    is_table = tables.is_table(path)
    recording = None if is_table else import_log(path, out=path.with_name(IMPORTED))
    return {"kind": kind, **_drop_of(path, recording)}


def _of_sound(path: Path) -> Plain:
    _refuse_others(path)
    recording = import_log(path, out=path.with_name(IMPORTED))
    if not recording.streams:
        raise InputError(path.name, ["holds no sound that is a number throughout; record again"])
    stream = next(iter(recording.streams.values()))
    sound = _heard(recording)
    heard = _impacts(recording)
    rate_hz = (len(stream.time_s) - 1) / float(stream.time_s[-1] - stream.time_s[0])
    notes = [*_of_loudness(sound)]
    found = _drop_of(path, recording) if heard else {}
    notes += found.pop("notes", []) if heard or notes else [_NOTHING]
    return {
        "kind": SOUND,
        "rate_hz": shortened(rate_hz),
        "duration_s": shortened(float(stream.time_s[-1])),
        "wave": envelope(stream.time_s, sound.values),
        **found,
        "impacts": [_impact(one) for one in heard[:_MOST]],
        "notes": notes,
    }


def _refuse_others(path: Path) -> None:
    """Raises ``InputError`` for what is no sound that is stored sample by sample."""
    with path.open("rb") as file:
        start = file.read(12)
    if start[:4] in (b"RIFF", b"RF64", b"BW64", b"fLaC"):
        return
    is_compressed = start.startswith(_COMPRESSED) or start[4:8] == b"ftyp"
    text = (
        "is a compressed sound, in which an impact is smeared over milliseconds"
        if is_compressed
        else "is no sound that is read here"
    )
    raise InputError(path.name, [f"{text}; record with the page, or export it as WAV or FLAC"])


def _heard(recording: Recording) -> Channel:
    """The channel in which impacts were looked for, the first one where none was."""
    stream = next(iter(recording.streams.values()))
    told = next((r.channel for r in recording.provenance.repairs if r.rule == "onsets"), None)
    every = list(stream.channels.items())
    return next((one for name, one in every if told in (name, one.raw)), every[0][1])


def _impacts(recording: Recording) -> list[Event]:
    return [one for one in recording.events if one.name == "impact"]


def _impact(event: Event) -> Plain:
    return {"time_s": round(event.time_s, 7), "u_s": shortened(event.u_s)}


def _of_loudness(sound: Channel) -> Iterator[str]:
    """What is wrong with how loud a sound is."""
    size = np.abs(np.nan_to_num(sound.values))
    loudest = float(size.max(initial=0.0))
    if loudest < _SILENT:
        yield (
            "This is silence: the microphone is off, muted, or another one is chosen. Allow it"
            f" and {_AGAIN}."
        )
    elif np.count_nonzero(size > _FULL * max(loudest, 1.0 - 1e-4)) > _CLIPPED:
        yield (
            "The sound is clipped: it was too loud for the microphone, which blurs when an impact"
            f" began. Move the microphone away from the ball and {_AGAIN}."
        )


def _drop_of(path: Path, recording: Recording | None) -> Plain:
    """The first drop of a ball; notes alone where there is none."""
    try:
        if recording is None:
            drops: Sequence[Impacts] = (tables.read(path, None),)
        else:
            drops = reading.from_recording(recording)
    except InputError as error:
        several = recording is not None and len(_impacts(recording)) > _FEW
        notes = [*([_MIXED] if several else []), *map(_sentence, map(for_page, error.faults))]
        return {"notes": notes, "impacts": []}
    first = drops[0]
    times = [
        {"time_s": round(float(at), 7), "u_s": shortened(float(u))}
        for at, u in zip(first.times_s, first.u_s, strict=True)
    ]
    return {"notes": list(_of_drops(drops)), "drop": drop(first), "impacts": times}


def _sentence(fault: str) -> str:
    text = fault[:1].upper() + fault[1:]
    return text if text.endswith(".") else f"{text}."


def _of_drops(drops: Sequence[Impacts]) -> Iterator[str]:
    first = drops[0]
    if len(drops) > 1:
        yield f"{len(drops)} drops follow each other; all of them are fitted together."
    out = sum(other.what == "impact" for one in drops for other in one.dropped)
    whole = out + sum(len(one.times_s) for one in drops)
    if whole and out > (1 - _ENOUGH) * whole:
        yield f"{_MIXED} {out} of {whole} are left out."
    for one in [one for one in first.dropped if one.what == "impact"][:_TOLD]:
        yield f"Impact {one.number} at {one.time_s:.3f} s is left out: {one.reason}."
    for number in first.missed:
        yield f"Impact {number} was not heard; the flights about it count as one."
    yield from first.notes


def drop(one: Impacts) -> Plain:
    """What of a drop is compared with engines.

    The restitution of each bounce is the ratio of the flights about it; heights are those of the
    flights after each impact. The drop height is that of the flight before the first impact, if
    that bounced like the others. ``left_out`` are places of impacts, the first is 0.
    """
    flights = _flights(one)
    numbers = sorted(flights)
    ratios = {
        n: flights[n] / flights[n - 1] for n in numbers if n - 1 in flights and flights[n - 1] > 0
    }
    middle = float(np.median(list(ratios.values()))) if ratios else None
    heights = {n: GRAVITY * flights[n] ** 2 / 8 for n in numbers}
    first = heights.get(1)
    stated = {n: float(h) for n, h in zip(one.height_numbers, one.heights_m, strict=True)}
    fallen = None if first is None or middle is None else first / middle**2
    height = stated.get(0, fallen)
    return {
        "count": one.count,
        "restitution": [{"bounce": n, "value": shortened(v)} for n, v in ratios.items()],
        "middle": shortened(middle),
        "heights_m": [{"bounce": n, "value": shortened(v)} for n, v in heights.items()],
        "drop_height_m": shortened(height),
        "left_out": [other.number - 1 for other in one.dropped if other.what == "impact"],
        "begin_s": _begin_s(one, height),
    }


def _flights(one: Impacts) -> dict[int, float]:
    """Length of each flight by the impact at which it begins [s]."""
    found = one.flights
    flights = dict(zip(found.numbers.tolist(), found.lengths_s.tolist(), strict=True))
    for number, height in zip(one.height_numbers, one.heights_m, strict=True):
        if number > 0:
            flights.setdefault(int(number), float(np.sqrt(8 * height / GRAVITY)))
    return flights


def _begin_s(one: Impacts, height_m: float | None) -> float | None:
    """When the ball was let go, on the recording's clock; ``None`` where that is not known."""
    if height_m is None or 1 not in one.numbers:
        return None
    first = float(one.times_s[one.numbers.index(1)])
    return shortened(first - float(np.sqrt(2 * height_m / GRAVITY)))


def without(recording: Recording, struck: set[int]) -> Recording:
    """A recording without the impacts that a student struck out.

    Args:
        recording: a sound.
        struck: their places among the impacts, the first is 0.

    Raises:
        InputError: there is no such impact.
    """
    heard = _impacts(recording)
    wrong = sorted(number for number in struck if not 0 <= number < len(heard))
    if wrong:
        raise InputError("struck", [f"there is no impact {wrong[0] + 1}; there are {len(heard)}"])
    left = {id(heard[number]) for number in struck}
    events = tuple(one for one in recording.events if id(one) not in left)
    return dataclasses.replace(recording, events=events)
