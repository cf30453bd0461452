"""Why engines go wrong as they come: what they hold of their own, as the audit shows it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from simcompare.model.answer import Cause
from simcompare.model.settings import TUNED
from simcompare.reports.run import audit, runs
from simcompare.reports.run.lead import Lead
from simcompare.reports.run.listing import joined, noun
from simcompare.results.run import Run


@dataclass(frozen=True)
class Shown:
    """A cause that the audit of engines shows.

    Attributes:
        says: the cause, in a few words.
        names: of the engines.
        is_set: whether the level tuned sets what is missing in each of them.
    """

    says: str
    names: tuple[str, ...]
    is_set: bool

    def text(self, wrong: Sequence[str], *, cure: bool = True, named: int = 99) -> str:
        """The cause and what to do about it.

        Args:
            wrong: engines of which it needs no saying that it is theirs, if it is that of all.
            cure: whether it is told what to do.
            named: more engines than this are counted.
        """
        few = len(self.names) <= named
        who = joined(self.names) if few else f"{len(self.names)} {noun(self.names)}"
        where = "" if list(self.names) == list(wrong) else f"in {who} "
        return f"{where}{self.says}{' (tuned sets it)' if cure and self.is_set else ''}"


def causes(run: Run, lead: Lead, mode: str, wrong: Sequence[str]) -> list[Shown]:
    """What the scenario names as causes, as far as the audit of engines shows them.

    Args:
        run: the run.
        lead: the leading measure.
        mode: the contact level.
        wrong: engines that are wrong there.
    """
    found = []
    for cause in lead.answer.causes if lead.answer else ():
        names = tuple(
            name
            for name in wrong
            if _keeps(run, name, mode, cause) and _changes(run, lead, mode, name)
        )
        if names:
            found.append(Shown(cause.says, names, _is_set(run, names, cause)))
    return found


def _is_set(run: Run, names: Sequence[str], cause: Cause) -> bool:
    ran = runs.ran(run, TUNED)
    return all(name in ran and not _keeps(run, name, TUNED, cause) for name in names)


def _changes(run: Run, lead: Lead, mode: str, name: str) -> bool:
    """Whether a value is another one where everything is set; else that was not its cause."""
    here, there = (runs.score_of(run, name, level, lead.measure) for level in (mode, TUNED))
    if here is None or there is None or here.value is None or there.value is None:
        return True
    return abs(here.value - there.value) > (lead.width or 0.0)


def _keeps(run: Run, name: str, mode: str, cause: Cause) -> bool:
    source = runs.source_of(run, name, mode)
    return source is not None and audit.keeps_its_own(source, cause.quantity)
