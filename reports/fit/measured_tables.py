"""Tables of what a fit of bounces was made from, and where it holds."""

from __future__ import annotations

import math
from collections.abc import Sequence

from simcompare.model.settings import ASSISTED
from simcompare.reports.fit import fits
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table, printable
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_forms import Form
from simcompare.results.run import Run

#: lines of a list that is shown without being asked for
_SHORT = 8


def measured(run: Run) -> Table:
    """Every drop: where it comes from, how much was measured and how well."""
    found = fits.bounces(run)
    rows = []
    for use, drops in (("fitted", found.measured), ("held out", found.held_out)):
        for drop in drops:
            counts = (len(drop.heights_m), drop.samples)
            heights = " + ".join(
                f"{n} {word}" for n, word in zip(counts, ("heights", "samples"), strict=True) if n
            )
            source = printable(str(drop.source))
            count = str(len(drop.times_s) or len(drop.intervals_s))
            rows.append((source, drop.kind, use, count,
                         _u(drop.u_s or drop.u_intervals_s, "s"), heights or "none",
                         _u(drop.u_heights_m, "m")))  # fmt: skip
    columns = (
        Column("Recording", text=True), Column("Kind", text=True), Column("Use", text=True),
        Column("Times"), Column("u of a time", text=True), Column("Heights", text=True),
        Column("u of a height", text=True),
    )  # fmt: skip
    return Table("Drops", columns, (Group("", tuple(rows)),))


def _u(values: Sequence[float | None], unit: str) -> str:
    known = [v for v in values if v is not None]
    if not values:
        return "–"
    if not known:
        return "not stated"
    factor, small = phrases.people_unit(unit, known)
    ends = [numbers.plain(factor * v, 2) for v in (min(known), max(known))]
    words = ends[0] if ends[0] == ends[1] else " to ".join(ends)
    return f"{words} {small}"


def left_out(run: Run) -> Table | None:
    """Impacts that were left out or missed, with reasons."""
    found = fits.bounces(run)
    rows = []
    for drop in (*found.measured, *found.held_out):
        source = printable(str(drop.source))
        rows += [
            (source, f"{one.what} {one.number}", numbers.plain(one.time_s, 6),
             printable(one.reason)) for one in drop.dropped
        ]  # fmt: skip
        rows += [
            (source, f"impact {n}", "–", "missed: a flight there lasts too long for one")
            for n in drop.missed
        ]
    if not rows:
        return None
    columns = (Column("Recording", text=True), Column("What", text=True), Column("Time (s)"),
               Column("Why", text=True))  # fmt: skip
    return Table("Left out or missed", columns, (Group("", tuple(rows)),),
                 folded=len(rows) > _SHORT)  # fmt: skip


def known(run: Run) -> Table | None:
    """What was fixed, and what was known before, beside what the data say."""
    closed = fits.bounces(run).closed_form
    rows = [
        (fits.with_unit(name), "fixed", numbers.plain(value), "–", "")
        for name, value in closed.fixed.items()
    ]
    for name, prior in closed.priors.items():
        pull = closed.pulls.get(name)
        rows.append((
            fits.with_unit(name), "assumed" if prior.reason else "prior",
            numbers.with_u(prior.value, prior.u), numbers.plain(pull, 2), prior.reason,
        ))  # fmt: skip
    if not rows:
        return None
    columns = (Column("Quantity", text=True), Column("How", text=True), Column("Value ± u"),
               Column("Data less prior (÷ u)"), Column("Why", text=True))  # fmt: skip
    return Table("Fixed values and priors", columns, (Group("", tuple(rows)),))


def valid(run: Run) -> dict[str, str]:
    """The range in which the fit may be used."""
    found = fits.bounces(run)
    facts = {
        "valid for impacts at": f"{fits.speeds(found.valid.speed_m_s)} m/s",
        "contact level": _level(found),
        "time between samples": f"{numbers.plain(found.valid.step_s)} s",
        "closed form": found.closed_form.text,
        "numbers measured": str(found.closed_form.count),
        "residuals (RMS)": fits.rms_words(found.closed_form.rms),
        "χ² ÷ degrees of freedom": f"{_reduced(found.closed_form)}",
    }
    return {key: printable(value) for key, value in facts.items()}


def _level(found: BouncesFit) -> str:
    """The contact level, and with which of our helps."""
    level = found.contact
    return f"{level}, helps: {found.assist}" if level == ASSISTED else level


def _reduced(closed: Form) -> str:
    if not closed.dof or not math.isfinite(closed.chi2):
        return "no degree of freedom is left"
    return f"{numbers.plain(closed.chi2, 4)} ÷ {closed.dof}"
