"""Jobs: plain picklable values; the same job runs in-process, in a worker or on another machine."""

from __future__ import annotations

from dataclasses import dataclass, replace

from simcompare import engines
from simcompare.backend import Settings
from simcompare.errors import EngineMissing, SimcompareError, Unsupported
from simcompare.scenario import Scenario
from simcompare.trajectory import Trajectory

#: how a job can end
OK, UNSUPPORTED, MISSING, FAILED = "ok", "unsupported", "missing", "failed"


@dataclass(frozen=True)
class Job:
    """One run of one scenario on one engine.

    Attributes:
        engine: name of the engine.
        scenario: the scene with numbers.
        settings: contact mode and seed.
        repeat: index of the dithered repeat.
    """

    engine: str
    scenario: Scenario
    settings: Settings
    repeat: int = 0


@dataclass(frozen=True)
class Outcome:
    """How a job ended.

    Attributes:
        job: the job, without its scenario's bulk when it comes from a worker.
        status: "ok", "unsupported", "missing" or "failed".
        reason: one sentence where the status is not "ok".
        trajectory: what happened, where the status is "ok".
        noise: what the engine's process printed.
    """

    job: Job
    status: str
    reason: str | None = None
    trajectory: Trajectory | None = None
    noise: str = ""


def execute(job: Job) -> Outcome:
    """Runs a job in this process; every failure becomes an outcome."""
    try:
        backend = engines.get(job.engine)
        trajectory = backend.simulate(job.scenario, job.settings)
    except Unsupported as error:
        return Outcome(job, UNSUPPORTED, str(error))
    except EngineMissing as error:
        return Outcome(job, MISSING, str(error))
    except SimcompareError as error:
        return Outcome(job, FAILED, str(error))
    except Exception as error:  # noqa: BLE001  (an engine may raise anything; it spoils only its own row)
        return Outcome(job, FAILED, f"{job.engine}: {type(error).__name__}: {error}")
    return Outcome(job, OK, trajectory=replace(trajectory, contact=job.settings.contact))
