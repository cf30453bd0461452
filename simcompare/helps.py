"""What we add to an engine's own loop, by name; an engine takes those that it declares.

The level ``assisted`` takes all of them, ``tuned`` none. Each can be left out by itself, so that
its part in a result can be told.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from simcompare.errors import InputError, UnknownName

LANDING = "landing"
HALF_STEP_START = "half_step_start"
CENTRED_EFFORTS = "centred_efforts"
RECOIL = "recoil"
REACTIONS = "reactions"
RIMS = "rims"

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
}
#: words of the command line for all helps and for none
ALL, NONE = "all", "none"


def chosen(text: str | Sequence[str]) -> frozenset[str]:
    """Helps from ``all``, ``none`` or names with commas.

    Raises:
        UnknownName: one of them does not exist.
        InputError: ``all`` or ``none`` beside others.
    """
    words = text.split(",") if isinstance(text, str) else text
    asked = [word.strip() for word in words if word.strip()]
    if asked == [ALL]:
        return frozenset(HELPS)
    if asked == [NONE]:
        return frozenset()
    for word in asked:
        if word in (ALL, NONE):
            raise InputError("--assist", [f"{word!r} stands alone; found {text!r}"])
        if word not in HELPS:
            raise UnknownName("help", word, [*HELPS, ALL, NONE])
    if not asked:
        raise InputError(
            "--assist", [f"names no help; expected {ALL}, {NONE} or some of {known()}"]
        )
    return frozenset(asked)


def known(names: Iterable[str] = HELPS) -> str:
    """Names of helps as they are typed, in their order."""
    return ",".join(name for name in HELPS if name in set(names))
