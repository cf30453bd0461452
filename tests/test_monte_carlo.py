"""Propagation of distributions, held against the worked examples of JCGM 101:2008."""

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.statistics import distributions as d
from simcompare.statistics.budget import budget
from simcompare.statistics.monte_carlo import numerical_tolerance, propagate, validation

#: trials; a mean repeats to u/1000, the end of a 95 % interval of normal results to 3 u/1000
TRIALS = 1_000_000
ROOT3 = 3**0.5


def added(**inputs):
    return sum(inputs.values())


def of_unit_variance(largest=1.0):
    names = ("x1", "x2", "x3")
    parts = {name: d.rectangular(-ROOT3, ROOT3) for name in names}
    return {**parts, "x4": d.rectangular(-largest * ROOT3, largest * ROOT3)}


@pytest.mark.parametrize(
    ("inputs", "u", "end"),
    [
        # 9.2.2, 9.2.3 and 9.2.4, as published
        ({f"x{i}": d.normal(0, 1) for i in range(4)}, 2.00, 3.92),
        (of_unit_variance(), 2.00, 3.88),
        (of_unit_variance(10.0), 10.1, 17.0),
    ],
)
def test_additive_model(inputs, u, end):
    found = propagate(added, inputs, seed=1, trials=TRIALS)
    # 5 standard deviations of a mean of that many
    assert abs(found.estimate) < 5 * found.u / 1000
    # published to three digits
    assert found.u == pytest.approx(u, rel=0.005)
    for interval in (found.symmetric, found.shortest):
        # half a unit in the last published digit, and the shortest repeats to 2 %
        assert interval == pytest.approx((-end, end), rel=0.02)


def mass(reference, difference, air, dense, normal):
    """9.3.1.3, the deviation from 100 g [mg]."""
    return (reference + difference) * (1 + (air - 1.2) * (1 / dense - 1 / normal)) - 1e5


def test_mass_calibration_that_first_order_fails():
    inputs = {
        "reference": d.normal(100_000, 0.05),
        "difference": d.normal(1.234, 0.02),
        "air": d.rectangular(1.1, 1.3),
        "dense": d.rectangular(7000, 9000),
        "normal": d.rectangular(7950, 8050),
    }
    found = propagate(mass, inputs, seed=1)
    assert found.stable
    assert found.tolerance == 0.0005
    # the adaptive run promises each within that tolerance
    assert found.estimate == pytest.approx(1.2340, abs=0.0005)
    assert found.u == pytest.approx(0.0755, abs=0.0005)
    # the shortest interval repeats less well than what stability is judged by
    assert found.shortest == pytest.approx((1.0857, 1.3850), abs=0.003)
    first = validation(budget(mass, inputs), found, digits=1)
    assert first.tolerance == 0.005
    assert not first.passed
    assert first.low == pytest.approx(0.045, abs=0.003)


@pytest.mark.parametrize(
    ("x1", "r", "estimate", "u", "shortest"),
    [
        (0.0, 0.0, 50e-6, 50e-6, (0, 150e-6)),
        (0.010, 0.0, 150e-6, 112e-6, (0, 367e-6)),
        (0.050, 0.0, 2550e-6, 502e-6, (1590e-6, 3543e-6)),
        (0.0, 0.9, 50e-6, 67e-6, (0, 185e-6)),
        (0.010, 0.9, 150e-6, 121e-6, (13e-6, 398e-6)),
        (0.050, 0.9, 2550e-6, 505e-6, (1628e-6, 3555e-6)),
    ],
)
def test_comparison_loss(x1, r, estimate, u, shortest):
    inputs = {"x1": d.normal(x1, 0.005), "x2": d.normal(0, 0.005)}
    found = propagate(
        lambda x1, x2: x1**2 + x2**2, inputs, seed=1, trials=TRIALS, correlation={("x1", "x2"): r}
    )
    # published to 1e-6, and the run's own noise
    assert found.estimate == pytest.approx(estimate, abs=1.5e-6)
    assert found.u == pytest.approx(u, abs=1.5e-6)
    # ends of a shortest interval repeat to a few hundredths of u
    assert found.shortest == pytest.approx(shortest, abs=0.06 * u)


def test_intervals_hold_what_they_say():
    generator = np.random.default_rng(3)
    held = 0
    for _ in range(2000):
        # a student reads two quantities once each and propagates what she knows of them
        read = {"a": generator.normal(2.0, 0.1), "b": generator.uniform(0.8, 1.2)}
        known = {
            "a": d.normal(read["a"], 0.1),
            "b": d.rectangular(read["b"] - 0.2, read["b"] + 0.2),
        }
        low, high = propagate(lambda a, b: a * b, known, seed=1, trials=2000).symmetric
        held += low <= 2.0 <= high
    # 2000 draws of 95 % repeat to 0.5 %
    assert 0.93 < held / 2000 < 0.97


@pytest.mark.parametrize(
    "known",
    [
        d.rectangular(1, 2),
        d.triangular(1, 2),
        d.u_shaped(1, 2),
        d.truncated_normal(1, 0.3, 0.4),
        d.student_t(1, 0.2, 5),
    ],
)
def test_correlated_quantity_keeps_its_distribution(known):
    inputs = {"a": known, "b": d.normal(0, 1)}
    found = propagate(lambda a, b: a, inputs, seed=1, trials=TRIALS, correlation={("a", "b"): 0.5})
    alone = propagate(lambda a: a, {"a": known}, seed=2, trials=TRIALS)
    # both repeat to 0.3 %; the heavy tails of t to a little more
    assert found.u == pytest.approx(alone.u, rel=0.01)
    assert found.symmetric == pytest.approx(alone.symmetric, rel=0.01)
    assert found.estimate == pytest.approx(known.center, abs=0.005 * known.u)


def test_another_input_changes_no_draw():
    one = propagate(lambda a: a, {"a": d.normal(0, 1)}, seed=4, trials=1000)
    both = propagate(
        lambda a, b: a, {"b": d.normal(0, 1), "a": d.normal(0, 1)}, seed=4, trials=1000
    )
    assert one == both


def test_histogram_has_the_area_of_its_trials():
    found = propagate(lambda a: a, {"a": d.normal(0, 1)}, seed=4, trials=100_000)
    area = float(np.sum(np.diff(found.edges) * found.density))
    # a thousandth lies outside
    assert area == pytest.approx(0.999, abs=1e-4)


def test_exact_inputs_leave_nothing_open():
    found = propagate(lambda a: 2 * a, {"a": d.fixed(3.0)}, seed=1)
    assert (found.estimate, found.u, found.symmetric) == (6.0, 0.0, (6.0, 6.0))
    assert found.edges == ()


@pytest.mark.parametrize(
    ("u", "digits", "expected"),
    [(0.00035, 2, 5e-6), (2.0, 2, 0.05), (0.0754, 1, 0.005), (0.0996, 2, 0.005), (0.0, 2, 0.0)],
)
def test_tolerance_is_half_a_unit_in_the_last_digit(u, digits, expected):
    assert numerical_tolerance(u, digits) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("asked", "text"),
    [
        (
            {"correlation": {("a", "b"): 1.5}},
            "correlation: a with b: 1.5 is no coefficient of correlation; expected -1 to 1",
        ),
        (
            {"correlation": {("a", "z"): 0.5}},
            "correlation: a with z: there is no input 'z'; expected two of a, b, c",
        ),
        (
            {"correlation": {("a", "b"): 0.9, ("b", "c"): 0.9, ("a", "c"): -0.9}},
            "correlation: a with b 0.9, b with c 0.9, a with c -0.9 cannot all be true: "
            "the matrix has a negative eigenvalue; make one smaller",
        ),
        (
            {"trials": 10},
            "Monte Carlo: 10 trials cannot tell an interval of 95 %; expected at least 40",
        ),
        (
            {"trials": 10**8},
            "Monte Carlo: 100000000 trials are too many; expected at most 10000000",
        ),
        (
            {"probability": 1.0},
            "Monte Carlo: probability 1 is out of range; expected more than 0 and at most 0.99999",
        ),
    ],
)
def test_what_cannot_be_is_refused(asked, text):
    inputs = dict.fromkeys("abc", d.normal(1, 0.1))
    with pytest.raises(InputError) as error:
        propagate(added, inputs, seed=1, **asked)
    assert str(error.value) == text


def test_draws_without_a_result_are_told():
    with pytest.raises(InputError, match="give no finite number, such as a = "):
        propagate(lambda a: np.log(a), {"a": d.normal(0, 1)}, seed=1)
