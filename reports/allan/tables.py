"""Tables of the noise of a sensor at rest."""

from __future__ import annotations

from simcompare import units
from simcompare.hardware.sensors import noise_units
from simcompare.reports.allan import words
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results.records.allan import AxisNoise, NoiseAnalysis, NoiseTerm

_TITLES = {
    "N": "white noise N", "B": "bias instability B", "K": "rate random walk K",
    "Q": "quantisation Q", "R": "ramp R",
}  # fmt: skip


def of_terms(found: NoiseAnalysis) -> Table:
    """Each noise of each channel, in SI and in the unit of data sheets."""
    columns = (
        Column("Noise", text=True, nowrap=True), Column("Value ± u"),
        Column("Unit", text=True, nowrap=True), Column("In SI", spare=True),
        Column("SI unit", text=True, nowrap=True, spare=True),
    )  # fmt: skip
    groups = tuple(Group(words.short(axis.channel), _rows(axis)) for axis in found.axes)
    note = (
        "“<”: the record does not show it; it is below this with 95 % probability. N² is a"
        " two-sided density; data sheets state n = √2·N, one-sided."
    )
    return Table("Noises", columns, groups, note)


def _rows(axis: AxisNoise) -> tuple[tuple[str, ...], ...]:
    rows = [_density(axis), _neighbours(axis), *(_row(term) for term in axis.terms)]
    found = axis.gauss_markov
    if found is not None:
        symbol = units.symbol(axis.unit)
        name, size = noise_units.of_sheets("B", axis.unit)
        told = numbers.with_u(found.sigma / size, found.u_sigma / size)
        si = numbers.with_u(found.sigma, found.u_sigma)
        rows.append(("Gauss-Markov σ", told, name, si, symbol))
        rows.append(
            ("Gauss-Markov time", numbers.with_u(found.time_s, found.u_time_s), "s", "", "")
        )
    return tuple(row for row in rows if row)


def _density(axis: AxisNoise) -> tuple[str, ...]:
    white = axis.term("N")
    if white.value is None or white.u is None:
        return ()
    found, u = 2**0.5 * white.value, 2**0.5 * white.u
    told = numbers.with_u(found / white.sheet_size, u / white.sheet_size)
    return ("noise density n", told, white.sheet_unit, numbers.with_u(found, u), white.unit)


def _neighbours(axis: AxisNoise) -> tuple[str, ...]:
    """The density that neighbouring readings show, where the fit begins later."""
    white = axis.term("N")
    if axis.from_s < 1.5 * axis.tau_s[0]:
        return ()
    found = axis.deviation[0] * (2 * axis.tau_s[0]) ** 0.5
    told = numbers.plain(found / white.sheet_size, 3)
    return ("n of neighbours", told, white.sheet_unit, numbers.plain(found, 3), white.unit)


def _row(term: NoiseTerm) -> tuple[str, ...]:
    title = _TITLES[term.name]
    if term.value is None or term.u is None:
        limit = words.limited(term.limit / term.sheet_size)
        return (title, limit, term.sheet_unit, words.limited(term.limit), term.unit)
    told = numbers.with_u(term.value / term.sheet_size, term.u / term.sheet_size)
    return (title, told, term.sheet_unit, numbers.with_u(term.value, term.u), term.unit)


def of_walks(found: NoiseAnalysis) -> Table | None:
    """White noise as angle and velocity random walk."""
    rows = []
    for axis in found.axes:
        white, walk = axis.term("N"), noise_units.walk(axis.unit)
        if walk is not None and white.value is not None and white.u is not None:
            told = numbers.with_u(white.value / walk[1], white.u / walk[1])
            rows.append((words.short(axis.channel), told, walk[0]))
    if not rows:
        return None
    columns = (Column("Channel", text=True), Column("Random walk ± u"), Column("Unit", text=True))
    return Table("White noise, as navigation calls it", columns, (Group("", tuple(rows)),))


def of_sheet(found: NoiseAnalysis) -> Table | None:
    """White noise beside a data sheet."""
    if not found.against:
        return None
    columns = (
        Column("Channel", text=True), Column("Measured n ± u"), Column("Sheet, typical"),
        Column("Unit", text=True, nowrap=True), Column("Ratio ± u"),
    )  # fmt: skip
    unit_of = {axis.channel: axis.unit for axis in found.axes}
    rows = []
    for row in found.against:
        name, size = noise_units.of_sheets("N", unit_of[row.channel])
        rows.append((
            words.short(row.channel), numbers.with_u(row.found / size, row.u / size),
            numbers.plain(row.stated / size, 3), name, numbers.with_u(row.ratio, row.u_ratio),
        ))  # fmt: skip
    return Table(f"Beside {found.against[0].sheet}", columns, (Group("", tuple(rows)),))


def of_findings(found: NoiseAnalysis) -> Table | None:
    """Every test of the audit."""
    if not found.audited:
        return None
    columns = (
        Column("Test", text=True), Column("Channel", text=True), Column("Verdict", text=True),
        Column("p"), Column("Found", text=True),
    )  # fmt: skip
    rows = tuple(
        (one.test, ", ".join(words.short(name) for name in one.channel.split(", ")),
         "fault" if one.fault else "fine", words.chance_of(one.p)[2:].lstrip("= "),
         one.text if one.fault else "")
        for one in found.findings
    )  # fmt: skip
    note = (
        "p: chance of so extreme a stream without the fault, of each test alone; the verdicts are"
        " corrected for how many tests there are (Holm)."
    )
    return Table("Audit", columns, (Group("", rows),), note)


def of_matches(found: NoiseAnalysis) -> Table | None:
    """Data sheets beside the stream."""
    if not found.matches:
        return None
    columns = (
        Column("Sheet", text=True), Column("Sensor", text=True), Column("Noise over the sheet's"),
        Column("Fits", text=True),
    )  # fmt: skip
    rows = tuple(
        (one.sheet, one.part.replace("_", " "), numbers.plain(one.ratio, 3),
         "yes" if one.fits else "no")
        for one in found.matches
    )  # fmt: skip
    return Table("Whose noise it is", columns, (Group("", rows),))


def of_deviations(found: NoiseAnalysis) -> Table:
    """Every deviation with its bounds and noise type."""
    columns = (
        Column("τ (s)"), Column("Deviation"), Column("95 % from"), Column("to"),
        Column("Fit"), Column("Noise", text=True),
    )  # fmt: skip
    groups = []
    for axis in found.axes:
        rows = zip(
            axis.tau_s, axis.deviation, axis.low, axis.high, axis.fitted, axis.noise_types,
            strict=True,
        )  # fmt: skip
        cells = tuple((*(numbers.plain(one, 4) for one in row[:5]), str(row[5])) for row in rows)
        groups.append(Group(f"{words.short(axis.channel)} ({units.symbol(axis.unit)})", cells))
    return Table("Overlapping Allan deviation", columns, tuple(groups), folded=True)
