"""Figures of a fit: closed forms, what the data can tell, hold-out and other residuals."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.reports.fit import fits
from simcompare.reports.fit.fits import CLOSED, RESTITUTION
from simcompare.reports.fit.form_words import EXCLUDED
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Bars, Figure, Matrix, Panel, Series, Span, spread
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.validation import validations
from simcompare.results.records.fit_forms import RIVAL, OtherEstimate, ProfileRow, Unknown
from simcompare.results.records.fit_holdout import EngineHoldout, HeldOutDrop
from simcompare.results.run import Run

#: a bar is no longer than this; its number says how long it would be
_LONGEST, _ROOM = 30.0, 5.0
#: letters of the name of a closed form on one line
_NAME = 36
#: Δχ² of a 95 % interval, and up to which profiles are drawn
_LEVEL, _HIGHEST = 3.841458820694124, 9.0
#: profiles beside each other
_PANELS = 3
#: |E_n| beyond this is drawn at the edge
_FAR = 10.0
_BLUE, _GREY = "#0072B2", "#7F7F7F"
_PROFILE, _NORMAL = Style(_BLUE), Style(_GREY, "dash", width=2.0)
_LIMIT = Style("#D55E00", "dot", width=2.0)
_OWN, _CLOSED = Style("#000000"), Style(_GREY, marker="star")


def forms_figure(run: Run) -> Figure | None:
    """How much worse than the best each closed form describes the data."""
    choice = fits.bounces(run).choice
    rows = choice.candidates
    if len(rows) < 2:
        return None
    deltas = [math.inf if row.delta is None else row.delta for row in rows]
    lengths = np.array([min(delta, _LONGEST) for delta in deltas])
    texts = tuple(_bar_words(delta) if delta > _ROOM else "" for delta in deltas)
    ticks = tuple("\n".join(textwrap.wrap(row.text, _NAME)) for row in rows)
    panel = Panel(
        "", "ΔAIC: above the least AIC", "", (),
        bars=(Bars("ΔAIC", lengths, _BLUE, "", texts),),
        spans=(Span(0.0, RIVAL, f"below {RIVAL:g}: the data cannot tell"),
               Span(EXCLUDED, EXCLUDED, f"beyond {EXCLUDED:g}: excluded")),
        y_ticks=ticks, x_limits=(0.0, 1.04 * max(EXCLUDED * 1.2, float(lengths.max()))),
    )  # fmt: skip
    caption = "The shorter, the better; the best has no bar."
    if any(delta > _LONGEST for delta in deltas):
        caption += f" Bars end at {_LONGEST:g}; the numbers in them say how far they would go."
    return Figure("forms", "Which closed form", caption, (panel,),
                  height=round(max(0.75, len(rows) / 6.5), 2))  # fmt: skip


def _bar_words(delta: float) -> str:
    if math.isinf(delta):
        return "too few data"
    return str(numbers.plain(delta, 2) if delta >= _LONGEST else f"{delta:.1f}")


def correlation_figure(run: Run) -> Figure | None:
    """Correlations of the unknowns as a matrix."""
    known = fits.record(run).identifiability
    names = tuple(map(fits.title, known.names))
    narrow = tuple("\n".join(textwrap.wrap(name, 10, break_long_words=False)) for name in names)
    if len(names) < 2:
        return None
    values = np.array(
        [[math.nan if v is None else v for v in row] for row in known.correlation], dtype=float
    )
    places = 3 if np.any(np.abs(values - np.eye(len(names))) > 0.99) else 2
    panel = Panel("", "", "", (), x_ticks=narrow, y_ticks=names, matrix=Matrix(values, places))
    caption = (
        "From the data alone, without priors. Near 1 or −1 an error of one unknown is hidden by"
        " the other."
    )
    return Figure("correlation", "Correlation of the unknowns", caption, (panel,),
                  height=round(max(0.75, len(names) / 6), 2))  # fmt: skip


def profile_figures(run: Run) -> list[Figure]:
    """How χ² rises about the best value of each unknown."""
    rows = [row for row in fits.bounces(run).profiles if len(row.values) > 1]
    closed = fits.bounces(run).closed_form
    over_all = closed.parameters if closed.alone else {}
    panels = [_profile_panel(row, closed.own[row.name], over_all.get(row.name)) for row in rows]
    parts = [panels[i : i + _PANELS] for i in range(0, len(panels), _PANELS)]
    caption = (
        "How much χ² rises when one unknown is held and the others are fitted. The 95 % interval"
        " ends at 3.84. Where the profile leaves the dashed parabola, ± u alone would mislead."
    )
    if over_all:
        caption += (
            " This is the best closed form alone. Shaded: the 95 % interval over all closed forms."
        )
    return [
        Figure(f"profiles-{number}" if number > 1 else "profiles", "Profile likelihood",
               caption if number == 1 else "The same for the other unknowns.", tuple(part),
               share_y=True)
        for number, part in enumerate(parts, start=1)
    ]  # fmt: skip


def _profile_panel(row: ProfileRow, closed: Unknown, over_all: Unknown | None = None) -> Panel:
    x, y = _smooth(row, closed.value)
    low, high = float(x.min()), float(x.max())
    series = [
        Series("Δχ² of 95 %", np.array([low, high]), np.full(2, _LEVEL), _LIMIT),
        Series("profile", x, y, _PROFILE),
    ]
    if closed.value is not None and closed.u:
        at = np.linspace(low, high, 200)
        parabola = ((at - closed.value) / closed.u) ** 2
        parabola[parabola > _HIGHEST] = math.nan
        series.append(Series("normal approximation", at, parabola, _NORMAL))
    name = row.name
    spans = () if over_all is None else (_over_all(over_all, low, high),)
    return Panel(fits.title(name), fits.with_unit(name), "Δχ²", tuple(series), spans=spans,
                 y_range=(0.0, _HIGHEST), x_limits=(low, high))  # fmt: skip


def _over_all(row: Unknown, low: float, high: float) -> Span:
    """The interval over all closed forms, as far as the panel reaches."""
    ends = np.clip(fits.interval(row), low, high)
    return Span(float(ends[0]), float(ends[1]), "95 % over all closed forms")


def _smooth(row: ProfileRow, best: float | None) -> tuple[Array, Array]:
    """The profile between its places by the root of χ², which is near a line."""
    x, root = np.array(row.values), np.sqrt(np.array(row.chi2))
    if best is not None:
        root = np.where(x < best, -root, root)
        x, root = np.append(x, best), np.append(root, 0.0)
    x, first = np.unique(x, return_index=True)
    root = root[first]
    at = np.linspace(x[0], x[-1], 400)
    y = np.interp(at, x, root) ** 2
    inside = y <= _HIGHEST
    return (at[inside], y[inside]) if inside.sum() > 1 else (at, y)


def holdout_figure(run: Run) -> Figure | None:
    """Held-out drops beside the fitted restitution."""
    drops = fits.bounces(run).holdout.drops
    rows = np.array(
        [(d.restitution, d.u_restitution, d.fitted, d.u_fitted) for d in drops], dtype=float
    )
    if not drops or np.isnan(rows).any():  # a restitution that was fixed is not judged
        return None
    ticks = tuple(validations.short(str(drop.source)) for drop in drops)
    places = np.arange(len(drops), dtype=float)
    x, u = rows[:, 0], 2 * rows[:, 1]
    centre, half = rows[0, 2], 2 * rows[0, 3]
    own = Series("of the held-out drop ± 2u", x, places, _OWN, u, points=True, line=False)
    ends = np.concatenate((x - u, x + u, [centre - half, centre + half]))
    margin = 0.1 * float(np.ptp(ends)) or 1e-6
    value = Panel(
        "restitution", "restitution", "", (own,),
        spans=(Span(centre - half, centre + half, "fitted ± 2u"),), y_ticks=ticks,
        x_limits=(float(ends.min()) - margin, float(ends.max()) + margin),
    )  # fmt: skip
    caption = (
        "Height and release of a held-out drop are its own; all else is as fitted. |E_n| up to 1:"
        " they agree."
    )
    if any(abs(row.e_n or 0) > _FAR for drop in drops for row in _judged(drop)):
        caption += f" Values beyond {_FAR:g} are drawn at the edge; the table has them."
    return Figure("holdout", "Drops that were not fitted", caption, (value, _e_n(drops, ticks)),
                  share_y=True, height=round(max(0.6, len(drops) / 6), 2))  # fmt: skip


def _judged(drop: HeldOutDrop) -> list[HeldOutDrop | EngineHoldout]:
    return [drop, *drop.engines.values()]


def _e_n(drops: Sequence[HeldOutDrop], ticks: tuple[str, ...]) -> Panel:
    names = [CLOSED, *drops[0].engines]
    series = []
    for i, name in enumerate(names):
        rows = [drop if name == CLOSED else drop.engines[name] for drop in drops]
        x = [math.nan if r.e_n is None else min(abs(r.e_n), _FAR) for r in rows]
        y: Array = np.arange(len(drops), dtype=float) + spread(i, len(names), 0.6)
        style = _CLOSED if name == CLOSED else style_of(name)
        series.append(Series(name, np.array(x), y, style, points=True, line=False))
    reach = max([1.5, *(float(v) for one in series for v in one.x if math.isfinite(v))])
    return Panel("|E_n|", "|E_n|", "", tuple(series),
                 spans=(Span(0.0, 1.0, "within the uncertainty"),), y_ticks=ticks,
                 x_limits=(0.0, 1.05 * reach))  # fmt: skip


def others_figure(run: Run) -> Figure | None:
    """Restitutions that other rules would have given, beside the fit's."""
    rows = fits.bounces(run).other_estimates
    closed = fits.bounces(run).closed_form.parameters.get(RESTITUTION)
    if not rows or closed is None:
        return None
    ticks = tuple("\n".join(textwrap.wrap(_other(run, row), 16)) for row in rows)
    x = np.array([row.value for row in rows])
    u = np.array([2 * row.u if row.u else math.nan for row in rows])
    low, high = fits.interval(closed)
    bars = np.nan_to_num(u)
    reach: Array = np.concatenate((x - bars, x + bars, np.array([low, high])))
    reach = reach[np.isfinite(reach)]
    margin = 0.08 * float(np.ptp(reach)) or 1e-6
    series = Series("by another rule ± 2u", x, np.arange(len(rows), dtype=float), _OWN, u,
                    points=True, line=False)  # fmt: skip
    panel = Panel(
        "", "restitution", "", (series,), spans=(Span(low, high, "this fit, 95 %"),),
        y_ticks=ticks, x_limits=(float(reach.min()) - margin, float(reach.max()) + margin),
    )  # fmt: skip
    caption = "The same data, fitted in other ways. No bar: that way gives no uncertainty."
    return Figure("others", "Other ways to judge the same data", caption, (panel,),
                  height=round(max(0.7, len(rows) / 6), 2))  # fmt: skip


def _other(run: Run, row: OtherEstimate) -> str:
    several = len(fits.bounces(run).measured) > 1
    return str(row.name) + (f", drop {row.drop}" if several else "")
