"""Efforts at the instant of the positions: springs, dampers, motors and drag.

An engine stores velocities half a step away from positions. What acts with the stored rate is wrong
to first order in the step: the time constant T of a motor by h/2T, and a resonance by ζ·ω·h. So the
efforts are given with the rate at the instant of the positions; an engine that takes a damper with
the rate before a step and with that after it gets half of it in each, whose mean belongs there.
"""

from __future__ import annotations

from dataclasses import replace

from simcompare.engine.drives import JointLaw
from simcompare.engine.helps import CENTRED_EFFORTS
from simcompare.model.settings import Settings


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
