"""Outcomes and replies as frames: typed records on both sides, and no code in between.

What the runner knows itself, such as the job, is not sent: a process cannot answer for another.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from simcompare.model.audit import AuditRow
from simcompare.model.plain import Plain, of_plain, plain
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Trajectory
from simcompare.model.tuning import TuningRow
from simcompare.running.jobs import OK, Facts, Inquiry, Job, Outcome, Reply, check_numbers
from simcompare.running.wire import Arrays, BadFrame

#: bytes that any answer may have, and those of a sample for each part of a scene: far more than
#: backends need, far fewer than a machine has
_ANY_BYTES, _PART_BYTES = 256 * 2**20, 1024


@dataclass(frozen=True)
class _Motion:
    """A trajectory without its arrays: times first, then the signals in the order of names."""

    signals: tuple[str, ...]
    version: str
    wall_s: Mapping[str, float]
    audit: tuple[AuditRow, ...]
    notes: tuple[str, ...]
    helps: tuple[str, ...]
    velocity_offset_s: float
    tuning: tuple[TuningRow, ...]
    lacks: Mapping[str, str]

    def trajectory(self, job: Job, arrays: Arrays) -> Trajectory:
        time_s, *values = arrays
        made = Trajectory(
            source=job.source, contact=job.mode, time_s=time_s,
            signals=dict(zip(self.signals, values, strict=True)), version=self.version,
            wall_s=self.wall_s, audit=self.audit, notes=self.notes, helps=self.helps,
            velocity_offset_s=self.velocity_offset_s, tuning=self.tuning, lacks=self.lacks,
        )  # fmt: skip
        check_numbers(job, made)
        return made


@dataclass(frozen=True)
class _Head:
    """How a job or an inquiry ended; ``number`` counts those of one process."""

    number: int
    status: Literal["ok", "unsupported", "missing", "failed"]
    reason: str | None
    facts: Facts = field(default_factory=Facts)
    longest_step_s: float | None = None
    motion: _Motion | None = None
    version: str | None = None
    value: Any = None


def sent(number: int, ended: Outcome | Reply[Any]) -> tuple[Plain, Arrays]:
    """The parts of a frame.

    Raises:
        ValueError: the result holds what cannot be sent; so do TypeError and other errors.
    """
    if isinstance(ended, Reply):
        value = None if ended.value is None else plain(ended.value)
        head = _Head(number, _status(ended), ended.reason, version=ended.version, value=value)
        return plain(head), ()
    found, arrays = ended.trajectory, []
    motion = None
    if found is not None:
        motion = _Motion(
            (*found.signals,), found.version, found.wall_s, found.audit, found.notes, found.helps,
            found.velocity_offset_s, found.tuning, found.lacks,
        )  # fmt: skip
        arrays = [found.time_s, *found.signals.values()]
    head = _Head(
        number, _status(ended), ended.reason, ended.facts, ended.longest_step_s, motion
    )  # fmt: skip
    told = plain(head)
    of_plain(_Head, told)  # what the runner would refuse is told by this job alone
    return told, arrays


def _status(ended: Outcome | Reply[Any]) -> Any:  # noqa: ANN401
    return ended.status


def received(
    number: int, job: Job | Inquiry[Any], head: Plain, arrays: Arrays
) -> Outcome | Reply[Any]:
    """How a job ended, out of a frame.

    Args:
        number: the job's place among all that the process was given.
        job: which is answered next.
        head: of the frame.
        arrays: of the frame.

    Raises:
        ValueError: it is no answer to this job.
    """
    told = of_plain(_Head, head)
    if told.number != number:
        raise BadFrame("an answer that nobody asked for")
    if (told.status == OK) == (told.reason is not None):
        raise BadFrame(f"an answer that is {told.status!r}, with the reason {told.reason!r}")
    if isinstance(job, Inquiry):
        value = of_plain(job.ask.kind, told.value) if told.status == OK else None
        return Reply(job, told.status, told.reason, value, told.version)
    if (told.status == OK) != (told.motion is not None):
        raise BadFrame(f"an answer that is {told.status!r}, and no trajectory to it")
    motion = None if told.motion is None else told.motion.trajectory(job, arrays)
    return Outcome(
        job, told.status, told.reason, motion, facts=told.facts, longest_step_s=told.longest_step_s
    )  # fmt: skip


def most_bytes(job: Job | Inquiry[Any]) -> int:
    """Bytes of arrays that the answer may have."""
    return _ANY_BYTES + (_of_samples(job.scenario) if isinstance(job, Job) else 0)


def _of_samples(scenario: Scenario) -> int:
    world = scenario.world
    parts = 1 + len(scenario.bodies) + len(scenario.joints) + len(scenario.sensors)
    return int(world.duration_s / world.step_s) * parts * _PART_BYTES
