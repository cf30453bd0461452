"""The search for an engine's numbers that give a restitution over a range of speeds."""

from __future__ import annotations

import math
from typing import Protocol

from simcompare.engine.calibration.calibration import (
    AIM,
    MAX_RESTITUTION,
    PHASES,
    CannotCalibrate,
    coefficient_for,
    refuse_extremes,
)
from simcompare.engine.calibration.drops import even_phases
from simcompare.engine.calibration.springs import MIN_RESTITUTION, damped_for, find_spring
from simcompare.errors import SimulationDiverged
from simcompare.model.settings import SPRING
from simcompare.tuning.bench import Bench, Numbers

#: how often numbers are moved so that the means over the range lie evenly about what is wanted
_BALANCED = 4
#: digits of a number that is handed out, and tried out, as it is typed in
DIGITS = 7
_PHASES = even_phases(PHASES)


def numbers_for(bench: Bench, restitution: float) -> Numbers:
    """Numbers whose mean restitutions over the range lie evenly about what is wanted.

    Raises:
        CannotCalibrate: there are none.
    """
    try:
        found = _exactly(bench, restitution)
    except SimulationDiverged as error:
        raise CannotCalibrate(f"while numbers were sought, {error}") from None
    return tuple(float(f"{value:.{DIGITS}g}") for value in found)


def _exactly(bench: Bench, restitution: float) -> Numbers:
    if bench.kind != SPRING and MAX_RESTITUTION < restitution <= 1:
        return (restitution,)  # what hardly loses anything is typed in as it stands
    if bench.kind != SPRING:
        refuse_extremes(restitution)
    search: _NumberSearch = (
        _SpringNumbers(bench) if bench.kind == SPRING else _CoefficientNumbers(bench)
    )
    numbers, target = search.first(restitution), restitution
    if len(bench.request.speeds_m_s) == 1:
        return numbers
    for _ in range(_BALANCED):
        off = _middle(bench, numbers) - restitution
        if not abs(off) > AIM * restitution or not 0 < target - off <= MAX_RESTITUTION:
            break
        target -= off
        try:
            numbers = search.moved(numbers, target)
        except CannotCalibrate:  # those that are right at one speed are there
            break
    return numbers


def _middle(bench: Bench, numbers: Numbers) -> float:
    """Middle of the lowest and the highest mean of the range; NaN where nothing bounces."""
    some = bench.request.speeds_m_s[::2]  # both ends among them
    means = [bench.drops()(numbers, v, _PHASES).mean for v in some]
    means = [mean for mean in means if math.isfinite(mean)]
    return (min(means) + max(means)) / 2 if means else math.nan


class _NumberSearch(Protocol):
    def first(self, restitution: float) -> Numbers:
        """Numbers that are right at one speed of the range."""

    def moved(self, numbers: Numbers, restitution: float) -> Numbers:
        """The same for another restitution."""


class _CoefficientNumbers:
    """One coefficient, whose mean restitution grows with it."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench

    def first(self, restitution: float) -> Numbers:
        request, drops = self._bench.request, self._bench.drops()
        return (coefficient_for(drops, restitution, request.middle_m_s, request.step_s),)

    def moved(self, _: Numbers, restitution: float) -> Numbers:
        return self.first(restitution)


class _SpringNumbers:
    """A spring and damper: the stiffest within the scatter, or the steadiest within the depth."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench

    def first(self, restitution: float) -> Numbers:
        if not MIN_RESTITUTION <= restitution <= MAX_RESTITUTION:
            raise CannotCalibrate(
                f"a spring and damper is sought for restitutions from {MIN_RESTITUTION:g} to"
                f" {MAX_RESTITUTION:g}, not for {restitution:g}"
            )
        request, bench = self._bench.request, self._bench
        # slow impacts scatter most, fast ones sink deepest; then what the fast ones allow
        for speed_m_s in dict.fromkeys((request.lowest_m_s, request.highest_m_s)):
            depth_m = bench.depth_m * speed_m_s / request.highest_m_s
            found = find_spring(
                bench.drops(), restitution, speed_m_s, request.step_s, request.gravity_m_s2,
                depth_m, bench.scatter_part, steadiest=bench.wants_steadiest,
            )  # fmt: skip
            if found is not None:
                return found
        steady = f" and a scatter of at most {bench.scatter_part * restitution:.2g}"
        if math.isinf(bench.scatter_part):
            steady = ""
        raise CannotCalibrate(
            f"no spring and damper of up to {1e3 * bench.depth_m:.3g} mm gives a restitution of"
            f" {restitution:g} with a step of {1e3 * request.step_s:.3g} ms{steady}"
        )

    def moved(self, numbers: Numbers, restitution: float) -> Numbers:
        request = self._bench.request
        return damped_for(
            self._bench.drops(), restitution, request.middle_m_s, request.step_s, numbers
        )
