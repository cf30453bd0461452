"""Efforts at the instant of the positions: springs, dampers, motors and drag.

An engine stores velocities half a step away from positions. What acts with the stored rate is wrong
to first order in the step: the time constant T of a motor by h/2T, and a resonance by ζ·ω·h. So the
efforts are given with the rate at the instant of the positions; an engine that takes a damper with
the rate before a step and with that after it gets half of it in each, whose mean belongs there.
"""

from __future__ import annotations

import math
from dataclasses import replace

from simcompare.engine.drives import JointLaw
from simcompare.engine.helps import CENTRED_EFFORTS
from simcompare.model.scenario import Body
from simcompare.model.settings import Settings
from simcompare.model.shapes import Vector


def shares(law: JointLaw, passive: str, settings: Settings) -> tuple[JointLaw, float, JointLaw]:
    """Divides what acts on a joint.

    Args:
        law: all of it.
        passive: what the engine does itself about springs and dampers; see ``scene.Traits``.
        settings: whether the help is taken.

    Returns:
        What the engine itself is to be given; the damping of an actuator of its own, with the rate
        before a step; and what is given as an effort in each step.
    """
    helped = settings.takes(CENTRED_EFFORTS)
    inputs = replace(law, stiffness=0.0, rest=0.0, damping=0.0)
    if passive == "none" or (passive == "implicit" and helped):
        return inputs, 0.0, law
    if passive == "both" and helped:
        return replace(law, damping=law.damping / 2), law.damping / 2, inputs
    return law, 0.0, inputs


def drag_at(body: Body, velocity: Vector, acceleration: Vector, ahead_s: float) -> Vector:
    """Drag [N] at a velocity that is a time ahead of the stored one."""
    assert body.drag is not None
    vx, vy, vz = (v + a * ahead_s for v, a in zip(velocity, acceleration, strict=True))
    scale = -body.drag.factor_kg_m * math.hypot(vx, vy, vz)
    return scale * vx, scale * vy, scale * vz
