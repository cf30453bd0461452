"""Budgets of first order, held against the worked examples of the GUM (JCGM 100:2008, annex H)."""

import math

import GTC
import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.statistics import distributions as d
from simcompare.statistics.budget import budget, coverage_factor, linear_budget


def length(standard, mean, random, systematic, expansion, temperature, cycle, alpha, theta):
    """H.1, the length of the end gauge at 20 °C [nm]."""
    grown = alpha * (temperature + cycle) + expansion * theta
    return standard + mean + random + systematic - standard * grown


GAUGE_BLOCK = {
    "standard": d.normal(50_000_623, 25),
    "mean": d.student_t(215, 5.8, 24),
    "random": d.student_t(0, 3.9, 5),
    "systematic": d.student_t(0, 6.7, 8),
    "expansion": d.rectangular(9.5e-6, 13.5e-6),
    "temperature": d.normal(-0.1, 0.2),
    "cycle": d.u_shaped(-0.5, 0.5),
    "alpha": d.rectangular(-1e-6, 1e-6),
    "theta": d.rectangular(-0.05, 0.05),
}


def test_end_gauge():
    found = budget(
        length, GAUGE_BLOCK, degrees={"standard": 18, "alpha": 50, "theta": 2}, probability=0.99
    )
    assert found.estimate == pytest.approx(50_000_838)
    # published: 32 nm, 16 degrees of freedom (rounded down), k = 2.92, U = 93 nm
    assert round(found.u) == 32
    assert math.floor(found.degrees_of_freedom) == 16
    assert coverage_factor(16, 0.99) == pytest.approx(2.92, abs=0.005)
    assert found.largest_first[0].name == "standard"
    contributions = {row.name: row.contribution for row in found.rows}
    # table H.1, in whole nanometres but for the second
    assert contributions["theta"] == pytest.approx(16.6, abs=0.05)
    assert contributions["alpha"] == pytest.approx(2.9, abs=0.05)
    assert contributions["expansion"] == 0


READINGS = {
    "voltage": [5.007, 4.994, 5.005, 4.990, 4.999],
    "current": [19.663e-3, 19.639e-3, 19.640e-3, 19.685e-3, 19.678e-3],
    "phase": [1.0456, 1.0438, 1.0468, 1.0428, 1.0433],
}


@pytest.mark.parametrize(
    ("model", "value", "u"),
    [
        # table H.4, to its last digit
        (lambda voltage, current, phase: voltage / current * GTC.cos(phase), 127.732, 0.071),
        (lambda voltage, current, phase: voltage / current * GTC.sin(phase), 219.847, 0.295),
        (lambda voltage, current, phase: voltage / current, 254.260, 0.236),
    ],
)
def test_readings_taken_together(model, value, u):
    names = list(READINGS)
    related = np.corrcoef(list(READINGS.values()))
    inputs = {
        name: d.student_t(np.mean(read), np.std(read, ddof=1) / 5**0.5, 4)
        for name, read in READINGS.items()
    }
    pairs = [(i, j) for i in range(3) for j in range(i)]
    found = budget(
        model,
        inputs,
        correlation={(names[i], names[j]): related[i, j] for i, j in pairs},
        ensembles=[names],
    )
    assert found.estimate == pytest.approx(value, abs=0.0006)
    assert found.u == pytest.approx(u, abs=0.0006)
    # three means of the same five readings: as many as each has
    assert found.degrees_of_freedom == pytest.approx(4)
    assert found.k == pytest.approx(2.776, abs=0.0005)
    assert sum(row.share for row in found.rows) == pytest.approx(1)


def test_logarithm_of_first_order():
    found = budget(lambda x: GTC.log(x), {"x": d.rectangular(0.1, 1.1)})
    # ln 0.6, and (0.5/√3)/0.6
    assert found.estimate == pytest.approx(-0.511, abs=0.0005)
    assert found.u == pytest.approx(0.481, abs=0.0005)
    assert found.k == pytest.approx(1.960, abs=0.0005)
    assert found.interval == pytest.approx((-1.454, 0.432), abs=0.001)


def test_known_sensitivities_give_the_budget_of_the_formula():
    inputs = {"a": d.student_t(2.0, 0.1, 5), "b": d.rectangular(3, 4), "c": d.fixed(7)}
    traced = budget(lambda a, b, c: a * b + c, inputs)
    known = linear_budget(14.0, {"a": 3.5, "b": 2.0, "c": 1.0}, inputs)
    assert known == traced


def test_nothing_uncertain_leaves_nothing_open():
    found = budget(lambda a: 3 * a, {"a": d.fixed(2.0)})
    assert (found.estimate, found.u, found.expanded) == (6.0, 0.0, 0.0)
    assert [row.share for row in found.rows] == [0.0]


@pytest.mark.parametrize(
    ("asked", "text"),
    [
        (
            {"degrees": {"z": 4}},
            "budget: there is no input 'z'; expected some of a, b",
        ),
        (
            {"degrees": {"b": 0.5}},
            "budget: b: 0.5 are no degrees of freedom; expected a number of at least 1",
        ),
        (
            {"correlation": {("a", "b"): 0.5}},
            "budget: a and b are correlated and have few degrees of freedom; "
            "name them in one of the ensembles",
        ),
        ({"probability": 2.0}, "budget: probability 2 is none; expected one between 0 and 1"),
    ],
)
def test_what_cannot_be_is_refused(asked, text):
    inputs = {"a": d.student_t(1, 0.1, 4), "b": d.normal(1, 0.1)}
    with pytest.raises(InputError) as error:
        budget(lambda a, b: a + b, inputs, **asked)
    assert str(error.value) == text


def test_intervals_of_few_readings_hold_what_they_say():
    """Five readings of one quantity and a stated u of another; only k = t covers 95 %."""
    generator = np.random.default_rng(5)
    held = 0
    for _ in range(2000):
        readings = generator.normal(3.0, 0.1, 5)
        mean, s = float(readings.mean()), float(readings.std(ddof=1)) / 5**0.5
        inputs = {
            "a": d.student_t(mean, s, 4),
            "b": d.normal(float(generator.normal(2.0, 0.02)), 0.02),
        }
        low, high = linear_budget(mean + inputs["b"].center, {"a": 1, "b": 1}, inputs).interval
        held += low <= 5.0 <= high
    # 2000 draws of 95 % repeat to 0.5 %; with k = 1.96 it would be 91 %
    assert 0.93 < held / 2000 < 0.97
