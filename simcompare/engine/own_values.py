"""An engine's own contact values, by which somebody makes a body bounce by hand."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class OwnValue:
    """One number of an engine's contact that a user may type in.

    Attributes:
        name: what the engine calls it, without blanks, as it is typed.
        text: what it does, in one short sentence.
        unit: its unit, "1" where it is a plain number.
        value: that of the engine as it comes.
        min: smallest value that makes sense.
        max: largest value that makes sense.
        log: whether equal factors count alike, not equal differences.
        tuned: what it is where all else is given, and it is not typed; ``None``: it stands for a
            restitution, and is ``value`` then.
    """

    name: str
    text: str
    unit: str
    value: float
    min: float
    max: float
    log: bool = False
    tuned: float | None = None


def coefficient(name: str) -> OwnValue:
    """The one value of an engine that has a coefficient; engines come with 0."""
    text = "Part of its speed that a body keeps in a bounce, as this engine takes it."
    return OwnValue(name, text, "1", 0.0, 0.0, 1.0)
