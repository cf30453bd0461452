"""Outcomes and replies as frames: typed records on both sides, and no code in between.

What the runner knows itself, such as the job, is not sent: a process cannot answer for another.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from simcompare.model.audit import AuditRow
from simcompare.model.plain import Plain, of_plain, plain
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import TRUTH, Trajectory
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

    def trajectory(self, source: str, contact: str, arrays: Arrays) -> Trajectory:
        time_s, *values = arrays
        return Trajectory(
            source=source, contact=contact, time_s=time_s,
            signals=dict(zip(self.signals, values, strict=True)), version=self.version,
            wall_s=self.wall_s, audit=self.audit, notes=self.notes, helps=self.helps,
            velocity_offset_s=self.velocity_offset_s, tuning=self.tuning, lacks=self.lacks,
        )  # fmt: skip


def _motion(found: Trajectory) -> _Motion:
    return _Motion(
        (*found.signals,), found.version, found.wall_s, found.audit, found.notes, found.helps,
        found.velocity_offset_s, found.tuning, found.lacks,
    )  # fmt: skip


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
    status: Any = ended.status
    answer = ended.value if isinstance(ended, Reply) else ended.trajectory
    found = answer if isinstance(answer, Trajectory) else None
    arrays = [] if found is None else [found.time_s, *found.signals.values()]
    head = _Head(
        number, status, ended.reason, motion=None if found is None else _motion(found)
    )  # fmt: skip
    if isinstance(ended, Outcome):
        head = replace(head, facts=ended.facts, longest_step_s=ended.longest_step_s)
    else:
        value = None if found is answer else plain(answer)
        head = replace(head, version=ended.version, value=value)
    told = plain(head)
    of_plain(_Head, told)  # what the runner would refuse is told by this job alone
    return told, arrays


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
        value = _answer(job, told, arrays) if told.status == OK else None
        return Reply(job, told.status, told.reason, value, told.version)
    if (told.status == OK) != (told.motion is not None):
        raise BadFrame(f"an answer that is {told.status!r}, and no trajectory to it")
    made = None if told.motion is None else told.motion.trajectory(job.source, job.mode, arrays)
    if made is not None:
        check_numbers(job, made)
    return Outcome(
        job, told.status, told.reason, made, facts=told.facts, longest_step_s=told.longest_step_s
    )  # fmt: skip


def _answer(job: Inquiry[Any], told: _Head, arrays: Arrays) -> Any:  # noqa: ANN401
    if job.ask.kind is not Trajectory:
        return of_plain(job.ask.kind, told.value)
    if told.motion is None:
        raise BadFrame("an answer without a trajectory")
    return told.motion.trajectory(TRUTH, "", arrays)


def most_bytes(job: Job | Inquiry[Any]) -> int:
    """Bytes of arrays that the answer may have."""
    return _ANY_BYTES + (_of_samples(job.scenario) if isinstance(job, Job) else job.most_bytes)


def _of_samples(scenario: Scenario) -> int:
    world = scenario.world
    parts = 1 + len(scenario.bodies) + len(scenario.joints) + len(scenario.sensors)
    return int(world.duration_s / world.step_s) * parts * _PART_BYTES
