"""Channels that follow from others: what a scenario is given, or held against, and no log holds.

A ``derive:`` block of a mapping file names new streams and how they are made:

    derive:
      wheels: {function: wheel_rates, way: ds, turn: dheading, wheel_radius_m: 0.1, track_m: 0.5}
      smooth: {function: low_pass, of: [acc_x, acc_y, acc_z], cutoff_Hz: 5}
      size: {function: magnitude, of: [acc_x, acc_y, acc_z]}
      pose: {function: yaw_pitch_roll, of: [q_w, q_x, q_y, q_z]}
      swing: {function: angle, of: [x, y]}
      speed: {function: rate, of: [x, y]}

Later ones may use earlier ones. Every new channel is written into the record of conversions.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PositiveFloat, TypeAdapter, ValidationError

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.conditioning import derived_motion
from simcompare.model.frozen import Frozen
from simcompare.model.recording import Channel, Conversion, Recording, Stream
from simcompare.model.trajectory import Array
from simcompare.model.yaml_file import describe, faults_of
from simcompare.statistics.noise import measured_noise

#: part of an interval in which a rate changes into the next, half of it on either side
FLANK = 0.2
#: fewest samples without a gap that are filtered, and the order of the filter, forwards
MIN_FILTERED = 30
ORDER = 2


class _OfChannels(Frozen):
    of: tuple[str, ...]

    def names(self) -> tuple[str, ...]:
        """Channels that are needed."""
        return self.of


class WheelRates(Frozen):
    """Rates of two wheels from increments of way and heading.

    Attributes:
        way: channel with the way since the sample before [m].
        turn: channel with the turn to the left since then [rad].
        wheel_radius_m: of the robot that is to be driven.
        track_m: distance of its wheels.
    """

    function: Literal["wheel_rates"]
    way: str
    turn: str
    wheel_radius_m: PositiveFloat
    track_m: PositiveFloat

    def names(self) -> tuple[str, ...]:
        """Channels that are needed."""
        return (self.way, self.turn)


class LowPass(_OfChannels):
    """The same channels without what is faster than a frequency, and not delayed.

    Attributes:
        of: channels.
        cutoff_Hz: where half of the amplitude is left.
    """

    function: Literal["low_pass"]
    of: Annotated[tuple[str, ...], Field(min_length=1)]
    cutoff_Hz: PositiveFloat


class Magnitude(_OfChannels):
    """Length of a vector, ``magnitude``.

    Attributes:
        of: its components, of one unit.
    """

    function: Literal["magnitude"]
    of: Annotated[tuple[str, ...], Field(min_length=2, max_length=3)]


class YawPitchRoll(_OfChannels):
    """Angles about z, then the new y, then the new x: ``yaw``, ``pitch`` and ``roll``.

    Attributes:
        of: w, x, y and z of the quaternion that turns the body's frame to the world's.
        u_rad: standard uncertainty of each angle.
    """

    function: Literal["yaw_pitch_roll"]
    of: Annotated[tuple[str, ...], Field(min_length=4, max_length=4)]
    u_rad: PositiveFloat | None = None


Wish = WheelRates | LowPass | Magnitude | YawPitchRoll | derived_motion.Angle | derived_motion.Rate
_WISH: TypeAdapter[Wish] = TypeAdapter(Annotated[Wish, Field(discriminator="function")])


def add(recording: Recording, tree: Mapping[str, object], where: str) -> Recording:
    """A recording with the streams that a ``derive:`` block asks for.

    Args:
        recording: in SI.
        tree: the block: name of a stream -> function and what it needs.
        where: file and key, for messages.

    Raises:
        InputError: what is wrong with a wish or its channels.
        UnknownName: a channel that the recording does not have.
    """
    for name, wanted in tree.items():
        place = f"{where}.{name}"
        try:
            wish = _WISH.validate_python(wanted)
        except ValidationError as error:
            raise InputError(place, describe(faults_of(error), {})) from None
        if name in recording.streams:
            raise InputError(place, ["a stream of that name is in the log already"])
        made = _made(recording, wish, place)
        source, reason = ", ".join(wish.names()), _reason(wish)
        new = tuple(
            Conversion(source, "", f"{name}/{channel}", content.unit, reason=reason)
            for channel, content in made.channels.items()
        )
        known = recording.provenance
        recording = replace(
            recording,
            streams={**recording.streams, name: made},
            provenance=replace(known, conversions=(*known.conversions, *new)),
        )
    return recording


def _reason(wish: Wish) -> str:
    options = {k: v for k, v in wish.model_dump().items() if isinstance(v, float)}
    shown = ", ".join(f"{name} {value:g}" for name, value in options.items())
    return f"derived by {wish.function}{f' with {shown}' if shown else ''}"


def _made(recording: Recording, wish: Wish, where: str) -> Stream:
    needed = [recording.find(name) for name in wish.names()]
    sources = sorted({stream for stream, _ in needed})
    if len(sources) > 1:
        raise InputError(where, [f"its channels are of {', '.join(sources)}; one stream is needed"])
    stream = recording.streams[sources[0]]
    channels = {name: stream.channels[name] for _, name in needed}
    if isinstance(wish, WheelRates):
        return _wheels(stream, channels, wish, where)
    if isinstance(wish, derived_motion.Angle):
        return derived_motion.angle(stream, channels, wish, where)
    if isinstance(wish, derived_motion.Rate):
        return derived_motion.rates(stream, channels)
    if isinstance(wish, LowPass):
        rate_Hz = _rate_of(stream, where)
        if not wish.cutoff_Hz < rate_Hz / 2:
            fault = (
                f"cutoff_Hz {wish.cutoff_Hz:g} is not below half of {rate_Hz:.5g} samples a second"
            )
            raise InputError(where, [fault])
        return replace(
            stream,
            channels={name: _smoothed(c, rate_Hz, wish.cutoff_Hz) for name, c in channels.items()},
        )
    raw = ", ".join(wish.of)
    values = [channel.values for channel in channels.values()]
    if isinstance(wish, Magnitude):
        first = next(iter(channels))
        unit = channels[first].unit
        _expect(channels, [unit] * len(channels), where)
        suffix = units.suffix_for(unit)
        size = np.sqrt(sum(part**2 for part in values))
        u = max((_largest_u(c) for c in channels.values()), default=0.0) or None
        ends = [c.saturated for c in channels.values() if c.saturated is not None]
        clipped = np.logical_or.reduce(ends) if ends else None
        made = Channel(size, unit, "", u, raw=raw, saturated=clipped)
        return replace(stream, channels={f"magnitude{suffix}": made})
    _expect(channels, ["1"] * 4, where)
    angles = yaw_pitch_roll(np.column_stack(values))
    names = ("yaw_rad", "pitch_rad", "roll_rad")
    turns = {
        n: Channel(a, "rad", "", wish.u_rad, raw=raw) for n, a in zip(names, angles, strict=True)
    }
    return replace(stream, channels=turns)


def _largest_u(channel: Channel) -> float:
    if channel.u is None:
        return 0.0
    return float(np.max(channel.u))


def _smoothed(channel: Channel, rate_Hz: float, cutoff_Hz: float) -> Channel:
    """A channel with less noise, and what is left of that.

    The noise is told before the filter, where it is seen from sample to sample; white noise is
    made smaller by the root of the sum of squares of the filter's answer to a pulse. What a stated
    uncertainty has beyond the noise is systematic and stays. Neighbours of samples at the sensor's
    end, as far as the filter smears them, are at its end too.
    """
    before = measured_noise(channel.values).value
    pulse = np.zeros(2 * int(4 * rate_Hz / cutoff_Hz) + 1)
    pulse[len(pulse) // 2] = 1.0
    gain = float(np.sqrt(np.sum(low_pass(pulse, rate_Hz, cutoff_Hz) ** 2)))
    stated = _largest_u(channel)
    u = float(np.hypot(before * gain, np.sqrt(max(0.0, stated**2 - before**2))))
    clipped = channel.saturated
    if clipped is not None:
        width = 2 * round(rate_Hz / cutoff_Hz / 2) + 1
        clipped = np.convolve(clipped, np.ones(width), mode="same") > 0.5
    return replace(
        channel, values=low_pass(channel.values, rate_Hz, cutoff_Hz), u=u or None, saturated=clipped
    )


def _expect(channels: Mapping[str, Channel], expected: list[str], where: str) -> None:
    faults = [
        f"{name} is in {channel.unit}; expected {unit}"
        for (name, channel), unit in zip(channels.items(), expected, strict=True)
        if channel.unit != unit
    ]
    if faults:
        raise InputError(where, faults)


def _rate_of(stream: Stream, where: str) -> float:
    steps = np.diff(stream.time_s)
    if len(steps) < 2 or not np.allclose(steps, steps.mean(), rtol=0.05):
        raise InputError(where, ["its samples are not evenly spaced; resample the log first"])
    return 1 / float(steps.mean())


def _wheels(
    stream: Stream, channels: Mapping[str, Channel], wish: WheelRates, where: str
) -> Stream:
    _expect(channels, ["m", "rad"], where)
    way, turn = channels.values()
    faults = [
        f"{name} lacks {count} increments; without one all that follows is unknown"
        for name, channel in channels.items()
        if (count := int(np.count_nonzero(~np.isfinite(channel.values))))
    ]
    if faults:
        raise InputError(where, faults)
    time_s, left, right = wheel_rates(
        way.values, turn.values, stream.time_s, wish.wheel_radius_m, wish.track_m
    )
    made = {
        f"{side}_rate_rad_s": Channel(values, "rad/s", raw=f"{wish.way}, {wish.turn}")
        for side, values in (("left", left), ("right", right))
    }
    # the first increment lies before the first sample
    clock = replace(stream.clock, first_s=stream.clock.first_s + float(time_s[0]))
    return Stream(time_s - time_s[0], made, clock)


def wheel_rates(
    way_m: Array,
    turn_rad: Array,
    time_s: Array,
    radius_m: float,
    track_m: float,
    flank: float = FLANK,
) -> tuple[Array, Array, Array]:
    """Rates of the wheels of a robot that makes these increments, as straight lines.

    A wheel that rolls turns by (way ∓ turn·track/2)/radius. In each interval the rate is constant,
    and changes into the next along a straight line that is centred on the sample between them, so
    no way and no turn is lost: up to the middle of any interval their sums are exact. A rate per
    sample would lose some, because times between samples differ.

    Args:
        way_m: way since the sample before (n,) [m].
        turn_rad: turn to the left since then (n,) [rad].
        time_s: times of the samples, increasing (n,); the first interval is as long as the second.
        radius_m: radius of the wheels.
        track_m: distance of the wheels.
        flank: length of a change, as a part of the shorter one of both intervals.

    Returns:
        Times (2n,), rate of the left and of the right wheel there (2n,) [rad/s].
    """
    if len(time_s) < 2:
        raise ValueError(f"{len(time_s)=}, expected at least 2")
    edges = np.concatenate(([2 * time_s[0] - time_s[1]], time_s))
    lengths = np.diff(edges)
    half = flank / 2 * np.minimum(lengths[1:], lengths[:-1])
    times = np.empty(2 * len(lengths))
    times[0], times[-1] = edges[0], edges[-1]
    times[1:-1:2], times[2:-1:2] = edges[1:-1] - half, edges[1:-1] + half
    swing = turn_rad * track_m / 2
    left, right = ((way_m + sign * swing) / radius_m / lengths for sign in (-1, 1))
    return times, np.repeat(left, 2), np.repeat(right, 2)


def low_pass(values: Array, rate_Hz: float, cutoff_Hz: float) -> Array:
    """Values without what is faster than ``cutoff_Hz``; nothing is delayed.

    A Butterworth filter of second order runs forwards and backwards, so half of the amplitude is
    left at the cut-off. Each stretch without gaps is filtered alone; short ones become NaN.

    Args:
        values: evenly spaced samples (n,), NaN where nothing was measured.
        rate_Hz: samples in a second.
        cutoff_Hz: below half of that.
    """
    from scipy.signal import butter, sosfiltfilt

    sections = butter(ORDER, cutoff_Hz, fs=rate_Hz, output="sos")
    smooth = np.full(len(values), np.nan)
    known = np.isfinite(values)
    ends = np.flatnonzero(np.diff(np.concatenate(([False], known, [False]))))
    for start, stop in zip(ends[::2], ends[1::2], strict=True):
        if stop - start >= MIN_FILTERED:
            smooth[start:stop] = sosfiltfilt(sections, values[start:stop])
    return smooth


def yaw_pitch_roll(orientation_wxyz: Array) -> tuple[Array, Array, Array]:
    """Angles about z, then the new y, then the new x (n,) each, counted on through whole turns.

    Args:
        orientation_wxyz: quaternions (n, 4), of any length; NaN where nothing was measured.
    """
    w, x, y, z = (orientation_wxyz / np.linalg.norm(orientation_wxyz, axis=1, keepdims=True)).T
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y**2 + z**2))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x**2 + y**2))
    return _counted_on(yaw), np.asarray(pitch, dtype=float), _counted_on(roll)


def _counted_on(angle: Array) -> Array:
    continuous = np.array(angle, dtype=float)
    known = np.isfinite(continuous)
    continuous[known] = np.unwrap(continuous[known])
    return continuous
