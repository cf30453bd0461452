"""Lists of engines and of other things in plain words."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from typing import TypeVar

from simcompare.model.trajectory import AT

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")
#: more names than this are counted where they are all that there are; no more are left out
_FEW = 2


def grouped(pairs: Iterable[tuple[K, V]]) -> dict[K, list[V]]:
    """Values by their keys, in the order in which they come."""
    groups: dict[K, list[V]] = {}
    for key, value in pairs:
        groups.setdefault(key, []).append(value)
    return groups


def joined(names: Sequence[str]) -> str:
    """``a, b and c``."""
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last


def engines(names: Sequence[str], every: Sequence[str]) -> str:
    """Some of all sources by their names, counted where they are all or nearly so."""
    others = [name for name in every if name not in names]
    if len(names) > (_FEW if not others else 2 * _FEW) and len(others) <= _FEW:
        return _count(names, every)
    return joined(steps_together(names, every))


def in_how_many(names: Sequence[str], every: Sequence[str]) -> str:
    """Where something happens, shortly: all of one or two by their names, else counted."""
    few = len(names) == len(every) <= _FEW
    return f"in {joined(names) if few else _count(names, every)}"


def _count(names: Sequence[str], every: Sequence[str]) -> str:
    if len(names) == len(every):
        return f"all {len(every)} {noun(every)}"
    return f"{len(names)} of {len(every)} {noun(every)}"


def steps_together(names: Sequence[str], every: Sequence[str]) -> list[str]:
    """The same, an engine at all of its steps as one, and at some as one with these steps."""
    steps, every_step = (
        grouped((name.partition(AT)[0], name.partition(AT)[2]) for name in some)
        for some in (names, every)
    )
    return [
        engine if len(some) == len(every_step[engine]) else f"{engine}{AT}{'/'.join(some)}"
        for engine, some in steps.items()
    ]


def noun(every: Sequence[str]) -> str:
    """What sources are: one and the same engine may stand among them more than once."""
    bare = {name.partition("@")[0].partition(":")[0] for name in every}
    return "engines" if len(bare) == len(every) else "cases"
