"""One way to a result, with its uncertainty of first order and by Monte Carlo."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from simcompare.propagation.inputs import Known
from simcompare.statistics.budget import Budget, budget, linear_budget
from simcompare.statistics.distributions import Distribution
from simcompare.statistics.joint import Correlation
from simcompare.statistics.monte_carlo import (
    Model,
    MonteCarlo,
    Validation,
    propagate,
    validation,
)

#: significant digits of u that are regarded as meaningful where first order is validated: how
#: well inputs are known is seldom known to more
DIGITS = 1


@dataclass(frozen=True)
class Asked:
    """What is asked of every way to a result.

    Attributes:
        known: the inputs.
        correlation: pairs of names -> coefficient.
        probability: that the value lies in an interval.
        trials: of Monte Carlo; ``None`` for as many as each way can afford.
        seed: of the draws.
    """

    known: Sequence[Known]
    correlation: Correlation
    probability: float = 0.95
    trials: int | None = None
    seed: int = 1

    @property
    def inputs(self) -> dict[str, Distribution]:
        """What is known of each input."""
        return {one.name: one.distribution for one in self.known}

    @property
    def ensembles(self) -> list[set[str]]:
        """Inputs that are correlated were read together: with as few degrees as the least has."""
        found: list[set[str]] = []
        for pair in self.correlation:
            joined = [one for one in found if one & set(pair)]
            found = [one for one in found if one not in joined]
            found.append(set(pair).union(*joined))
        finite = {name for name, degrees in self.degrees.items() if math.isfinite(degrees)}
        return [one for one in found if one & finite]

    @property
    def degrees(self) -> dict[str, float]:
        """Their degrees of freedom."""
        return {one.name: one.degrees_of_freedom for one in self.known}


@dataclass(frozen=True)
class Propagated:
    """A result with its uncertainty.

    Attributes:
        budget: of first order.
        monte_carlo: ``None`` where no trials were made.
        validation: of the first order by Monte Carlo, ``None`` without that.
        bent: inputs over which an engine's result bends or jumps within their uncertainty, so that
            first order says little.
    """

    budget: Budget
    monte_carlo: MonteCarlo | None = None
    validation: Validation | None = None
    bent: tuple[str, ...] = ()


def traced(asked: Asked, model: Callable[..., Any]) -> Budget:
    """The budget of a model that GTC can trace."""
    return budget(
        model, asked.inputs, degrees=asked.degrees, correlation=asked.correlation,
        ensembles=asked.ensembles, probability=asked.probability,
    )  # fmt: skip


def linear(
    asked: Asked,
    estimate: float,
    slopes: Mapping[str, float],
    more: Mapping[str, Distribution] | None = None,
) -> Budget:
    """The budget from sensitivities.

    Args:
        asked: the inputs.
        estimate: the result at their estimates.
        slopes: input -> sensitivity.
        more: further inputs, which are added to the result as they are.
    """
    more = more or {}
    return linear_budget(
        estimate, {**slopes, **dict.fromkeys(more, 1.0)}, {**asked.inputs, **more},
        degrees=asked.degrees, correlation=asked.correlation, ensembles=asked.ensembles,
        probability=asked.probability,
    )  # fmt: skip


def with_trials(asked: Asked, first: Budget, model: Model, trials: int | None) -> Propagated:
    """A budget beside the Monte Carlo of the same result."""
    found = propagate(
        model, asked.inputs, seed=asked.seed, trials=trials, probability=asked.probability,
        correlation=asked.correlation,
    )  # fmt: skip
    return Propagated(first, found, validation(first, found, digits=DIGITS))
