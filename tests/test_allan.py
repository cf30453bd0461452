"""Deviations of a record against published values."""

from __future__ import annotations

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.statistics import allan
from tests.noise_records import NBS14_PHASE, thousand_points

#: NIST SP 1065 (2008), 12.2: the ten phases of NBS Monograph 140 at 1 and 2 s
NBS14 = {
    "adev": (91.22945, 115.8082),
    "oadev": (91.22945, 85.95287),
    "mdev": (91.22945, 74.78849),
    "totdev": (91.22945, 93.90379),
    "hdev": (70.80608, 116.7980),
    "tdev": (52.67135, 86.35831),
}
#: NIST SP 1065 (2008), 12.4: the set of 1000 points at 1, 10 and 100 s
THOUSAND = {
    "adev": (2.922319e-01, 9.965736e-02, 3.897804e-02),
    "oadev": (2.922319e-01, 9.159953e-02, 3.241343e-02),
    "mdev": (2.922319e-01, 6.172376e-02, 2.170921e-02),
    "tdev": (1.687202e-01, 3.563623e-01, 1.253382e-00),
    "hdev": (2.943883e-01, 1.052754e-01, 3.910860e-02),
    "ohdev": (2.943883e-01, 9.581083e-02, 3.237638e-02),
    "totdev": (2.922319e-01, 9.134743e-02, 3.406530e-02),
}


@pytest.mark.parametrize("kind", NBS14)
def test_ten_phases_of_nbs_14(kind: allan.Kind) -> None:
    found = allan.of_phase(NBS14_PHASE, kind=kind, m=(1, 2)).values
    # printed to seven digits
    assert found == pytest.approx(NBS14[kind], rel=1e-6)


@pytest.mark.parametrize("kind", allan.KINDS)
def test_thousand_points_of_sp_1065(kind: allan.Kind) -> None:
    found = allan.deviations(thousand_points(), kind=kind, m=(1, 10, 100)).values
    # printed to seven digits, of which the last is rounded
    assert found == pytest.approx(THOUSAND[kind], rel=1e-6)


@pytest.mark.parametrize("kind", allan.KINDS)
def test_a_constant_rate_and_a_constant_phase_change_nothing(kind: allan.Kind) -> None:
    rates = thousand_points()
    still = allan.deviations(rates, 50.0, kind).values
    assert allan.deviations(rates + 1e3, 50.0, kind).values == pytest.approx(still, rel=1e-9)


def test_octaves_go_as_far_as_the_record() -> None:
    assert allan.octaves(1000, "oadev") == [1, 2, 4, 8, 16, 32, 64, 128, 256]
    assert allan.octaves(1024, "oadev")[-1] == 512
    assert allan.octaves(3, "ohdev") == [1]


def test_missing_values_are_refused() -> None:
    with pytest.raises(InputError, match="2 of 9 are missing"):
        allan.deviations([1, 2, np.nan, 3, 4, np.nan, 5, 6, 7])


def test_a_record_that_is_too_short_is_refused() -> None:
    with pytest.raises(InputError, match="no difference over 5 readings fits into 9"):
        allan.deviations(np.arange(9.0), m=(1, 5))
