"""An engine's numbers for the restitution of every pair of a scene, from drops in that engine."""

from __future__ import annotations

import math
from dataclasses import replace
from types import ModuleType

from simcompare.engine.calibration import cache, calibration
from simcompare.engine.calibration.calibration import Calibration, CannotCalibrate
from simcompare.engine.calibration.engine_drops import MIN_GRAVITY_M_S2, EngineDrops, Tunable
from simcompare.engine.calibration.plan import drop_plans
from simcompare.engine.calibration.springs import DEPTH, calibrate_spring
from simcompare.engine.contacts import touching_pairs
from simcompare.model.scenario import Scenario
from simcompare.model.settings import SPRING, DropPlan, PairNumbers, Settings
from simcompare.model.tuning import TuningRow

#: impacts of a body that bounces on, whose speeds are looked at; the first one is right
IMPACTS = 4
#: how many shorter steps are tried as a cure
_CURES = 12


def tuned(
    backend: Tunable, engine: ModuleType, scenario: Scenario, settings: Settings
) -> tuple[Settings, tuple[TuningRow, ...]]:
    """Settings with numbers for every pair that bounces, and how they were found.

    Raises:
        Unsupported: no numbers give a restitution at this step; says what is possible.
    """
    known = {frozenset(numbers.pair) for numbers in settings.numbers}
    wanted = {frozenset(contact.pair): contact.restitution for contact in touching_pairs(scenario)}
    # a plan that was made for another restitution, as in a repeat that varies it, is not for this
    plans = [*(settings.drops or ()), *drop_plans(scenario)]
    numbers, rows = list(settings.numbers), []
    for plan in plans:
        open_pairs = [
            pair
            for pair in plan.pairs
            if frozenset(pair) not in known
            and math.isclose(wanted.get(frozenset(pair), -1.0), plan.restitution, rel_tol=1e-9)
        ]
        if not open_pairs:
            continue
        known |= {frozenset(pair) for pair in open_pairs}
        try:
            found = _cached(backend, engine, plan)
        except CannotCalibrate as error:
            raise error.of(backend.name) from None
        numbers += [PairNumbers(pair, found.numbers) for pair in open_pairs]
        rows.append(_row(plan, found))
    return replace(settings, numbers=tuple(numbers)), tuple(rows)


def _row(plan: DropPlan, found: Calibration) -> TuningRow:
    return TuningRow(
        pairs=plan.pairs, restitution=found.restitution, numbers=found.numbers,
        speed_m_s=plan.speed_m_s, step_s=plan.step_s, size_m=plan.size_m,
        gravity_m_s2=plan.gravity_m_s2, notes=plan.notes, stall_speed_m_s=found.stall_speed_m_s,
        drops=found.drops, at=found.at, checks=found.checks,
    )  # fmt: skip


def calibrate(
    backend: Tunable, engine: ModuleType, plan: DropPlan, *, _is_cure: bool = False
) -> Calibration:
    """Finds numbers for a plan by dropping a sphere in the engine.

    Raises:
        CannotCalibrate: there are none; says with which step there are, where one was found.
    """
    is_lossless = plan.restitution > calibration.MAX_RESTITUTION and backend.bounces_by != SPRING
    if is_lossless or not backend.bounces_by:
        # what hardly loses anything is typed in as it stands, and what comes of it is shown
        return Calibration(plan.restitution, (plan.restitution,))
    e, gravity = plan.restitution, max(plan.gravity_m_s2, MIN_GRAVITY_M_S2)
    speeds = [plan.speed_m_s * e**k for k in range(IMPACTS)]
    if backend.bounces_by == SPRING:
        return calibrate_spring(
            EngineDrops(backend, engine, plan), e, speeds, plan.step_s, plan.size_m, gravity,
            lambda step_s: EngineDrops(backend, engine, replace(plan, step_s=step_s)),
        )  # fmt: skip
    found = calibration.calibrate_coefficient(
        EngineDrops(backend, engine, plan), e, speeds, plan.step_s, gravity
    )
    depth_m = found.at[0].penetration_m if found.at else 0.0
    if depth_m <= DEPTH * plan.size_m:
        return found
    longest_s = None if _is_cure else _longest_step_s(backend, engine, plan, depth_m)
    cure = "" if longest_s is None else f"; with a step of {1e3 * longest_s:g} ms it does not"
    raise CannotCalibrate(
        f"in a step of {1e3 * plan.step_s:.3g} ms a body at {plan.speed_m_s:.3g} m/s goes"
        f" {1e3 * depth_m:.4g} mm deep, more than half its size of {1e3 * plan.size_m:.3g}"
        f" mm{cure}",
        math.nan if longest_s is None else longest_s,
    )


def _longest_step_s(
    backend: Tunable, engine: ModuleType, plan: DropPlan, depth_m: float
) -> float | None:
    """The longest step that was tried with which a body does not go too deep [s]."""
    step_s = plan.step_s * DEPTH * plan.size_m / depth_m  # how deep it goes grows with the step
    for _ in range(_CURES):
        step_s = math.floor(1e5 * step_s) / 1e5
        try:
            calibrate(backend, engine, replace(plan, step_s=step_s), _is_cure=True)
        except CannotCalibrate:
            step_s *= 0.97
        else:
            return step_s
    return None


def _cached(backend: Tunable, engine: ModuleType, plan: DropPlan) -> Calibration:
    question = replace(plan, pairs=(), notes=())  # whatever the pairs are called
    return cache.kept(backend, question, Calibration, lambda: calibrate(backend, engine, plan))
