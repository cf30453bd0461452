"""WHAT of a scenario is estimated: which probe or signal plays which part for which estimator."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field, PositiveFloat

from simcompare.model.frozen import Frozen
from simcompare.model.sensor_errors import SensorErrors


class EstimatePlan(Frozen):
    """How one estimator is used on a scenario.

    Attributes:
        signals: role -> what is measured: a probe, a signal of a sensor such as
            ``imu.specific_force_m_s2``, or one component of it such as
            ``imu.specific_force_m_s2.x``.
        truth: role -> what it is judged by, named alike; an orientation stands for its heading.
        options: numbers of the estimator.
        sensors: sensor, or actuator of which something is measured -> data sheet, or own errors,
            that it has where the user names none.
        start_s: from when on it is measured [s].
    """

    signals: Mapping[str, str] = Field(min_length=1)
    truth: Mapping[str, str] = Field(default_factory=dict)
    options: Mapping[str, float] = Field(default_factory=dict)
    sensors: Mapping[str, SensorErrors] = Field(default_factory=dict)
    start_s: float = Field(0.0, ge=0)


class RecordedSignal(Frozen):
    """A channel of a recording that plays a role.

    Attributes:
        channel: its name, with or without unit, or stream/channel; several of as many streams are
            put in order of time.
        u: standard uncertainty of one sample by noise; the channel's own where left out.
        scale: values are multiplied by it, such as 1/radius from m/s to rad/s.
        offset: is added afterwards.
    """

    channel: str | Annotated[tuple[str, ...], Field(min_length=1)]
    u: PositiveFloat | None = None
    scale: float = 1.0
    offset: float = 0.0

    @property
    def channels(self) -> tuple[str, ...]:
        """Every channel."""
        return (self.channel,) if isinstance(self.channel, str) else self.channel


class RecordedPlan(Frozen):
    """How one estimator is used on a recording.

    Attributes:
        scenario: whose estimator it is.
        estimator: its name.
        signals: role -> channel.
        truth: role -> channel that it is judged by.
        options: its numbers, in place of those of the scenario.
        start_s: the part of the recording that is looked at begins there [s].
        duration_s: and is so long [s]; to the end where left out.
        note: what the reader must know.
    """

    scenario: str
    estimator: str
    signals: Mapping[str, RecordedSignal] = Field(min_length=1)
    truth: Mapping[str, RecordedSignal] = Field(default_factory=dict)
    options: Mapping[str, float] = Field(default_factory=dict)
    start_s: float = Field(0.0, ge=0)
    duration_s: PositiveFloat | None = None
    note: str = ""
