"""Uncertainty budgets of first order with degrees of freedom (JCGM 100:2008), through GTC.

GTC (the GUM Tree Calculator of MSL, New Zealand) traces a formula and adds its inputs' shares by
the Welch-Satterthwaite formula, also where inputs were read together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.model.plain import Finite
from simcompare.statistics.distributions import Distribution, Kind
from simcompare.statistics.joint import Correlation, correlation_matrix


@dataclass(frozen=True)
class Row:
    """What one input adds to the uncertainty of a result.

    Attributes:
        name: of the input.
        estimate: its best estimate.
        u: its standard uncertainty; of a mean of n readings, s/√n.
        distribution: the shape of what is known of it.
        degrees_of_freedom: how well u is known, infinite where it is taken as exact.
        sensitivity: change of the result over change of the input.
        contribution: size of sensitivity times u, in the result's unit.
        share: of the combined variance; correlated inputs may take some away.
    """

    name: str
    estimate: float
    u: float
    distribution: Kind
    degrees_of_freedom: Finite
    sensitivity: float
    contribution: float
    share: float


@dataclass(frozen=True)
class Budget:
    """A result with its uncertainty, and what each input adds to it.

    Attributes:
        estimate: the result at the inputs' best estimates.
        u: combined standard uncertainty.
        degrees_of_freedom: effective ones (Welch-Satterthwaite).
        probability: that the value lies within estimate ± expanded.
        k: coverage factor for it, from Student's t distribution.
        expanded: expanded uncertainty U = k·u.
        rows: one for each input, in the order in which they were given.
    """

    estimate: float
    u: float
    degrees_of_freedom: Finite
    probability: float
    k: float
    expanded: float
    rows: tuple[Row, ...]

    @property
    def interval(self) -> tuple[float, float]:
        """The coverage interval, symmetric about the estimate."""
        return self.estimate - self.expanded, self.estimate + self.expanded

    @property
    def largest_first(self) -> tuple[Row, ...]:
        """The rows by their shares."""
        return tuple(sorted(self.rows, key=lambda row: -abs(row.share)))


def budget(
    model: Callable[..., Any],
    inputs: Mapping[str, Distribution],
    *,
    degrees: Mapping[str, float] | None = None,
    correlation: Correlation | None = None,
    ensembles: Sequence[Collection[str]] = (),
    probability: float = 0.95,
) -> Budget:
    """The budget of a formula; GTC traces it, so that no step has to be chosen.

    ::

        budget(lambda v, i: v / i, {"v": normal(5, 0.01), "i": student_t(0.02, 1e-4, 4)})

    Args:
        model: called with one number of GTC for each input, by name. It may add, multiply, divide
            and raise to powers, and call ``GTC.sqrt``, ``GTC.cos`` and the like.
        inputs: what is known of each. A mean of readings is a ``student_t``, whose scale is s/√n.
        degrees: degrees of freedom of other inputs' u, where it is not taken as exact.
        correlation: pairs of names -> coefficient; others are independent.
        ensembles: names that were read together, in the same readings. Correlated inputs with few
            degrees of freedom need one.
        probability: that of the expanded uncertainty.

    Raises:
        InputError: an impossible correlation or probability, or a u that is infinite.
    """
    import GTC

    numbers = _numbers(inputs, degrees or {}, correlation or {}, ensembles)
    result = model(**numbers)
    result = result if isinstance(result, GTC.lib.UncertainReal) else GTC.constant(float(result))
    slopes = {
        name: float(GTC.rp.sensitivity(result, one)) if u_of(inputs[name]) else 0.0
        for name, one in numbers.items()
    }
    return _budget(result, slopes, inputs, degrees or {}, correlation or {}, probability)


def linear_budget(
    estimate: float,
    sensitivities: Mapping[str, float],
    inputs: Mapping[str, Distribution],
    *,
    degrees: Mapping[str, float] | None = None,
    correlation: Correlation | None = None,
    ensembles: Sequence[Collection[str]] = (),
    probability: float = 0.95,
) -> Budget:
    """The budget of a result whose sensitivities are known already, such as those of an engine.

    Args:
        estimate: the result at the inputs' best estimates.
        sensitivities: name -> change of the result over change of the input.
        inputs: what is known of each.
        degrees: as for :func:`budget`.
        correlation: pairs of names -> coefficient.
        ensembles: names that were read together.
        probability: that of the expanded uncertainty.

    Raises:
        InputError: as for :func:`budget`.
    """

    def model(**numbers: Any) -> Any:  # noqa: ANN401
        moved = [sensitivities[name] * (x - inputs[name].center) for name, x in numbers.items()]
        return sum(moved, estimate)

    return budget(
        model, inputs, degrees=degrees, correlation=correlation, ensembles=ensembles,
        probability=probability,
    )  # fmt: skip


def u_of(known: Distribution) -> float:
    """Standard uncertainty in a budget: of a mean of readings s/√n, whatever their number."""
    return known.scale if known.kind == "student_t" else known.u


def coverage_factor(degrees_of_freedom: float, probability: float = 0.95) -> float:
    """K for a probability, from Student's t distribution (JCGM 100:2008, G.3)."""
    from scipy import stats

    return float(stats.t.ppf((1 + probability) / 2, degrees_of_freedom))


def _numbers(
    inputs: Mapping[str, Distribution],
    degrees: Mapping[str, float],
    correlation: Correlation,
    ensembles: Sequence[Collection[str]],
) -> dict[str, Any]:
    """The inputs as numbers of GTC, correlated."""
    import GTC

    _check(inputs, degrees, correlation, ensembles)
    related = {name for pair in correlation for name in pair}
    numbers: dict[str, Any] = {}
    for names in ensembles:
        numbers |= _together(names, inputs, degrees)
    for name, known in inputs.items():
        if name not in numbers:
            numbers[name] = GTC.ureal(
                known.center, u_of(known), degrees_of(name, inputs, degrees), label=name,
                independent=name not in related,
            )  # fmt: skip
    for (one, other), r in correlation.items():
        if u_of(inputs[one]) and u_of(inputs[other]):
            GTC.set_correlation(r, numbers[one], numbers[other])
    return {name: numbers[name] for name in inputs}


def _together(
    names: Collection[str], inputs: Mapping[str, Distribution], degrees: Mapping[str, float]
) -> dict[str, Any]:
    import GTC

    numbers = GTC.multiple_ureal(
        [inputs[name].center for name in names],
        [u_of(inputs[name]) for name in names],
        min(degrees_of(name, inputs, degrees) for name in names),
        label_seq=list(names),
    )
    return dict(zip(names, numbers, strict=True))


def degrees_of(
    name: str, inputs: Mapping[str, Distribution], degrees: Mapping[str, float]
) -> float:
    """Degrees of freedom of an input's u: as given, else its distribution's."""
    return degrees.get(name, inputs[name].degrees_of_freedom)


def _check(
    inputs: Mapping[str, Distribution],
    degrees: Mapping[str, float],
    correlation: Correlation,
    ensembles: Sequence[Collection[str]],
) -> None:
    correlation_matrix(inputs, correlation)
    asked = [*degrees, *(name for names in ensembles for name in names)]
    faults = [
        f"there is no input {name!r}; expected some of {', '.join(inputs)}"
        for name in dict.fromkeys(asked)
        if name not in inputs
    ]
    faults += [
        f"{name}: {given:g} are no degrees of freedom; expected a number of at least 1"
        for name, given in degrees.items()
        if not given >= 1
    ]
    if not faults:
        faults += [
            f"{one} and {other} are correlated and have few degrees of freedom; "
            "name them in one of the ensembles"
            for one, other in correlation
            if any(math.isfinite(degrees_of(name, inputs, degrees)) for name in (one, other))
            and not any(one in names and other in names for names in ensembles)
        ]
    if faults:
        raise InputError("budget", faults)


def _budget(
    result: Any,  # noqa: ANN401
    slopes: Mapping[str, float],
    inputs: Mapping[str, Distribution],
    degrees: Mapping[str, float],
    correlation: Correlation,
    probability: float,
) -> Budget:
    if not 0 < probability < 1:
        raise InputError(
            "budget", [f"probability {probability:g} is none; expected one between 0 and 1"]
        )
    k = coverage_factor(result.df, probability) if result.u else coverage_factor(math.inf)
    parts = np.array([slopes[name] * u_of(inputs[name]) for name in inputs])
    shares = parts * (correlation_matrix(inputs, correlation) @ parts)
    whole = float(shares.sum())
    rows = tuple(
        Row(
            name, known.center, u_of(known), known.kind, degrees_of(name, inputs, degrees),
            slopes[name], abs(float(part)), float(share) / whole if whole > 0 else 0.0,
        )
        for (name, known), part, share in zip(inputs.items(), parts, shares, strict=True)
    )  # fmt: skip
    return Budget(
        float(result.x), float(result.u), float(result.df), probability, k, k * float(result.u),
        rows,
    )  # fmt: skip
