"""What a report shows, as a tree of plain values, for HTML, Markdown and PDF alike."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from simcompare.notation import sentence
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.replays import Replay
from simcompare.reports.render.tables import Table, printable
from simcompare.results.run import Run


@dataclass(frozen=True)
class KeyNumber:
    """One of the few numbers that a report begins with.

    Attributes:
        label: what it is of, such as "tuned".
        value: the number with its unit, or a word such as "stands still".
        note: a few words below it, such as how many engines are within the tolerance.
        verdict: "pass", "fail" or empty, where nothing is judged.
    """

    label: str
    value: str
    note: str = ""
    verdict: str = ""


@dataclass(frozen=True)
class Part:
    """A part of a report; parts may hold parts. See ``items`` for the order on the page.

    Attributes:
        title: its heading, empty for none.
        name: short name of a section, for anchors.
        short: the answer in at most 40 words, above everything else.
        key_numbers: at most three or four numbers, beside each other below it.
        answer: the answer in full sentences; below the first figure where there is a short one.
        notices: what the reader must not miss.
        figures: what is drawn.
        replays: scenes that can be played, below the figures.
        remarks: sentences below the first figure.
        facts: values by their names.
        notes: sentences.
        code: what was typed or printed.
        tables: of numbers and words.
        parts: parts of this part.
        folded: whether it is only wanted by few readers.
        finding: what is found in it, in a few words behind the title of what is folded.
        brief: whether it stands in Markdown too.
    """

    title: str = ""
    name: str = ""
    short: tuple[str, ...] = ()
    key_numbers: tuple[KeyNumber, ...] = ()
    answer: tuple[str, ...] = ()
    notices: tuple[str, ...] = ()
    figures: tuple[Figure, ...] = ()
    replays: tuple[Replay, ...] = ()
    remarks: tuple[str, ...] = ()
    facts: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    code: str = ""
    tables: tuple[Table, ...] = ()
    parts: tuple[Part, ...] = ()
    folded: bool = False
    finding: str = ""
    brief: bool = True

    @property
    def items(self) -> list[tuple[str, Any]]:
        """All that it holds, from top to bottom, each with the name of its kind.

        A part with a short answer is one screen: that, a few numbers and a figure. The table that
        leads and all sentences stand below.
        """
        leads = bool(self.short)
        figures, tables = _each("figure", self.figures), _each("table", self.tables)
        answer, remarks = _each("answer", self.answer), _each("remark", self.remarks)
        numbers = [("numbers", self.key_numbers)] if self.key_numbers else []
        above = [*_each("short", self.short), *numbers, *([] if leads else answer)]
        below = [*(tables[:1] + figures[1:] + answer if leads else []), *remarks]
        rest = [] if leads else figures[1:]
        facts = [("facts", self.facts)] if self.facts else []
        code = [("code", self.code)] if self.code else []
        return [
            *above, *_each("notice", self.notices), *figures[:1], *below, *rest,
            *_each("replay", self.replays), *facts,
            *_each("note", self.notes), *code, *tables[1 if leads else 0 :],
            *_each("part", self.parts),
        ]  # fmt: skip

    @property
    def every_figure(self) -> list[Figure]:
        """Its figures and those of its parts."""
        return [*self.figures, *(one for part in self.parts for one in part.every_figure)]

    @property
    def every_replay(self) -> list[Replay]:
        """Its replays and those of its parts."""
        return [*self.replays, *(one for part in self.parts for one in part.every_replay)]

    @property
    def every_table(self) -> list[Table]:
        """Its tables and those of its parts."""
        return [*self.tables, *(one for part in self.parts for one in part.every_table)]

    @property
    def has_text(self) -> bool:
        """Whether there is more to show than figures."""
        kinds = {kind for kind, _ in self.items} - {"figure", "part"}
        return bool(kinds) or any(part.has_text for part in self.parts)


def _each(kind: str, values: Iterable[Any]) -> list[tuple[str, Any]]:
    return [(kind, value) for value in values]


#: what makes a part of a report out of a run; ``None`` where there is nothing to show
Section = Callable[[Run], Part | None]


def part_of(
    title: str,
    name: str,
    figures: Iterable[Figure | None] = (),
    tables: Iterable[Table | None] = (),
    notes: Iterable[str] = (),
    answer: Iterable[str] = (),
    facts: Mapping[str, str] | None = None,
    finding: str | None = None,
) -> Part:
    """Figures, tables and sentences of a section, as far as there are any; texts on one line.

    A section with a finding, which may be empty, is folded.
    """
    return Part(
        title,
        name,
        answer=tuple(map(printable, answer)),
        figures=tuple(figure for figure in figures if figure is not None),
        facts=facts or {},
        notes=tuple(sentence(printable(note)) for note in notes if note),
        tables=tuple(table for table in tables if table is not None),
        folded=finding is not None,
        finding=finding or "",
    )


@dataclass(frozen=True)
class Block:
    """One run, or whatever else a report shows by itself.

    Attributes:
        anchor: prefix of everything that is linked to in this block.
        name: what the names of its files start with.
        title: above everything, with what kind of report it is.
        question: below it.
        settings: how it was made, on one line.
        made_with: the same in a few sentences, folded behind that line.
        origin: what tells it from other blocks of the same title, such as when it was made.
        version: of simcompare, with which it was made.
        parts: its sections, the answer first.
    """

    anchor: str
    name: str
    title: str
    question: str
    origin: str
    version: str | None
    parts: tuple[Part, ...]
    settings: str = ""
    made_with: tuple[str, ...] = ()

    @property
    def figures(self) -> list[Figure]:
        """Every figure."""
        return [figure for part in self.parts for figure in part.every_figure]

    @property
    def has_replay(self) -> bool:
        """Whether anything in it can be played."""
        return any(part.every_replay for part in self.parts)

    def part(self, name: str) -> Part:
        """The section of a name."""
        return next(part for part in self.parts if part.name == name)
