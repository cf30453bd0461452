"""How well the parameters of a scenario are known, and formulas of what follows from them."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import Field

from simcompare.model.frozen import Frozen


class KnownBy(Frozen):
    """How well one parameter is known.

    Attributes:
        u: as it is stated: "2%", "0.1mm" (standard), "±5g" (limits), "0.1mm, dof 4".
        reason: by what it was measured, or where that is written.
    """

    u: str | float = Field(description="such as 2%, 0.1mm (standard), ±5g (limits), '1g, dof 4'")
    reason: str = Field(min_length=10)


class Uncertain(Frozen):
    """What a scenario says of the uncertainty of its parameters.

    Attributes:
        inputs: parameter -> how well it is known. A fit of bounces takes gravity and drag from
            here. A per cent of a parameter that is 0 says nothing.
        formulas: result -> its closed form in the parameters, for many trials of Monte Carlo.
    """

    inputs: Mapping[str, KnownBy] = Field(default_factory=dict)
    formulas: Mapping[str, str] = Field(default_factory=dict)
