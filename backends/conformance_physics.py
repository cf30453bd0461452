"""The contract of physics: small scenes with a known answer, which every backend is held to.

They know no engine. Each simulates some tenths of a second, all together take about a second.

    from simcompare.backends import conformance_physics
    for finding in conformance_physics.check(my_backend):
        print(finding)  # what was passed, and what could not be asked, with the reason

An engine is judged in its plain loop ("tuned"), and with our helps ("assisted") if it takes any.
At the other levels nobody gives it all of the physics, so that it is shown there and not judged.
"""

from __future__ import annotations

import enum
from collections.abc import Sequence
from dataclasses import dataclass

from simcompare.backends import (
    conformance_contacts,
    conformance_flights,
    conformance_joints,
    conformance_laws,
    conformance_rays,
    conformance_shapes,
)
from simcompare.backends.conformance_scenes import PhysicsCheck, SignalNotGiven
from simcompare.engine.backend import Backend
from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.engine.features import needs
from simcompare.errors import ReadBackMismatch, SimulationDiverged, Unsupported
from simcompare.model.settings import ASSISTED, TUNED, Settings

#: all scenes, each with its judge
PHYSICS: tuple[PhysicsCheck, ...] = (
    *conformance_flights.CHECKS,
    *conformance_joints.CHECKS,
    *conformance_contacts.CHECKS,
    *conformance_laws.CHECKS,
    *conformance_shapes.CHECKS,
    *conformance_rays.CHECKS,
)


class Status(enum.StrEnum):
    """What came of a check."""

    PASSED = "passed"
    FAILED = "failed"
    #: the backend states that it lacks a feature
    SKIPPED = "skipped"
    #: it has the features, and refuses this scene at this level
    REFUSED = "refused"
    #: it runs the scene, and says that it does not give what is asked for
    NOT_GIVEN = "not given"


@dataclass(frozen=True)
class Finding:
    """What came of one check on one backend.

    Attributes:
        check: name of the check.
        backend: name of the backend.
        level: contact level.
        status: what came of it.
        reason: a sentence, empty where it was passed.
    """

    check: str
    backend: str
    level: str
    status: Status
    reason: str = ""

    def __str__(self) -> str:
        """One line for people."""
        line = f"{self.backend}, {self.level}: {self.check} {self.status}"
        return f"{line}: {self.reason}" if self.reason else line


def judged_levels(backend: Backend) -> tuple[str, ...]:
    """Levels at which a backend is held to physics."""
    takes_helps = bool(getattr(backend, "helps", frozenset()))
    return (TUNED, ASSISTED) if takes_helps else (TUNED,)


def look(check: PhysicsCheck, backend: Backend, level: str) -> Finding:
    """Runs one check and says what came of it.

    Raises:
        EngineMissing: the engine is not installed.
    """
    status, reason = _outcome(check, backend, level)
    return Finding(check.name, backend.name, level, status, reason)


def _outcome(check: PhysicsCheck, backend: Backend, level: str) -> tuple[Status, str]:
    wanted = needs(check.scenario)
    lacking = sorted(wanted.required - backend.features)
    if lacking:
        return Status.SKIPPED, f"{backend.name} has no {', no '.join(lacking)}"
    try:
        check.judge(backend.simulate(check.scenario, Settings(level)))
    except CannotCalibrate as error:  # it says that it bounces, and no drop of it does as it should
        return Status.FAILED, str(error)
    except Unsupported as error:
        return Status.REFUSED, str(error)
    except SignalNotGiven as error:
        return Status.NOT_GIVEN, str(error)
    except (AssertionError, ReadBackMismatch, SimulationDiverged) as error:
        return Status.FAILED, str(error)
    return Status.PASSED, ""


def look_at_all(backend: Backend, levels: Sequence[str] | None = None) -> tuple[Finding, ...]:
    """What comes of every check, at the levels at which the backend is judged, or at others."""
    chosen = judged_levels(backend) if levels is None else levels
    return tuple(look(check, backend, level) for level in chosen for check in PHYSICS)


def check(backend: Backend, levels: Sequence[str] | None = None) -> tuple[Finding, ...]:
    """Holds a backend to all of physics.

    Returns:
        What came of every check: those that are not "passed" could not be asked, and say why.

    Raises:
        AssertionError: some were failed, or none could be asked; each is named, with the reason.
    """
    findings = look_at_all(backend, levels)
    failed = [str(finding) for finding in findings if finding.status is Status.FAILED]
    assert not failed, "\n".join(failed)
    passed = any(finding.status is Status.PASSED for finding in findings)
    assert passed, "nothing could be asked:\n" + "\n".join(map(str, findings))
    return findings
