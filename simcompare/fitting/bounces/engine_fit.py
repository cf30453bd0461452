"""What a fit found for one engine, common to those in its plain loop and those with helps."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from simcompare import units
from simcompare.fitting.bounces.beside import Bouncing
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.model.audit import AuditRow
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Trajectory
from simcompare.running.jobs import Outcome

#: what of an audit a user's own loop needs for the contact
_CONTACT = ("restitution", "friction", "solref", "contact", "sleep", "engine step")


@dataclass(frozen=True)
class EngineFit:
    """What one engine must be given, and what it then shows.

    Attributes:
        engine: its name.
        version: its version.
        contact: level for which it holds: "tuned" or "assisted".
        status: "ok" or how it failed.
        reason: why it failed.
        fit: the closed form's parameters; with helps those to be given to the engine, ``None``
            where it failed.
        u_num: unknown -> standard uncertainty from phase and step.
        effective: mean restitution that it shows in the fitted drops, and its standard uncertainty
            from the phase.
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
    u_num: Mapping[str, float] = field(default_factory=dict)
    effective: tuple[float, float] | None = None
    u_effective: float = 0.0
    shown: tuple[Bouncing, ...] = ()
    native: tuple[AuditRow, ...] = ()
    simulations: int = 0
    wall_s: float = 0.0
    outcome: Outcome | None = field(default=None, repr=False)
    runs: tuple[tuple[Scenario, Trajectory], ...] = field(default=(), repr=False)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        plain: dict[str, Any] = {
            "name": self.engine, "version": self.version, "contact": self.contact,
            "status": self.status, "reason": self.reason, "simulations": self.simulations,
            "wall_s": self.wall_s,
        }  # fmt: skip
        if self.fit is None or self.effective is None:
            return {**plain, "parameters": {}, "effective": {}}
        return {
            **plain,
            "parameters": self.parameters(),
            "correlation": self.fit.to_dict()["correlation"],
            "effective": {"restitution": {"value": self.effective[0], "u": self.u_effective,
                                          "u_phase": self.effective[1], "unit": "1"}},
            "native": [vars(row) for row in self.native],
            "shown": [
                {"times_s": seen.times_s.tolist(), "restitution": seen.restitution.tolist(),
                 "scatter": seen.u_restitution.tolist(), "late_s": seen.late_s.tolist(),
                 "scatter_s": seen.scatter_s.tolist()}
                for seen in self.shown
            ],
        }  # fmt: skip

    def parameters(self) -> dict[str, dict[str, Any]]:
        """Unknown -> value, uncertainty and interval."""
        assert self.fit is not None
        return {
            name: {"value": row["value"], "u": row["u"], "interval95": [row["low"], row["high"]],
                   "unit": units.unit_of(name.partition("[")[0]),
                   "u_num": _finite(self.u_num.get(name, 0.0))}
            for name, row in self.fit.to_dict()["parameters"].items()
        }  # fmt: skip


def contact_rows(run: Trajectory) -> tuple[AuditRow, ...]:
    """What of the audit of a run belongs to the contact, and all that was set besides the scene."""
    return tuple(
        row for row in run.audit
        if any(word in f"{row.quantity} {row.engine_parameter}".lower() for word in _CONTACT)
        or (row.scenario_value is None and row.set_value is not None)
    )  # fmt: skip


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
