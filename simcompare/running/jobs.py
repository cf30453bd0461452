"""Jobs: plain picklable values; the same job runs in-process, in a worker or on another machine.

A job travels as a pickle, what comes of it as a record of numbers and texts.

A job simulates a scenario; an inquiry asks an engine something else, such as how its contact
bounces. Both are work for the engine's own process.
"""

from __future__ import annotations

import math
import traceback
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from simcompare.engine import engines
from simcompare.engine.backend import Backend, KnownLimit
from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.engine.features import Feature
from simcompare.engine.helps import HELPS
from simcompare.errors import EngineBroken, EngineMissing, SimcompareError, Unsupported
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Trajectory

Answer = TypeVar("Answer")
Answered = TypeVar("Answered", covariant=True)

#: how a job can end
OK, UNSUPPORTED, MISSING, FAILED = "ok", "unsupported", "missing", "failed"


@dataclass(frozen=True)
class Job:
    """One run of one scenario on one engine.

    Attributes:
        engine: name of the engine.
        scenario: the scene with numbers.
        settings: contact level and seed.
        repeat: index of the dithered repeat.
        label: level under which the result is shown, where it is not that of the settings.
        without: one of our helps that is left out to show its part.
        at: what its step adds to the engine's name, where a run has several steps.
    """

    engine: str
    scenario: Scenario
    settings: Settings
    repeat: int = 0
    label: str = ""
    without: str = ""
    at: str = ""

    @property
    def source(self) -> str:
        """Name under which the result is shown."""
        return f"{self.engine}{self.at}"

    @property
    def mode(self) -> str:
        """Contact level under which the result is shown."""
        return self.label or self.settings.contact

    def execute(self) -> Outcome:
        """Runs it in this process."""
        return execute(self)

    def failed(self, reason: str, noise: str = "") -> Outcome:
        """The outcome of a job that never ended."""
        return Outcome(self, FAILED, reason, noise=noise)


class Ask(Protocol[Answered]):
    """A question to an engine.

    Attributes:
        kind: type of the answer: a record, which travels as plain values.
    """

    kind: ClassVar[type[Any]]

    def __call__(self, backend: Backend) -> Answered:
        """The answer of an engine."""


@dataclass(frozen=True)
class Inquiry(Generic[Answer]):
    """One question to one engine, answered in a process of its own.

    Attributes:
        engine: name of the engine.
        ask: the question: called with the engine's backend, it says what its answer is.
        about: what it is about, for whoever reads the answers.
    """

    engine: str
    ask: Ask[Answer]
    about: str = ""

    @property
    def most_bytes(self) -> int:
        """Bytes of arrays in the answer: only motions have any."""
        return 0

    def execute(self) -> Reply[Answer]:
        """Asks in this process."""
        version: str | None = None
        try:
            backend = engines.get(self.engine)
            version = backend.version()
            return Reply(self, OK, value=self.ask(backend), version=version)
        except SimcompareError as error:
            return Reply(self, _status_of(error), str(error), version=version)
        # as in a job, an engine may raise anything
        except (Exception, SystemExit) as error:  # noqa: BLE001
            traceback.print_exc()
            return self.failed(f"{self.engine}: {type(error).__name__}: {error}")

    def failed(self, reason: str, noise: str = "") -> Reply[Answer]:
        """The answer to a question that never came back."""
        return Reply(self, FAILED, reason, noise=noise)


@dataclass(frozen=True)
class Reply(Generic[Answer]):
    """What came of an inquiry.

    Attributes:
        job: the inquiry.
        status: "ok", "unsupported", "missing" or "failed".
        reason: one sentence where the status is not "ok".
        value: the answer, where the status is "ok".
        version: the engine's version.
        noise: what the engine's process printed.
    """

    job: Inquiry[Answer]
    status: str
    reason: str | None = None
    value: Answer | None = None
    version: str | None = None
    noise: str = ""


@dataclass(frozen=True)
class VariantFacts:
    """What a backend states about one of its variants.

    Attributes:
        name: without that of the engine.
        text: what differs, in one sentence.
        reference: where it is documented.
    """

    name: str
    text: str
    reference: str


@dataclass(frozen=True)
class Facts:
    """What a backend states about itself; gathered where it is loaded, never in the parent.

    Attributes:
        version: version of the installed engine, ``None`` where it is not installed.
        features: what the backend can do, as people read it.
        mapping: how the scenario's contact is translated.
        known_limits: what a user should know, each with its reference.
        helps: which of our helps it can take.
        variants: the engine with one of its own choices made otherwise.
    """

    version: str | None = None
    features: tuple[str, ...] = ()
    mapping: str = ""
    known_limits: tuple[KnownLimit, ...] = ()
    helps: tuple[str, ...] = ()
    variants: tuple[VariantFacts, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """How a job ended.

    Attributes:
        job: the job.
        status: "ok", "unsupported", "missing" or "failed".
        reason: one sentence where the status is not "ok".
        trajectory: what happened, where the status is "ok".
        noise: what the engine's process printed.
        facts: what the backend states about itself, where it could be loaded.
        longest_step_s: longest step with which the engine could do it, where the step is at fault
            [s].
    """

    job: Job
    status: str
    reason: str | None = None
    trajectory: Trajectory | None = None
    noise: str = ""
    facts: Facts = field(default_factory=Facts)
    longest_step_s: float | None = None


def execute(job: Job) -> Outcome:
    """Runs a job in this process; every failure becomes an outcome."""
    facts = Facts()
    try:
        backend = engines.get(job.engine)
        facts = facts_of(backend)
        if job.without and not _acts(backend, job):
            return Outcome(job, UNSUPPORTED, does_not_act(job.without), facts=facts)
        trajectory = _checked(job, backend.simulate(job.scenario, job.settings))
    except CannotCalibrate as error:
        longest_s = error.longest_step_s
        reason = str(error)
        return Outcome(job, UNSUPPORTED, reason, facts=facts, longest_step_s=longest_s)
    except SimcompareError as error:
        return Outcome(job, _status_of(error), str(error), facts=facts)
    # an engine may raise anything, also SystemExit; it spoils only its own row
    except (Exception, SystemExit) as error:  # noqa: BLE001
        traceback.print_exc()  # into what the engine prints, for whoever looks into it
        return Outcome(job, FAILED, f"{job.engine}: {type(error).__name__}: {error}", facts=facts)
    return Outcome(job, OK, trajectory=trajectory, facts=facts)


def _status_of(error: SimcompareError) -> str:
    if isinstance(error, Unsupported):
        return UNSUPPORTED
    return MISSING if isinstance(error, EngineMissing) else FAILED


def exit_code_of(statuses: Collection[str], asked: str, *, out_of_reach: bool) -> int:
    """Exit code for how all that was asked for ended.

    Args:
        statuses: of all of it.
        asked: engines as they were asked for; with "all", a missing one is no failure.
        out_of_reach: whether another step or value would make something possible.

    Returns:
        0 fine; 2 where nothing was possible, and that is the user's to change; 3 where an engine
        is broken, none of those asked for ran, or one that was named is missing.
    """
    named = "all" not in [name.strip() for name in asked.split(",")]
    if set(statuses) == {UNSUPPORTED} and out_of_reach:
        return 2
    if FAILED in statuses or OK not in statuses or (named and MISSING in statuses):
        return 3
    return 0


def does_not_act(help_name: str) -> str:
    """The reason of a job that leaves out a help which its scene does not need."""
    return f"{help_name} does not act here"


def _acts(backend: Backend, job: Job) -> bool:
    """Whether the help that a job leaves out would act in its scene."""
    if job.without not in getattr(backend, "helps", ()):
        return False
    settings = replace(job.settings, helps=job.settings.helps_with(job.without))
    whole = backend.open(job.scenario, settings)
    try:
        return job.without in getattr(whole, "helps", ())
    finally:
        whole.close()


def facts_of(backend: Backend) -> Facts:
    """What a backend states about itself."""
    try:
        version: str | None = str(backend.version())
    except EngineMissing:
        version = None
    return Facts(
        version,
        tuple(str(feature) for feature in Feature if feature in backend.features),
        str(backend.mapping),
        tuple(KnownLimit(str(one.text), str(one.reference)) for one in backend.known_limits),
        tuple(name for name in HELPS if name in getattr(backend, "helps", ())),
        tuple(
            VariantFacts(str(name), str(variant.text), str(variant.reference))
            for name, variant in getattr(backend, "variants", {}).items()
        ),
    )


def _checked(job: Job, trajectory: Trajectory) -> Trajectory:
    """The trajectory under the name of its source, if the backend kept the contract.

    Raises:
        EngineBroken: it did not; one sentence says where.
    """
    if not isinstance(trajectory, Trajectory):
        raise EngineBroken(f"{job.engine} returned {type(trajectory).__name__}, not a Trajectory")
    wall = {str(stage): float(seconds) for stage, seconds in trajectory.wall_s.items()}
    named = replace(trajectory, source=job.source, contact=job.mode, wall_s=wall)
    check_numbers(job, named)
    named.to_columns()
    if not named.audit:
        note = "this backend read nothing back: whether the engine took what was set is not known"
        named = replace(named, notes=(*named.notes, note))
    return named


def check_numbers(job: Job, trajectory: Trajectory) -> None:
    """Raises ``EngineBroken`` where times or the audit hold values that are no numbers."""
    numbers = list(trajectory.wall_s.values())
    for row in trajectory.audit:
        held = (row.scenario_value, row.set_value, row.read_value)
        numbers += [value for value in held if value is not None]
    if not all(isinstance(value, float) and math.isfinite(value) for value in numbers):
        raise EngineBroken(
            f"{job.engine} returned times or an audit with values that are no numbers"
        )
