"""The verb ``compare``: runs beside each other, one table and one figure of what differs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare.arguments import checked
from simcompare.errors import InputError
from simcompare.model import cells
from simcompare.reports import builder
from simcompare.reports.compare import page, rows, tables, words
from simcompare.reports.compare.compared import Compared, compared
from simcompare.reports.compare.figure import deviations, figure
from simcompare.reports.render import frames, matplotlib_, output
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.run.listing import joined
from simcompare.results import store, stored_runs
from simcompare.results.run import Run
from simcompare.verbs.damaged import told_as_damaged

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

Source = Run | str | Path
#: the page of a comparison, in the folder that holds the runs
PAGE = "comparison.html"
_MORE = "More: .table(measure), .plot(measure), .scores, .to_csv(path), .report()"


@dataclass(frozen=True, repr=False)
class Comparison(Shown):
    """Runs beside each other.

    A notebook shows one table and one figure of what differs. Besides::

        comparison = simcompare.compare(runs)
        comparison.plot("settling_time").savefig("settling.pdf")
        comparison.to_csv("sweep.csv")

    Attributes:
        compared: the runs in order, what differs, and their titles.
        measure: what table and figure show.
    """

    compared: Compared
    measure: str

    @property
    def measures(self) -> tuple[str, ...]:
        """What all runs measured, the leading one first."""
        return self.compared.measures

    @property
    def scores(self) -> pd.DataFrame:
        """A row for each run, engine, level and measure; what differs is in columns, in SI."""
        return rows.frame(self.compared, self.measures)

    @checked
    def table(self, measure: str | None = None) -> pd.DataFrame:
        """Engines and levels as rows, runs as columns, each value with its scatter and verdict.

        Args:
            measure: such as "restitution"; what leads where ``None``.

        Raises:
            UnknownName: not all runs measured it; names what they did.
        """
        return frames.frame(tables.runs_beside(self.compared, self._chosen(measure)))

    @checked
    def plot(self, measure: str | None = None, *, deviation: bool = False) -> Figure:
        """The measure over the one number in which runs differ, else run by run.

        Args:
            measure: such as "restitution"; what leads where ``None``.
            deviation: whether it is drawn less its truth, where that changes by much more than
                its tolerance.

        Raises:
            UnknownName: not all runs measured it; names what they did.
        """
        chosen = self._chosen(measure)
        off = deviations(self.compared, chosen) if deviation else None
        return matplotlib_.canvas(off or figure(self.compared, chosen))

    @checked
    def to_csv(self, path: str | Path) -> Path:
        """Writes :attr:`scores` as a CSV file and returns its place.

        An apostrophe stands before a name that a spreadsheet would take for a formula.

        Raises:
            OutputError: it cannot be written.
        """
        table = self.scores.map(cells.cell).rename(columns=cells.cell)
        text = table.to_csv(index=False, lineterminator="\n")
        return output.write(Path(path), text.encode("utf-8"), rows.MARK)

    @checked
    def report(self, out: str | Path | None = None) -> Path:
        """Writes table and figure of every measure as one HTML page and returns its place.

        Args:
            out: the file; in the folder that holds the runs where ``None``.

        Raises:
            OutputError: it cannot be written.
        """
        path = words.common_folder(self.compared) / PAGE if out is None else Path(out)
        return builder.write_html_of([page.block_of(self.compared, self.measure)], path)

    def _chosen(self, measure: str | None) -> str:
        if measure is not None:
            self.compared.check(measure)
        return measure or self.measure

    def _glance(self) -> Glance:
        table = tables.one_table(self.compared, self.measure)
        return Glance(
            title=words.title(self.compared),
            sentences=words.short(self.compared, self.measure),
            legend=words.legend(self.compared, [table]),
            table=table,
            notes=words.notes(self.compared),
            figure=figure(self.compared, self.measure),
            more=_MORE,
        )


@checked
def compare(runs: Source | Sequence[Source], measure: str | None = None) -> Comparison:
    """Puts runs beside each other and finds what differs between them.

    ::

        heights = ("0.3m", "1m", "2m")
        runs = [simcompare.run("ball", engine="pymunk", set={"drop_height": h}) for h in heights]
        simcompare.compare(runs).plot()

    Args:
        runs: results of ``run``, folders of stored runs, or folders that hold such folders.
        measure: what table and figure show, such as "restitution"; what the scenario asks for
            where ``None``.

    Raises:
        InputError: fewer than two runs, a damaged one, or runs that measured nothing alike.
        UnknownName: not all runs measured it; names what they did.
    """
    listed = [runs] if isinstance(runs, Run | str | Path) else [*runs]
    read = [one for source in listed for one in _read(source)]
    given = {_key(run): run for run in read if isinstance(run, Run)}
    stored = [one.folder for one in given.values() if one.folder is not None]
    with told_as_damaged(stored, "comparison"):
        found = compared(list(given.values()), [text for text in read if isinstance(text, str)])
    if measure is not None:
        found.check(measure)
    return Comparison(found, measure or found.measures[0])


def _key(run: Run) -> Path | int:
    """What tells whether a run is given twice."""
    return id(run) if run.folder is None else run.folder.resolve()


def _read(source: Source) -> Iterator[Run | str]:
    """A run, or all that a folder holds; what is no run there is told in a sentence."""
    if isinstance(source, Run):
        yield source
        return
    place = Path(source)
    inside = [] if stored_runs.is_run(place) or not place.is_dir() else stored_runs.of(place)
    if not inside:
        yield store.load_record(place)
    for one in reversed(inside):
        if one.record is None:
            yield f"{one.folder.name} is damaged: {one.fault}."
        elif one.record.kind == "run":
            yield Run(one.record, (), one.folder)
    kinds = Counter(one.record.kind for one in inside if one.record and one.record.kind != "run")
    if not kinds:
        return
    others = joined([f"{count} {kind}{'s' * (count > 1)}" for kind, count in kinds.items()])
    if kinds.total() == len(inside):
        fault = f"holds {others}, and no run; expected runs, or a folder that holds them"
        raise InputError(str(place), [fault])
    yield f"{others} in {place}."
