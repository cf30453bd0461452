"""Answers to a request: the numbers for a restitution, or the restitution of numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from types import ModuleType

from simcompare.engine.backend import Backend
from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.engine.calibration.edges import edge
from simcompare.engine.calibration.engine_drops import Tunable
from simcompare.engine.calibration.question import Question, on_the_kit
from simcompare.model.audit import AuditRow
from simcompare.model.settings import SPRING
from simcompare.model.tuning import AtSpeed
from simcompare.tuning.bench import STATED, Bench, Numbers
from simcompare.tuning.number_search import numbers_for
from simcompare.tuning.ranges import speed_range, step_range
from simcompare.tuning.request import Request
from simcompare.tuning.statement import Statement, Typed

#: how the core calls what is set for a restitution
_RESTITUTION = " restitution"
#: how often the value is doubled or halved, and how often the way back is halved
_FAR, _NEAR = 8, 4


def statement_for(backend: Tunable, engine: ModuleType, request: Request) -> Statement:
    """The numbers for a restitution, or the restitution of numbers, and where they hold.

    Raises:
        CannotCalibrate: no numbers give it; says why, and the nearest that can be had.
    """
    bench = Bench(backend, engine, request)
    if request.restitution is None:
        return _stated(bench, request.numbers, None)
    try:
        found = _sought(bench, request.restitution)
        if not any(bench.rebounds(one) for one in found.at):
            raise CannotCalibrate(f"with what comes nearest to it, {found.fault}")
    except CannotCalibrate as error:
        raise _with_nearest(bench, request, error) from None
    if not found.fault:
        return found
    return replace(found, longest_step_s=_longest_step_s(bench))


def _sought(bench: Bench, restitution: float) -> Statement:
    """The stiffest contact; where it does not hold everywhere and a softer one does, that one."""
    found = _stated(bench, numbers_for(bench, restitution), restitution)
    if bench.wants_steadiest:
        return replace(found, is_steadiest=True)
    if not found.fault or bench.kind != SPRING or bench.request.scatter_part is not None:
        return found
    softer = bench.of(replace(bench.request, depth_m=bench.depth_m))
    try:
        other = _stated(softer, numbers_for(softer, restitution), restitution)
    except CannotCalibrate:
        return found
    return found if other.fault else replace(other, is_steadiest=True)


def _stated(bench: Bench, numbers: Numbers, wanted: float | None) -> Statement:
    """What numbers do, held against what is wanted, or against what they do in the middle."""
    request = bench.request
    at = tuple(bench.at(numbers, speed, phases=STATED) for speed in request.speeds_m_s)
    restitution = _found(at) if wanted is None else wanted
    speeds, steps, faults = None, None, []
    if math.isfinite(restitution):
        speeds = speed_range(bench, numbers, restitution, at)
        faults = [(one, bench.fault(one, restitution)) for one in at]
    if speeds is not None:
        held = [speed for speed in request.speeds_m_s if speeds.low <= speed <= speeds.high]
        ends = sorted({held[0], held[len(held) // 2], held[-1]})
        steps = step_range(bench, numbers, restitution, ends)
    wrong = next((f"at {one.speed_m_s:.3g} m/s {words}" for one, words in faults if words), "")
    typed = tuple(typed_in(bench.audit(numbers), numbers))
    return Statement(restitution, numbers, typed, at, speeds, steps, None, wrong, drops=bench.count)


def _found(at: Sequence[AtSpeed]) -> float:
    """Middle of the lowest and the highest mean of those that bounce; NaN where none does."""
    means = [one.restitution for one in at if math.isfinite(one.restitution)]
    return (min(means) + max(means)) / 2 if means else math.nan


def typed_in(audit: Sequence[AuditRow], numbers: Numbers) -> list[Typed]:
    """All that a loop of one's own needs beside the scene: restitution, solver and step.

    Friction is left out: it does nothing to a bounce without a slip.
    """
    found = []
    for row in audit:
        is_wanted = row.quantity.endswith(_RESTITUTION) or row.quantity == "engine step_s"
        if row.set_value is None or not (is_wanted or row.scenario_value is None):
            continue
        is_tuned = row.quantity.endswith(_RESTITUTION) and row.set_value in numbers
        unit = "" if row.unit in ("1", "SI") else row.unit
        found.append(Typed(row.engine_parameter, row.set_value, unit, is_tuned, row.note))
    return sorted(found, key=lambda one: not one.is_tuned)


def _longest_step_s(bench: Bench) -> float | None:
    """The longest shorter step with which numbers hold at all speeds that were asked for."""
    request = bench.request
    return nearest(lambda step_s: _can(bench, request.with_step(step_s)), request.step_s, 0.5)


def _can(bench: Bench, request: Request, *, everywhere: bool = True) -> bool:
    """Whether there are numbers for a request that hold at all its speeds, or at some of them."""
    other, wanted = bench.of(request), request.restitution
    assert wanted is not None
    try:
        numbers = numbers_for(other, wanted)
    except CannotCalibrate:
        return False
    found = (not other.fault(other.at(numbers, v), wanted) for v in request.speeds_m_s)
    return all(found) if everywhere else any(found)


def _with_nearest(bench: Bench, request: Request, error: CannotCalibrate) -> CannotCalibrate:
    """The error with what can be had instead: a shorter step, or another speed."""

    def at_some_speeds(step_s: float) -> bool:
        return _can(bench, request.with_step(step_s), everywhere=False)

    def at_speed(speed_m_s: float) -> bool:
        return _can(bench, replace(request, lowest_m_s=speed_m_s, highest_m_s=speed_m_s))

    where = " at all speeds" if len(request.speeds_m_s) > 1 else ""
    step_s = _longest_step_s(bench)
    if step_s is None and where:
        where, step_s = " at some of the speeds", nearest(at_some_speeds, request.step_s, 0.5)
    if step_s is not None:
        can = f"with a step of {1e3 * step_s:.3g} ms it can be had{where}"
        return CannotCalibrate(f"{error}; {can}", step_s)
    for factor, speed_m_s in ((2.0, request.highest_m_s), (0.5, request.lowest_m_s)):
        found = nearest(at_speed, speed_m_s, factor)
        if found is not None:
            return CannotCalibrate(f"{error}; at {found:.3g} m/s it can be had")
    return error


def nearest(can: Callable[[float], bool], start: float, factor: float) -> float | None:
    """The nearest value on one side with which something can be had, to two or three digits.

    Args:
        can: whether it can be had with a value.
        start: a value with which it cannot.
        factor: by which the value is multiplied, 2 or 0.5.

    Returns:
        The value, ``None`` if none was found.
    """
    bad, good = start, start
    for _ in range(_FAR):
        good *= factor
        if can(good):
            break
        bad = good
    else:
        return None
    good = edge(can, good, bad, _NEAR)
    for digits in (2, 3):  # as it is printed, and typed in
        rounded = _rounded(good, digits, up=factor > 1)
        if can(rounded):
            return rounded
    return None


def _rounded(value: float, digits: int, *, up: bool) -> float:
    unit = 10.0 ** (math.floor(math.log10(value)) + 1 - digits)
    count = math.ceil(value / unit) if up else math.floor(value / unit)
    return float(f"{count * unit:.{digits}g}")


@dataclass(frozen=True)
class StatementQuestion(Question[Statement]):
    """Which numbers give a restitution, or the other way round.

    Attributes:
        request: what is asked.
    """

    kind = Statement
    request: Request

    def answer(self, backend: Backend) -> Statement:
        """Finds it with drops in the engine.

        Raises:
            Unsupported: the engine cannot be asked.
            CannotCalibrate: no numbers give it.
        """
        engine = on_the_kit(backend, ": its backend is not on the kit, so cannot be tuned")
        try:
            return statement_for(engine, engine.load(), self.request)
        except CannotCalibrate as error:
            raise error.of(backend.name) from None
