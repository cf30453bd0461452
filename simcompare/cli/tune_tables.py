"""What ``tune`` prints: the answer in a sentence, a table, and lines to copy."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import typer

from simcompare import notation
from simcompare.cli import console
from simcompare.jobs import OK
from simcompare.settings import TUNED
from simcompare.tune import Tuned
from simcompare.tuning.request import Request
from simcompare.tuning.statement import Range, Statement


def show(rows: Sequence[Tuned]) -> None:
    """Prints the answer for people."""
    for about in dict.fromkeys((row.about, row.request) for row in rows):
        own = [row for row in rows if (row.about, row.request) == about]
        _show_request(own)


def show_snippets(rows: Sequence[Tuned]) -> None:
    """Prints the lines to copy, those of each engine below its name."""
    for row in rows:
        named = len(rows) > 1
        if row.status != OK:
            typer.echo(f"{row.engine}: {row.reason}", err=True)
            continue
        if named:
            typer.echo(f"# {row.engine} {row.version}")
        typer.echo(row.snippet + ("\n" if named else ""))


def plain(rows: Sequence[Tuned]) -> dict[str, Any]:
    """All of it as plain values for JSON; what has no value is null."""
    return {"answers": [_finite({**asdict(row)}) for row in rows]}


def _finite(value: Any) -> Any:  # noqa: ANN401
    if isinstance(value, Mapping):
        return {name: _finite(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _show_request(rows: Sequence[Tuned]) -> None:
    typer.echo(_headline(rows))
    _show_table(rows)
    for row in rows:
        for sentence in _remarks(row):
            typer.echo(f"{row.engine}: {sentence.removeprefix(f'{row.engine}: ')}")
    for note in dict.fromkeys(note for row in rows for note in row.notes):
        typer.echo(notation.sentence(note))
    (first, *others) = rows
    if others:
        typer.echo(
            "±: standard deviation over where in a step the impact falls. --snippet prints the"
            " lines to copy, --engine NAME all speeds."
        )
    elif first.statement is not None:
        if first.statement.bounces:
            _show_speeds(first.statement)
        typer.echo("To copy:")
        typer.echo(first.snippet)


def _headline(rows: Sequence[Tuned]) -> str:
    request = rows[0].request
    where = f"{_speeds(request)} at a step of {1e3 * request.step_s:.4g} ms"
    if request.restitution is None:
        return _found(rows[0], where)
    of = f" of {rows[0].about}" if rows[0].about else ""
    told = (
        f"Restitution {request.restitution:g}{of}, {where}, held within"
        f" {100 * request.within:.3g} % by "
    )
    holding = [row.engine for row in rows if row.statement and not row.statement.fault]
    if not holding:
        return f"{told}no engine."
    if len(holding) == len(rows) > 1:
        return f"{told}all {len(rows)} engines."
    counted = f" ({len(holding)} of {len(rows)})" if len(rows) > 1 else ""
    return f"{told}{', '.join(holding)}{counted}."


def _found(row: Tuned, where: str) -> str:
    """Which restitution numbers are, in a sentence."""
    rest = "all else as tuned sets it" if row.request.level == TUNED else "all else as it comes"
    start = f"{row.engine} with {_listed(row.request.numbers)}, {rest}, {where}: "
    if row.statement is None:
        return f"{start}{row.status}."
    found = row.statement.bounces
    if not found:
        return f"{start}nothing leaves the floor."
    means = [one.restitution for one in found]
    some = "" if len(found) == len(row.statement.at) else ", and not every impact is a bounce"
    return f"{start}a restitution of {_span(means)}{some}."


def _speeds(request: Request) -> str:
    low, high = request.lowest_m_s, request.highest_m_s
    return f"at {low:.3g} m/s" if low == high else f"from {low:g} to {high:g} m/s"


def _listed(numbers: Sequence[float]) -> str:
    return ", ".join(f"{value:.7g}" for value in numbers)


def _show_table(rows: Sequence[Tuned]) -> None:
    """Two or three lines for each engine, so that all of it fits into 80 columns."""
    made = console.table("engine", "type in", "restitution", "holds at", "costs")
    for row in rows:
        name = f"{row.engine}\n{row.version or ''}"
        if row.statement is None:
            made.add_row(name, row.status, "", "", "")
        else:
            made.add_row(name, *("\n".join(lines) for lines in _cells(row.statement)))
    console.show_table(made)


def _cells(found: Statement) -> list[list[str]]:
    # both bodies may be given the same number
    names = {one.parameter.partition(" of ")[0]: one.value for one in found.typed if one.is_tuned}
    called = dict.fromkeys(name.partition("[")[0] for name in names)
    typed = [f"{', '.join(called)} =", *(f"{value!r}" for value in names.values())]
    bounces = found.bounces
    if not bounces:
        return [typed, ["no bounce"], [], []]
    scatter = max(one.scatter for one in bounces)
    deepest_mm = 1e3 * max(one.penetration_m for one in bounces)
    longest_ms = 1e3 * max(one.contact_s for one in bounces)
    some = [] if len(bounces) == len(found.at) else ["or no bounce"]
    return [
        typed,
        [_span([one.restitution for one in bounces]), f"±{scatter:.2g}", *some],
        [f"{_range(found.speed_m_s)} m/s", f"{_range(found.step_s, 1e3)} ms"]
        if found.speed_m_s else ["none of these speeds"],
        [f"sinks {deepest_mm:.2g} mm", f"lasts {longest_ms:.2g} ms"],
    ]  # fmt: skip


def _span(means: Sequence[float]) -> str:
    low, high = f"{min(means):.4f}", f"{max(means):.4f}"
    return low if low == high else f"{low} to {high}"


def _range(found: Range | None, factor: float = 1.0) -> str:
    if found is None:
        return "none"
    low, high = (f"{factor * value:.3g}" for value in (found.low, found.high))
    return f"{'' if found.below else '≤'}{low} … {'' if found.above else '≥'}{high}"


def _remarks(row: Tuned) -> list[str]:
    """What a user of the numbers must know: where they do not hold, and why."""
    if row.statement is None:
        return [row.reason or row.status]
    found, said = row.statement, []
    speeds, steps = found.speed_m_s, found.step_s
    if found.fault:
        said.append(found.fault + _other_step(found))
    elif speeds is not None:
        said += [f"below {speeds.low:.3g} m/s {speeds.below}"] if speeds.below else []
        said += [f"above {speeds.high:.3g} m/s {speeds.above}"] if speeds.above else []
    if steps is not None and steps.above:
        said.append(f"with steps above {1e3 * steps.high:.3g} ms {steps.above}")
    return ["; ".join(said)] if said else []


def _other_step(found: Statement) -> str:
    if found.longest_step_s is None:
        return ""
    return f" (with --step {1e3 * found.longest_step_s:.3g}ms other numbers hold at all speeds)"


def _show_speeds(found: Statement) -> None:
    made = console.table(
        "impact at [m/s]", "restitution", "± scatter", "sinks [mm]", "lasts [ms]", "late by [ms]"
    )
    for one in found.at:
        if not math.isfinite(one.restitution):
            made.add_row(f"{one.speed_m_s:.3g}", "not every one bounces", *["–"] * 4)
            continue
        made.add_row(
            f"{one.speed_m_s:.3g}", f"{one.restitution:.4f}", f"±{one.scatter:.2g}",
            *(f"{1e3 * value:.3g}" for value in (one.penetration_m, one.contact_s, one.delay_s)),
        )  # fmt: skip
    console.show_table(made)
