"""What we add to an engine's own loop, by name; an engine takes those that it declares.

The level ``assisted`` takes all of them, ``tuned`` none. Each can be left out by itself, so that
its part in a result can be told.
"""

from __future__ import annotations

from collections.abc import Iterable

LANDING = "landing"
HALF_STEP_START = "half_step_start"
CENTRED_EFFORTS = "centred_efforts"
RECOIL = "recoil"
REACTIONS = "reactions"
RIMS = "rims"
RAYS = "rays"

#: help -> what it does, in one sentence
HELPS = {
    LANDING: "Steps are divided so that an impact happens within microseconds, with the contact"
    " numbers that such steps need.",
    HALF_STEP_START: "Motion begins half a step away from the start, where a step stores its"
    " velocities, so that positions do not run ahead.",
    CENTRED_EFFORTS: "Springs, dampers, motors and drag act with the rate at the instant of the"
    " positions, not with the one that is stored half a step away.",
    RECOIL: "The parent of a joint with an armature gets the torques that are missing where the"
    " armature is a part of the child's moment of inertia.",
    REACTIONS: "Forces through joints that an engine gives wrongly, or only as a magnitude, are"
    " worked out from its motion.",
    RIMS: "Other collision shapes take the place of those that an engine handles badly: two rims"
    " of a cylinder on a plane, a large box of a plane under boxes.",
    RAYS: "Range sensors read what our own exact rays meet, where the engine casts none, or casts"
    " them beside round shapes.",
}


def known(names: Iterable[str] = HELPS) -> str:
    """Names of helps as they are typed, in their order."""
    return ",".join(name for name in HELPS if name in set(names))
