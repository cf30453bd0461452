"""Events and single values of simulations against those of a recording, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from simcompare.reports.validation import phrases
from simcompare.reports.validation.phrases import SAME

Record = Mapping[str, Any]
LEVEL = "within the noise level (|E_n| ≤ 1, k = 2)"
#: parts of an uncertainty and what they come from
_SOURCES = {"u_num": "the steps", "u_input": "the parameters", "u_data": "the measurement"}
#: groups of engines and stretches that are told one by one; of more, only the worst
_MOST_TOLD = 4
#: below this part of an uncertainty its numerical part is not worth a word
_WORTH = 0.05
#: a parameter with less than this share of a budget leads by chance
_LEADING = 0.3


def sentences(found: Record) -> list[str]:
    """When things happened, and how sure single values are."""
    return [*_when(found), *_how_sure(found)]


# events


def _when(found: Record) -> Iterator[str]:
    rows = list(found.get("timings") or ())
    if not rows:
        return
    told = ""
    if any(_is_lost(row) for row in rows):
        told = (
            "Fewer than half of the events belong together, so either the clocks are not aligned or"
            " other things happened; the errors of the rest say little. "
        )
    told += f"{phrases.first_up(phrases.spaced(rows[0]['series']))}: {_pairs(found, rows)}."
    if any(row["matched"] for row in rows) and (found.get("align") or {}).get("by") == "events":
        told += " The clocks were aligned by these very events, so that only intervals are judged."
    yield " ".join([told, *_intervals(found, rows)])


def _is_lost(row: Record) -> bool:
    lost: int = max(row["missed"], row["extra"])
    return lost > int(row["matched"])


def _pairs(found: Record, rows: Sequence[Record]) -> str:
    """How many events belong together, engines with the same numbers as one."""
    groups: dict[tuple[Any, ...], list[Record]] = {}
    for row in rows:
        key = (row["stream"], row["matched"], row["missed"], row["extra"])
        groups.setdefault(key, []).append(row)
    own = list(groups.values())
    if len(own) <= _MOST_TOLD:
        return "; ".join(_paired(found, rows, group) for group in own)
    worst = min(own, key=lambda group: group[0]["matched"] / max(_counts(group[0])))
    return f"{_paired(found, rows, worst)} (the worst; the table has all)"


def _counts(row: Record) -> tuple[int, int]:
    """How many events were measured and how many simulated; 1 for none."""
    return max(row["matched"] + row["missed"], 1), max(row["matched"] + row["extra"], 1)


def _paired(found: Record, rows: Sequence[Record], group: Sequence[Record]) -> str:
    row = group[0]
    there = [one for one in rows if one["stream"] == row["stream"]]
    names = phrases.whose(phrases.engines_of(group), phrases.engines_of(there))
    both = row["matched"]
    told = (
        f"in {names}{phrases.where(found, row)} {both} of {both + row['missed']} measured events"
        f" belong to {both} of {both + row['extra']} simulated ones"
    )
    sizes = [one["rmse_s"] for one in group if one["rmse_s"] is not None]
    return told + (f", {phrases.size_span(sizes, 's')} apart (root mean square)" if sizes else "")


def _intervals(found: Record, rows: Sequence[Record]) -> Iterator[str]:
    judged = [
        {**one, "source": row["source"], "stream": row["stream"], "measure": one.get("number", i),
         "within_noise": abs(one["e_n"]) <= 1}
        for row in rows
        for i, one in enumerate(row["intervals"])
        if one["e_n"] is not None
    ]  # fmt: skip
    if judged:
        yield f"{_agreeing(judged, 'interval')}."


# single values


def _how_sure(found: Record) -> Iterator[str]:
    rows = [row for row in found["values"] if row["e_n"] is not None]
    if not found["values"]:
        if found["waveforms"]:
            yield "No single value of the scenario can be read off this recording."
        return
    if not rows:
        yield "No single value can be judged, because a part of its uncertainty is not known."
        return
    told = _agreeing(rows, "single value") + _differing(found, rows)
    if not all(row["within_noise"] for row in rows):
        told += f"; the furthest is the {_furthest(found, rows)}"
    elif found["basis"] != SAME:
        told += "; that shows no fault, and proves no model"
    yield " ".join([f"{told}.", _budget(rows), *_steps(found, rows)])


def _cells(rows: Sequence[Record]) -> list[list[Record]]:
    """Rows of all engines on one quantity of one stretch: one thing that was measured."""
    found: dict[tuple[Any, Any], list[Record]] = {}
    for row in rows:
        found.setdefault((row["stream"], row["measure"]), []).append(row)
    return list(found.values())


def _agreeing(rows: Sequence[Record], noun: str) -> str:
    """How many measured things agree; each counts once, however many engines simulate it."""
    cells = _cells(rows)
    within = sum(all(row["within_noise"] for row in cell) for cell in cells)
    engines = phrases.engines_of(rows)
    mixed = any(_is_mixed(cell) for cell in cells)
    alike = f"{' ' if mixed else ', alike '}in all {len(engines)} engines"
    alike = alike if len(engines) > 1 else ""
    measures = len({row["measure"] for row in rows})
    streams = len({row["stream"] for row in rows})
    made = f"{measures} {'quantity' if measures == 1 else 'quantities'}"
    made = "" if noun == "interval" else f" ({made} on {_on(streams)})"
    if len(cells) == 1:
        agrees = "agrees" if within else "does not agree"
        return f"The one {noun}{made} {agrees} {LEVEL}{alike}"
    if within == 0:
        return f"None of {len(cells)} {noun}s{made} agrees {LEVEL}{alike}"
    if within == len(cells):
        return f"All {within} {noun}s{made} agree {LEVEL}{alike}"
    agree = "agrees" if within == 1 else "agree"
    return f"Of {len(cells)} {noun}s{made} {within} {agree} {LEVEL}{alike}"


def _on(streams: int) -> str:
    return f"{streams} stretch{'' if streams == 1 else 'es'}"


def _is_mixed(cell: Sequence[Record]) -> bool:
    return len({row["within_noise"] for row in cell}) > 1


def _differing(found: Record, rows: Sequence[Record]) -> str:
    """Engines that do not agree where others do."""
    told = []
    for cell in _cells(rows):
        if _is_mixed(cell):
            beyond = [row["source"] for row in cell if not row["within_noise"]]
            measure = phrases.spaced(cell[0]["measure"])
            told.append(f"{phrases.listed(beyond)} in {measure}{phrases.where(found, cell[0])}")
    if not told:
        return ""
    more = f" and {len(told) - _MOST_TOLD} more" if len(told) > _MOST_TOLD else ""
    return f"; beyond it where others agree: {', '.join(told[:_MOST_TOLD])}{more}"


def _furthest(found: Record, rows: Sequence[Record]) -> str:
    worst = max(rows, key=lambda row: abs(row["e_n"]))
    # one just outside must not look like one just inside
    digits = 2 if abs(worst["e_n"]) < 2 else 1
    e_n = _e_n(worst["e_n"], digits)
    same = [row for row in rows if (row["stream"], row["measure"]) ==
            (worst["stream"], worst["measure"])]  # fmt: skip
    alike = [row["source"] for row in same if _e_n(row["e_n"], digits) == e_n]
    names = phrases.whose(alike, phrases.engines_of(same))
    measure = phrases.spaced(worst["measure"])
    return f"{measure} of {names}{phrases.where(found, worst)}, E_n = {e_n}"


def _e_n(value: float, digits: int) -> str:
    return f"{value:+.{digits}f}".replace("-", "−")


def _budget(rows: Sequence[Record]) -> str:
    """Where most of the uncertainty comes from, and from which parameter."""
    source, share = dominant(rows)
    most = "Nearly all" if share > 0.99 else phrases.percent(share)
    told = f"{most} of the squared uncertainty comes from {_SOURCES[source]}"
    name, part = leading_parameter(rows)
    if source == "u_input" and part > _LEADING:
        told += f", of which {phrases.percent(part)} from the {phrases.parameter(name)}"
    return f"{told}."


def dominant(rows: Sequence[Record]) -> tuple[str, float]:
    """The part that makes up most of the squared uncertainty, and its mean share.

    Args:
        rows: single values that are judged.
    """
    known = [row for row in rows if row["u_val"] > 0]
    shares = {key: sum((row[key] / row["u_val"]) ** 2 for row in known) for key in _SOURCES}
    shares = {key: share / max(len(known), 1) for key, share in shares.items()}
    return max(shares.items(), key=lambda item: item[1])


def leading_parameter(rows: Sequence[Record]) -> tuple[str, float]:
    """The parameter with the largest part of the values' budgets, and its mean share of squares.

    Without any budget that is no parameter with no share.

    Args:
        rows: single values.
    """
    parts: dict[str, float] = {}
    whole = 0
    for row in rows:
        squares: dict[str, float] = {}
        for key, one in (row.get("budget") or {}).items():
            # a fitted parameter stands for an axis of the covariance
            name = key.rstrip("'").removesuffix(" (fitted)")
            squares[name] = squares.get(name, 0.0) + one**2
        total = sum(squares.values())
        if total > 0:
            whole += 1
            for name, square in squares.items():
                parts[name] = parts.get(name, 0.0) + square / total
    if not whole:
        return "", 0.0
    name = max(parts, key=lambda key: parts[key])
    return name, parts[name] / whole


def _steps(found: Record, rows: Sequence[Record]) -> Iterator[str]:
    """The value in which the engines' own error weighs most."""
    worst = max(rows, key=lambda row: row["u_num"] / (row["u_val"] or 1.0))
    if worst["u_num"] <= _WORTH * worst["u_val"]:
        return
    u_num, u_val = (phrases.sized(worst[key], worst.get("unit", "1")) for key in ("u_num", "u_val"))
    yield (
        f"Numerical error weighs most in the {phrases.spaced(worst['measure'])} of"
        f" {worst['source']}{phrases.where(found, worst)}: u = {u_num} of {u_val}."
    )
