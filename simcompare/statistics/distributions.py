"""Probability distributions of input quantities (JCGM 101:2008, table 1).

What is known of a quantity is its distribution. Each of these has a best estimate, a standard
uncertainty, and draws numbers; all are values that can be compared and stored.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from simcompare.model.trajectory import Array

Kind = Literal[
    "fixed", "normal", "rectangular", "triangular", "u_shaped", "truncated_normal", "student_t"
]


@dataclass(frozen=True)
class Distribution:
    """What is known of one quantity; made by the functions of this module.

    Attributes:
        kind: its shape.
        center: best estimate; all these shapes are symmetric about it.
        scale: standard deviation before truncation of "normal" and "truncated_normal", scale of
            "student_t", 0 of the others.
        half_width: largest distance from the centre, infinite of "normal" and "student_t".
        degrees_of_freedom: of "student_t", infinite of the others.
    """

    kind: Kind
    center: float
    scale: float = 0.0
    half_width: float = math.inf
    degrees_of_freedom: float = math.inf

    @property
    def u(self) -> float:
        """Standard uncertainty, the standard deviation; infinite of a t with 2 or fewer degrees."""
        match self.kind:
            case "fixed":
                return 0.0
            case "normal":
                return self.scale
            case "student_t":
                v = self.degrees_of_freedom
                return self.scale * math.sqrt(v / (v - 2)) if v > 2 else math.inf
            case "truncated_normal":
                return _truncated_u(self.scale, self.half_width)
        return self.half_width / math.sqrt(_DIVISORS[self.kind])

    def draw(self, generator: np.random.Generator, size: int | tuple[int, ...]) -> Array:
        """Independent values of that many, or of that shape."""
        return np.asarray(self.center + _deviations(self, generator, size), dtype=float)

    def scaled(self, factor: float, shift: float = 0.0) -> Distribution:
        """What is known of ``factor``·x + ``shift``."""
        size = abs(factor)
        return Distribution(
            self.kind, self.center * factor + shift, self.scale * size,
            self.half_width * size, self.degrees_of_freedom,
        )  # fmt: skip


#: half-width² over variance
_DIVISORS = {"rectangular": 3.0, "triangular": 6.0, "u_shaped": 2.0}


def fixed(value: float) -> Distribution:
    """A number that is taken as exact."""
    return Distribution("fixed", value, half_width=0.0)


def normal(center: float, u: float) -> Distribution:
    """A best estimate with its standard uncertainty."""
    return Distribution("normal", center, _positive(u))


def rectangular(low: float, high: float) -> Distribution:
    """Any value between two limits, none more likely: u = a/√3."""
    return Distribution("rectangular", *_between(low, high))


def triangular(low: float, high: float) -> Distribution:
    """Between two limits, most likely in the middle: u = a/√6."""
    return Distribution("triangular", *_between(low, high))


def u_shaped(low: float, high: float) -> Distribution:
    """A sine between two limits at an unknown phase (arcsine distribution): u = a/√2."""
    return Distribution("u_shaped", *_between(low, high))


def truncated_normal(center: float, sigma: float, limit: float) -> Distribution:
    """Normal of standard deviation ``sigma``, and nothing beyond ``center`` ± ``limit``."""
    return Distribution("truncated_normal", center, _positive(sigma), _positive(limit))


def student_t(center: float, scale: float, degrees_of_freedom: float) -> Distribution:
    """Mean of repeated readings with s/√n and n - 1 (JCGM 101:2008, 6.4.9)."""
    return Distribution(
        "student_t", center, _positive(scale), degrees_of_freedom=_positive(degrees_of_freedom)
    )


def _positive(value: float) -> float:
    if not 0 < value < math.inf:
        raise ValueError(f"{value:g} is no width of a distribution; expected a number above 0")
    return value


def _between(low: float, high: float) -> tuple[float, float, float]:
    """Centre, no scale, and half-width."""
    if not -math.inf < low < high < math.inf:
        raise ValueError(f"{low:g} to {high:g} is no range; expected two limits, the lower first")
    return (low + high) / 2, 0.0, (high - low) / 2


def _truncated_u(sigma: float, limit: float) -> float:
    from scipy import stats

    return float(sigma * stats.truncnorm.std(-limit / sigma, limit / sigma))


def _deviations(
    known: Distribution, generator: np.random.Generator, size: int | tuple[int, ...]
) -> Array | float:
    match known.kind:
        case "fixed":
            return np.zeros(size)
        case "normal":
            return generator.normal(0.0, known.scale, size)
        case "student_t":
            return known.scale * generator.standard_t(known.degrees_of_freedom, size)
        case "triangular":
            return generator.triangular(-known.half_width, 0.0, known.half_width, size)
        case "u_shaped":
            return known.half_width * np.sin(generator.uniform(-math.pi, math.pi, size))
        case "truncated_normal":
            # by its quantiles, so that every draw takes one number
            return truncated_at(known, generator.uniform(size=size))
    return generator.uniform(-known.half_width, known.half_width, size)


def truncated_at(known: Distribution, chance: Array) -> Array:
    """Deviation of a truncated normal from its centre at probabilities."""
    from scipy import special

    edge = special.ndtr(known.half_width / known.scale)
    return np.asarray(known.scale * special.ndtri(1 - edge + chance * (2 * edge - 1)))
