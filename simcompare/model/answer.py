"""WHAT a scenario is asked: the measure that leads its report, and how its answer is said."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from string import Formatter

from pydantic import Field

from simcompare.errors import UnknownName
from simcompare.model.frozen import Frozen

#: what stands for the leading measure in the templates of an answer
VALUE = "value"


class Cause(Frozen):
    """Why engines miss the truth as they come: they hold a value of their own."""

    quantity: str = Field(description="as in the audit: a-b friction, joint.friction, sleep, …")
    says: str = Field(min_length=1, description="the cause, in a few words")


class Answer(Frozen):
    """The leading measure, and half a sentence for each thing that can become of it.

    ``nothing`` says in words what does not happen; its value is 0.
    Without ``outside`` that of ``within`` is said there as well, so it must not say "right".
    ``{value}`` stands for the leading measure, ``{name}`` for another one. The words ``in`` and
    the names of engines follow, so each template must also be true of several engines: "the ball
    stays on the floor", not "the ball does not bounce".
    """

    measure: str = Field(description="the measure that leads the report")
    within: str = Field(min_length=1, description="said where the value is within its tolerance")
    outside: str | None = Field(None, min_length=1, description="said where it is not")
    nothing: str | None = Field(
        None, min_length=1, description="said where it is 0 in every repeat, and wrong"
    )
    causes: tuple[Cause, ...] = ()

    def half_sentence(self, kind: str) -> str | None:
        """What is said of one kind; ``None`` where the scenario leaves that to the report."""
        if kind == "nothing":
            return self.nothing
        return self.within if kind == "within" else self.outside or self.within

    def faults(self, measured: Collection[str], held: Collection[str]) -> dict[str, str]:
        """What in it points to nothing, as place -> sentence.

        Args:
            measured: names of all that is measured.
            held: quantities of contacts and joints that engines are asked for.
        """
        found = {}
        if self.measure not in measured:
            found["measure"] = str(UnknownName("measured value", self.measure, measured))
        for key in ("within", "outside", "nothing"):
            try:
                used = list(placeholders(getattr(self, key) or ""))
            except ValueError as error:
                found[key] = f"{error}; expected placeholders such as {{{VALUE}}}"
                continue
            for name in used:
                if name not in (*measured, VALUE):
                    known = (VALUE, *measured)
                    found[key] = str(UnknownName("measured value", name, known))
                if key == "nothing" and name in (VALUE, self.measure):
                    found[key] = f"takes no {{{name}}}, which is 0 here; say it in words alone"
        for i, cause in enumerate(self.causes):
            if cause.quantity not in held:
                wrong = UnknownName("quantity of a contact or joint", cause.quantity, held)
                found[f"causes.{i}.quantity"] = str(wrong)
        return found


def placeholders(template: str) -> Iterator[str]:
    """Names in braces.

    Raises:
        ValueError: a brace has no partner, or more than a name stands in one: how a value is
            written follows from its tolerance.
    """
    try:
        parts = list(Formatter().parse(template))
    except ValueError:
        raise ValueError("a { or } stands alone") from None
    for _, name, form, conversion in parts:
        if form or conversion:
            raise ValueError(f"{{{name}}} takes no format")
        if name is not None:
            yield name
