"""The verb ``doctor``: engines, versions, features, limits, and a self-test in a child process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from simcompare import engines
from simcompare.backend import Feature, Settings
from simcompare.errors import SimcompareError
from simcompare.jobs import FAILED, OK, Job, Outcome
from simcompare.runner import run_jobs
from simcompare.scenario import Scenario

#: a sphere in free fall, without any contact
_FALL = {
    "name": "self_test",
    "title": "Free fall",
    "question": "Does the engine step?",
    "world": {"duration_s": 0.2, "step_s": 0.001},
    "bodies": {
        "ball": {
            "mass_kg": 1.0,
            "inertia_kg_m2": [0.1, 0.1, 0.1],
            "position_m": [0.0, 0.0, 10.0],
            "shapes": [{"type": "sphere", "radius_m": 0.5}],
        }
    },
}
SELF_TEST_LIMIT_S = 60.0


@dataclass(frozen=True)
class Diagnosis:
    """What is known of one engine.

    Attributes:
        engine: its name.
        status: "ok", "missing" or "failed".
        version: version of the installed engine.
        message: what the self-test found, or what to do.
        features: what the backend can do.
        known_limits: text and reference of each.
        mapping: how the scenario's contact is translated.
    """

    engine: str
    status: str
    version: str | None
    message: str
    features: tuple[str, ...]
    known_limits: tuple[tuple[str, str], ...]
    mapping: str

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        limits = [{"text": text, "reference": source} for text, source in self.known_limits]
        return {**vars(self), "known_limits": limits, "features": list(self.features)}


def doctor() -> list[Diagnosis]:
    """Examines every known engine; each is imported and stepped in a process of its own."""
    scenario = Scenario.model_validate(_FALL)
    jobs = [Job(name, scenario, Settings()) for name in engines.names()]
    return [_diagnose(outcome) for outcome in run_jobs(jobs, time_limit_s=SELF_TEST_LIMIT_S)]


def _diagnose(outcome: Outcome) -> Diagnosis:
    name = outcome.job.engine
    status, message = outcome.status, outcome.reason or ""
    if outcome.trajectory is not None:
        status, message = _judge(outcome)
    try:
        backend = engines.get(name)
    except SimcompareError:
        return Diagnosis(name, status, None, message, (), (), "")
    try:
        version: str | None = backend.version()
    except SimcompareError:
        version = None
    limits = tuple((limit.text, limit.reference) for limit in backend.known_limits)
    features = tuple(str(feature) for feature in Feature if feature in backend.features)
    return Diagnosis(name, status, version, message, features, limits, backend.mapping)


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
