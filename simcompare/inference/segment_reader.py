"""Segments read from a recording: channels on the clock of a scenario, and starts read off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare import measures, units
from simcompare.errors import InputError, UnknownName
from simcompare.inference.plan import Plan, ReadOff
from simcompare.inference.segments import DURATION, Observed, Segment
from simcompare.model.recording import Channel, Recording, Stream
from simcompare.model.signals import Signal, Table
from simcompare.model.trajectory import Array
from simcompare.scenarios.scenario_file import ScenarioFile

#: samples of a channel below which nothing can be said of it
MIN_SAMPLES = 10
#: samples that may be missing in a row in an input
_MAX_HOLE = 20


def segments_of(
    file: ScenarioFile,
    plan: Plan,
    recording: Recording,
    streams: Sequence[str],
    overrides: Mapping[str, float],
    most_s: float | None = None,
) -> list[Segment]:
    """The segments of some streams, in their order.

    Args:
        file: the scenario.
        plan: which channel is what.
        recording: the recording.
        streams: streams; all that have the leading channel where empty.
        overrides: parameters that the user sets, which replace those of the plan.
        most_s: longest duration [s].

    Raises:
        UnknownName: a channel or stream that does not exist.
        InputError: a segment without samples.
    """
    chosen = list(streams) or _streams_of(plan, recording)
    for name in chosen:
        if name not in recording.streams:
            raise UnknownName("stream of the recording", name, recording.streams)
    return [_segment_of(file, plan, recording, name, overrides, most_s) for name in chosen]


def _streams_of(plan: Plan, recording: Recording) -> list[str]:
    """Streams that have the leading channel, or the events."""
    if plan.compare:
        return _streams_with(recording, next(iter(plan.compare.values())).channel)
    assert plan.events is not None
    streams = [event.stream for event in recording.events if event.name == plan.events.event]
    if not streams:
        known = {event.name for event in recording.events}
        raise UnknownName("event of the recording", plan.events.event, known)
    return list(dict.fromkeys(streams))


def _streams_with(recording: Recording, channel: str) -> list[str]:
    streams = [
        name for name, stream in recording.streams.items() if _channel(stream, name, channel)
    ]
    if not streams:
        recording.find(channel)  # says which channels there are
    return streams


def _channel(stream: Stream, name: str, channel: str) -> Channel | None:
    stream_name, _, short = channel.rpartition("/")
    if stream_name and stream_name != name:
        return None
    full = units.find_name(short, stream.channels)
    return None if full is None else stream.channels[full]


@dataclass(frozen=True)
class _Reader:
    """Channels of a recording on the clock of one segment."""

    recording: Recording
    stream: str
    start_s: float

    def read(self, channel: str) -> tuple[Array, Channel]:
        """Times from the start of the segment, and the channel."""
        log = self.recording.streams[self.stream]
        own_channel = _channel(log, self.stream, channel)
        if own_channel is not None:
            return log.time_s - self.start_s, own_channel
        other, name = self.recording.find(channel)
        stream = self.recording.streams[other]
        shift = stream.clock.first_s - log.clock.first_s
        return stream.time_s + shift - self.start_s, stream.channels[name]


def _segment_of(
    file: ScenarioFile,
    plan: Plan,
    recording: Recording,
    stream: str,
    overrides: Mapping[str, float],
    most_s: float | None,
) -> Segment:
    log = recording.streams[stream]
    start_s = plan.window.start_s
    remaining_s = float(log.time_s[-1]) - start_s
    duration_s = min(d for d in (plan.window.duration_s, most_s, remaining_s) if d is not None)
    if duration_s <= 0:
        raise InputError(
            f"stream {stream}",
            [f"lasts {log.time_s[-1]:g} s, but the window begins at {start_s:g} s"],
        )
    reader = _Reader(recording, stream, start_s)
    values = {name: known.value for name, known in plan.parameters.items()}
    u = {name: known.u for name, known in plan.parameters.items()}
    for name, read_off in plan.start.items():
        values[name], u[name] = _read_off(reader, read_off)
    if DURATION in file.parameters:
        values[DURATION], u[DURATION] = duration_s, 0.0
    values.update(overrides)
    u.update(dict.fromkeys(overrides, 0.0))
    inputs: dict[str, Signal] = {
        name: _table(reader, driven.channel, duration_s) for name, driven in plan.inputs.items()
    }
    u_inputs = {
        name: float(stated)
        for name, driven in plan.inputs.items()
        if isinstance(stated := reader.read(driven.channel)[1].u, float)
    }
    input_units = {name: reader.read(one.channel)[1].unit for name, one in plan.inputs.items()}
    faults = unit_faults(file, plan, reader)
    if faults:
        raise InputError(f"stream {stream}", faults)
    observed = {
        probe: _observed(reader, compared.channel, compared.u, compared.offset, duration_s)
        for probe, compared in plan.compare.items()
    }
    events = tuple(
        replace(event, time_s=event.time_s - start_s)
        for event in recording.events
        if plan.events is not None
        and (event.stream, event.name) == (stream, plan.events.event)
        and 0 <= event.time_s - start_s <= duration_s
    )
    watched = tuple(dict.fromkeys((*plan.compare, *event_probes(file, plan))))
    short = plan.window.duration_s is not None and remaining_s < 0.99 * plan.window.duration_s
    return Segment(
        stream, start_s, duration_s, values, u, inputs, observed, events, watched, u_inputs, short,
        input_units,
    )  # fmt: skip


def unit_faults(file: ScenarioFile, plan: Plan, reader: _Reader) -> list[str]:
    """Channels that are of another unit than what they are held against, or read off as."""
    faults = []
    probes = file.resolve().probes
    expected = [(f"probe {n}", probes[n].unit, c.channel) for n, c in plan.compare.items()]
    expected += [
        (f"parameter {name}", units.unit_of(name), read_off.channel)
        for name, read_off in plan.start.items()
        if not read_off.derivative
    ]
    for what, unit, channel in expected:
        measured = reader.read(channel)[1].unit
        if measured != units.si_of(unit, what)[2]:
            faults.append(
                f"{what} is in {units.symbol(unit)}, but channel {channel} in"
                f" {units.symbol(measured)}; compare the right channel, or mend its unit with --map"
            )
    return faults


def event_probes(file: ScenarioFile, plan: Plan) -> list[str]:
    """Probes that the measure of the plan's events looks at."""
    if plan.events is None:
        return []
    for measure in file.resolve().measures:
        names = measures.load(measure.function).series
        if plan.events.series in [measure.name_of(name) for name in names]:
            return [measure.probe, *measure.also.values()]
    known = [n for m in file.resolve().measures for n in measures.load(m.function).series]
    raise UnknownName(f"series of {file.name}", plan.events.series, known)


def _observed(
    reader: _Reader, name: str, u: float | None, offset: float, duration_s: float
) -> Observed:
    time_s, channel = reader.read(name)
    inside = (time_s >= 0) & (time_s <= duration_s)
    known = inside & np.isfinite(channel.values)
    usable = known if channel.saturated is None else known & ~channel.saturated
    if np.count_nonzero(usable) < MIN_SAMPLES:
        raise InputError(
            f"stream {reader.stream}, channel {name}",
            [
                f"has {np.count_nonzero(usable)} usable samples in the window of {duration_s:g} s;"
                f" expected at least {MIN_SAMPLES}; {_more_samples(time_s)}"
            ],
        )
    stated = channel.u if u is None else u
    return Observed(
        time_s[usable],
        channel.values[usable] + offset,
        stated[usable] if isinstance(stated, np.ndarray) else stated,
        int(np.count_nonzero(inside & ~known)),
        int(np.count_nonzero(known & ~usable)),
    )


def _more_samples(time_s: Array) -> str:
    """How a window gets more of the samples that the log has, counted from the window's start."""
    if np.count_nonzero(time_s >= 0) >= MIN_SAMPLES:
        return "make duration_s of window: (for a fit most_s of calibrate:) longer in the mapping"
    if len(time_s) >= MIN_SAMPLES:
        return "make start_s of window: smaller in the mapping"
    return "record for a longer time, or with more samples a second"


def _table(reader: _Reader, name: str, duration_s: float) -> Table:
    time_s, channel = reader.read(name)
    step_s = float(np.median(np.diff(time_s)))
    inside = (time_s >= -2 * step_s) & (time_s <= duration_s + 2 * step_s)
    known = inside & np.isfinite(channel.values)
    holes = np.diff(time_s[known]) if np.count_nonzero(known) > 2 else np.zeros(1)
    if holes.max() > _MAX_HOLE * step_s:
        at = float(time_s[known][int(np.argmax(holes))])
        raise InputError(
            f"stream {reader.stream}, channel {name}",
            [
                f"an input has a hole of {holes.max():.3g} s at {at:.4g} s of the window, where"
                " nothing is known of it; choose a window without it"
            ],
        )
    if np.count_nonzero(known) < 2:
        raise InputError(
            f"stream {reader.stream}, channel {name}",
            ["holds nothing in the window; an input needs at least two samples"],
        )
    return Table(
        signal="table",
        time_s=tuple(time_s[known].tolist()),
        value=tuple(channel.values[known].tolist()),
    )


def _read_off(reader: _Reader, wanted: ReadOff) -> tuple[float, float]:
    """Value or rate at the start, and its standard uncertainty, from a parabola or a cubic.

    It is laid through the samples on both sides of the start where the record has them.
    """
    time_s, channel = reader.read(wanted.channel)
    back_s = min(wanted.over_s / 2, max(0.0, -float(time_s[0])))
    near = (time_s >= -back_s) & (time_s <= wanted.over_s - back_s) & np.isfinite(channel.values)
    if channel.saturated is not None:
        near &= ~channel.saturated
    times, values = time_s[near], channel.values[near]
    # a rate at the edge of its window wants one order more
    degree = min(2 + wanted.derivative, len(times) - 2)
    if degree < wanted.derivative or degree < 0:
        raise InputError(
            f"stream {reader.stream}, channel {wanted.channel}",
            [
                f"has {len(times)} usable samples within {wanted.over_s:g} s of the start; too few"
                " to read a start off, use a longer over_s"
            ],
        )
    scale = wanted.over_s  # so that powers of short times do not vanish
    design = np.vander(times / scale, degree + 1, increasing=True)
    coefficients, *_ = np.linalg.lstsq(design, values, rcond=None)
    residuals = values - design @ coefficients
    free = len(times) - degree - 1
    stated = (
        float(np.mean(channel.u[near])) if isinstance(channel.u, np.ndarray) else channel.u or 0.0
    )
    # samples that stand still show no scatter, and are not exact for that
    spread = max(
        float(residuals @ residuals) / max(free, 1), stated**2 if wanted.derivative else 0.0
    )
    k = wanted.derivative
    u = np.sqrt(np.linalg.pinv(design.T @ design)[k, k] * spread) / scale**k
    common = stated if k == 0 else 0.0
    return float(coefficients[k]) / scale**k + wanted.offset, float(np.hypot(u, common))
