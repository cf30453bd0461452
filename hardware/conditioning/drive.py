"""A robot on two wheels: whether its wheels' speeds lead where it is known to have been.

    drive: {left: velocity_left, right: velocity_right, track_m: 0.0785, x: x, y: y}

Left and right are exchanged in a log as easily as half of a track is taken for the whole. Neither
shows in the speeds; both show in the path. So the path is reckoned as the log says, and with each
such mistake undone. What is found is told with its numbers, and nothing is changed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from pydantic import BaseModel, ConfigDict, PositiveFloat

from simcompare.errors import InputError
from simcompare.hardware.conditioning.strict import refused
from simcompare.hardware.sensors import odometer
from simcompare.model.recording import WARNING, Recording, Repair
from simcompare.model.trajectory import Array

#: factors of the track that are tried: half and twice of it are taken for each other
FACTORS = (1.0, 2.0, 0.5)
#: told where the path as given misses by more than this part of its length, and another fits so
#: much better
MISSES, BETTER = 0.02, 3.0
#: fewest samples that are looked at
LEAST = 10


class Drive(BaseModel):
    """Which channels are the wheels and the place of a robot.

    Attributes:
        left: channel of the left wheel's speed [m/s], or of its rate [rad/s].
        right: channel of the right wheel.
        wheel_radius_m: of the wheels, where the channels are rates.
        track_m: distance of the wheels.
        x: channel with the true place.
        y: channel with the true place.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    left: str
    right: str
    wheel_radius_m: PositiveFloat | None = None
    track_m: PositiveFloat
    x: str
    y: str


@dataclass(frozen=True)
class Reading:
    """One way to read the wheels, and what comes of it.

    Attributes:
        exchanged: whether left and right are exchanged.
        factor: of the track.
        rms_m: root mean square distance from the truth, after the best turn and shift.
    """

    exchanged: bool
    factor: float
    rms_m: float


def noted(recording: Recording, drive: Drive | None, where: str) -> Recording:
    """The same recording, with a warning where its wheels do not lead to its places.

    Args:
        recording: in SI.
        drive: the block of the mapping file; nothing is looked at where ``None``.
        where: file and key, for messages.

    Raises:
        InputError: channels of another unit, or a suspicion where the mode is "strict".
        UnknownName: a channel that the recording does not have.
    """
    if drive is None:
        return recording
    wheels, place = _arrays(recording, drive, where)
    if len(wheels) < LEAST:
        return recording
    length = float(np.hypot(*np.diff(place, axis=0).T).sum())
    found = list(readings(wheels, drive.track_m, place))
    best = min(found, key=lambda reading: reading.rms_m)
    if found[0].rms_m < MISSES * length or found[0].rms_m < BETTER * best.rms_m:
        return recording
    text = suspicion(drive, found[0], best, length)
    numbers = {"rms_m": found[0].rms_m}, {"rms_m": best.rms_m}
    repair = Repair("drive", WARNING, text, before=numbers[0], after=numbers[1])
    if recording.provenance.mode == "strict":
        raise InputError(where, [refused(repair)])
    about = recording.provenance
    return replace(recording, provenance=replace(about, repairs=(*about.repairs, repair)))


def readings(wheels: Array, track_m: float, place: Array) -> Iterator[Reading]:
    """How far each way to read the wheels misses the truth, the one as given first.

    Args:
        wheels: time [s], speeds of the left and the right wheel [m/s] (n, 3).
        track_m: distance of the wheels as given.
        place: true places at the same times (n, 2).
    """
    time_s, left, right = wheels.T
    ways = [
        np.concatenate(([0.0], np.cumsum(np.diff(time_s) * (v[1:] + v[:-1]) / 2)))
        for v in (left, right)
    ]
    for exchanged in (False, True):
        first, second = ways[::-1] if exchanged else ways
        for factor in FACTORS:
            path = odometer.poses(odometer.arcs(first, second, track_m * factor))[:, :2]
            yield Reading(exchanged, factor, apart(path, place))


def apart(path: Array, place: Array) -> float:
    """Root mean square distance of two paths after the best turn and shift of one (Kabsch)."""
    ours, true = path - path.mean(axis=0), place - place.mean(axis=0)
    u, _, v = np.linalg.svd(ours.T @ true)
    turn = u @ np.diag((1.0, np.sign(np.linalg.det(u @ v)))) @ v
    return math.sqrt(float(np.mean(np.sum((ours @ turn - true) ** 2, axis=1))))


def suspicion(drive: Drive, given: Reading, best: Reading, length_m: float) -> str:
    """What was found, in words, and how the log is read so."""
    changes, cures = [], []
    if best.exchanged:
        changes.append("left and right exchanged (or a truth whose frame is mirrored)")
        cures.append(f"exchange the columns of {drive.left} and {drive.right}")
    if best.factor != 1:
        track = f"{drive.track_m * best.factor:.4g}"
        changes.append(f"{'twice' if best.factor > 1 else 'half'} the track, {track} m,")
        cures.append(f"write track_m: {track} under drive:")
    return (
        f"dead reckoning with left, right and the track of {drive.track_m:.4g} m as given misses"
        f" the truth by {given.rms_m:.2g} m rms over {length_m:.3g} m, after the best turn and"
        f" shift; with {' and '.join(changes)} by {best.rms_m:.2g} m. Nothing was changed; to read"
        f" it so, {' and '.join(cures)} in the mapping file"
    )


def _arrays(recording: Recording, drive: Drive, where: str) -> tuple[Array, Array]:
    """Time and speeds (n, 3) where the truth is known, and the places there (n, 2)."""
    unit, factor = "m/s", 1.0
    if drive.wheel_radius_m is not None:
        unit, factor = "rad/s", drive.wheel_radius_m
    time_s, left, right = _pair(recording, (drive.left, drive.right), unit, where)
    true_s, x, y = _pair(recording, (drive.x, drive.y), "m", where)
    inside = (time_s >= true_s[0]) & (time_s <= true_s[-1]) if len(true_s) else time_s < time_s
    time_s = time_s[inside]
    wheels = np.column_stack((time_s, factor * left[inside], factor * right[inside]))
    place = np.column_stack([np.interp(time_s, true_s, v) for v in (x, y)]) if len(time_s) else x
    return wheels, place


def _pair(
    recording: Recording, names: Sequence[str], unit: str, where: str
) -> tuple[Array, Array, Array]:
    """Times on the log's own clock and the values of two channels, where both are known."""
    found = [recording.find(name) for name in names]
    if found[0][0] != found[1][0]:
        raise InputError(where, [f"{' and '.join(names)} are of two streams; one is needed"])
    stream = recording.streams[found[0][0]]
    channels = [stream.channels[name] for _, name in found]
    wrong = [
        f"{name} is in {channel.unit}; expected {unit}"
        for name, channel in zip(names, channels, strict=True)
        if channel.unit != unit
    ]
    if wrong:
        raise InputError(where, wrong)
    first, second = (channel.values for channel in channels)
    known = np.isfinite(first) & np.isfinite(second)
    return stream.time_s[known] + stream.clock.first_s, first[known], second[known]
