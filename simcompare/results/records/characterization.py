"""What characterization.json says of a characterization."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from simcompare.characterization.behaviour import Behaviour
from simcompare.results.records.run import Software
from simcompare.running.jobs import exit_code_of

#: version of what is stored
FORMAT = 1


@dataclass(frozen=True)
class Sentence:
    """What there is to see.

    Attributes:
        experiment: in which one.
        text: the sentence.
        leads: whether it stands at the top of the page.
    """

    experiment: str
    text: str
    leads: bool


@dataclass(frozen=True)
class Trial:
    """One engine in one experiment at one contact level.

    Attributes:
        engine: its name.
        version: its version, ``None`` where it is not installed.
        experiment: name of the experiment.
        contact: contact level.
        status: "ok", "unsupported", "missing" or "failed".
        reason: one sentence where the status is not "ok".
        found: what the engine did, where the status is "ok".
    """

    engine: str
    version: str | None
    experiment: str
    contact: str
    status: str
    reason: str | None = None
    found: Behaviour | None = None


@dataclass(frozen=True, kw_only=True)
class Characterization:
    """What the experiments found.

    Attributes:
        format: version of what is stored.
        created: date and time, ISO 8601.
        title: of the page.
        question: that the experiments ask.
        step_s: the engine's step [s].
        experiments: their names.
        contact: contact levels.
        engines_asked: the engines as the user named them.
        sentences: what there is to see.
        answers: what each engine did.
        software: versions.
        folder: where it is stored, ``None`` where it is not.
    """

    format: int = FORMAT
    created: str
    title: str = "How engines behave"
    question: str = (
        "What does each engine make of a bounce, of friction, of a joint and of a force, at which"
        " step and speed?"
    )
    step_s: float
    experiments: tuple[str, ...]
    contact: tuple[str, ...]
    engines_asked: str
    sentences: tuple[Sentence, ...]
    answers: tuple[Trial, ...]
    software: Software
    folder: Path | None = None

    @property
    def exit_code(self) -> int:
        """0 fine, 3 an engine is broken, or one that was named is missing."""
        statuses = [trial.status for trial in self.answers]
        return exit_code_of(statuses, self.engines_asked, out_of_reach=True)
