"""What stands below the answer: what contacts cost, what was typed in, and what was missed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from simcompare.compare import FAIL
from simcompare.reports import listing, numbers, runs
from simcompare.reports.words import how, merged
from simcompare.results import Run
from simcompare.settings import SHOWN_LEVELS, TUNED

#: contacts whose depths differ by less than this factor are told as one
_ALIKE_DEPTHS = 2.0
#: a depth below this part of the body's size is called small
_SHALLOW = 0.01


def remarks(run: Run) -> list[str]:
    """Sentences, as far as there is something to say."""
    found = [_typed_in(run), _contacts(run)]
    judged = [mode for mode in runs.modes(run) if mode not in SHOWN_LEVELS]
    found += merged((how(run, mode), _missed(run, mode)) for mode in judged)
    found += [_not_run(run)]
    if run.interrupted:
        found.append("The run was interrupted before it was complete.")
    return [sentence for sentence in found if sentence]


def typed(source: Mapping[str, Any], record: Mapping[str, Any], digits: int = 6) -> str:
    """The numbers of a tuning under the names of the engine's own parameters."""
    names = {
        row["set_value"]: row["engine_parameter"]
        for row in source["audit"]
        if row["quantity"].endswith("restitution")
    }
    return ", ".join(
        f"{names[value]} = {numbers.plain(value, digits)}"
        if value in names
        else numbers.plain(value, digits)
        for value in record["numbers"]
    )


#: how all of so many tolerances are called
_ALL = {1: "the one tolerance is", 2: "both tolerances are"}


def _tuned(run: Run) -> list[tuple[Mapping[str, Any], Mapping[str, Any]]]:
    """Sources of the level tuned, each with the first record of its tuning."""
    sources = [source for source in run.record["sources"] if source["contact"] == TUNED]
    return [(source, source["tuning"][0]) for source in sources if source.get("tuning")]


def _contacts(run: Run) -> str:
    """How deep the first contact sinks and how long it lasts, engines alike together."""
    known = [
        (at["penetration_m"], at["contact_s"], source["name"], record.get("size_m") or 0.0)
        for source, record in _tuned(run)
        for at in record["at"][:1]
        if at["penetration_m"] is not None and at["contact_s"] is not None
    ]
    if not known:
        return ""
    groups: list[list[tuple[float, float, str, float]]] = []
    for one in sorted(known, key=lambda row: -row[0]):
        first = groups[-1][0] if groups else None
        if first and (first[0] <= _ALIKE_DEPTHS * one[0] or first[0] <= _SHALLOW * first[3]):
            groups[-1].append(one)
        else:
            groups.append([one])
    order = runs.names(run)
    said = [_contact(sorted(group, key=lambda row: order.index(row[2]))) for group in groups]
    return f"Tuned, the first contact sinks {'; '.join(said)}."


def _contact(group: Sequence[tuple[float, float, str, float]]) -> str:
    depth, size = max(row[0] for row in group), group[0][3]
    lasts = _span([1e3 * row[1] for row in group], "ms")
    names = listing.joined([row[2] for row in group])
    if depth <= _SHALLOW * size:
        return f"less than {numbers.plain(1e3 * _SHALLOW * size, 2)} mm for {lasts} in {names}"
    return f"{_span([1e3 * row[0] for row in group], 'mm')} for {lasts} in {names}"


def _span(values: Sequence[float], unit: str, digits: int = 2) -> str:
    low, high = (numbers.plain(value, digits) for value in (min(values), max(values)))
    after = f" {unit}" if unit else ""
    return f"{low}{after}" if low == high else f"{low} to {high}{after}"


def _typed_in(run: Run) -> str:
    """Which numbers stand for the restitution, engine by engine."""
    rows = _tuned(run)
    if not rows:
        return ""
    said = [f"{_short(source, record)} in {source['name']}" for source, record in rows]
    wanted = {record["restitution"] for _, record in rows}
    goal = f" for a restitution of {numbers.plain(wanted.pop())}" if len(wanted) == 1 else ""
    return f"Typed in{goal}: {', '.join(said)}."


def _short(source: Mapping[str, Any], record: Mapping[str, Any]) -> str:
    """A coefficient alone; the numbers of a parameter with several under its name."""
    values = [numbers.plain(value) for value in record["numbers"]]
    if len(values) == 1:
        return numbers.plain(record["numbers"][0], 4)
    whole = typed(source, record).partition("[")[0]
    return f"{whole} = ({', '.join(values)})" if "=" not in whole else typed(source, record, 4)


def _missed(run: Run, mode: str) -> str:
    """Which tolerances are missed at a level, and by which engines."""
    every, judged = runs.ran(run, mode), runs.judged(run)
    if not every or not judged:
        return ""
    by_names: dict[tuple[str, ...], list[str]] = {}
    for measure in judged:
        names = tuple(name for name in every if _failed(run, name, mode, measure))
        if names:
            by_names.setdefault(names, []).append(runs.measure_words(measure))
    if not by_names:
        what = _ALL.get(len(judged), f"all {len(judged)} tolerances are")
        return f"{what} met in {listing.engines(every, every)}"
    said = [
        f"{listing.joined(measures)} by {listing.engines(names, every)}"
        for names, measures in sorted(by_names.items(), key=lambda item: -len(item[0]))
    ]
    return f"missed: {'; '.join(said)}{_worst(run, mode)}"


def _failed(run: Run, name: str, mode: str, measure: str) -> bool:
    score = runs.score_of(run, name, mode, measure)
    return score is not None and score.verdict == FAIL


def _worst(run: Run, mode: str) -> str:
    """The value that is farthest from the truth, in tolerances."""
    found = [
        runs.score_of(run, name, mode, m) for m in runs.judged(run) for name in runs.names(run)
    ]
    shares = [
        (share, score)
        for score in found
        if score is not None and (share := runs.share_of_tolerance(run, score)) is not None
    ]
    if not shares:
        return ""
    share, score = max(shares, key=lambda pair: pair[0])
    off = abs((score.value or 0.0) - (score.truth or 0.0))
    if share <= 1:  # what was missed could not be measured
        return ""
    far = numbers.with_u(off, score.u, score.unit, score.truth, 2)
    return (
        f"; farthest is {score.source}, {runs.measure_words(score.measure)} off by {far},"
        f" {numbers.plain(share, 2)} times the tolerance"
    )


def _not_run(run: Run) -> str:
    """Engines that did not run at any level or at some, by what became of them."""
    by_status: dict[str, list[str]] = {}
    for row in runs.not_run(run):
        names = by_status.setdefault(row["status"], [])
        if row["name"] not in names:
            names.append(row["name"])
    if not by_status:
        return ""
    said = [f"{listing.joined(sorted(names))} ({status})" for status, names in by_status.items()]
    return f"Did not run: {'; '.join(said)}. The reasons are below."
