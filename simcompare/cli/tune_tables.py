"""What ``tune`` prints: the answer in a sentence, a table, and lines to copy."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import typer

from simcompare import notation
from simcompare.cli import console, manner
from simcompare.engine.calibration.drops import slowest_m_s
from simcompare.engine.calibration.springs import SCATTER
from simcompare.model.settings import TUNED
from simcompare.model.tuning import AtSpeed
from simcompare.running.jobs import OK
from simcompare.tuning.bench import STATED
from simcompare.tuning.request import Request
from simcompare.tuning.statement import Range, Statement
from simcompare.verbs.tuning import TuneResult

_LEGEND = (
    "restitution: lowest and highest mean over where in a step the impact falls; ± the largest"
    " standard deviation, by which single impacts differ.",
    "holds at: speeds, and steps at these speeds, with which the mean is near enough, the scatter"
    " small and the ball not half sunk; ≤, ≥: no end was found so far.",
)
_MORE = "--snippet prints the lines to copy, --engine NAME all speeds, -v all remarks."
_LATE = ("late by: how much later the next impact comes than after a bounce that takes no time.",)


def show(rows: Sequence[TuneResult]) -> None:
    """Prints the answer for people."""
    for asked in dict.fromkeys((row.about, row.request) for row in rows):
        _show_request([row for row in rows if (row.about, row.request) == asked])


def show_snippets(rows: Sequence[TuneResult]) -> None:
    """Prints the lines to copy, those of each engine below its name; settings where there are none.

    What is no line of a program goes to stderr.
    """
    for row in rows:
        if row.status != OK:
            typer.echo(row.reason, err=True)
            continue
        if len(rows) > 1:
            head = f"# {row.engine} {row.version}"
            console.print_wanted(head) if row.snippet else typer.echo(head, err=True)
        if row.snippet:
            console.print_wanted(row.snippet + ("\n" if len(rows) > 1 else ""))
        else:
            typer.echo("\n".join(_settings(row)), err=True)


def _show_request(rows: Sequence[TuneResult]) -> None:
    console.print_wrapped([_headline(rows)])
    _show_table(rows)
    told = [row for row in rows if len(rows) == 1 or manner.is_verbose() or _has_fault(row)]
    console.print_wrapped(sentence for row in told for sentence in _remarks(row))
    notes = dict.fromkeys(note for row in rows for note in row.notes)
    console.print_wrapped(map(notation.sentence, notes))
    console.print_wrapped(_LEGEND)
    if len(rows) == 1:
        _show_alone(rows[0])
    else:
        console.print_wrapped([_MORE])


def _has_fault(row: TuneResult) -> bool:
    return row.statement is None or bool(row.statement.fault)


def _show_alone(row: TuneResult) -> None:
    """All speeds, and what is typed in."""
    if row.statement is None:
        return
    if row.statement.bounces:
        _show_speeds(row.statement, row.request)
        console.print_wrapped(_LATE)
    if row.snippet:
        typer.echo(f"To copy:\n{row.snippet}")
    else:
        typer.echo("Set, all else as it comes:" if row.request.level != TUNED else "Set:")
        typer.echo("\n".join(f"  {line}" for line in _settings(row)))


def _settings(row: TuneResult) -> Iterator[str]:
    assert row.statement is not None
    for one in row.statement.typed:
        note = f" ({one.note})" if one.note else ""
        yield f"{one.parameter}: {one.value:.10g} {one.unit}".rstrip() + note


def _headline(rows: Sequence[TuneResult]) -> str:
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


def _found(row: TuneResult, where: str) -> str:
    """Which restitution numbers are, in a sentence."""
    rest = "all else as tuned sets it" if row.request.level == TUNED else "all else as it comes"
    given = ", ".join(f"{value:.7g}" for value in row.request.numbers)
    start = f"{row.engine} with {given}, {rest}, {where}: "
    if row.statement is None:
        return f"{start}{row.status}."
    found = row.statement.bounces
    if not found:
        return f"{start}nothing leaves the floor."
    some = "" if len(found) == len(row.statement.at) else ", and not every impact is a bounce"
    return f"{start}a restitution of {_span(found)}{some}."


def _speeds(request: Request) -> str:
    low, high = request.lowest_m_s, request.highest_m_s
    return f"at {low:.3g} m/s" if low == high else f"from {low:g} to {high:g} m/s"


def _show_table(rows: Sequence[TuneResult]) -> None:
    """Two or three lines for each engine, so that all of it fits into 80 columns."""
    made = console.Rows("engine", "type in", "restitution", "holds at", "sinks, lasts")
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
    typed = [", ".join(called), *(f"{value!r}" for value in names.values())]
    bounces = found.bounces
    if not bounces:
        return [typed, ["no bounce"], [], []]
    scatter = max(one.scatter for one in bounces)
    deepest_mm = 1e3 * max(one.penetration_m for one in bounces)
    longest_ms = 1e3 * max(one.contact_s for one in bounces)
    some = [] if len(bounces) == len(found.at) else ["or no bounce"]
    held = [f"{_range(found.holds_at_m_s)} m/s", f"{_range(found.holds_with_s, 1e3)} ms"]
    return [
        typed,
        [_span(bounces), f"±{scatter:.2g}", *some],
        held if found.holds_at_m_s else ["none of these"],
        [f"{_plain(deepest_mm, 2)} mm", f"{_plain(longest_ms, 2)} ms"],
    ]


def _span(bounces: Sequence[AtSpeed]) -> str:
    """Lowest and highest mean, with as many digits as so many drops tell of either."""
    means = [one.restitution for one in bounces]
    places = max(_places(one) for one in bounces)
    low, high = f"{min(means):.{places}f}", f"{max(means):.{places}f}"
    return low if low == high else f"{low} to {high}"


def _places(one: AtSpeed) -> int:
    u = one.scatter / math.sqrt(STATED)
    return 4 if u <= 0 else min(max(math.ceil(-math.log10(u)), 2), 4)


def _range(found: Range | None, factor: float = 1.0) -> str:
    if found is None:
        return "none"
    low, high = (_plain(factor * value) for value in (found.low, found.high))
    return f"{'' if found.below else '≤'}{low} … {'' if found.above else '≥'}{high}"


def _plain(value: float, digits: int = 3) -> str:
    """A number with so many digits that count, and without a power of ten."""
    rounded = float(f"{value:.{digits}g}")
    return f"{rounded:.{max(0, digits - 1 - math.floor(math.log10(abs(rounded) or 1)))}f}"


def _remarks(row: TuneResult) -> Iterator[str]:
    """What a user of the numbers must know: where they do not hold, and why."""
    found = row.statement
    if found is None:
        yield row.reason or row.status
        return
    said = [found.fault + _other_step(found)] if found.fault else []
    if found.holds_at_m_s is not None and not found.fault:
        said += _ends(found.holds_at_m_s, 1.0, "m/s", "")
    if found.holds_with_s is not None:
        said += _ends(found.holds_with_s, 1e3, "ms", "steps ")
    if len(row.request.numbers) == 0 and len(found.numbers) == 2:
        said.append(_choice(row.request, found))
    if said:
        yield f"{row.engine}: {'; '.join(said)}"


def _ends(held: Range, factor: float, unit: str, what: str) -> list[str]:
    low, high = (f"{_plain(factor * value)} {unit}" for value in (held.low, held.high))
    below = [f"{what}below {low}: {held.below}"] if held.below else []
    return below + ([f"{what}above {high}: {held.above}"] if held.above else [])


def _choice(request: Request, found: Statement) -> str:
    """Which of many springs and dampers it is."""
    if found.is_steadiest:
        limit = "half of the ball" if request.depth_m is None else f"{1e3 * request.depth_m:g} mm"
        return f"of the contacts that sink {limit} at most the one that scatters least"
    part = SCATTER if request.scatter_part is None else request.scatter_part
    return (
        f"the stiffest contact that scatters by {100 * part:g} % at most; --depth asks for others"
    )


def _other_step(found: Statement) -> str:
    if found.longest_step_s is None:
        return ""
    return f" (with --step {1e3 * found.longest_step_s:.3g}ms other numbers hold at all speeds)"


def _show_speeds(found: Statement, request: Request) -> None:
    made = console.Rows("impact [m/s]", "restitution", "± scatter", "sinks [mm]", "lasts [ms]",
                         "late by [ms]")  # fmt: skip
    for one in found.at:
        if not math.isfinite(one.restitution):
            slow = one.speed_m_s < slowest_m_s(request.step_s, request.gravity_m_s2)
            words = "too short to read" if slow else "not every one"
            made.add_row(_plain(one.speed_m_s), words, *["–"] * 4)
            continue
        made.add_row(
            _plain(one.speed_m_s), f"{one.restitution:.{_places(one)}f}", f"±{one.scatter:.2g}",
            *(_plain(1e3 * value) for value in (one.penetration_m, one.contact_s, one.delay_s)),
        )  # fmt: skip
    console.show_table(made)
