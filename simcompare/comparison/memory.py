"""Whether what a run keeps fits into this machine, asked before any of it is made."""

from __future__ import annotations

import os
from collections.abc import Sequence
from decimal import Decimal

from simcompare.errors import InputError
from simcompare.model.scenario import Scenario

#: one recorded number, and one repeat of a scene without its samples [bytes]
_NUMBER, _REPEAT = 8, 13_000
#: recorded of each body: position, orientation, velocity and rate
_OF_BODY = 3 + 4 + 3 + 3
#: memory of a machine that does not tell it [bytes]
_USUAL = 16 * 10**9
_TERABYTE, _GIGABYTE = 10**12, 10**9


def check(
    scenario: Scenario, repeats: int, sources: int, where: str, steps_s: Sequence[float] = ()
) -> None:
    """Refuses more repeats, or more steps, than this machine can hold.

    Args:
        scenario: one of them.
        repeats: number of them.
        sources: that are simulated, each by itself, at its level.
        where: the option or scenario that asks for them.
        steps_s: times between samples [s], where they are not the scenario's own.

    Raises:
        InputError: they do not fit; says how many do.
    """
    world = scenario.world
    counts = [round(world.duration_s / step_s) + 1 for step_s in steps_s or [world.step_s]]
    samples, moving = sum(counts), len(scenario.moving_bodies())
    each = len(counts) * _REPEAT + sources * samples * _NUMBER * (1 + _OF_BODY * moving)
    needed, memory = repeats * each, total()
    if needed <= memory:
        return
    most = memory // each
    cure = f"at most {most} fit" if most else "use a longer --step or fewer engines"
    cure = "use fewer or longer steps, or fewer engines" if len(counts) > 1 else cure
    what = f"{_count(repeats)} repeats of " * (repeats > 1) + f"{samples} samples"
    what += f" at {len(counts)} steps" * (len(counts) > 1)
    times = f" of {sources} sources" if sources > 1 else ""
    fault = f"{what}{times} need {_said(needed)} of memory, and {_said(memory)} are here; {cure}"
    raise InputError(where, [fault])


def total() -> int:
    """Memory of this machine [bytes]."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # not on Windows
        return _USUAL


def _count(number: int) -> str:
    """A number as it was typed, but not all of its digits where they fill lines."""
    return str(number) if number < 10**15 else f"{Decimal(number):.3g}"


def _said(size: int) -> str:
    if size >= 10**18:
        return f"{Decimal(size) / _TERABYTE:.2g} TB"
    unit, name = (_TERABYTE, "TB") if size >= _TERABYTE else (_GIGABYTE, "GB")
    return f"{size / unit:.5g} {name}"
