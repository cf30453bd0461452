"""Ten phases of NBS Monograph 140 (NIST SP 1065): Allan deviation and its kin."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging.check import Check, last_digit
from simcompare.gauging.example import Example
from simcompare.statistics import allan

_PHASES = (
    0.0, 103.11111, 123.22222, 157.33333, 166.44444, 48.55555, -96.33333, -2.22222, 111.88889, 0.0,
)  # fmt: skip
_PUBLISHED: dict[allan.Kind, tuple[str, str]] = {
    "adev": ("91.22945", "115.8082"),
    "oadev": ("91.22945", "85.95287"),
    "mdev": ("91.22945", "74.78849"),
    "totdev": ("91.22945", "93.90379"),
    "hdev": ("70.80608", "116.7980"),
    "tdev": ("52.67135", "86.35831"),
}


def _checks() -> Iterator[Check]:
    for kind, published in _PUBLISHED.items():
        found = allan.of_phase(_PHASES, kind=kind, m=(1, 2))
        for text, tau, value in zip(published, found.tau_s, found.values, strict=True):
            yield last_digit(Check(f"{kind}, tau = {tau:g}", text, float(value)))


EXAMPLE = Example(
    "NBS14, ten phases: Allan deviation and its kin",
    "W. J. Riley, Handbook of Frequency Stability Analysis, NIST SP 1065 (2008), table 31; read in"
    " the tests of allantools 2024.6.",
    _checks,
)
