"""Pictures of the bounces: restitution over speeds, phases and steps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from simcompare.characterization.behaviour import (
    BounceBehaviour,
    Spread,
    SpreadAtSpeed,
    SpreadAtStep,
)
from simcompare.characterization.bounce import PHASES, BounceQuestion
from simcompare.model.settings import TUNED
from simcompare.model.trajectory import Array
from simcompare.reports.characterization.curves import (
    LEVELS,
    STEP,
    Curve,
    answered,
    line_of,
    series_of,
    wanted,
)
from simcompare.reports.characterization.words import by_engine
from simcompare.reports.render.figures import MAX_PANELS, Band, Figure, Panel, Series
from simcompare.results.records.characterization import Characterization

_WANTED, _FIRST_M_S = BounceQuestion("", 0.0).restitution, BounceQuestion("", 0.0).speed_m_s
#: a restitution below this is drawn as none [1]
_SEEN = 0.01
#: deviations that a panel shows [%]; what is off by more leaves it
_SHOWN_PERCENT = 6.0
_SPEED = "Impact speed (m/s)"


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
    curve = Curve[SpreadAtSpeed](
        lambda row: row.speed_m_s, lambda row: row.mean, lambda row: row.scatter
    )
    lines = {level: _bounces_over_speed(result, level, curve) for level in levels}
    panels = [
        Panel(
            LEVELS[level], _SPEED, "Restitution", lines[level], wanted(_WANTED), log_x=True,
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
    result: Characterization, level: str, curve: Curve[SpreadAtSpeed]
) -> tuple[Series, ...]:
    answers = by_engine(result.answers, BounceBehaviour, level)
    return series_of({name: one.over_speed for name, one in answers.items()}, curve)


def _off_over_speed(result: Characterization, levels: Sequence[str]) -> Figure:
    curve = Curve[SpreadAtSpeed](lambda row: row.speed_m_s, _off, _off_scatter)
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
            line_of(name, np.array(one.phases), _percents(one.over_phase))
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
    curve = Curve[SpreadAtStep](lambda row: 1e3 * row.step_s, _off, _off_scatter)
    panels = []
    for level in levels:
        title = f"{LEVELS[level]}, held" if level == TUNED else LEVELS[level]
        answers = by_engine(result.answers, BounceBehaviour, level)
        held = {name: answered(one.over_step) for name, one in answers.items()}
        panels.append(_off_panel(title, STEP, series_of(held, curve)))
    if TUNED in levels:
        answers = by_engine(result.answers, BounceBehaviour, TUNED)
        retuned = {name: answered(one.retuned) for name, one in answers.items()}
        again = series_of(retuned, curve)
        panels.insert(levels.index(TUNED) + 1, _off_panel("Tuned at each step", STEP, again))
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
