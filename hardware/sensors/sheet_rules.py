"""How a value of a data sheet becomes a distribution: one rule for each kind of value, by name.

JCGM 100:2008, 4.3 (evaluation from what is known beforehand) and JCGM 101:2008, 6.4 (which
distribution says no more than is known). A rule can be stated beside a value; otherwise the kind of
the value chooses it. Each can be repeated in one sentence.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from simcompare.statistics import distributions
from simcompare.statistics.distributions import Distribution


@dataclass(frozen=True)
class Stated:
    """The numbers of one entry in SI, deviations from what an ideal device has.

    Attributes:
        kind: what the sheet states: typ, max, min_max, typ_max, rms, density or resolution.
        typ: typical size of the deviation; rms, density or size of one count of these kinds.
        low, high: limits of the deviation; infinite where none is stated.
        typ_is_sigma: which part of a typical value is one standard deviation.
    """

    kind: str
    typ: float = math.nan
    low: float = -math.inf
    high: float = math.inf
    typ_is_sigma: float = 1.0

    @property
    def center(self) -> float:
        """Middle of the limits, 0 where there are none."""
        return (self.low + self.high) / 2 if math.isfinite(self.high - self.low) else 0.0


@dataclass(frozen=True)
class Rule:
    """How values become a distribution.

    Attributes:
        name: by which a sheet can state it.
        source: where it is written.
        words: the rule in one sentence.
        needs: what must be stated for it, "typ", "limits" or both; limits alone can be ± a typical
            value, where a sheet asks for the rule.
        known: makes the distribution.
    """

    name: str
    source: str
    words: str
    needs: tuple[str, ...]
    known: Callable[[Stated], Distribution]


def _rectangular(stated: Stated) -> Distribution:
    low, high = _limits(stated)
    return distributions.rectangular(low, high)


def _triangular(stated: Stated) -> Distribution:
    low, high = _limits(stated)
    return distributions.triangular(low, high)


def _u_shaped(stated: Stated) -> Distribution:
    low, high = _limits(stated)
    return distributions.u_shaped(low, high)


def _limits(stated: Stated) -> tuple[float, float]:
    """The limits, or ± the typical value where the rule is stated beside one."""
    if math.isfinite(stated.high - stated.low):
        return stated.low, stated.high
    return -stated.typ, stated.typ


def _normal(stated: Stated) -> Distribution:
    return distributions.normal(0.0, stated.typ * stated.typ_is_sigma)


def _normal_95(stated: Stated) -> Distribution:
    low, high = _limits(stated)
    return distributions.normal((low + high) / 2, (high - low) / 2 / 1.96)


def _three_sigma(stated: Stated) -> Distribution:
    low, high = _limits(stated)
    return distributions.normal((low + high) / 2, (high - low) / 6)


def _truncated(stated: Stated) -> Distribution:
    half = (stated.high - stated.low) / 2
    return distributions.truncated_normal(stated.center, stated.typ * stated.typ_is_sigma, half)


#: name -> rule
RULES = {
    rule.name: rule
    for rule in (
        Rule(
            "rectangular",
            "JCGM 101:2008, 6.4.2; JCGM 100:2008, 4.3.7",
            "Between two limits any value is as likely as another: rectangular, u = a/√3 with half"
            " the width a.",
            ("limits",),
            _rectangular,
        ),
        Rule(
            "normal",
            "JCGM 100:2008, 4.3.6; JCGM 101:2008, 6.4.7",
            "A typical value without a limit is read as: two devices of three are within it. So it"
            " is one standard deviation: normal about 0, u = typ. Few sheets say so; what part of"
            " it is one standard deviation can be chosen (typ_is_sigma).",
            ("typ",),
            _normal,
        ),
        Rule(
            "truncated_normal",
            "JCGM 101:2008, 6.4.7, cut off at the limits",
            "A typical value and a limit: normal with the typical value as standard deviation, and"
            " nothing beyond the limits.",
            ("typ", "limits"),
            _truncated,
        ),
        Rule(
            "rms",
            "JCGM 100:2008, 4.3.3",
            "Noise is drawn anew for every reading: normal about 0, and the stated rms is its"
            " standard deviation.",
            ("typ",),
            lambda stated: distributions.normal(0.0, stated.typ),
        ),
        Rule(
            "density",
            "IEEE Std 952, noise as a density",
            "A density n belongs to every device alike; the noise of one reading is normal with"
            " u = n·√B, where B is the noise bandwidth (1.57 times the bandwidth of one pole).",
            ("typ",),
            lambda stated: distributions.fixed(stated.typ),
        ),
        Rule(
            "alike",
            "JCGM 101:2008, 6.4.1",
            "The stated value is taken for every device alike, without an uncertainty of its own.",
            ("typ",),
            lambda stated: distributions.fixed(stated.typ),
        ),
        Rule(
            "resolution",
            "JCGM 100:2008, F.2.2.1",
            "The true value lies anywhere within half a count of the reading: rectangular,"
            " u = LSB/√12.",
            ("typ",),
            lambda stated: distributions.rectangular(-stated.typ / 2, stated.typ / 2),
        ),
        Rule(
            "triangular",
            "JCGM 101:2008, 6.4.5; JCGM 100:2008, 4.3.9",
            "Between two limits, the middle more likely than the ends: triangular, u = a/√6.",
            ("limits",),
            _triangular,
        ),
        Rule(
            "u_shaped",
            "JCGM 101:2008, 6.4.6",
            "It swings between two limits like a sine: arcsine distribution, u = a/√2.",
            ("limits",),
            _u_shaped,
        ),
        Rule(
            "three_sigma",
            "JCGM 100:2008, 4.3.3",
            "The sheet says that its limits are three standard deviations: normal, u = a/3.",
            ("limits",),
            _three_sigma,
        ),
        Rule(
            "normal_95",
            "JCGM 100:2008, 4.3.4",
            "The sheet says that 95 % of the devices are within the limits: normal, u = a/1.96.",
            ("limits",),
            _normal_95,
        ),
    )
}
#: kind of a value -> rule where the sheet's file states none
RULE_OF_KIND = {
    "typ": "normal",
    "max": "rectangular",
    "min_max": "rectangular",
    "typ_max": "truncated_normal",
    "rms": "rms",
    "density": "density",
    "resolution": "resolution",
}
#: rules that a sheet can ask for, of what is drawn once for a device
CHOICES = (
    "rectangular", "normal", "truncated_normal", "triangular", "u_shaped", "three_sigma",
    "normal_95",
)  # fmt: skip
