"""What is said of runs beside each other: what came out, what else differs, what did not run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from simcompare import glossary
from simcompare.comparison.comparison import FAIL, PASS
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.notation import capital
from simcompare.reports.compare.compared import Compared
from simcompare.reports.render.parts import KeyNumber
from simcompare.reports.render.tables import Table
from simcompare.reports.run import runs
from simcompare.reports.run.listing import engines, grouped, joined
from simcompare.results.records.run import SourceRecord

#: what may stand in a cell, and the word that explains it
_SIGNS = {"✓": PASS, "✗": FAIL, "(": "brackets", "–": "–"}

#: in how many runs a tolerance is met, and in how many it is judged
Count = tuple[int, int]
#: so many runs are listed one by one, and letters of their titles
_FEW, _SHORT = 4, 60
#: more engines than these at the end of a sentence are "the other …"
_NAMED = 2


def title(compared: Compared) -> str:
    """What is compared, in one line."""
    scenario = " and ".join(dict.fromkeys(run.record.title for run in compared.runs))
    count = len(compared.runs)
    if not compared.told:
        return f"{scenario}: {count} runs with the same settings"
    return f"{scenario}: {count} runs that differ in {joined([o.label for o in compared.told])}"


def short(compared: Compared, measure: str) -> tuple[str, ...]:
    """In how many runs each engine meets the tolerance of a measure, level by level."""
    found = ((level, _counts(compared, measure, level)) for level in _judged_levels(compared))
    return tuple(_met(measure, level, counts) for level, counts in found if counts)


def key_numbers(compared: Compared, measure: str) -> tuple[KeyNumber, ...]:
    """How many values of each level are within their tolerance."""
    numbers = []
    for level in _judged_levels(compared):
        counts = _counts(compared, measure, level).values()
        met, judged = (sum(column) for column in zip(*counts, strict=True)) if counts else (0, 0)
        if judged:
            verdict = PASS if met == judged else FAIL
            note = "values within the tolerance"
            numbers.append(KeyNumber(runs.mode_words(level), f"{met} of {judged}", note, verdict))
    return tuple(numbers)


def finding(compared: Compared, measure: str) -> str:
    """The same in a few words, such as "tuned 3 of 6, assisted 6 of 6 within the tolerance"."""
    met = [f"{one.label} {one.value}" for one in key_numbers(compared, measure)]
    return f"{', '.join(met)} within the tolerance" if met else "not judged"


def _judged_levels(compared: Compared) -> list[str]:
    return [level for level in compared.levels if level not in SHOWN_LEVELS]


def _counts(compared: Compared, measure: str, level: str) -> dict[str, Count]:
    """Engine -> in how many runs it is within its tolerance, and of how many that are judged."""
    counts = {}
    for name in compared.engines:
        scores = [runs.score_of(run, name, level, measure) for run in compared.runs]
        verdicts = [score.verdict for score in scores if score is not None]
        met, missed = verdicts.count(PASS), verdicts.count(FAIL)
        if met + missed:
            counts[name] = met, met + missed
    return counts


def _met(measure: str, level: str, counts: Mapping[str, Count]) -> str:
    pairs = ((count, name) for name, count in counts.items())
    groups = sorted(grouped(pairs).items(), key=lambda group: len(group[1]))
    *most, (count, last) = groups
    told = [f"{engines(names, list(counts))} in {_of(*of)}" for of, names in most]
    rest = f"the other {len(last)}" if most and len(last) > _NAMED else engines(last, list(counts))
    told.append(f"{rest} in {_of(*count)}")
    words = runs.measure_words(measure)
    return f"{capital(runs.mode_words(level))}, {words} within its tolerance: {'; '.join(told)}."


def _of(met: int, judged: int) -> str:
    return f"{met} of {judged} run{'s' * (judged > 1)}"


def notes(compared: Compared) -> tuple[str, ...]:
    """What the reader must know beside the numbers."""
    left_out = (f"Left out: {text}" for text in compared.left_out)
    return (*left_out, *_about_scenarios(compared), *_also(compared), *_beyond(compared),
            *_not_run(compared))  # fmt: skip


def _about_scenarios(compared: Compared) -> Iterator[str]:
    records = [run.record for run in compared.runs]
    if len(compared.scenarios) > 1:
        measured = joined([runs.measure_words(name) for name in compared.measures])
        yield f"The scenarios differ; only what all of them measure is compared: {measured}."
    elif len({record.scenario_sha256 for record in records}) > 1:
        yield "The file of the scenario changed between these runs; they may differ in more."
    if not compared.told:
        yield "Nothing that is stored differs between these runs; they should give the same."


def _also(compared: Compared) -> Iterator[str]:
    for one in compared.untold:
        every = [one.number(i) for i in range(len(compared.runs))]
        values = every if len(every) <= _FEW else dict.fromkeys(every)
        yield f"Also different: {one.label} ({'; '.join(values)})."


def _beyond(compared: Compared) -> Iterator[str]:
    """Why there is no truth in some runs."""
    pairs = zip(compared.runs, compared.titles, strict=True)
    known = ((" ".join(runs.beyond(run)), title) for run, title in pairs if runs.beyond(run))
    for reason, titles in grouped(known).items():
        yield f"Not judged {_where(compared, titles, 'in every run')}: {reason}"


def _not_run(compared: Compared) -> Iterator[str]:
    """Every reason once, with the engines, levels and runs that it is of."""
    pairs = [
        ((source.reason or source.status).removeprefix(f"{source.name}: "), (source, title))
        for run, title in zip(compared.runs, compared.titles, strict=True)
        for source in run.record.sources
        if not source.ran
    ]
    by_names = grouped(
        (_named(compared, [source for source, _ in places]), (reason, places))
        for reason, places in grouped(pairs).items()
    )
    for names, reasons in by_names.items():
        titles = list(dict.fromkeys(title for _, places in reasons for _, title in places))
        where = _where(compared, titles, "in any run")
        first = "" if len(reasons) == 1 else f"; {titles[0]}"
        yield f"{names} did not run {where}{first}: {reasons[0][0]}"


def _named(compared: Compared, sources: Sequence[SourceRecord]) -> str:
    """Engines with their levels."""
    levels = grouped((source.name, source.contact) for source in sources)
    return joined([_at(compared, name, list(dict.fromkeys(at))) for name, at in levels.items()])


def _at(compared: Compared, name: str, levels: list[str]) -> str:
    """An engine with its levels, where these are not all that there are."""
    records = [source for run in compared.runs for source in run.record.sources]
    every = {source.contact for source in records if source.name == name}
    return name if every <= set(levels) else f"{name} {'/'.join(levels)}"


def _where(compared: Compared, titles: list[str], everywhere: str) -> str:
    """In which runs."""
    if len(titles) == len(compared.runs):
        return everywhere
    text = "; ".join(titles)
    return f"({text})" if len(text) <= _SHORT else f"in {len(titles)} of {len(compared.runs)} runs"


def legend(compared: Compared, shown: Iterable[Table]) -> tuple[str, ...]:
    """A line for each level and each sign in the tables."""
    cells = [c for table in shown for group in table.groups for row in group.rows for c in row]
    signs = {sign: word for sign, word in _SIGNS.items() if any(sign in cell for cell in cells)}
    words = [level for level in compared.levels if level in glossary_words()]
    lines = list(glossary.legend(words))
    for sign, word in signs.items():
        line = glossary.legend([word])[0]
        lines.append(f"{sign} {line}" if word in (PASS, FAIL) else line)
    return tuple(lines)


def glossary_words() -> set[str]:
    """Words that are explained."""
    return {term.word for term in glossary.terms()}


def common_folder(compared: Compared) -> Path:
    """The folder that holds the runs; the current one where they lie apart or are not stored."""
    parents = {None if run.folder is None else run.folder.parent for run in compared.runs}
    parent = parents.pop() if len(parents) == 1 else None
    return Path() if parent is None else parent
