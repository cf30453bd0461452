"""Figures of what was measured of a drop, and of the simulations beside it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from simcompare.model.trajectory import TRUTH, Array
from simcompare.reports.fit import fits
from simcompare.reports.fit.fits import CLOSED
from simcompare.reports.render.figures import Figure, Note, Panel, Series
from simcompare.reports.render.numbers import plain
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.run import runs
from simcompare.reports.validation import phrases, validations
from simcompare.results.records.fit_bounces import Drop
from simcompare.results.run import Run

TIME = "time (s)"
SOUND, HEIGHT = "sound", "height_m"
_FITTED = "fitted"
#: part of the time axis by which two numbers stand apart
_APART = 0.03
_SOUND = Style("#8A8A8A", width=1.0)
_USED = Style("#000000", marker="triangle-down")
_SAMPLE = Style("#000000", marker="circle")
_MISSED = Style("#0072B2", marker="circle", hollow=True)
#: what was left out, one look for each reason
_LEFT_OUT = tuple(Style("#D55E00", marker=m) for m in ("x", "square", "diamond", "triangle-up"))
_ARC = Style("#BDBDBD", width=6.0)


def measured_figures(run: Run) -> list[Figure]:
    """The recording of each drop that is drawn, with what was used of it and what was not."""
    return [_measured(run, number) for number in fits.drawn_drops(run)]


def _measured(run: Run, number: int) -> Figure:
    """The sound with its impacts, the track with its arcs, or what else was measured."""
    drop = fits.bounces(run).measured[number - 1]
    heard = _signal(run, number, SOUND)
    if heard is not None:
        panel, caption = _sound_panel(run, number, *heard), "The sound, and the impacts in it."
    elif drop.intervals_s:
        panel, caption = _intervals_panel(run, number), "The measured intervals."
    elif not drop.times_s:
        panel, caption = _heights_panel(run, number), "The measured heights."
    else:
        panel, caption = _arcs_panel(run, number), "What was measured, and the fitted arcs."
    title = f"What was measured: {fits.drop_title(run, number)}"
    return Figure(f"measured-{number}", title, caption + _left_out_words(drop), (panel,))


def _signal(run: Run, number: int, name: str) -> tuple[Array, Array] | None:
    """Time and values of what was recorded of a drop; ``None`` where there is no such signal."""
    one = validations.stored(run, validations.MEASURED, "", number - 1)
    if one is None or name not in one.signals:
        return None
    return one.time_s, one.signals[name]


def closed_arcs(run: Run, number: int) -> tuple[Array, Array] | None:
    """Height over time as the closed form has it; ``None`` in fits that were stored without."""
    one = validations.stored(run, TRUTH, _FITTED, number - 1)
    return None if one is None else (one.time_s, one.signals[HEIGHT])


def _sound_panel(run: Run, number: int, time_s: Array, values: Array) -> Panel:
    drop = fits.bounces(run).measured[number - 1]
    top = 1.15 * float(np.abs(values).max()) or 1.0
    level = np.full(len(drop.times_s), top)
    series = (
        Series("sound", time_s, values, _SOUND),
        Series("impact", np.array(drop.times_s), level, _USED, points=True, line=False),
        *_rejected(drop, top),
        *_missed(run, number, top),
    )
    return Panel("", TIME, "sound (1 is full scale)", series, notes=_numbers(drop, 1.14 * top),
                 y_range=(-top, 1.3 * top))  # fmt: skip


def _numbers(drop: Drop, y: float) -> tuple[Note, ...]:
    """The number of each impact, as far as they do not run into each other."""
    apart = _APART * (max(drop.times_s) - min(drop.times_s))
    notes: list[Note] = []
    for number, time in zip(drop.numbers, drop.times_s, strict=True):
        if not notes or time - notes[-1].x > apart:
            notes.append(Note(time, y, str(number), "center"))
    return tuple(notes)


def _rejected(
    drop: Drop, level: float, seen: tuple[Array, Array] | None = None
) -> Iterator[Series]:
    """What was left out, one row of points for each reason."""
    reasons = dict.fromkeys(reason_of(one.reason) for one in drop.dropped)
    for i, reason in enumerate(reasons):
        x = np.array([one.time_s for one in drop.dropped if reason_of(one.reason) == reason])
        y = np.full(len(x), level) if seen is None else np.interp(x, *seen)
        style = _LEFT_OUT[i % len(_LEFT_OUT)]
        yield Series(f"left out: {reason}", x, y, style, points=True, line=False)


def reason_of(text: str) -> str:
    """A reason without its numbers: ``12 mm off its flight`` is "off its flight"."""
    return re.sub(r"^[-−]?\d+ mm ", "", text.partition(",")[0])


def _missed(run: Run, number: int, level: float | None = None) -> Iterator[Series]:
    """Where impacts should be that were not recorded."""
    arcs, drop = closed_arcs(run, number), fits.bounces(run).measured[number - 1]
    if not drop.missed or arcs is None:
        return
    time_s, height = arcs
    low = np.flatnonzero((height[1:-1] < height[:-2]) & (height[1:-1] <= height[2:])) + 1
    at = [low[n - 1] for n in drop.missed if n <= len(low)]
    y = height[at] if level is None else np.full(len(at), level)
    yield Series("not recorded", time_s[at], y, _MISSED, points=True, line=False)


def _arcs_panel(run: Run, number: int) -> Panel:
    """The heights of a video, or instants on the floor, with the closed form's arcs."""
    return Panel("", TIME, "height (m)", (*_arcs(run, number), *_points(run, number)))


def _arcs(run: Run, number: int) -> Iterator[Series]:
    arcs = closed_arcs(run, number)
    if arcs is not None:
        yield Series(CLOSED, *arcs, _ARC)


def _points(run: Run, number: int) -> Iterator[Series]:
    """Measured samples with those that were left out; impacts on the floor where there are none."""
    drop, track = fits.bounces(run).measured[number - 1], _signal(run, number, HEIGHT)
    if track is None and not drop.times_s:  # heights alone have no place in time
        return
    if track is None:
        floor = np.full(len(drop.times_s), _floor(run, number))
        yield Series("measured impact", np.array(drop.times_s), floor, _SAMPLE, points=True,
                     line=False)  # fmt: skip
        yield from _rejected(drop, _floor(run, number))
        yield from _missed(run, number)
        return
    used = ~np.isin(track[0], [one.time_s for one in drop.dropped])
    yield Series("measured", track[0][used], track[1][used], _SAMPLE, points=True, line=False)
    yield from _rejected(drop, 0.0, track)


def _floor(run: Run, number: int) -> float:
    arcs = closed_arcs(run, number)
    return 0.0 if arcs is None else float(arcs[1].min())


def _heights_panel(run: Run, number: int) -> Panel:
    """Measured heights of the bounces beside those of the closed form."""
    drop, arcs = fits.bounces(run).measured[number - 1], closed_arcs(run, number)
    u = np.array([np.nan if one is None else 2 * one for one in drop.u_heights_m])
    series = [Series("measured ± 2u", np.array(drop.height_numbers, dtype=float),
                     np.array(drop.heights_m), _SAMPLE, u, points=True, line=False)]  # fmt: skip
    if arcs is not None:
        before, here, after = arcs[1][:-2], arcs[1][1:-1], arcs[1][2:]
        tops = [arcs[1][0], *here[(here >= before) & (here > after)], arcs[1][-1]]
        series.insert(0, Series(CLOSED, np.arange(len(tops), dtype=float), np.array(tops), _ARC))
    return Panel("", "number of the bounce, 0 is the drop", "height (m)", tuple(series),
                 integer_x=True)  # fmt: skip


def _intervals_panel(run: Run, number: int) -> Panel:
    """Measured times between impacts beside those of the closed form."""
    drop = fits.bounces(run).measured[number - 1]
    at = np.array(drop.interval_numbers, dtype=float)
    measured = np.array(drop.intervals_s)
    u = np.array([np.nan if one is None else 2 * one for one in drop.u_intervals_s])
    series = [Series("measured ± 2u", at, measured, _SAMPLE, u, points=True, line=False)]
    for row in fits.bounces(run).residuals:
        if (row.drop, row.kind) == (number, "intervals"):
            series.insert(0, Series(CLOSED, at, measured - np.array(row.residuals), _ARC))
    return Panel("", "number of the impact before", "time interval (s)", tuple(series),
                 integer_x=True)  # fmt: skip


def _left_out_words(drop: Drop) -> str:
    """What the picture marks, in words."""
    words = []
    if drop.dropped:
        count, what = len(drop.dropped), drop.dropped[0].what
        verb = "was" if count == 1 else "were"
        words.append(f"{count} {what}{'' if count == 1 else 's'} {verb} left out (orange).")
    if drop.missed:
        numbers = ", ".join(map(str, drop.missed))
        word, verb = ("Impact", "was") if len(drop.missed) == 1 else ("Impacts", "were")
        words.append(f"{word} {numbers} {verb} not recorded (blue).")
    return "".join(f" {one}" for one in words)


def simulated_figure(run: Run) -> Figure | None:
    """The engines' motion over the first drop: the whole of it, and its last flights."""
    lines = [*_arcs(run, 1), *_engines(run)]
    if len(lines) < 2:
        return None
    points, drop = tuple(_points(run, 1)), fits.bounces(run).measured[0]
    panels = [Panel("whole drop", TIME, "height (m)", (*lines, *points))]
    if len(drop.times_s) > 3:
        panels.append(_last_flights(drop, (*lines, *points)))
    caption = f"The engines' motion with the fitted numbers, beside {fits.drop_title(run, 1)}."
    if len(panels) > 1:
        caption += " Right: the last flights, where all errors have added up."
    return Figure("simulated", "Simulated and measured", caption, tuple(panels))


def _last_flights(drop: Drop, rows: tuple[Series, ...]) -> Panel:
    """The same between the last impacts."""
    begin, end = drop.times_s[-3], drop.times_s[-1]
    low, high = begin - 0.1 * (end - begin), end + 0.2 * (end - begin)
    inside = [one.y[(one.x >= low) & (one.x <= high)] for one in rows]
    values = np.concatenate(inside)
    factor, unit = phrases.people_unit("m", [float(np.ptp(values))])
    rows, values = tuple(replace(one, y=factor * one.y) for one in rows), factor * values
    margin = 0.1 * (float(values.max()) - float(values.min())) or 1.0
    limits = (float(values.min()) - margin, float(values.max()) + margin)
    return Panel(f"{plain(low, 3)} s to {plain(high, 3)} s", TIME, f"height ({unit})", rows,
                 x_limits=(low, high), y_range=limits)  # fmt: skip


def _engines(run: Run) -> Iterator[Series]:
    """Heights over time of each engine on the clock and the level of the recording."""
    probe = next(iter(runs.probes(run).values()))
    for source in fits.engines(run):
        one = next((s for s in run.trajectories if (s.source, s.segment) == (source.name, 0)), None)
        height = None if one is None else runs.observed(one.trajectory, probe)
        if one is not None and height is not None:
            known = {name: row.value for name, row in source.parameters.items()}
            time_s, height = _on_log(run, known, one.trajectory.time_s, height)
            style = style_of(source.name)
            yield Series(source.name, time_s, height, Style(style.colour, style.dash, width=1.6))


def _on_log(
    run: Run, known: dict[str, float | None], time_s: Array, height_m: Array
) -> tuple[Array, Array]:
    """Time and height as the recording has them: its release, its clock, its floor, its scale."""
    form = fits.bounces(run).closed_form
    rest = {**form.fixed, **{name: form.parameters[name].value for name in form.assumed}}

    def value(name: str, usual: float) -> float:
        found = known.get(name, known.get(f"{name}[1]", rest.get(name)))
        return usual if found is None else found

    on_log = value("release_time_s", 0.0) + (1 + value("clock_skew", 0.0)) * time_s
    return on_log, value("floor_m", 0.0) + height_m / value("scale", 1.0)
