"""Tables of scores with their verdicts."""

from __future__ import annotations

from simcompare import notation
from simcompare.comparison.comparison import FAIL, INFO, PASS, Score
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import TRUTH
from simcompare.reports.render import numbers
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, of_engines
from simcompare.reports.run import runs
from simcompare.results.run import Run

#: never told by colour alone
_VERDICTS = {PASS: "✓ pass", FAIL: "✗ fail", INFO: "· shown"}


def scores(run: Run) -> Part | None:
    """Every value of a whole run: value ± s, truth, tolerance, verdict; ``None`` without any."""
    measures = runs.measures(run)
    if not measures:
        return None
    columns = [column for mode in runs.modes(run) for column in _columns(mode)]
    table = of_engines(columns, [_group(run, measure) for measure in measures])
    return Part(
        "Scores", "scores", notes=(_note(run),), tables=(table,), folded=True, finding=_finding(run)
    )


def _finding(run: Run) -> str:
    """How many tolerances were met at each level at which they are judged."""
    parts = []
    for mode in runs.modes(run):
        pairs = [runs.passed(run, name, mode) for name in runs.ran(run, mode)]
        met, of = sum(met for met, _ in pairs), sum(of for _, of in pairs)
        if of and mode not in SHOWN_LEVELS:
            parts.append(f"{runs.mode_words(mode)} {met} of {of} within the tolerance")
    return ", ".join(parts) or "every value of a whole run"


def _note(run: Run) -> str:
    repeats = run.record.repeats
    text = "There was a single repeat, so no scatter is known."
    if repeats > 1:
        text = (
            f"Each value is the mean over {repeats} repeats, s their standard deviation: how far a"
            " single run would scatter, not a bound of its error. The standard uncertainty of the"
            f" mean is u = s/√{repeats}; run.json and scores.csv hold both."
        )
    if any(score.truth is not None for score in run.record.scores):
        text += f" Deviations are from the {TRUTH}, sampled and measured in the same way."
    return (
        f"{text} What an engine does by default is shown and not judged: nobody gave it the"
        " scenario's physics."
    )


def _columns(mode: str) -> list[Column]:
    words = runs.mode_words(mode)
    judged = [
        Column("deviation ± s", spare=True, over=words),
        Column("of tolerance", spare=True, over=words),
        Column("verdict", text=True, nowrap=True, over=words),
    ]
    return [Column("value ± s", over=words), *(() if mode in SHOWN_LEVELS else judged)]


def _group(run: Run, measure: str) -> Group:
    measured = [s for s in run.record.scores if s.measure == measure and s.index is None]
    names = [source.name for source in run.record.sources if source.ran]
    rows = tuple(
        (name, *(cell for mode in runs.modes(run) for cell in _cells(run, name, mode, measure)))
        for name in dict.fromkeys(names)
    )
    title = runs.label(measure, measured[0].unit)
    return Group(title, rows, _accepted(run, measured))


def _accepted(run: Run, measured: list[Score]) -> str:
    """The truth of a measure, what is accepted about it, and why."""
    first = measured[0]
    # at other steps there may be other tolerances
    widths = [runs.width(run, score) for score in (measured if runs.steps(run) else [first])]
    accepted = dict.fromkeys(numbers.plain(width, 3) for width in widths if width is not None)
    text = "" if first.truth is None else f"truth {_truth(run, first)}"
    tolerance = run.record.tolerances.get(first.measure)
    if not accepted or tolerance is None:
        return text
    part = "" if tolerance.relative is None else f" ({numbers.percent(tolerance.relative)})"
    return f"{text}, tolerance ± {' or '.join(accepted)}{part}. {tolerance.reason}"


def _truth(run: Run, score: Score) -> str:
    places = notation.places(runs.width(run, score))
    return numbers.with_u(score.truth, None, scale=runs.size(run, score), places=places)


def _cells(run: Run, name: str, mode: str, measure: str) -> list[str]:
    score = runs.score_of(run, name, mode, measure)
    if score is None:
        cells = ["was not measured", "–", "–", "–"]
    else:
        share = numbers.percent(runs.share_of_tolerance(run, score))
        value, verdict = runs.value_words(run, score), _VERDICTS[score.verdict]
        cells = [value, _deviation(run, score), share, verdict]
    return cells[:1] if mode in SHOWN_LEVELS else cells


def _deviation(run: Run, score: Score) -> str:
    if score.value is None or score.truth is None:
        return "–"
    size, places = runs.size(run, score), notation.places(runs.width(run, score))
    deviation = score.value - score.truth
    return numbers.with_u(deviation, score.scatter, scale=size, digits=4, places=places)
