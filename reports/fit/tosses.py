"""What a fit by tosses says: sentences, tables and figures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare import units
from simcompare.engine.assist import ALL
from simcompare.model.settings import TUNED
from simcompare.model.trajectory import Array
from simcompare.notation import number
from simcompare.reports.fit import fits
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.validation import phrases, validations
from simcompare.results.records.fit_tosses import TossErrors, TossFit, TossMean, TossSource
from simcompare.results.run import Run

#: standard uncertainties by which the scale must differ from 1 to be called wrong
_COVERAGE = 2
#: signal that is drawn of a toss, and how what was seen is drawn
_PLACE = ".position_m"
_SEEN = Style("#000000", width=1.0)


def found_of(run: Run) -> TossFit:
    """What was found."""
    found = fits.of_any(run)
    assert isinstance(found, TossFit)
    return found


def fitted(found: TossFit) -> list[TossSource]:
    """Engines whose fit succeeded."""
    return [source for source in found.sources if source.parameters]


def sentences(found: TossFit) -> list[str]:
    """The answer, and what must be known of it; one fact a sentence."""
    sources = fitted(found)
    if not sources:
        return [*_scale(found)]
    return [*_needed(found, sources), *_predicted(sources), *_level(found), *_scale(found),
            *_open(sources)]  # fmt: skip


def _needed(found: TossFit, sources: Sequence[TossSource]) -> list[str]:
    words = []
    for name in found.unknowns:
        own = [source.parameters[name] for source in sources]
        unit = "" if own[0].unit == "1" else f" {units.symbol(own[0].unit)}"
        title = fits.title(name)
        if len(own) == 1:
            ends = phrases.ends(*(f"{end:.3g}" for end in own[0].interval95))
            words.append(f"{sources[0].name} lands the tosses best with {title}"
                         f" {own[0].value:.4g}{unit} (95 %: {ends}).")  # fmt: skip
            continue
        low, high = (f"{end(one.value for one in own):.4g}" for end in (min, max))
        words.append(f"{len(own)} engines land the tosses best with {title}"
                     f" {phrases.ends(low, high)}{unit}.")  # fmt: skip
    return words


def _predicted(sources: Sequence[TossSource]) -> list[str]:
    held = [(source.name, source.holdout) for source in sources if source.holdout is not None]
    if not held:
        return ["No toss was kept back, so the fit was not tested."]
    name, best = min(held, key=lambda one: one[1].position.mean)
    who = f"{name} is off by" if len(held) == 1 else f"{name} comes nearest and is off by"
    count = phrases.counted(len(best.positions), "toss", "tosses")
    return [
        f"In {count} that {'was' if len(best.positions) == 1 else 'were'} not fitted, {who}"
        f" {_mean(best.position)} % of the cube's width and {_mean(best.rotation)}° (means with"
        " 95 % intervals)."
    ]


def _mean(own: TossMean) -> str:
    low, high = (f"{end:.1f}" for end in own.interval95)
    return f"{own.mean:.1f} ({phrases.ends(low, high)})"


def _level(found: TossFit) -> list[str]:
    step_ms = 1e3 * found.valid.engine_step_s
    if found.contact == TUNED:
        return [
            f"The values hold for a plain loop with a step of {step_ms:.4g} ms.",
            "The restitution was tuned with a sphere that falls as fast as the first toss.",
        ]
    helps = "all our helps" if found.assist == ALL else f"our helps {found.assist}"
    return [
        f"The values hold with {helps}, at a step of {step_ms:.4g} ms.",
        "A plain loop lands otherwise: fit it with --assist none.",
    ]


def _scale(found: TossFit) -> list[str]:
    """Whether lengths of the recording are right, as far as it tells itself."""
    put = [f"All lengths were divided by {found.scale:.6g} (--fix scale)."]
    put = [] if found.scale == 1 else put
    if not found.witnesses:
        return put
    both = found.witnesses[-1]
    text = f"Measured lengths are {both.scale:.4f} times the true ones (u = {both.u:.4f})"
    if abs(both.scale - 1) <= _COVERAGE * both.u:
        return [f"{text}: as they should be.", *put]
    if put:
        return [f"{text}.", *put]
    return [f"{text}.", f"They were taken as they are; --fix scale={both.scale:.4f} corrects them."]


def _open(sources: Sequence[TossSource]) -> list[str]:
    """What the tosses hardly tell."""
    said = []
    for name in sources[0].parameters:
        bound = [source.name for source in sources if source.parameters[name].at_bound]
        wide = [source.name for source in sources
                if source.parameters[name].open and source.name not in bound]  # fmt: skip
        if bound:
            said.append(f"In {phrases.listed(bound)} the {fits.title(name)} ended at its limit; it"
                        " may stand for another fault of the model.")  # fmt: skip
        if wide:
            said.append(f"In {phrases.listed(wide)} the tosses hardly tell the {fits.title(name)};"
                        " its interval may be wider.")  # fmt: skip
    return said


def engines(found: TossFit) -> Table | None:
    """What each engine must be given, and how far it then is off."""
    sources = fitted(found)
    if not sources:
        return None
    names = found.unknowns
    rows = []
    for source in sources:
        own = [source.parameters[name] for name in names]
        rows.append((
            f"{source.name} {source.version or ''}".strip(),
            *(cell for one in own for cell in (number(one.value, one.u), _ends(one.interval95))),
            f"{source.cost:.1f}", *_held(source.holdout), str(source.simulations),
            f"{source.wall_s:.0f}",
        ))  # fmt: skip
    heads = [
        column
        for name in names
        for column in (Column(fits.with_unit(name)), Column("95 % interval", spare=True))
    ]
    columns = (
        Column("Engine", text=True, nowrap=True), *heads, Column("corners, fitted (%)"),
        Column("position, held out (%)"), Column("rotation, held out (°)"),
        Column("simulations", spare=True), Column("seconds", spare=True),
    )  # fmt: skip
    note = (
        "Errors are means over the samples of a toss and then over tosses, with their 95 %"
        " intervals; lengths in % of the cube's width."
    )
    return Table("", columns, (Group("", tuple(rows)),), note)


def _ends(ends: tuple[float, float]) -> str:
    return phrases.ends(*(f"{end:.3g}" for end in ends))


def _held(own: TossErrors | None) -> tuple[str, str]:
    return ("–", "–") if own is None else (_mean(own.position), _mean(own.rotation))


def failed(found: TossFit) -> Table | None:
    """Engines that could not be fitted, and why."""
    rows = tuple((source.name, source.status, source.reason or "no reason is known")
                 for source in found.sources if not source.parameters)  # fmt: skip
    columns = (Column("Engine", text=True), Column("Status", text=True), Column("Why", text=True))
    return Table("Could not be fitted", columns, (Group("", rows),)) if rows else None


def scales(found: TossFit) -> Table | None:
    """What tells the length scale."""
    rows = tuple((one.name, f"{one.scale:.4f}", f"{one.u:.4f}", one.text)
                 for one in found.witnesses)  # fmt: skip
    columns = (Column("By", text=True), Column("Measured over true length"), Column("u"),
               Column("Where it comes from", text=True))  # fmt: skip
    return Table("Length scale of the recording", columns, (Group("", rows),)) if rows else None


def measured_figure(run: Run) -> Figure | None:
    """The first fitted toss as it was seen, with the engines over it."""
    rows = [(one.source, one.trajectory) for one in run.trajectories]
    if not rows or rows[0][0] != validations.MEASURED or len(rows) == 1:
        return None
    body = next(name for name in rows[0][1].signals if name.endswith(_PLACE))
    shown = (("height of the centre", "height (mm)", _height),
             ("way over the table", "way (mm)", _way))  # fmt: skip
    panels = tuple(
        Panel(title, "time (s)", label, tuple(
            _curve(name, one.time_s, 1e3 * value(one.signals[body])) for name, one in rows
        ))
        for title, label, value in shown
    )  # fmt: skip
    toss = found_of(run).fitted[0]
    caption = f"{toss}, one of the tosses that were fitted. Black: measured. Lines: the engines."
    return Figure("measured", f"A measured toss: {toss}", caption, panels)


def _height(position_m: Array) -> Array:
    return position_m[:, 2]


def _way(position_m: Array) -> Array:
    moved = position_m - position_m[0]
    return np.asarray(np.hypot(moved[:, 0], moved[:, 1]))


def _curve(name: str, time_s: Array, values: Array) -> Series:
    if name == validations.MEASURED:
        return Series(name, time_s, values, _SEEN, points=True, line=False)
    return Series(name, time_s, values, style_of(name))


def holdout_figure(found: TossFit) -> Figure | None:
    """Errors of every toss that was predicted, the smallest first."""
    held = [(source.name, source.holdout) for source in fitted(found) if source.holdout is not None]
    if not held:
        return None
    panels = tuple(
        Panel(title, axis, "tosses up to this error (%)", tuple(
            _cumulative(name, own.rotations if is_turn else own.positions) for name, own in held
        ), y_range=(0, 100))
        for title, axis, is_turn in (
            ("Position", "error (% of the width)", False), ("Rotation", "error (°)", True),
        )
    )  # fmt: skip
    caption = (
        "Every toss that was not fitted: how many of them an engine predicts to within an error."
        " The long tail of the rotation are tosses in which the cube falls on another face."
    )
    return Figure("held-out", "Tosses that were predicted", caption, panels, share_y=True)


def _cumulative(name: str, errors: Sequence[float]) -> Series:
    shares = 100 * np.arange(len(errors) + 1) / len(errors)
    steps = np.repeat(shares, 2)[1:-1]  # up at each toss
    return Series(name, np.repeat(np.sort(np.array(errors)), 2), steps, style_of(name))


def cost_figure(found: TossFit) -> Figure | None:
    """Cost of every point that was tried, over each parameter."""
    sources = fitted(found)
    if not sources:
        return None
    panels = tuple(
        Panel(fits.title(name), fits.with_unit(name), "corners (% of the width)",
              tuple(_tried(source, name) for source in sources))
        for name in found.unknowns
    )  # fmt: skip
    caption = (
        "Mean distance of the corners in the fitted tosses, for every point that was tried; at one"
        " value of a parameter there are several, as the others differ. How deep the valley is, is"
        " how well the tosses tell the parameter."
    )
    return Figure("cost", "What was tried", caption, panels, share_y=True)


def _tried(source: TossSource, name: str) -> Series:
    rows = sorted((point.values[name], point.cost) for point in source.tried
                  if point.cost is not None)  # fmt: skip
    x, y = np.array(rows).T
    return Series(source.name, x, y, style_of(source.name), points=True, line=False)
