"""Channels that follow from others: where a log holds increments, and a scenario wants rates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, ValidationError

from simcompare.errors import InputError
from simcompare.recording import Channel, Conversion, Recording, Stream
from simcompare.scenario_file import describe, faults_of
from simcompare.trajectory import Array

#: part of an interval in which a rate changes into the next, half of it on either side
FLANK = 0.2


class WheelRates(BaseModel):
    """Rates of two wheels from increments of way and heading, as a new stream.

    Attributes:
        function: which one.
        way: channel with the way since the sample before [m].
        turn: channel of the same stream with the turn since then, to the left [rad].
        wheel_radius_m: of the robot that is to be driven.
        track_m: distance of its wheels.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    function: Literal["wheel_rates"]
    way: str
    turn: str
    wheel_radius_m: PositiveFloat
    track_m: PositiveFloat


#: name of the new stream -> how it is made
Derived = Mapping[Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")], WheelRates]


def add(recording: Recording, tree: Mapping[str, Any], where: str) -> Recording:
    """A recording with the streams that a ``derive:`` block asks for.

    Args:
        recording: in SI.
        tree: the block: name of a stream -> function and what it needs.
        where: file and key, for messages.

    Raises:
        InputError: all faults of the block at once.
        UnknownName: a channel that the recording does not have.
    """
    streams = dict(recording.streams)
    conversions = list(recording.provenance.conversions)
    for name, wanted in tree.items():
        try:
            wish = WheelRates.model_validate(wanted)
        except ValidationError as error:
            raise InputError(f"{where}.{name}", describe(faults_of(error), {})) from None
        if name in streams:
            raise InputError(f"{where}.{name}", ["a stream of that name is in the log already"])
        streams[name] = _wheels(recording, wish, f"{where}.{name}")
        conversions += [
            Conversion(
                f"{wish.way}, {wish.turn}", "", f"{name}/{channel}", made.unit,
                reason=f"derived by {wish.function} for wheels of radius {wish.wheel_radius_m:g} m"
                f" that are {wish.track_m:g} m apart",
            )
            for channel, made in streams[name].channels.items()
        ]  # fmt: skip
    provenance = replace(recording.provenance, conversions=tuple(conversions))
    return replace(recording, streams=streams, provenance=provenance)


def _wheels(recording: Recording, wish: WheelRates, where: str) -> Stream:
    (first, way), (second, turn) = recording.find(wish.way), recording.find(wish.turn)
    if first != second:
        fault = f"{wish.way} is of stream {first}, {wish.turn} of {second}; both must be of one"
        raise InputError(where, [fault])
    stream = recording.streams[first]
    increments = stream.channels[way], stream.channels[turn]
    for name, channel, unit in zip((way, turn), increments, ("m", "rad"), strict=True):
        if channel.unit != unit:
            raise InputError(where, [f"{name} is in {channel.unit}; expected {unit}"])
        missing = int(np.count_nonzero(~np.isfinite(channel.values)))
        if missing:
            raise InputError(
                where,
                [f"{name} lacks {missing} increments; without one all that follows is unknown"],
            )
    time_s, left, right = wheel_rates(
        increments[0].values, increments[1].values, stream.time_s,
        wish.wheel_radius_m, wish.track_m,
    )  # fmt: skip
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
