"""What a fit found for one engine: in any loop, and in its plain one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from simcompare.fitting.bounces.deviations import Deviation
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.model.audit import AuditRow
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory
from simcompare.model.tuning import TuningRow
from simcompare.results.records.fit_engines import Impact, Number
from simcompare.running.jobs import Outcome

#: what of an audit a user's own loop needs for the contact
_CONTACT = ("restitution", "friction", "contact", "sleep", "engine step")


@dataclass(frozen=True)
class EngineFit:
    """What one engine must be given, and what it then shows.

    Attributes:
        engine: its name.
        version: its version.
        contact: level for which it holds: "tuned" or "assisted".
        status: "ok" or how it failed.
        reason: why it failed.
        fit: what it must be given: the closed form's parameters, and one restitution of its own;
            ``None`` where it failed.
        misfit: root mean square by which the recorded impacts differ from that restitution.
        u_num: unknown -> standard uncertainty from phase, step and change from impact to impact.
        effective: mean restitution that it shows in the fitted drops, and the engine's part of its
            standard uncertainty: phase of the step, and change from impact to impact.
        u_effective: its whole standard uncertainty.
        shown: what the simulations of each drop showed.
        native: contact values that the engine held.
        simulations: how many were run.
        wall_s: wall time of them.
        outcome: how the last simulation ended.
        runs: the middle simulation of each drop.
    """

    engine: str
    version: str | None
    contact: str
    status: str
    reason: str | None
    fit: Fit | None = None
    misfit: float = 0.0
    u_num: Mapping[str, float] = field(default_factory=dict)
    effective: tuple[float, float] | None = None
    u_effective: float = 0.0
    shown: tuple[Deviation, ...] = ()
    native: tuple[AuditRow, ...] = ()
    simulations: int = 0
    wall_s: float = 0.0
    outcome: Outcome | None = field(default=None, repr=False)
    runs: tuple[tuple[Scenario, Trajectory], ...] = field(default=(), repr=False)


@dataclass(frozen=True)
class TunedFit(EngineFit):
    """What a user types into a plain loop of one engine, and what it then does.

    Attributes:
        numbers: the engine's own, for the restitution.
        step_s: the engine step for which they hold [s].
        restitution: what they were tuned to at the first recorded impact, and its u.
        impacts: what each recorded impact showed, drop by drop.
        penetration_m: largest depth in the drops [m].
        tuning: how the numbers were found.
        held: what the held-out drops showed.
        held_m: heights of their apexes in the plain loop, the drop first [m].
        phases: at how many phases of the step each drop was run.
    """

    numbers: tuple[Number, ...] = ()
    step_s: float = 0.0
    restitution: tuple[float, float] = (0.0, 0.0)
    impacts: tuple[Impact, ...] = ()
    penetration_m: float = 0.0
    tuning: tuple[TuningRow, ...] = field(default=(), repr=False)
    held: tuple[Deviation, ...] = ()
    held_m: tuple[Array, ...] = ()
    phases: int = 0


def contact_rows(run: Trajectory) -> tuple[AuditRow, ...]:
    """What of the audit of a run belongs to the contact, and all that was set besides the scene."""
    return tuple(
        row for row in run.audit
        if any(word in f"{row.quantity} {row.engine_parameter}".lower() for word in _CONTACT)
        or (row.scenario_value is None and row.set_value is not None)
    )  # fmt: skip
