"""JCGM 101:2008, 9.5: the end gauge of GUM H.1, by Monte Carlo."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.statistics.distributions import normal, rectangular, student_t, u_shaped

_NOMINAL_NM = 50_000_000.0
#: limits that are not known exactly: the half-width is drawn, and a place within it
_INPUTS = {
    "standard_nm": student_t(623.0, 25.0, 18),
    "read_nm": student_t(215.0, 6.0, 24),
    "random_nm": student_t(0.0, 4.0, 5),
    "systematic_nm": student_t(0.0, 7.0, 8),
    "expansion_K": rectangular(9.5e-6, 13.5e-6),
    "mean_K": normal(-0.1, 0.2),
    "cycle_K": u_shaped(-0.5, 0.5),
    "expansion_limit_K": rectangular(0.9e-6, 1.1e-6),
    "expansion_place": rectangular(-1.0, 1.0),
    "gap_limit_K": rectangular(0.025, 0.075),
    "gap_place": rectangular(-1.0, 1.0),
}


def _length(
    standard_nm: Number,
    read_nm: Number,
    random_nm: Number,
    systematic_nm: Number,
    expansion_K: Number,
    mean_K: Number,
    cycle_K: Number,
    expansion_limit_K: Number,
    expansion_place: Number,
    gap_limit_K: Number,
    gap_place: Number,
) -> Number:
    """What the gauge is longer than its nominal length."""
    warmth = expansion_limit_K * expansion_place * (mean_K + cycle_K)
    warmth = warmth + expansion_K * gap_limit_K * gap_place
    difference = read_nm + random_nm + systematic_nm
    return standard_nm + difference - (_NOMINAL_NM + standard_nm) * warmth


def _checks() -> Iterator[Check]:
    found = monte_carlo.repeated(_length, _INPUTS, probability=0.99)
    yield monte_carlo.estimate(found, "838.0000", "nm")
    yield monte_carlo.uncertainty(found, "35.80808", "nm")
    yield from monte_carlo.interval(found, "744.3484", "931.6516", "nm", shortest=True)
    yield from monte_carlo.interval(found, "744.3484", "931.6516", "nm")


EXAMPLE = Example(
    "JCGM 101 9.5, the end gauge of GUM H.1 by Monte Carlo",
    "Inputs of JCGM 101:2008, 9.5. Mean and u: exact moments; ends: numerical inversion of the"
    " characteristic function (Gil-Pelaez, 1200 nodes). Odd in all of its centred inputs but for"
    " a part of 1e-6, so that both intervals are the same.",
    _checks,
    kind="exact",
)
