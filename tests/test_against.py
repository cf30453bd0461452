"""Simulated values held against measured ones: E_n numbers by hand, and stated limits."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from simcompare.comparison.against import matches
from simcompare.comparison.comparison import Score
from simcompare.hardware.recordings.bounce_table import BounceTable, Quantity
from simcompare.model.plain import plain
from simcompare.reports.sections.measurement import agreement

UNITS = {"rebound_height": "m", "restitution": "1"}


def table(*quantities):
    return BounceTable(Path("t.csv"), "", {}, {}, quantities)


def score(value, scatter, *, measure="rebound_height", index=1, source="toy", contact="assisted"):
    u = None if scatter is None else scatter / 3
    return Score(
        source, contact, measure, "h", index, value, scatter, u, "m", 9, None, None, "info"
    )


def one(quantity, *scores):
    (found,) = matches(table(quantity), scores, UNITS)
    return found


def test_e_n_by_hand():
    """(0.65 - 0.64)/√(0.006² + 0.008²) = 1 with expanded uncertainties U = 2u, and U = k·scatter.

    Nine repeats have eight degrees of freedom: k = 2.37 for 95.45 % (JCGM 100:2008, table G.2).
    """
    scatter = 0.006 / 2.37
    found = one(Quantity("rebound_height", 1, 0.64, 0.004), score(0.65, scatter))
    # k has three digits
    assert found.e_n == pytest.approx(1.0, abs=0.002)
    assert (found.value, found.measured, found.unit) == (0.65, 0.64, "m")
    lower = one(Quantity("rebound_height", 1, 0.66, 0.004), score(0.65, scatter))
    assert lower.e_n == pytest.approx(-1.0, abs=0.002), "its sign says on which side"


@pytest.mark.parametrize(
    ("value", "inside"), [(0.6479, True), (0.6481, False), (0.6321, True), (0.6319, False)]
)
def test_without_limits_the_e_n_number_decides(value, inside):
    assert one(Quantity("rebound_height", 1, 0.64, 0.004), score(value, None)).inside is inside


@pytest.mark.parametrize(
    ("value", "inside"), [(0.60, True), (0.70, True), (0.71, False), (0.59, False)]
)
def test_stated_limits_decide_where_there_are_some_and_belong_to_the_band(value, inside):
    found = one(Quantity("rebound_height", 1, 0.65, 0.0001, 0.60, 0.70), score(value, 0.0))
    assert found.inside is inside
    assert found.e_n is None, "limits and E_n would be two different criteria"


def test_without_any_uncertainty_nothing_is_claimed():
    found = one(Quantity("rebound_height", 1, 0.64, None), score(0.65, 0.003))
    assert (found.e_n, found.inside) == (None, None)


def test_a_bounce_that_the_engine_does_not_have_is_outside():
    found = one(Quantity("rebound_height", 2, 0.64, 0.004), score(0.65, 0.003, index=1))
    assert (found.value, found.e_n, found.inside) == (None, None, False)


def test_every_source_and_mode_is_held_against_every_value():
    scores = [
        score(0.65, 0.003),
        score(0.40, 0.003, index=2),
        score(0.1, None, contact="default"),
        score(0.8, None, measure="restitution", index=None),  # a mean is no bounce
    ]
    quantities = (
        Quantity("rebound_height", 1, 0.64, 0.004),
        Quantity("rebound_height", 2, 0.41, 0.004),
        Quantity("restitution", 1, 0.8, 0.01),
    )
    found = matches(table(*quantities), scores, UNITS)
    assert [(m.contact, m.quantity, m.bounce, m.value) for m in found] == [
        ("assisted", "rebound_height", 1, 0.65),
        ("assisted", "rebound_height", 2, 0.40),
        ("assisted", "restitution", 1, None),
        ("default", "rebound_height", 1, 0.1),
        ("default", "rebound_height", 2, None),
        ("default", "restitution", 1, None),
    ]
    json.dumps([plain(m) for m in found], allow_nan=False)


@pytest.mark.parametrize(
    ("inside", "words"),
    [
        ([True], "a agrees with the measurement."),
        ([False], "a does not agree with the measurement."),
        ([None], "it cannot be told whether the engines agree with the measurement."),
        ([False, False], "no engine agrees with the measurement."),
        ([True, False, False], "a agrees with the measurement."),
        ([True, True], "a and b agree with the measurement."),
        ([True, True, True], "all 3 engines agree with the measurement."),
        ([True, None, False], "a agrees with the measurement. It cannot be told for b."),
    ],
)
def test_who_agrees_with_a_measurement_is_said_in_plain_words(inside, words):
    known = one(Quantity("rebound_height", 1, 0.64, 0.004), score(0.65, 0.003))
    rows = [replace(known, source="abc"[i], inside=own) for i, own in enumerate(inside)]
    assert agreement(rows) == words
