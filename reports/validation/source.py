"""Tables of a recording: what was repaired, its segments, and how columns became SI."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from simcompare.model.recording import INFO, REPAIR, WARNING, Repair
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table, printable
from simcompare.reports.validation import validations
from simcompare.results.run import Run

#: ranges of rows and streams that are named for each repair
_MAX_RANGES, _MAX_STREAMS = 8, 4
_SEVERITIES = {REPAIR: "repaired", WARNING: "left and marked", INFO: "noted"}


def facts(run: Run) -> dict[str, str]:
    """Where the recording comes from and how it was read."""
    validation = validations.validation(run)
    file = validation.provenance
    align = validation.align
    how = "taken as they are" if align.by == "none" else align.by
    texts = (one.text for one in validation.alignments if one is not None)
    clocks = [how, *([align.reason] if align.reason else []), *texts]
    inputs = ", ".join(f"{name} follows channel {c}" for name, c in validation.inputs.items())
    compared = ", ".join(
        f"{one.label} with channel {one.channel}" + ("" if one.judged else " (not judged)")
        for one in validation.compare.values()
    )
    shown = {
        **validation.about,
        "file": f"{file.file}, {file.size_bytes} bytes",
        "SHA-256": file.sha256,
        "read by": f"importer {file.importer} of simcompare {file.version}, mode {file.mode}",
        "clocks": ": ".join(clocks),
    }
    shown |= {"compared": compared} if compared else {}
    shown |= {"inputs": inputs} if inputs else {}
    return {printable(key): printable(value) for key, value in shown.items()}


def repairs(run: Run) -> list[Table]:
    """What was noticed in the log: changes and defects first, what is harmless folded."""
    rows = validations.validation(run).provenance.repairs
    serious = [row for row in rows if row.severity != INFO]
    serious.sort(key=lambda row: row.severity != REPAIR)
    harmless = [row for row in rows if row.severity == INFO]
    tables = []
    if serious:
        tables.append(_repairs("Defects of the log", serious))
    if harmless:
        tables.append(_repairs("Decided on the way, harmless", harmless)._replace(folded=True))
    return tables


def _repairs(title: str, rows: Sequence[Repair]) -> Table:
    columns = (
        Column("Done", text=True), Column("Rule", text=True),
        Column("What was found", text=True), Column("Where", text=True), Column("Count"),
        Column("Before → after", text=True, spare=True),
    )  # fmt: skip
    return Table(title, columns, (Group("", tuple(map(_repair, _merged(rows)))),))


def _merged(rows: Sequence[Repair]) -> list[list[Repair]]:
    """What was noticed alike in several streams, as one row."""
    merged: dict[tuple[str | int, ...], list[Repair]] = {}
    for i, row in enumerate(rows):
        # rows of a log can only be named for one stream at a time
        number = i if row.rows or row.before else -1
        key = (row.severity, row.rule, row.text, row.channel, number)
        merged.setdefault(key, []).append(row)
    return list(merged.values())


def _repair(rows: Sequence[Repair]) -> tuple[str, ...]:
    row = rows[0]
    count = sum(one.count for one in rows)
    return (
        _SEVERITIES.get(row.severity, row.severity),
        row.rule.replace("_", " "),
        row.text,
        _where(rows),
        str(count) if count else "",
        _changes(row.before, row.after),
    )


def _where(rows: Sequence[Repair]) -> str:
    row = rows[0]
    parts = [_few(dict.fromkeys(one.stream for one in rows if one.stream != validations.ONLY))]
    parts += [f"column {row.channel}"] if row.channel else []
    ranges = [f"{a}" if a == b else f"{a}–{b}" for a, b in row.rows[:_MAX_RANGES]]
    if ranges:
        kind = "row" if ranges == [f"{row.rows[0][0]}"] else "rows"
        parts.append(f"{kind} {', '.join(ranges)}{' …' if len(row.rows) > _MAX_RANGES else ''}")
    return ", ".join(part for part in parts if part)


def _few(streams: Iterable[str]) -> str:
    names = [name for name in streams if name]
    shown = ", ".join(names[:_MAX_STREAMS])
    return f"{shown} and {len(names) - _MAX_STREAMS} more" if len(names) > _MAX_STREAMS else shown


def _changes(before: Mapping[str, float], after: Mapping[str, float]) -> str:
    return "; ".join(
        f"{key.replace('_', ' ')} {numbers.plain(value)}"
        + (f" → {numbers.plain(after[key])}" if key in after else "")
        for key, value in before.items()
    )


def segments(run: Run) -> Table | None:
    """The segments that were judged and how well each quantity was measured there.

    ``None`` where only events were compared.
    """
    columns = (
        Column("Segment", text=True, nowrap=True), Column("Begins (s)"), Column("Lasts (s)"),
        Column("Quantity", text=True), Column("Samples"), Column("Missing"),
        Column("Saturated"), Column("u of a sample"), Column("u from", text=True),
    )  # fmt: skip
    rows = []
    for case in validations.validation(run).cases:
        for probe, measured in case.probes.items():
            rows.append(
                (
                    validations.segment_name(run, case.stream) or "the whole log",
                    numbers.plain(case.start_s, 4),
                    numbers.plain(case.duration_s, 4) + (" (cut)" if case.short else ""),
                    validations.with_unit(run, probe),
                    *map(str, (measured.samples, measured.missing, measured.saturated)),
                    numbers.plain(measured.u, 2),
                    measured.u_from,
                )
            )
    if not rows:
        return None
    note = "Cut: the log ends before the window that was asked for."
    cut = any(case.short for case in validations.validation(run).cases)
    return Table("Segments", columns, (Group("", tuple(rows)),), note if cut else "")


def conversions(run: Run) -> Table | None:
    """How every column of the log became SI."""
    conversions_ = validations.validation(run).provenance.conversions
    if not conversions_:
        return None
    columns = (
        Column("Column", text=True), Column("Unit", text=True, nowrap=True),
        Column("Channel", text=True), Column("SI", text=True, nowrap=True),
        Column("× factor"), Column("+ offset"), Column("Note", text=True),
    )  # fmt: skip
    rows = tuple(
        (
            row.raw, row.raw_unit, row.channel or "left out", row.unit,
            f"{row.factor:.9g}", f"{row.offset:.9g}", row.reason,
        )
        for row in conversions_
    )  # fmt: skip
    return Table("How every column became SI", columns, (Group("", rows),), folded=True)


def events(run: Run) -> Table | None:
    """Events of the recording within the segments."""
    validation = validations.validation(run)
    streams = {case.stream for case in validation.cases}
    rows = tuple(
        (
            row.name,
            validations.segment_name(run, row.stream),
            numbers.with_u(row.time_s, row.u_s, digits=7),
            numbers.plain(row.value, 4),
        )
        for row in validation.events
        if row.stream in streams
    )
    if not rows:
        return None
    columns = (Column("Event", text=True), Column("Segment", text=True),
               Column("Time ± u (s)"), Column("Value"))  # fmt: skip
    return Table("Events", columns, (Group("", rows),), folded=len(rows) > _MAX_RANGES)
