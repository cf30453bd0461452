"""Every value of runs beside each other as one long table, a row each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from simcompare.reports.compare.compared import Compared
from simcompare.reports.run import runs
from simcompare.results.run import Run

if TYPE_CHECKING:
    import pandas as pd

#: columns behind those that name the run and what differs
_COLUMNS = ("engine", "version", "contact", "measure", "unit", "value", "scatter", "u", "truth",
            "tolerance", "verdict")  # fmt: skip
#: what stands in the first line of each file of such rows
MARK = f",{','.join(_COLUMNS)}\n".encode()


def frame(compared: Compared, measures: Sequence[str]) -> pd.DataFrame:
    """A row for each run, engine, level and measure; what differs is in columns, in SI.

    An engine that did not run has no values; why, stands in the column of the verdict.
    """
    import pandas as pd

    heads = [one.name for one in compared.differences]
    rows = [
        [title, *(one.values[i] for one in compared.differences), *row]
        for i, (title, run) in enumerate(zip(compared.titles, compared.runs, strict=True))
        for measure in measures
        for row in _of_run(run, measure)
    ]
    return pd.DataFrame(rows, columns=["run", *heads, *_COLUMNS])


def _of_run(run: Run, measure: str) -> Iterator[list[Any]]:
    for source in run.record.sources:
        whose = [source.name, source.version, source.contact, measure]
        score = runs.score_of(run, source.name, source.contact, measure)
        if score is not None:
            yield [*whose, score.unit, score.value, score.scatter, score.u, score.truth,
                   score.tolerance, score.verdict]  # fmt: skip
        elif not source.ran:
            yield [*whose, "", None, None, None, None, None, source.status]
