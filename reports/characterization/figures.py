"""Pictures of friction, of a hinge and of forces: what each engine does over steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from operator import attrgetter

from simcompare.characterization.behaviour import (
    BrakingAtSpeed,
    ForceBehaviour,
    ForceReading,
    ForcesAtStep,
    FrictionAtStep,
    FrictionBehaviour,
    HingeAtStep,
    JointBehaviour,
)
from simcompare.characterization.force import CASES
from simcompare.characterization.friction import LOAD
from simcompare.notation import capital
from simcompare.reports.characterization.curves import (
    LEVELS,
    STEP,
    Curve,
    answered,
    series_of,
    wanted,
)
from simcompare.reports.characterization.words import by_engine
from simcompare.reports.render.figures import Band, Figure, Panel, Series, fitted_range
from simcompare.results.records.characterization import Characterization

#: what is smaller is drawn there, on a logarithmic axis: creep [mm/s], and parts of a force [%]
_MIN_CREEP, _MIN_PERCENT = 1e-6, 1e-7
#: what a panel about 1 shows at least
_MIN_RANGE = (Band(0.95, 1.05, ""),)


def of_friction(result: Characterization) -> list[Figure]:
    """What holds, creeps and brakes, over steps, for each level."""
    return [figure for level in result.contact for figure in _friction(result, level)]


def _friction(result: Characterization, level: str) -> Iterator[Figure]:
    answers = by_engine(result.answers, FrictionBehaviour, level)
    steps = {name: answered(one.over_step) for name, one in answers.items()}

    def at(y: Callable[[FrictionAtStep], float]) -> tuple[Series, ...]:
        return series_of(steps, Curve(lambda row: 1e3 * row.step_s, y))

    holds = at(lambda row: math.nan if row.lets_go_at is None else row.lets_go_at)
    if not holds:
        return
    creeps = at(lambda row: max(1e3 * abs(row.creep_m_s), _MIN_CREEP))
    brakes = series_of(
        {name: one.braking for name, one in answers.items()},
        Curve[BrakingAtSpeed](lambda row: row.speed_m_s, lambda row: row.braking),
    )
    panels = (
        _over_truth("Lets go at", STEP, "Load ÷ µ·N", holds),
        Panel("Creeps", STEP, "Speed (mm/s)", creeps, log_x=True, log_y=True),
        _over_truth("Is braked", "Speed (m/s)", "Deceleration ÷ µ·g", brakes),
    )
    caption = (
        "By Coulomb a block sticks up to a load along the plane of µ·N, the coefficient of friction"
        " times the normal force, and one that slides is braked by µ·g. Creep is the speed of a"
        f" block that should stick, under {LOAD:g} of that load; what is below"
        f" {_MIN_CREEP:g} mm/s is drawn there."
    )
    yield Figure(f"friction_{level}", f"{LEVELS[level]}: a block on a plane", caption, panels)


def of_joint(result: Characterization) -> list[Figure]:
    """Damping, frequency and damping ratio over steps, for each level."""
    return [figure for level in result.contact for figure in _joint(result, level)]


def _joint(result: Characterization, level: str) -> Iterator[Figure]:
    titles = {"damping": "Damper", "frequency": "Spring: frequency",
              "damping_ratio": "Spring: damping ratio"}  # fmt: skip
    answers = by_engine(result.answers, JointBehaviour, level)
    steps = {name: answered(one.over_step) for name, one in answers.items()}
    panels = []
    for quantity, title in titles.items():
        curve = Curve[HingeAtStep](lambda row: 1e3 * row.step_s, attrgetter(quantity))
        panels.append(_over_truth(title, STEP, "Over the truth", series_of(steps, curve)))
    if any(panel.series for panel in panels):
        caption = (
            "A hinge that turns and is braked by a damper, and one on a spring with a damper, over"
            " the closed form. Below 0 a damping ratio lets the swing grow."
        )
        yield Figure(
            f"joint_{level}", f"{LEVELS[level]}: a hinge", caption, tuple(panels)
        )  # fmt: skip


def of_force(result: Characterization) -> list[Figure]:
    """Errors and jitter of forces over steps, for each level."""
    return [figure for level in result.contact for figure in _force(result, level)]


def _force(result: Characterization, level: str) -> Iterator[Figure]:
    answers = by_engine(result.answers, ForceBehaviour, level)
    steps = {name: answered(one.over_step) for name, one in answers.items()}

    def panel(case: str, label: str, part: Callable[[ForceReading], float]) -> Panel:
        def y(row: ForcesAtStep) -> float:
            one = row.cases.get(case)
            return math.nan if one is None else max(100 * abs(part(one)), _MIN_PERCENT)

        series = series_of(steps, Curve(lambda row: 1e3 * row.step_s, y))
        title = capital(CASES[case])
        return Panel(title, STEP, f"{label} (%)", series, log_x=True, log_y=True)

    panels = (
        panel("contact_rest", "Jitter", lambda one: one.jitter),
        panel("contact_slides", "Jitter", lambda one: one.jitter),
        panel("weld_shaken", "Amplitude off by", lambda one: one.ratio - 1),
    )
    if any(panel.series for panel in panels):
        caption = (
            "Jitter is the standard deviation of the force over its mean value by Newton; what is"
            f" below {_MIN_PERCENT:g} % is drawn there."
        )
        yield Figure(f"force_{level}", f"{LEVELS[level]}: forces", caption, panels)


def _over_truth(title: str, x_label: str, y_label: str, series: tuple[Series, ...]) -> Panel:
    """A panel about 1, in which less than some per cent does not look like much."""
    return Panel(
        title, x_label, y_label, series, wanted(1.0), log_x=True,
        y_range=fitted_range(series, _MIN_RANGE),
    )  # fmt: skip
