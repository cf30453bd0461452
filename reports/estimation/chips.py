"""How well chips tell an angle, as bought and calibrated: sentences, tables, a figure."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from simcompare.estimation.joint_angle import AS_READ, AT_AXIS, CORRECTED
from simcompare.estimation.joint_angle_study import BOUGHT, CALIBRATED, Accuracy, Feasibility
from simcompare.reports.estimation.units_of import text
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import Style
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results.records.estimation import Estimation

_DEGREE = math.degrees(1.0)
_STYLES = {
    BOUGHT: Style("#D55E00", marker="square"),
    CALIBRATED: Style("#0072B2", marker="circle"),
}
#: ways of telling the angle in motion -> head of their column and panel
_WAYS = {
    AT_AXIS: "In motion, at the axis",
    CORRECTED: "In motion, lever arms off",
    AS_READ: "In motion, as read",
}
REST = "At rest"
#: what nobody can read off [°]
_NOTHING = 0.01
#: what most of an error is, in words
_CAUSES = {"calibration: levelling": "the levelling of the six positions"}

Told = Callable[[Feasibility], Accuracy | None]


def rows(result: Estimation) -> list[Feasibility]:
    """Of the first source of which there is a study."""
    return list(next((one.chips for one in result.done if one.chips), ()))


def sentences(result: Estimation) -> Iterator[str]:
    """The answer: at rest, in motion, what the error is made of, and where it ends."""
    every = rows(result)
    if not every:
        return
    bought, calibrated = ([one for one in every if one.state == s] for s in (BOUGHT, CALIBRATED))
    yield (
        f"Two accelerometers tell the angle at rest to {_span(bought, _rest)} as they are bought,"
        f" and to {_span(calibrated, _rest)} once each was calibrated in six positions (standard"
        f" uncertainty; 95 % of the errors are within"
        f" {_span(calibrated, _rest, half_width=True)})."
    )
    yield _in_motion(calibrated)
    yield (
        f"Most of the error is {_main(bought)} before, and {_main(calibrated)} after the"
        " calibration. About an axis that stands upright two accelerometers tell nothing."
    )
    if len([one for one in result.done if one.chips]) > 1:
        yield _sources(result)


def table(result: Estimation) -> Table | None:
    """A row a chip and state, a column a situation."""
    every = rows(result)
    if not every:
        return None
    ways = [way for way in _WAYS if any(way in one.motion for one in every)]
    columns = [
        Column("Chip", text=True), Column("", text=True), Column(REST), Column("First order"),
        *(Column(_WAYS[way]) for way in ways),
    ]  # fmt: skip
    body = tuple(
        (
            one.chip, one.state, _degrees(one.rest), text(one.first_order_rad, _DEGREE),
            *(_degrees(one.motion.get(way)) for way in ways),
        )
        for one in every
    )  # fmt: skip
    note = (
        f"Standard uncertainties in degrees over {every[0].pairs} pairs of devices drawn from the"
        " data sheets. At rest: the mean while nothing moves; in motion: each sample. A dash: the"
        " chip has no gyroscope."
    )
    return Table("Angle error of each chip (°)", tuple(columns), (Group("", body),), note)


def budget(result: Estimation) -> Table | None:
    """What the error at rest is made of, to first order."""
    every = rows(result)
    if not every:
        return None
    groups = []
    for state in (BOUGHT, CALIBRATED):
        chosen = [one for one in every if one.state == state]
        terms = list(chosen[0].shares_rad)
        body = [(term, *(_share(one, term) for one in chosen)) for term in terms]
        body.append(("all", *(text(one.first_order_rad, _DEGREE) for one in chosen)))
        groups.append(Group(state, tuple(body)))
    chips = [one.chip for one in every if one.state == BOUGHT]
    columns = (Column("Term", text=True), *map(Column, chips))
    note = "Standard uncertainties to first order; their squares add up."
    return Table("What the error at rest is made of (°)", columns, tuple(groups), note)


def figure(result: Estimation) -> Figure | None:
    """Errors of all chips, before and after, at rest and in motion, on one logarithmic scale."""
    every = rows(result)
    if not every:
        return None
    chips = tuple(one.chip for one in every if one.state == BOUGHT)
    ways = [way for way in (AT_AXIS, CORRECTED) if any(way in one.motion for one in every)]
    told = {REST: _rest, **{_WAYS[way]: _way(way) for way in ways}}
    panels = [_panel(title, every, chips, one) for title, one in told.items()]
    decades = _decades([one for panel in panels for one in panel.series])
    panels = [replace(panel, y_range=decades) for panel in panels]
    caption = (
        "Standard uncertainty of the angle. Six positions take off offset, scale and cross-axis"
        " terms; what is left at rest is levelling, and in motion the low-pass filters besides,"
        " which are late."
    )
    return Figure("chips", "Angle error of each chip", caption, tuple(panels), share_y=True)


def _panel(title: str, every: list[Feasibility], chips: tuple[str, ...], told: Told) -> Panel:
    x = np.arange(len(chips), dtype=float)
    series = []
    for state, style in _STYLES.items():
        found = [told(one) for one in every if one.state == state]
        y = np.array([math.nan if one is None else _DEGREE * one.u_rad for one in found])
        series.append(Series(state, x, y, style, points=True, line=False))
    return Panel(title, "", "Angle error (°)", tuple(series), x_ticks=chips, log_y=True)


def _decades(series: list[Series]) -> tuple[float, float]:
    """Powers of ten about all values."""
    values = np.log10(np.concatenate([one.y[np.isfinite(one.y)] for one in series]))
    return 10.0 ** math.floor(values.min()), 10.0 ** math.ceil(values.max())


def _way(way: str) -> Told:
    return lambda one: one.motion.get(way)


def _rest(one: Feasibility) -> Accuracy:
    return one.rest


def _in_motion(calibrated: list[Feasibility]) -> str:
    said = []
    if any(AT_AXIS in one.motion for one in calibrated):
        said.append(f"to {_span(calibrated, _way(AT_AXIS))} at the joint's axis")
    if any(CORRECTED in one.motion for one in calibrated):
        said.append(
            f"to {_span(calibrated, _way(CORRECTED))} away from it with lever arms taken off by"
            " gyroscopes"
        )
    wrong = f"away from it and as read it is off by {_span(calibrated, _way(AS_READ))}"
    return f"In motion calibrated sensors tell it {' and '.join(said)}; {wrong}."


def _span(rows: list[Feasibility], told: Told, *, half_width: bool = False) -> str:
    """Smallest and largest over the chips, with the names of these."""
    found = [
        (accuracy.half_width_rad if half_width else accuracy.u_rad, one.chip)
        for one in rows
        if (accuracy := told(one)) is not None
    ]
    (low, least), (high, most) = min(found), max(found)
    first, last = text(low, _DEGREE), text(high, _DEGREE)
    if first == last or half_width:
        return f"{last}°"
    return f"{first}° ({least}) … {last}° ({most})"


def _main(rows: list[Feasibility]) -> str:
    """The largest term of most chips."""
    largest = [max(one.shares_rad, key=lambda name: one.shares_rad[name]) for one in rows]
    name = max(set(largest), key=largest.count)
    return _CAUSES.get(name, f"the {name}")


def _sources(result: Estimation) -> str:
    """How little it matters whose motion it is."""
    found = [one for one in result.done if one.chips]
    rest = [[chip.rest.u_rad for chip in one.chips] for one in found]
    spread = float(np.max(np.ptp(np.array(rest), axis=0)))
    names = ", ".join(one.source for one in found)
    differ = max(_DEGREE * spread, _NOTHING)
    return (
        f"Numbers are of the motion of {found[0].source}; over the motions of {names} those at rest"
        f" differ by {'less than ' if differ == _NOTHING else ''}{differ:.2g}°."
    )


def _degrees(accuracy: Accuracy | None) -> str:
    return "–" if accuracy is None else text(accuracy.u_rad, _DEGREE)


def _share(one: Feasibility, term: str) -> str:
    share = one.shares_rad.get(term)
    return "0" if share is not None and share * _DEGREE < 5e-4 else text(share, _DEGREE)
