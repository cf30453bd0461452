"""A robot on two wheels: whether its wheels' speeds lead where it is known to have been.

    drive: {left: velocity_left, right: velocity_right, track_m: 0.0785, x: x, y: y}

Left and right are exchanged in a log as easily as half of a track is taken for the whole. Neither
shows in the speeds; both show in the path. So the path is reckoned as the log says, and with each
such mistake undone. What is found is told with its numbers, and nothing is changed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from pydantic import PositiveFloat

from simcompare.errors import InputError
from simcompare.hardware.conditioning.strict import refused
from simcompare.model.frozen import Frozen
from simcompare.model.recording import WARNING, Recording, Repair
from simcompare.model.trajectory import Array

if TYPE_CHECKING:  # looked for in drives alone
    from simcompare.hardware.sensors.drive_mistakes import Cures, Driven
    from simcompare.statistics.suspicions import Suspicion

#: fewest samples that are looked at
LEAST = 10


class Drive(Frozen):
    """Which channels are the wheels and the place of a robot.

    Attributes:
        left: channel of the left wheel's speed [m/s], or of its rate [rad/s].
        right: channel of the right wheel.
        wheel_radius_m: of the wheels, where the channels are rates.
        track_m: distance of the wheels.
        x: channel with the true place.
        y: channel with the true place.
    """

    left: str
    right: str
    wheel_radius_m: PositiveFloat | None = None
    track_m: PositiveFloat
    x: str
    y: str


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
    from simcompare.hardware.sensors import drive_mistakes

    found = drive_mistakes.suspected(wheels_of(wheels, drive, place), _cures(drive))
    if found is None:
        return recording
    before, after = {"rms_m": found.before}, {"rms_m": found.after}
    text = suspicion(drive, found, place)
    repair = Repair("drive", WARNING, text, before=before, after=after)
    if recording.provenance.mode == "strict":
        raise InputError(where, [refused(repair)])
    about = recording.provenance
    return replace(recording, provenance=replace(about, repairs=(*about.repairs, repair)))


def wheels_of(wheels: Array, drive: Drive, place: Array) -> Driven:
    """What is known of the robot.

    Args:
        wheels: time [s], speeds of the left and the right wheel [m/s] (n, 3).
        drive: the block of the mapping file.
        place: true places at the same times (n, 2).
    """
    from simcompare.hardware.sensors.drive_mistakes import Driven

    time_s, left, right = wheels.T
    ways = [
        np.concatenate(([0.0], np.cumsum(np.diff(time_s) * (v[1:] + v[:-1]) / 2)))
        for v in (left, right)
    ]
    return Driven(ways[0], ways[1], drive.track_m, place, drive.wheel_radius_m or 1.0)


def suspicion(drive: Drive, found: Suspicion, place: Array) -> str:
    """What was found, in words, and how the log is read so."""
    length_m = float(np.hypot(*np.diff(place, axis=0).T).sum())
    return (
        f"dead reckoning with the track of {drive.track_m:.4g} m misses the truth by"
        f" {found.before:.2g} m rms over {length_m:.3g} m, after the best turn and shift. With"
        f" {' and '.join(found.says)} it misses it by {found.after:.2g} m. Nothing was changed; to"
        f" read it so, {' and '.join(found.cures)} in a mapping file of your own"
    )


def _cures(drive: Drive) -> Cures:
    """What to write in the mapping file."""
    from simcompare.hardware.sensors.drive_mistakes import Cures

    names = {"left": drive.left, "right": drive.right}

    def radius(value_m: float) -> str:
        if drive.wheel_radius_m is None:  # speeds; 1 stands for the radius
            return f"multiply scale: of {drive.left} and {drive.right} by {value_m:.4g}"
        return f"write wheel_radius_m: {value_m:.4g} under drive:"

    return Cures(
        exchange=f"exchange the columns of {drive.left} and {drive.right}",
        sign=lambda side: f"write sign: -1 for the channel {names[side]}",
        track_m=lambda value: f"write track_m: {value:.4g} under drive:",
        radius_m=radius,
        heading_rad=lambda value: f"start at {value:.4g} rad",
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
