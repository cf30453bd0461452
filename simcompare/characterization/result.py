"""What a characterization found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simcompare.running.jobs import exit_code_of


@dataclass(frozen=True)
class Characterization:
    """What the experiments found.

    Attributes:
        record: what characterization.json holds; plain values.
        folder: where it is stored, ``None`` where it is not.
    """

    record: Mapping[str, Any]
    folder: Path | None = None

    @property
    def sentences(self) -> list[str]:
        """What there is to see, a sentence each."""
        return [one["text"] for one in self.record["sentences"]]

    @property
    def exit_code(self) -> int:
        """0 fine, 3 an engine is broken, or one that was named is missing."""
        statuses = [answer["status"] for answer in self.record["answers"]]
        return exit_code_of(statuses, self.record["engines_asked"], out_of_reach=True)
