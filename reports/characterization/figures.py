"""Pictures of the experiments: what each engine does over speeds, phases and steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from simcompare.characterization.bounce import PHASES, BounceQuestion
from simcompare.characterization.force import CASES
from simcompare.characterization.friction import LOAD
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED
from simcompare.model.trajectory import Array
from simcompare.reports.characterization.words import Found, by_engine, capital
from simcompare.reports.render.figures import (
    MOST_PANELS,
    Band,
    Figure,
    Panel,
    Series,
    fitted_range,
    spread,
    style_of,
)

Record = Mapping[str, Any]
Row = Mapping[str, Any]

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
_LEAST_CREEP, _LEAST_PERCENT = 1e-6, 1e-7
#: what a panel about 1 shows at least
_LEAST_RANGE = (Band(0.95, 1.05, ""),)
#: sideways shift of one engine against the next on a logarithmic axis [decades]
_APART = 0.09
_STEP, _SPEED = "Step (ms)", "Impact speed (m/s)"


class _Curve(NamedTuple):
    """What is drawn of a row: where, how high, and half its bar; NaN where there is nothing."""

    x: Callable[[Row], float]
    y: Callable[[Row], float]
    u: Callable[[Row], float] | None = None


def of_bounce(record: Record) -> list[Figure]:
    """Restitution over speeds; where that is near, its deviation over speeds, phases and steps."""
    speeds = list(_over_speed(record, _levels(record, _SEEN)))
    levels = _levels(record, _WANTED / 2)
    if not levels:
        return speeds
    return [
        *speeds,
        _off_over_speed(record, levels),
        _over_phase(record, levels),
        *_over_step(record, levels),
    ]


def _levels(record: Record, least: float) -> list[str]:
    """Levels at which anything bounces with more than this, so that there is something to draw."""
    found = []
    for level in record["contact"]:
        ones = by_engine(record["answers"], "bounce", level).values()
        means = [row["mean"] or 0.0 for one in ones for row in one["over_speed"]]
        found += [level] if max(means, default=0.0) > least else []
    return found


def _over_speed(record: Record, levels: Sequence[str]) -> Iterator[Figure]:
    curve = _Curve(
        lambda row: row["speed_m_s"], lambda row: _or_nan(row["mean"]),
        lambda row: _or_nan(row["scatter"]),
    )  # fmt: skip
    lines = {level: _series(record, "bounce", level, curve, "over_speed") for level in levels}
    panels = [
        Panel(
            LEVELS[level], _SPEED, "Restitution", lines[level], _wanted(_WANTED), log_x=True,
            y_range=(-0.03, 1.13),
        )
        for level in levels
    ]  # fmt: skip
    caption = (
        f"Mean of {PHASES} drops that fall at even phases of a step of"
        f" {1e3 * record['step_s']:g} ms; the bars are their standard deviation. At 0 the bounce is"
        " dead; above 1 the ball gains energy and never stops."
    )
    return _in_rows("speed", "How much comes back, over impact speeds", caption, panels)


def _off_over_speed(record: Record, levels: Sequence[str]) -> Figure:
    curve = _Curve(lambda row: row["speed_m_s"], _off, _off_scatter)
    lines = {level: _series(record, "bounce", level, curve, "over_speed") for level in levels}
    panels = tuple(_off_panel(LEVELS[level], _SPEED, lines[level]) for level in levels)
    caption = (
        f"The same as a deviation from the {_WANTED:g} that is wanted, enlarged; dead bounces are"
        " left out, and what is off by more leaves the panel. The number of a tuned engine was"
        f" found at {_FIRST_M_S:g} m/s."
    )
    return Figure("off_speed", "How far it is off, over impact speeds", caption, panels,
                  share_y=True)  # fmt: skip


def _over_phase(record: Record, levels: Sequence[str]) -> Figure:
    panels = []
    for level in levels:
        found = by_engine(record["answers"], "bounce", level)
        series = tuple(
            _line(name, np.array(one["phases"]), _percents(one["over_phase"]))
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


def _over_step(record: Record, levels: Sequence[str]) -> Iterator[Figure]:
    curve = _Curve(lambda row: 1e3 * row["step_s"], _off, _off_scatter)
    panels = []
    for level in levels:
        title = f"{LEVELS[level]}, held" if level == TUNED else LEVELS[level]
        panels.append(_off_panel(title, _STEP, _series(record, "bounce", level, curve)))
    if TUNED in levels:
        again = _series(record, "bounce", TUNED, curve, "retuned")
        panels.insert(levels.index(TUNED) + 1, _off_panel("Tuned at each step", _STEP, again))
    caption = (
        f"Impacts at {_FIRST_M_S:g} m/s. Held: the number of {1e3 * record['step_s']:g} ms is kept"
        " at other steps, as when it is copied from somewhere; tuned at each step: found anew,"
        " where there is one. What is off by more leaves the panel; points are shifted sideways a"
        " little so that their bars stand apart."
    )
    return _in_rows("step", "How far it is off, over steps", caption, panels)


def _in_rows(name: str, title: str, caption: str, panels: list[Panel]) -> Iterator[Figure]:
    """One figure, or two where there are more panels than can be read side by side."""
    rows = math.ceil(len(panels) / MOST_PANELS)
    for i in range(rows):
        part = tuple(panels[i * len(panels) // rows : (i + 1) * len(panels) // rows])
        number, more = (f"{i + 1}", ", continued") if i else ("", "")
        yield Figure(name + number, title + more, caption, part, share_y=True)


def _off_panel(title: str, x_label: str, series: tuple[Series, ...]) -> Panel:
    return Panel(
        title, x_label, "Off by (%)", series, _right(), log_x=True,
        y_range=(-_SHOWN_PERCENT, _SHOWN_PERCENT),
    )  # fmt: skip


def of_friction(record: Record) -> list[Figure]:
    """What holds, creeps and brakes, over steps, for each level."""
    return [figure for level in record["contact"] for figure in _friction(record, level)]


def _friction(record: Record, level: str) -> Iterator[Figure]:
    def at(y: Callable[[Row], float]) -> tuple[Series, ...]:
        return _series(record, "friction", level, _Curve(lambda row: 1e3 * row["step_s"], y))

    holds = at(lambda row: _or_nan(row["lets_go_at"]))
    if not holds:
        return
    creeps = at(lambda row: max(1e3 * abs(_or_nan(row["creep_m_s"])), _LEAST_CREEP))
    brakes = _series(
        record, "friction", level,
        _Curve(lambda row: row["speed_m_s"], lambda row: _or_nan(row["braking"])), "braking",
    )  # fmt: skip
    panels = (
        _over_truth("Lets go at", _STEP, "Load ÷ µ·N", holds),
        Panel("Creeps", _STEP, "Speed (mm/s)", creeps, log_x=True, log_y=True),
        _over_truth("Is braked", "Speed (m/s)", "Deceleration ÷ µ·g", brakes),
    )
    caption = (
        "By Coulomb a block sticks up to a load along the plane of µ·N, the coefficient of friction"
        " times the normal force, and one that slides is braked by µ·g. Creep is the speed of a"
        f" block that should stick, under {LOAD:g} of that load; what is below"
        f" {_LEAST_CREEP:g} mm/s is drawn there."
    )
    yield Figure(f"friction_{level}", f"{LEVELS[level]}: a block on a plane", caption, panels)


def of_joint(record: Record) -> list[Figure]:
    """Damping, frequency and damping ratio over steps, for each level."""
    return [figure for level in record["contact"] for figure in _joint(record, level)]


def _joint(record: Record, level: str) -> Iterator[Figure]:
    titles = {"damping": "Damper", "frequency": "Spring: frequency",
              "damping_ratio": "Spring: damping ratio"}  # fmt: skip
    panels = []
    for name, title in titles.items():
        curve = _Curve(lambda row: 1e3 * row["step_s"], lambda row, n=name: _or_nan(row.get(n)))  # type: ignore[misc]
        series = _series(record, "joint", level, curve)
        panels.append(_over_truth(title, _STEP, "Over the truth", series))
    if any(panel.series for panel in panels):
        caption = (
            "A hinge that turns and is braked by a damper, and one on a spring with a damper, over"
            " the closed form. Below 0 a damping ratio lets the swing grow."
        )
        yield Figure(
            f"joint_{level}", f"{LEVELS[level]}: a hinge", caption, tuple(panels)
        )  # fmt: skip


def of_force(record: Record) -> list[Figure]:
    """Errors and jitter of forces over steps, for each level."""
    return [figure for level in record["contact"] for figure in _force(record, level)]


def _force(record: Record, level: str) -> Iterator[Figure]:
    def panel(case: str, label: str, part: Callable[[Row], float]) -> Panel:
        def y(row: Row) -> float:
            one = row.get("cases", {}).get(case)
            return math.nan if one is None else max(100 * abs(part(one)), _LEAST_PERCENT)

        series = _series(record, "force", level, _Curve(lambda row: 1e3 * row["step_s"], y))
        title = capital(CASES[case])
        return Panel(title, _STEP, f"{label} (%)", series, log_x=True, log_y=True)

    panels = (
        panel("contact_rest", "Jitter", lambda one: float(one["jitter"])),
        panel("contact_slides", "Jitter", lambda one: float(one["jitter"])),
        panel("weld_shaken", "Amplitude off by", lambda one: float(one["ratio"]) - 1),
    )
    if any(panel.series for panel in panels):
        caption = (
            "Jitter is the standard deviation of the force over its mean value by Newton; what is"
            f" below {_LEAST_PERCENT:g} % is drawn there."
        )
        yield Figure(f"force_{level}", f"{LEVELS[level]}: forces", caption, panels)


def _over_truth(title: str, x_label: str, y_label: str, series: tuple[Series, ...]) -> Panel:
    """A panel about 1, in which less than some per cent does not look like much."""
    return Panel(
        title, x_label, y_label, series, _wanted(1.0), log_x=True,
        y_range=fitted_range(series, _LEAST_RANGE),
    )  # fmt: skip


def _series(
    record: Record, experiment: str, level: str, curve: _Curve, part: str = "over_step"
) -> tuple[Series, ...]:
    """One line for each engine that has something to show."""
    found: Found = by_engine(record["answers"], experiment, level)
    lines = []
    for i, (name, one) in enumerate(found.items()):
        rows = [row for row in one[part] if not row.get("reason")]
        x = np.array([curve.x(row) for row in rows]) * 10 ** spread(i, len(found), _APART)
        y = np.array([curve.y(row) for row in rows], dtype=float)
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


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _off(row: Row) -> float:
    """Deviation of the mean [%]; nothing where the bounce is dead."""
    return 100 * (_or_nan(row["mean"]) / _WANTED - 1) if row["mean"] else math.nan


def _off_scatter(row: Row) -> float:
    return 100 * _or_nan(row["scatter"]) / _WANTED


def _percents(values: Sequence[float | None]) -> Array:
    return np.array(
        [100 * (_or_nan(value) / _WANTED - 1) if value else math.nan for value in values]
    )
