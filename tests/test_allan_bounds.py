"""Confidence bounds of Allan deviations."""

from __future__ import annotations

import numpy as np
import pytest

from simcompare.statistics import allan, allan_bounds
from tests import noise_records

#: the 1000 points of SP 1065 in Stable32 1.60, 68.3 % bounds: m -> lowest and highest deviation
OVERLAPPING = {
    1: (2.8515e-01, 2.9987e-01), 2: (1.9520e-01, 2.0738e-01), 4: (1.3931e-01, 1.5098e-01),
    8: (1.0038e-01, 1.1198e-01), 16: (5.7696e-02, 6.7217e-02), 32: (4.3654e-02, 5.4202e-02),
}  # fmt: skip
LONG_OVERLAPPING = {64: (3.1755e-02, 4.3377e-02), 128: (2.3045e-02, 3.7027e-02)}
MODIFIED = {
    2: (1.5336e-01, 1.6355e-01), 8: (6.9840e-02, 7.9481e-02), 32: (3.0466e-02, 3.9933e-02),
    128: (1.4874e-02, 2.8584e-02),
}  # fmt: skip
#: noise -> exponent and record of 512 readings
NOISES = {
    "white": (0, lambda draw: noise_records.white(draw, 512, 1.0)),
    "flicker": (-1, lambda draw: noise_records.flicker(draw, 512)),
    "walk": (-2, lambda draw: noise_records.walk(draw, 512, 1.0)),
    "angle": (2, lambda draw: noise_records.angle(draw, 512, 1.0)),
}
#: Allan deviation of each at 8 and 64 readings
TRUTH = {
    "white": (8**-0.5, 64**-0.5),
    "flicker": (0.6643, 0.6643),
    "walk": ((129 / 48) ** 0.5, (8193 / 384) ** 0.5),
    "angle": (3**0.5 / 8, 3**0.5 / 64),
}


@pytest.mark.parametrize(
    ("kind", "rows", "rel"),
    [
        ("oadev", OVERLAPPING, 1e-3),
        # beyond 100 differences in a sum Stable32 takes a table that is rounded
        ("oadev", LONG_OVERLAPPING, 2e-3),
        ("mdev", MODIFIED, 1e-3),
    ],
)
def test_bounds_of_stable32(
    kind: allan.Kind, rows: dict[int, tuple[float, float]], rel: float
) -> None:
    rates = noise_records.thousand_points()
    found = allan.deviations(rates, kind=kind, m=list(rows))
    bounds = allan_bounds.bounds(found, allan.phase_of(rates), 0.683)
    assert bounds.alpha.tolist() == [0] * len(rows)
    assert np.column_stack((bounds.low, bounds.high)) == pytest.approx(
        np.array(list(rows.values())), rel=rel
    )


@pytest.mark.parametrize("noise", NOISES)
def test_bounds_hold_the_truth_in_95_of_100_records(noise: str) -> None:
    draw = np.random.default_rng(1)
    truth, inside = np.array(TRUTH[noise]), np.zeros(2)
    for _ in range(500):
        rates = NOISES[noise][1](draw)
        found = allan.deviations(rates, m=(1, 8, 64))
        bounds = allan_bounds.bounds(found, allan.phase_of(rates))
        inside += (bounds.low[1:] <= truth) & (truth <= bounds.high[1:])
    # four standard deviations of a share of 500
    assert inside / 500 == pytest.approx([0.95, 0.95], abs=0.04)


@pytest.mark.parametrize("noise", NOISES)
def test_noise_types_are_told(noise: str) -> None:
    exponent, record = NOISES[noise]
    phase = allan.phase_of(record(np.random.default_rng(2)))
    # its standard uncertainty is about 2/√512
    assert allan_bounds.noise_exponent(phase, 1) == pytest.approx(exponent, abs=0.4)


def test_a_constant_has_no_noise_type() -> None:
    assert allan_bounds.noise_exponent(np.zeros(100), 1) is None
