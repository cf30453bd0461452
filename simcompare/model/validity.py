"""WHERE the truth of a scenario holds: conditions between numbers of its parameters."""

from __future__ import annotations

from pydantic import Field, field_validator

from simcompare.model.answer import VALUE, placeholders
from simcompare.model.frozen import Frozen
from simcompare.notation import sentence

#: what stands for the largest value at which the truth holds
LIMIT = "limit"


class Condition(Frozen):
    """A value up to which the truth of a scenario holds, and what happens beyond.

    ``{value}`` and ``{limit}`` in ``otherwise`` stand for both, each with the unit.
    """

    value: float
    at_most: float
    unit: str = Field("1", description="of both, as it is printed; 1 for none")
    otherwise: str = Field(min_length=10, description="what happens beyond, and why")

    @field_validator("otherwise")
    @classmethod
    def _can_be_filled(cls, text: str) -> str:
        for name in placeholders(text):
            if name not in (VALUE, LIMIT):
                raise ValueError(
                    f"{{{name}}} stands for nothing; expected {{{VALUE}}}, {{{LIMIT}}}"
                )
        return text

    @property
    def is_broken(self) -> bool:
        """Whether the truth does not hold."""
        return self.value > self.at_most

    @property
    def said(self) -> str:
        """What happens beyond, as a sentence."""
        value, limit = (self._number(one) for one in (self.value, self.at_most))
        return sentence(self.otherwise.format(**{VALUE: value, LIMIT: limit}))

    def _number(self, value: float) -> str:
        return f"{value:.3g}" + ("" if self.unit == "1" else f" {self.unit}")
