"""What every answer says that is stored in a folder of its own and is no run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from simcompare.results.records.run import Software


@dataclass(frozen=True, kw_only=True)
class Answered:
    """An answer to a question.

    Attributes:
        format: version of what is stored.
        created: date and time, ISO 8601.
        title: of the page.
        question: that is answered.
        engines_asked: the engines as the user named them.
        software: versions.
        folder: where it is stored, ``None`` where it is not.
    """

    format: int = 1
    created: str
    title: str
    question: str
    engines_asked: str = ""
    software: Software
    folder: Path | None = None
