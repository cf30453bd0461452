"""The portable set of 1000 frequencies of NIST SP 1065: Allan deviation and its kin."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging import portable_set
from simcompare.gauging.check import Check, last_digit
from simcompare.gauging.example import Example
from simcompare.statistics import allan

_PUBLISHED: dict[allan.Kind, tuple[str, str, str]] = {
    "adev": ("2.922319e-01", "9.965736e-02", "3.897804e-02"),
    "oadev": ("2.922319e-01", "9.159953e-02", "3.241343e-02"),
    "mdev": ("2.922319e-01", "6.172376e-02", "2.170921e-02"),
    "tdev": ("1.687202e-01", "3.563623e-01", "1.253382e+00"),
    "hdev": ("2.943883e-01", "1.052754e-01", "3.910860e-02"),
    "ohdev": ("2.943883e-01", "9.581083e-02", "3.237638e-02"),
    "totdev": ("2.922319e-01", "9.134743e-02", "3.406530e-02"),
}


def _checks() -> Iterator[Check]:
    rates = portable_set.frequencies()
    for kind, published in _PUBLISHED.items():
        found = allan.deviations(rates, kind=kind, m=(1, 10, 100))
        for text, tau, value in zip(published, found.tau_s, found.values, strict=True):
            yield last_digit(Check(f"{kind}, tau = {tau:g}", text, float(value)))


EXAMPLE = Example(
    "1000 frequencies: Allan deviation and its kin",
    "W. J. Riley, Handbook of Frequency Stability Analysis, NIST SP 1065 (2008), table 32; read in"
    " the tests of allantools 2024.6.",
    _checks,
)
