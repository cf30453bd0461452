"""Where the uncertainty of a fit of bounces comes from: a table, and what would make it smaller."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.notation import capital
from simcompare.reports.fit import fits
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_parts import DATA, LAW, Budget
from simcompare.results.run import Run

#: share of the squared uncertainty from which on a source is told
_MOST = 0.5
#: what is assumed -> how it is called, and what would make it better known
_ASSUMED = {
    "gravity_m_s2": ("the local gravity", "look up that of your place, such as --fix"
                     " gravity=9.8061m/s²"),
    "clock_skew": ("the recorder's clock", "compare it with a good one, and give the rest, such as"
                   " --prior clock_skew=0:5ppm"),
    "scale": ("the length in the video", "film a rod beside the ball and say how true it is, such"
              " as --prior scale=1:0.002"),
    "terminal_speed_m_s": ("the drag", "give the terminal speed of your ball, such as --prior"
                           " terminal_speed=9m/s:0.2m/s"),
}  # fmt: skip


def words(fit: BouncesFit) -> tuple[str, ...]:
    """What most of an uncertainty is due to though nobody measured it, one sentence for each."""
    priors = fit.closed_form.priors
    said: dict[str, list[str]] = {}
    for one in fit.budgets:
        source = one.largest if one.shares else ""
        default = source in priors and bool(priors[source].reason)
        if default and one.shares[source] > _MOST and source != one.name:
            said.setdefault(source, []).append(one.name)
    return tuple(_sentence(fit, source, names) for source, names in said.items())


def _sentence(fit: BouncesFit, source: str, names: Sequence[str]) -> str:
    called, advice = _ASSUMED[source]
    shares = [one.shares[source] for one in fit.budgets if one.name in names]
    what = phrases.listed([f"the {fits.title(name)}" for name in names])
    part = phrases.ends(*(numbers.plain(100 * end(shares), 2) for end in (min, max)))
    return (
        f"The uncertainty of {what} is mostly that of {called}, which was assumed"
        f" ({part} % of u²): {advice}."
    )


def table(run: Run) -> Table | None:
    """Every quantity with the share of each source; ``None`` where nothing is told."""
    found = fits.bounces(run).budgets
    sources = [name for name in dict.fromkeys(s for one in found for s in one.shares)]
    if not found:
        return None
    rows = tuple(_row(one, sources) for one in found)
    columns = (
        Column("Quantity", text=True), Column("u"),
        *(Column(capital(_called(source))) for source in sources),
    )  # fmt: skip
    note = "The parts of u² that each source makes. What was assumed is listed with its reason."
    return Table("Where the uncertainty comes from", columns, (Group("", rows),), note)


def _row(one: Budget, sources: Sequence[str]) -> tuple[str, ...]:
    unit = "" if fits.unit(one.name) == "1" else f" {fits.unit(one.name)}"
    shares = (_percent(one.shares.get(source, 0.0)) for source in sources)
    return (fits.title(one.name), f"{numbers.plain(one.u, 2)}{unit}", *shares)


def _percent(share: float) -> str:
    if share < 5e-4:
        return "0 %" if share < 1e-12 else "< 0.1 %"
    return numbers.percent(share)


def _called(source: str) -> str:
    if source in (DATA, LAW):
        return {DATA: "measurement", LAW: LAW}[source]
    return fits.title(source)
