"""Coefficients of noises told from a record."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from simcompare.statistics import allan, allan_covariance, allan_terms
from tests import noise_records

RATE_HZ, COUNT = 50.0, 20_000


@pytest.mark.parametrize(
    ("name", "record"),
    [
        ("N", lambda draw: 0.3 * noise_records.white(draw, COUNT, RATE_HZ)),
        ("B", lambda draw: 0.3 * noise_records.flicker(draw, COUNT)),
        ("K", lambda draw: 0.3 * noise_records.walk(draw, COUNT, RATE_HZ)),
        ("Q", lambda draw: 0.3 * noise_records.angle(draw, COUNT, RATE_HZ)),
        ("R", lambda draw: 0.3 * np.arange(COUNT) / RATE_HZ + draw.normal(size=COUNT)),
    ],
)
def test_each_noise_is_recovered_alone(name: str, record) -> None:
    terms = allan_terms.fitted(record(np.random.default_rng(3)), RATE_HZ)
    assert terms[name].value == pytest.approx(0.3, rel=0.04)
    assert terms[name].value == pytest.approx(0.3, abs=4 * terms[name].u)
    others = {term.name for term in terms.terms if term.seen} - {name, "N" if name == "R" else ""}
    assert not others


def test_gauss_markov_noise_is_recovered() -> None:
    rates = 0.3 * noise_records.gauss_markov(np.random.default_rng(4), COUNT, RATE_HZ, 1.0)
    found = allan_terms.fitted(rates, RATE_HZ).gauss_markov
    assert found is not None
    # 400 times its own time: known to about 4 % and 8 %
    assert found.sigma == pytest.approx(0.3, abs=4 * found.u_sigma)
    assert found.time_s == pytest.approx(1.0, abs=4 * found.u_time_s)
    assert found.u_sigma < 0.02
    assert found.u_time_s < 0.15


def test_a_noise_that_the_last_fit_sets_to_zero_is_left_out() -> None:
    draw = np.random.default_rng(19)
    rates = draw.normal(size=10_000) + noise_records.gauss_markov(draw, 10_000, 100.0, 0.2)
    terms = allan_terms.fitted(rates, 100.0)
    assert {term.name for term in terms.terms if term.seen} == {"N"}
    assert terms["N"].value == pytest.approx(0.1, abs=4 * terms["N"].u)


def test_white_noise_that_overlaps_with_a_bias_is_known_less_well() -> None:
    """Whether the bias is flicker or Gauss-Markov cannot be told, and N hangs on that."""
    draw = np.random.default_rng(6)
    markov = noise_records.gauss_markov
    rates = draw.normal(size=10_000) + 0.3 * markov(draw, 10_000, 100.0, 0.3)
    terms = allan_terms.fitted(rates, 100.0)
    assert terms.gauss_markov is None
    # 0.0085 if it were surely flicker, and 0.023 between both readings
    assert terms["N"].u > 0.02 * 0.1


def test_what_a_short_record_cannot_show_is_a_limit() -> None:
    draw = np.random.default_rng(5)
    rates = 0.1 * noise_records.white(draw, 2000, RATE_HZ) + 0.01 * noise_records.flicker(
        draw, 2000
    )
    terms = allan_terms.fitted(rates, RATE_HZ)
    assert terms["N"].seen
    assert not terms["B"].seen
    assert 0.01 < terms["B"].limit < 0.1


def test_a_ramp_leaves_the_other_noises_alone() -> None:
    draw = np.random.default_rng(6)
    noise = 0.1 * noise_records.white(draw, COUNT, RATE_HZ)
    still = allan_terms.fitted(noise, RATE_HZ)
    drifting = allan_terms.fitted(noise + 0.02 * np.arange(COUNT) / RATE_HZ, RATE_HZ)
    assert drifting["R"].value == pytest.approx(0.02, abs=4 * drifting["R"].u)
    # Hadamard variances in place of Allan variances, of the same white noise
    assert drifting["N"].value == pytest.approx(still["N"].value, rel=0.02)
    assert not drifting["K"].seen


def test_lines_of_the_fit_go_through_the_deviations() -> None:
    draw = np.random.default_rng(7)
    rates = noise_records.white(draw, COUNT, RATE_HZ) + 5 * noise_records.walk(draw, COUNT, RATE_HZ)
    terms, found = allan_terms.fitted(rates, RATE_HZ), allan.deviations(rates, RATE_HZ)
    # up to averaging times at which a deviation is known to about 10 %
    assert terms.total(found.tau_s[:8]) == pytest.approx(found.values[:8], rel=0.3)
    assert terms.deviation("N", np.array([1.0])) == pytest.approx(terms["N"].value)
    # of readings, not of their averages: 1 + 1/(2m²) times K²τ/3
    assert terms.deviation("K", np.array([3.0])) == pytest.approx(terms["K"].value, rel=1e-3)
    assert terms.deviation("GM", np.array([1.0])) == pytest.approx(0.0)


def test_covariance_of_variances_is_that_of_many_records() -> None:
    draw = np.random.default_rng(8)
    m = [1, 2, 4, 8, 16, 32]
    records = [allan.deviations(noise_records.white(draw, 256, 1.0), m=m) for _ in range(1500)]
    scatter = np.cov(np.array([one.values**2 for one in records]).T)
    products = allan_covariance.products(m, 256, allan_covariance.kernels())
    found = products.covariance({"N": 1.0})
    size = np.sqrt(np.diag(found))
    # a standard deviation of 1500 is known to 1/√3000 and more where it is skewed
    assert np.sqrt(np.diag(scatter)) == pytest.approx(size, rel=0.1)
    assert scatter / np.outer(size, size) == pytest.approx(found / np.outer(size, size), abs=0.15)


@pytest.mark.parametrize("count", [0.0, 4.0], ids=["exact", "rounded"])
def test_white_noise_behind_a_filter_is_told_from_longer_times(count: float) -> None:
    """A low-pass of 30 Hz at 1000 Hz smooths neighbours; slow averages know nothing of it.

    Rounding adds a little white noise that the filter does not see; that is not the sensor's.
    """
    draw, kept = np.random.default_rng(9), np.exp(-2 * np.pi * 30 / 1000)
    rates = signal.lfilter([1 - kept], [1, -kept], noise_records.white(draw, 30_000, 1000.0))
    if count:
        rates = np.round(rates / count) * count  # a seventieth of the variance
    terms = allan_terms.fitted(rates, 1000.0)
    # 30 times its time at least, for a smoothing below 5 %
    assert terms.from_s > 0.05
    assert terms["N"].value == pytest.approx(1.0, abs=0.05 + 3 * terms["N"].u)
    assert terms.gauss_markov is None
