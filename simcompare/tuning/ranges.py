"""In which range of speeds, and of steps, an engine's numbers hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from simcompare.model.tuning import AtSpeed
from simcompare.tuning.bench import Bench, Numbers
from simcompare.tuning.statement import Range

#: ratio from one value to the next while it still holds, and how close an end is found
_STRIDE, _CLOSE = 1.13, 1.01
#: places between the last two strides and an end that are looked at again
_CLOSER = 9
#: how far beyond the speeds and the step that were asked for an end is looked for
WIDER_SPEED, WIDER_STEP = 10.0, 8.0

Fault = Callable[[float], str]


def speed_range(
    bench: Bench, numbers: Numbers, restitution: float, at: Sequence[AtSpeed]
) -> Range | None:
    """Speeds about those that were asked for at which numbers hold; ``None`` where they never do.

    Args:
        bench: the engine.
        numbers: its numbers.
        restitution: what they stand for.
        at: what they do at the speeds that were asked for, the slowest first.
    """

    def fault(speed_m_s: float) -> str:
        return bench.fault(bench.at(numbers, speed_m_s), restitution)

    held = _longest_run([not bench.fault(one, restitution) for one in at])
    if held is None:
        return None
    speeds = [one.speed_m_s for one in at]
    # beyond the end of the run it fails, so that is where to look; else as far as makes sense
    first, last = held
    slowest = max(speeds[0] / WIDER_SPEED, bench.slowest_m_s())
    low_end = speeds[first - 1] if first else min(slowest, speeds[0])
    high_end = speeds[last + 1] if last + 1 < len(speeds) else speeds[-1] * WIDER_SPEED
    low, below = _end(fault, speeds[first], low_end)
    high, above = _end(fault, speeds[last], high_end)
    return Range(low, high, below, above)


def step_range(
    bench: Bench, numbers: Numbers, restitution: float, speeds_m_s: Sequence[float]
) -> Range:
    """Steps about the one that was asked for with which numbers hold at speeds where they do."""

    def fault(step_s: float) -> str:
        faults = (bench.fault(bench.at(numbers, v, step_s), restitution) for v in speeds_m_s)
        return next((words for words in faults if words), "")

    step_s = bench.request.step_s
    low, below = _end(fault, step_s, step_s / WIDER_STEP)
    # no further than its slowest impact can be read
    readable_s = step_s * min(speeds_m_s) / bench.slowest_m_s()
    high, above = _end(fault, step_s, max(min(step_s * WIDER_STEP, readable_s), step_s))
    return Range(low, high, below, above)


def _longest_run(held: Sequence[bool]) -> tuple[int, int] | None:
    """First and last index of the longest run of what holds, the later one of two."""
    best: tuple[int, int] | None = None
    start: int | None = None
    for i, is_held in enumerate([*held, False]):
        if is_held and start is None:
            start = i
        elif not is_held and start is not None:
            if best is None or i - 1 - start >= best[1] - best[0]:
                best = (start, i - 1)
            start = None
    return best


def _end(fault: Fault, start: float, stop: float) -> tuple[float, str]:
    """The last value that holds on the way from one that does, and what is wrong beyond it."""
    stride = _STRIDE if stop > start else 1 / _STRIDE
    before = good = start
    while good != stop:
        further = good * stride
        if (further - stop) * (stop - start) >= 0:
            further = stop
        wrong = fault(further)
        if wrong:
            return _first(fault, before, *_between(fault, good, further, wrong))
        before, good = good, further
    return good, ""


def _between(fault: Fault, good: float, bad: float, wrong: str) -> tuple[float, str]:
    while max(good / bad, bad / good) > _CLOSE:
        middle = math.sqrt(good * bad)
        found = fault(middle)
        if found:
            bad, wrong = middle, found
        else:
            good = middle
    return good, wrong


def _first(fault: Fault, start: float, end: float, wrong: str) -> tuple[float, str]:
    """The first of several ends: near its limit a mean ripples, and crosses it more than once."""
    good = start
    for further in np.geomspace(start, end, _CLOSER)[1:-1].tolist():
        found = fault(further)
        if found:
            return good, found
        good = further
    return end, wrong
