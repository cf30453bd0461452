"""What an estimator is given of a recording: channels that play its roles, on one clock."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from simcompare import units
from simcompare.errors import InputError, SimcompareError, UnknownName
from simcompare.estimation.estimate import Given, Signal
from simcompare.estimation.estimators import Estimator, Role
from simcompare.model.estimate_plan import RecordedPlan, RecordedSignal
from simcompare.model.recording import Channel, Recording, Stream
from simcompare.model.trajectory import Array


def given_of(recording: Recording, plan: RecordedPlan, estimator: Estimator, where: str) -> Given:
    """The signals and the truth of a recording, from the plan's start on, on the log's clock.

    Args:
        recording: the recording.
        plan: which channel plays which role.
        estimator: what needs them.
        where: what the recording is called, for messages.

    Raises:
        InputError: every channel that is missing, has a wrong unit, or holds nothing there.
    """
    faults: list[str] = []
    begin_s = min(stream.clock.first_s for stream in recording.streams.values()) + plan.start_s
    window = (begin_s, begin_s + (plan.duration_s or np.inf))
    signals = dict(_signals(recording, plan.signals, estimator.signals, window, faults))
    truth = dict(_signals(recording, plan.truth, estimator.truths, window, faults))
    if faults:
        raise InputError(f"{where}, estimate", faults)
    return Given(signals, truth, plan.options)


def _signals(
    recording: Recording,
    wanted: Mapping[str, RecordedSignal],
    roles: Mapping[str, Role],
    window: tuple[float, float],
    faults: list[str],
) -> Iterator[tuple[str, Signal]]:
    for role, one in wanted.items():
        if role not in roles:
            faults.append(str(UnknownName("role of the estimator", role, roles)))
            continue
        try:
            yield role, _signal(recording, one, roles[role], window)
        except SimcompareError as error:
            faults.append(f"{role}: {error}")


def _signal(
    recording: Recording, one: RecordedSignal, role: Role, window: tuple[float, float]
) -> Signal:
    """One role; channels of several streams are put in order of time."""
    parts = [_part(recording, name, one, role, window) for name in one.channels]
    time_s = np.concatenate([part.time_s for part in parts])
    if len(time_s) < 2:
        fault = f"has {len(time_s)} samples in this part of the recording; expected 2 or more"
        raise InputError(" and ".join(one.channels), [fault])
    order = np.argsort(time_s, kind="stable")
    values = np.concatenate([part.values for part in parts])[order]
    known = [float(part.u) for part in parts if isinstance(part.u, float)]
    u = float(np.sqrt(np.mean(np.square(known)))) if len(known) == len(parts) else None
    return Signal(time_s[order], values, u)


def _part(
    recording: Recording, name: str, one: RecordedSignal, role: Role, window: tuple[float, float]
) -> Signal:
    stream_name, full = recording.find(name)
    stream = recording.streams[stream_name]
    channel = stream.channels[full]
    if one.scale == 1 and channel.unit != role.unit:
        found, expected = units.symbol(channel.unit), units.symbol(role.unit)
        fault = f"is in {found}; expected {role.text}, in {expected}, or a scale"
        raise InputError(name, [fault])
    time_s = _times(stream)
    kept = (time_s >= window[0] - 1e-9) & (time_s <= window[1] + 1e-9)
    kept &= np.isfinite(channel.values)
    u = _u(channel, one, kept)
    return Signal(time_s[kept], one.scale * channel.values[kept] + one.offset, u)


def _times(stream: Stream) -> Array:
    """Times on the log's own clock, which streams share."""
    return np.asarray(stream.clock.first_s + stream.time_s)


def _u(channel: Channel, one: RecordedSignal, kept: NDArray[np.bool_]) -> float | None:
    if one.u is not None:
        return one.u
    if channel.u is None or not kept.any():
        return None
    mean = np.mean(np.square(np.broadcast_to(channel.u, kept.shape)[kept]))
    return float(abs(one.scale) * np.sqrt(mean))
