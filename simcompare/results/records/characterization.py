"""What characterization.json says of a characterization."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.characterization.behaviour import Behaviour
from simcompare.results.records.answered import Answered
from simcompare.running.jobs import exit_code_of


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
class Characterization(Answered):
    """What the experiments found.

    Attributes:
        step_s: the engine's step [s].
        experiments: their names.
        contact: contact levels.
        sentences: what there is to see.
        answers: what each engine did.
    """

    title: str = "How engines behave"
    question: str = (
        "What does each engine make of a bounce, of friction, of a joint and of a force, at which"
        " step and speed?"
    )
    step_s: float
    experiments: tuple[str, ...]
    contact: tuple[str, ...]
    sentences: tuple[Sentence, ...]
    answers: tuple[Trial, ...]

    @property
    def exit_code(self) -> int:
        """0 fine, 3 an engine is broken, or one that was named is missing."""
        statuses = [trial.status for trial in self.answers]
        return exit_code_of(statuses, self.engines_asked, out_of_reach=True)
