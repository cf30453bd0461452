"""Confidence bounds of Allan deviations of the portable set of 1000 frequencies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from simcompare.gauging import portable_set
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.statistics import allan, allan_bounds

_PROBABILITY = 0.683
#: digits that are enough, and from which averaging time on an approximation makes fewer of them
_DIGITS, _FITTED_FROM = 3.0, 64
_FIT = "the source takes a fit for the degrees of freedom here, r/(2/3 − 1/(3·r))"
#: averaging factor -> lowest and highest deviation
_OVERLAPPING = {
    1: ("2.8515e-01", "2.9987e-01"), 2: ("1.9520e-01", "2.0738e-01"),
    4: ("1.3931e-01", "1.5098e-01"), 8: ("1.0038e-01", "1.1198e-01"),
    16: ("5.7696e-02", "6.7217e-02"), 32: ("4.3654e-02", "5.4202e-02"),
    64: ("3.1755e-02", "4.3377e-02"), 128: ("2.3045e-02", "3.7027e-02"),
}  # fmt: skip
_MODIFIED = {
    2: ("1.5336e-01", "1.6355e-01"), 8: ("6.9840e-02", "7.9481e-02"),
    32: ("3.0466e-02", "3.9933e-02"), 128: ("1.4874e-02", "2.8584e-02"),
}  # fmt: skip


def _checks() -> Iterator[Check]:
    yield from _bounds("oadev", _OVERLAPPING)
    yield from _bounds("mdev", _MODIFIED)


def _bounds(kind: allan.Kind, published: Mapping[int, tuple[str, str]]) -> Iterator[Check]:
    rates = portable_set.frequencies()
    found = allan.deviations(rates, kind=kind, m=list(published))
    computed = allan_bounds.bounds(found, allan.phase_of(rates), _PROBABILITY)
    for m, texts, low, high in zip(
        published, published.values(), computed.low, computed.high, strict=True
    ):
        for text, value, name in zip(texts, (low, high), ("low", "high"), strict=True):
            fitted = m >= _FITTED_FROM
            yield Check(
                f"{kind}, tau = {m}, {name}", text, float(value), wanted=_DIGITS,
                allowed=2e-3 * float(text) if fitted else 0.0, remark=_FIT if fitted else "",
            )  # fmt: skip


EXAMPLE = Example(
    "1000 frequencies: 68.3 % bounds of the Allan deviation",
    "Output of Stable32 1.60 on the set of NIST SP 1065, read in the tests of allantools 2024.6"
    " (phase_dat_oadev_octave.txt, phase_dat_mdev_octave.txt); 3 digits are enough.",
    _checks,
)
