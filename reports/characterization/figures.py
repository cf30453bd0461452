"""Pictures of the experiments: what each engine does over speeds, phases and steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Generic, TypeVar

import numpy as np

from simcompare.characterization.behaviour import (
    AtStep,
    BounceBehaviour,
    BrakingAtSpeed,
    ForceBehaviour,
    ForceReading,
    ForcesAtStep,
    FrictionAtStep,
    FrictionBehaviour,
    HingeAtStep,
    JointBehaviour,
    Spread,
    SpreadAtSpeed,
    SpreadAtStep,
)
from simcompare.characterization.bounce import PHASES, BounceQuestion
from simcompare.characterization.force import CASES
from simcompare.characterization.friction import LOAD
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED
from simcompare.model.trajectory import Array
from simcompare.reports.characterization.words import by_engine, capital
from simcompare.reports.render.figures import (
    MAX_PANELS,
    Band,
    Figure,
    Panel,
    Series,
    fitted_range,
    spread,
)
from simcompare.reports.render.styles import style_of
from simcompare.results.records.characterization import Characterization

Row = TypeVar("Row")
Step = TypeVar("Step", bound=AtStep)

#: titles of panels
LEVELS = {
    DEFAULT: "By default",
    COEFFICIENTS: "Coefficients typed in",
    TUNED: "Tuned",
    ASSISTED: "With our helps",
}
_WANTED, _FIRST_M_S = BounceQuestion("", 0.0).restitution, BounceQuestion("", 0.0).speed_m_s
#: a restitution below this is drawn as none [1]
_SEEN = 0.01
#: deviations that a panel shows [%]; what is off by more leaves it
_SHOWN_PERCENT = 6.0
#: what is smaller is drawn there, on a logarithmic axis: creep [mm/s], and parts of a force [%]
_MIN_CREEP, _MIN_PERCENT = 1e-6, 1e-7
#: what a panel about 1 shows at least
_MIN_RANGE = (Band(0.95, 1.05, ""),)
#: sideways shift of one engine against the next on a logarithmic axis [decades]
_APART = 0.09
_STEP, _SPEED = "Step (ms)", "Impact speed (m/s)"


@dataclass(frozen=True)
class _Curve(Generic[Row]):
    """What is drawn of a row: where, how high, and half its bar; NaN where there is nothing."""

    x: Callable[[Row], float]
    y: Callable[[Row], float]
    u: Callable[[Row], float] | None = None


def of_bounce(result: Characterization) -> list[Figure]:
    """Restitution over speeds; where that is near, its deviation over speeds, phases and steps."""
    speeds = list(_over_speed(result, _levels(result, _SEEN)))
    levels = _levels(result, _WANTED / 2)
    if not levels:
        return speeds
    return [
        *speeds,
        _off_over_speed(result, levels),
        _over_phase(result, levels),
        *_over_step(result, levels),
    ]


def _levels(result: Characterization, least: float) -> list[str]:
    """Levels at which anything bounces with more than this, so that there is something to draw."""
    found = []
    for level in result.contact:
        ones = by_engine(result.answers, BounceBehaviour, level).values()
        means = [row.mean for one in ones for row in one.over_speed if math.isfinite(row.mean)]
        found += [level] if max(means, default=0.0) > least else []
    return found


def _over_speed(result: Characterization, levels: Sequence[str]) -> Iterator[Figure]:
    curve = _Curve[SpreadAtSpeed](
        lambda row: row.speed_m_s, lambda row: row.mean, lambda row: row.scatter
    )
    lines = {level: _bounces_over_speed(result, level, curve) for level in levels}
    panels = [
        Panel(
            LEVELS[level], _SPEED, "Restitution", lines[level], _wanted(_WANTED), log_x=True,
            y_range=(-0.03, 1.13),
        )
        for level in levels
    ]  # fmt: skip
    caption = (
        f"Mean of {PHASES} drops that fall at even phases of a step of"
        f" {1e3 * result.step_s:g} ms; the bars are their standard deviation. At 0 the bounce is"
        " dead; above 1 the ball gains energy and never stops."
    )
    return _in_rows("speed", "How much comes back, over impact speeds", caption, panels)


def _bounces_over_speed(
    result: Characterization, level: str, curve: _Curve[SpreadAtSpeed]
) -> tuple[Series, ...]:
    answers = by_engine(result.answers, BounceBehaviour, level)
    return _series({name: one.over_speed for name, one in answers.items()}, curve)


def _off_over_speed(result: Characterization, levels: Sequence[str]) -> Figure:
    curve = _Curve[SpreadAtSpeed](lambda row: row.speed_m_s, _off, _off_scatter)
    lines = {level: _bounces_over_speed(result, level, curve) for level in levels}
    panels = tuple(_off_panel(LEVELS[level], _SPEED, lines[level]) for level in levels)
    caption = (
        f"The same as a deviation from the {_WANTED:g} that is wanted, enlarged; dead bounces are"
        " left out, and what is off by more leaves the panel. The number of a tuned engine was"
        f" found at {_FIRST_M_S:g} m/s."
    )
    return Figure("off_speed", "How far it is off, over impact speeds", caption, panels,
                  share_y=True)  # fmt: skip


def _over_phase(result: Characterization, levels: Sequence[str]) -> Figure:
    panels = []
    for level in levels:
        found = by_engine(result.answers, BounceBehaviour, level)
        series = tuple(
            _line(name, np.array(one.phases), _percents(one.over_phase))
            for name, one in found.items()
        )
        panels.append(
            Panel(
                LEVELS[level], "Phase of the step", "Off by (%)", series, _right(),
                y_range=(-_SHOWN_PERCENT, _SHOWN_PERCENT), x_limits=(0.0, 1.0),
            )
        )  # fmt: skip
    caption = (
        f"One drop at {_FIRST_M_S:g} m/s for each phase: by what part of a step the impact falls"
        " later. A scene meets one of these by chance."
    )
    return Figure("phase", "Where in the step the impact falls", caption, tuple(panels),
                  share_y=True)  # fmt: skip


def _over_step(result: Characterization, levels: Sequence[str]) -> Iterator[Figure]:
    curve = _Curve[SpreadAtStep](lambda row: 1e3 * row.step_s, _off, _off_scatter)
    panels = []
    for level in levels:
        title = f"{LEVELS[level]}, held" if level == TUNED else LEVELS[level]
        answers = by_engine(result.answers, BounceBehaviour, level)
        held = {name: _answered(one.over_step) for name, one in answers.items()}
        panels.append(_off_panel(title, _STEP, _series(held, curve)))
    if TUNED in levels:
        answers = by_engine(result.answers, BounceBehaviour, TUNED)
        retuned = {name: _answered(one.retuned) for name, one in answers.items()}
        again = _series(retuned, curve)
        panels.insert(levels.index(TUNED) + 1, _off_panel("Tuned at each step", _STEP, again))
    caption = (
        f"Impacts at {_FIRST_M_S:g} m/s. Held: the number of {1e3 * result.step_s:g} ms is kept"
        " at other steps, as when it is copied from somewhere; tuned at each step: found anew,"
        " where there is one. What is off by more leaves the panel; points are shifted sideways a"
        " little so that their bars stand apart."
    )
    return _in_rows("step", "How far it is off, over steps", caption, panels)


def _in_rows(name: str, title: str, caption: str, panels: list[Panel]) -> Iterator[Figure]:
    """One figure, or two where there are more panels than can be read side by side."""
    rows = math.ceil(len(panels) / MAX_PANELS)
    for i in range(rows):
        part = tuple(panels[i * len(panels) // rows : (i + 1) * len(panels) // rows])
        number, more = (f"{i + 1}", ", continued") if i else ("", "")
        yield Figure(name + number, title + more, caption, part, share_y=True)


def _off_panel(title: str, x_label: str, series: tuple[Series, ...]) -> Panel:
    return Panel(
        title, x_label, "Off by (%)", series, _right(), log_x=True,
        y_range=(-_SHOWN_PERCENT, _SHOWN_PERCENT),
    )  # fmt: skip


def of_friction(result: Characterization) -> list[Figure]:
    """What holds, creeps and brakes, over steps, for each level."""
    return [figure for level in result.contact for figure in _friction(result, level)]


def _friction(result: Characterization, level: str) -> Iterator[Figure]:
    answers = by_engine(result.answers, FrictionBehaviour, level)
    steps = {name: _answered(one.over_step) for name, one in answers.items()}

    def at(y: Callable[[FrictionAtStep], float]) -> tuple[Series, ...]:
        return _series(steps, _Curve(lambda row: 1e3 * row.step_s, y))

    holds = at(lambda row: math.nan if row.lets_go_at is None else row.lets_go_at)
    if not holds:
        return
    creeps = at(lambda row: max(1e3 * abs(row.creep_m_s), _MIN_CREEP))
    brakes = _series(
        {name: one.braking for name, one in answers.items()},
        _Curve[BrakingAtSpeed](lambda row: row.speed_m_s, lambda row: row.braking),
    )
    panels = (
        _over_truth("Lets go at", _STEP, "Load ÷ µ·N", holds),
        Panel("Creeps", _STEP, "Speed (mm/s)", creeps, log_x=True, log_y=True),
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
    steps = {name: _answered(one.over_step) for name, one in answers.items()}
    panels = []
    for quantity, title in titles.items():
        curve = _Curve[HingeAtStep](lambda row: 1e3 * row.step_s, attrgetter(quantity))
        panels.append(_over_truth(title, _STEP, "Over the truth", _series(steps, curve)))
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
    steps = {name: _answered(one.over_step) for name, one in answers.items()}

    def panel(case: str, label: str, part: Callable[[ForceReading], float]) -> Panel:
        def y(row: ForcesAtStep) -> float:
            one = row.cases.get(case)
            return math.nan if one is None else max(100 * abs(part(one)), _MIN_PERCENT)

        series = _series(steps, _Curve(lambda row: 1e3 * row.step_s, y))
        title = capital(CASES[case])
        return Panel(title, _STEP, f"{label} (%)", series, log_x=True, log_y=True)

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
        title, x_label, y_label, series, _wanted(1.0), log_x=True,
        y_range=fitted_range(series, _MIN_RANGE),
    )  # fmt: skip


def _answered(rows: Sequence[Step]) -> list[Step]:
    """Rows of steps at which there is something."""
    return [row for row in rows if not row.reason]


def _series(found: Mapping[str, Sequence[Row]], curve: _Curve[Row]) -> tuple[Series, ...]:
    """One line for each engine that has something to show."""
    lines = []
    for i, (name, rows) in enumerate(found.items()):
        x = np.array([curve.x(row) for row in rows]) * 10 ** spread(i, len(found), _APART)
        y = np.array([curve.y(row) for row in rows], dtype=float)
        y[~np.isfinite(y)] = math.nan
        u = None if curve.u is None else np.array([curve.u(row) for row in rows], dtype=float)
        if np.isfinite(y).any():
            lines.append(_line(name, x, y, u))
    return tuple(lines)


def _line(name: str, x: Array, y: Array, u: Array | None = None) -> Series:
    return Series(name, x, y, style_of(name), u, points=True)


def _wanted(value: float) -> tuple[Band, ...]:
    return (Band(value, value, "truth", value),)


def _right() -> tuple[Band, ...]:
    return (Band(-1.0, 1.0, "within 1 %", 0.0),)


def _off(row: Spread) -> float:
    """Deviation of the mean [%]; nothing where the bounce is dead."""
    return _percent(row.mean)


def _off_scatter(row: Spread) -> float:
    return 100 * row.scatter / _WANTED


def _percents(values: Sequence[float]) -> Array:
    return np.array(list(map(_percent, values)))


def _percent(restitution: float) -> float:
    return 100 * (restitution / _WANTED - 1) if restitution else math.nan
