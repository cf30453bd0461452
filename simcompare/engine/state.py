"""State of a simulation, as plain values that bring it back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from simcompare.model.audit import Audit
from simcompare.model.scenario import Scenario
from simcompare.model.shapes import Vector
from simcompare.model.trajectory import BODY_SIGNALS


@dataclass(frozen=True)
class BodyState:
    """Motion of one body: position [m], orientation wxyz, velocity [m/s], rate [rad/s]; world."""

    position_m: tuple[float, ...]
    orientation_wxyz: tuple[float, ...]
    velocity_m_s: tuple[float, ...]
    rate_rad_s: tuple[float, ...]


@dataclass(frozen=True)
class State:
    """State of a simulation after a whole number of recorded steps.

    Attributes:
        time_s: time since the scenario's start [s].
        bodies: motion of every moving body.
        velocity_step_s: engine step to which the stored velocities belong [s]; see ``landing``.
        joints: coordinate and rate of every movable joint [rad, rad/s or m, m/s].
        rates_before: stored rates of the driven joints one engine step earlier; see ``drives``.
        recoil: what armatures remember; see ``helps.recoil``.
    """

    time_s: float
    bodies: Mapping[str, BodyState]
    velocity_step_s: float = field(default=0.0)
    joints: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    rates_before: tuple[float, ...] | None = None
    recoil: tuple[Any, Any] | None = None


def compare_start(
    engine: str,
    scenario: Scenario,
    state: State,
    origins: Mapping[str, Vector],
    precision: float = 1e-12,
) -> None:
    """Compares the motion that an engine holds at the start with the scenario's.

    Args:
        engine: name of the engine, for the message.
        scenario: the scene.
        state: what the engine holds.
        origins: where the engine itself has the bodies that hang on joints [m].
        precision: relative rounding of the engine's numbers.

    Raises:
        ReadBackMismatch: they differ; every component that does is named.
    """
    audit = Audit(engine, relative=max(1e-6, 10 * precision))

    def compare(what: str, wanted: Sequence[float], held: Sequence[float]) -> None:
        for axis, a, b in zip("wxyz"[-len(wanted) :], wanted, held, strict=True):
            # rounding about 0 is no difference: of metres, radians and their rates here
            clean = a if abs(a - b) < max(1e-12, precision * extent) else b
            audit.add(f"{what}.{axis}", a, "state", (a, clean), "")

    free = scenario.free_bodies()
    places = [c for body in scenario.moving_bodies().values() for c in body.position_m]
    extent = max([1.0, *map(abs, places)])
    for name, held in state.bodies.items():
        body = scenario.bodies[name]
        # how a body on a joint moves follows from the joint
        for part in BODY_SIGNALS if name in free else ("position_m", "orientation_wxyz"):
            wanted, got = getattr(body, part), getattr(held, part)
            if len(wanted) == 4 and sum(a * b for a, b in zip(wanted, got, strict=True)) < 0:
                got = tuple(-value for value in got)  # the same rotation
            compare(f"{name}.{part}", wanted, got)
    for name, origin in origins.items():
        compare(f"{name}.position_m", scenario.bodies[name].position_m, origin)
    for name, (position, rate) in state.joints.items():
        compare(f"{name}.position", (0.0,), (position,))
        compare(f"{name}.rate", (scenario.joints[name].rate,), (rate,))
    audit.finish()
