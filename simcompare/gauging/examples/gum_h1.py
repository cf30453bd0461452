"""JCGM 100:2008, H.1: the length of an end gauge."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.statistics.budget import budget
from simcompare.statistics.distributions import (
    Distribution,
    normal,
    rectangular,
    student_t,
    u_shaped,
)

#: the difference of the gauges: mean of readings, random and systematic errors of the comparator
_DIFFERENCE: dict[str, Distribution] = {
    "read_nm": student_t(215.0, 5.8, 24),
    "random_nm": student_t(0.0, 3.9, 5),
    "systematic_nm": student_t(0.0, 6.7, 8),
}
_INPUTS: dict[str, Distribution] = {
    "standard_nm": student_t(50_000_623.0, 25.0, 18),
    **_DIFFERENCE,
    "expansion_K": rectangular(9.5e-6, 13.5e-6),
    "expansion_gap_K": rectangular(-1e-6, 1e-6),
    "mean_K": normal(-0.1, 0.2),
    "cycle_K": u_shaped(-0.5, 0.5),
    "gap_K": rectangular(-0.05, 0.05),
}
_DEGREES = {"expansion_gap_K": 50.0, "gap_K": 2.0}


def _length(
    standard_nm: Number,
    read_nm: Number,
    random_nm: Number,
    systematic_nm: Number,
    expansion_K: Number,
    expansion_gap_K: Number,
    mean_K: Number,
    cycle_K: Number,
    gap_K: Number,
) -> Number:
    warmth = expansion_gap_K * (mean_K + cycle_K) + expansion_K * gap_K
    return standard_nm + read_nm + random_nm + systematic_nm - standard_nm * warmth


def _sum(read_nm: Number, random_nm: Number, systematic_nm: Number) -> Number:
    return read_nm + random_nm + systematic_nm


def _checks() -> Iterator[Check]:
    difference = budget(_sum, _DIFFERENCE)
    yield Check("difference, u (nm)", "9.7", difference.u)
    yield Check(
        "difference, degrees of freedom", "25.6", difference.degrees_of_freedom, allowed=0.2,
        remark="the GUM goes on with u rounded to 9.7 nm",
    )  # fmt: skip
    found = budget(_length, _INPUTS, degrees=_DEGREES)
    parts = {row.name: row.contribution for row in found.rows}
    yield Check("length (nm)", "50000838", found.estimate)
    yield Check("part of the standard (nm)", "25", parts["standard_nm"])
    yield Check("part of the temperature difference (nm)", "16.599", parts["gap_K"])
    yield Check("part of the expansions' difference (nm)", "2.88679", parts["expansion_gap_K"])
    yield Check("length, u (nm)", "32", found.u)
    yield Check(
        "length, degrees of freedom", "16", found.degrees_of_freedom, allowed=0.5,
        remark="the GUM cuts 16.7 to a whole number",
    )  # fmt: skip


EXAMPLE = Example(
    "GUM H.1, length of an end gauge",
    "JCGM 100:2008, H.1, first order; read in the tests of suncal 1.7, length and parts in the"
    " documentation of GTC (GUM_H1).",
    _checks,
)
