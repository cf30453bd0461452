"""How a script reads one sample: bodies and joints, alike ones in loops."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from simcompare.engine.scripting.rolling import loop_head


@dataclass(frozen=True)
class Group:
    """Bodies, or joints, that are read alike.

    Attributes:
        variables: names that the lines use for what is different.
        items: name of each -> source of the variables.
        seen: what is read of one: position, orientation, velocity and rate of a body; coordinate
            and rate of a joint.
        reads: lines that must run before.
    """

    variables: tuple[str, ...]
    items: Mapping[str, tuple[str, ...]]
    seen: Sequence[str]
    reads: Sequence[str] = ()


@dataclass(frozen=True)
class Reading:
    """What reads one sample.

    Attributes:
        bodies: names, in the order in which they are read.
        joints: likewise.
        lines: what must run first.
        seen: a list of all that is read, or the name of one.
    """

    bodies: Sequence[str]
    joints: Sequence[str]
    lines: list[str] = field(default_factory=list)
    seen: str = "seen"


def reading(
    bodies: Sequence[Group], joints: Sequence[Group] = (), first: Sequence[str] = ()
) -> Reading:
    """Reads all bodies, then all joints.

    Args:
        bodies: those that move.
        joints: those that move.
        first: lines that come before.
    """
    groups = [group for group in (*bodies, *joints) if group.items]
    moving = [name for group in bodies for name in group.items]
    driven = [name for group in joints for name in group.items]
    if all(len(group.items) == 1 for group in groups) and len(groups) <= 1 + bool(driven):
        plain = [_of_one(group) for group in groups]
        lines = [line for reads, _ in plain for line in reads]
        texts = ", ".join(text for _, seen in plain for text in seen)
        return Reading(moving, driven, [*first, *lines], f"[{texts}]")
    lines = [*first]
    known = False
    for group in groups:
        reads, seen = _of_one(group)
        if len(group.items) == 1:
            lines += [*reads, f"seen {'+=' if known else '='} [{', '.join(seen)}]"]
        else:
            lines += [] if known else ["seen = []"]
            columns = _columns(group)
            inside = [*reads, f"seen += [{', '.join(seen)}]"]
            lines += [loop_head(columns), *(f"    {line}" for line in inside)]
        known = True
    return Reading(moving, driven, lines)


def _columns(group: Group) -> dict[str, tuple[str, ...]]:
    columns = zip(*group.items.values(), strict=True)
    by_name = zip(group.variables, columns, strict=True)
    return {name: values for name, values in by_name if len(set(values)) > 1}


def _of_one(group: Group) -> tuple[list[str], list[str]]:
    """Lines and texts with those variables replaced that are the same for all."""
    first = next(iter(group.items.values()))
    varied = _columns(group)
    fixed = {n: text for n, text in zip(group.variables, first, strict=True) if n not in varied}

    def filled_in(text: str) -> str:
        for name, source in fixed.items():
            text = re.sub(rf"\b{name}\b", lambda _, source=source: source, text)  # type: ignore[misc]
        return text

    return [filled_in(line) for line in group.reads], [filled_in(text) for text in group.seen]
