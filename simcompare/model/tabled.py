"""How a table of results is read for a scenario: one experiment in each row."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from simcompare.model.frozen import Frozen


class TabledColumn(Frozen):
    """What a column that holds a parameter or a measured value may be called.

    Attributes:
        called: other names than our own; single letters count as they are written.
        counted: what is counted where one time is that of many, such as swings in "10 swings".
        event: which event of a value that is measured once per event, first is 1.
    """

    called: tuple[str, ...] = ()
    counted: tuple[str, ...] = ()
    event: Annotated[int, Field(ge=1)] | None = None


class Assumed(Frozen):
    """What is assumed of a parameter that a table does not tell.

    Attributes:
        value: number in SI, or an expression in the parameters.
        u: how well it is known, as in ``uncertainty:``; exact where nothing is said.
        reason: why so; what says nothing of the experiment, such as a duration, needs none.
    """

    value: float | str
    u: str | float | None = None
    reason: str = ""


class Tabled(Frozen):
    """What a scenario says of tables of results.

    Attributes:
        columns: parameter or result -> what a column of it is called.
        assume: parameter -> what is assumed where neither the table nor the user says it.
        tells: parameter that such a table tells by the closed form.
        offset: parameter of a column that may be off by the same amount in all rows.
    """

    columns: Mapping[str, TabledColumn] = Field(min_length=1)
    assume: Mapping[str, Assumed] = Field(default_factory=dict)
    tells: str | None = None
    offset: str | None = None
