"""The verb ``doctor``: engines, versions, features, limits, and a self-test in a child process."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.engine import engines
from simcompare.model.scenes import scene
from simcompare.model.settings import Settings
from simcompare.running.jobs import FAILED, OK, Facts, Job, Outcome
from simcompare.running.runner import Progress, run_jobs

#: a sphere in free fall, without any contact
_BALL = {
    "mass_kg": 1.0,
    "inertia_kg_m2": [0.1, 0.1, 0.1],
    "position_m": [0.0, 0.0, 10.0],
    "shapes": [{"type": "sphere", "radius_m": 0.5}],
}
SELF_TEST_LIMIT_S = 60.0


@dataclass(frozen=True)
class Diagnosis:
    """What is known of one engine.

    Attributes:
        engine: its name.
        status: "ok", "missing" or "failed".
        message: what the self-test found, or what to do.
        facts: version, features, limits and mapping that the backend states.
    """

    engine: str
    status: str
    message: str
    facts: Facts


def doctor(progress: Progress | None = None) -> list[Diagnosis]:
    """Examines every known engine; each is imported and stepped in a process of its own.

    Args:
        progress: called as ``progress(engine, done, total)``.
    """
    fall = scene("free_fall", {"ball": _BALL}, 0.2, 0.001)
    jobs = [Job(name, fall, Settings()) for name in engines.names()]
    outcomes = run_jobs(jobs, time_limit_s=SELF_TEST_LIMIT_S, progress=progress)
    return [_diagnose(outcome) for outcome in outcomes]


def _diagnose(outcome: Outcome) -> Diagnosis:
    status, message = outcome.status, outcome.reason or ""
    if outcome.trajectory is not None:
        status, message = _judge(outcome)
    return Diagnosis(outcome.job.engine, status, message, outcome.facts)


def _judge(outcome: Outcome) -> tuple[str, str]:
    """Free fall of 0.2 s: any time-stepping engine is within two steps' worth of -½·g·t²."""
    assert outcome.trajectory is not None
    world = outcome.job.scenario.world
    fallen = 10.0 - float(outcome.trajectory.signals["ball.position_m"][-1, 2])
    gravity = -world.gravity_m_s2[2]
    exact = 0.5 * gravity * world.duration_s**2
    bound = gravity * world.duration_s * world.step_s
    if abs(fallen - exact) > bound:
        return FAILED, f"fell {fallen:.6g} m in 0.2 s instead of {exact:.6g} m"
    return OK, "self-test passed"
