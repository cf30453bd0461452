"""What fit.json says of where an uncertainty comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

#: sources of uncertainty beside the unknowns that have a prior
DATA, LAW = "data", "choice of law"


@dataclass(frozen=True)
class Budget:
    """What each source adds to the uncertainty of one quantity of a closed form.

    Attributes:
        name: an unknown, or "restitution" of the fastest impact.
        u: its standard uncertainty of first order, over all laws by their weights.
        unit: of u.
        shares: source -> its part of u²: "data", unknowns that have a prior, "choice of law".
    """

    name: str
    u: float
    unit: str
    shares: Mapping[str, float]

    @property
    def largest(self) -> str:
        """The source with the largest share."""
        return max(self.shares, key=lambda source: self.shares[source])
