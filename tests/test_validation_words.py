"""Plain sentences that never say more than was shown."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simcompare.validation.gap import split
from simcompare.validation.scores import vv20
from simcompare.validation.words import made_of, number, prediction, verdict

SIZES = st.floats(0, 10)


@given(st.floats(-10, 10), SIZES, SIZES, SIZES, st.sampled_from(["known", "held out", "same data"]))
def test_nothing_is_ever_called_validated(error, a, b, c, basis):
    said = verdict(vv20(5 + error, 5.0, a, b, c), basis, "the period", "s")
    assert "validated" not in said.replace("not validated", "")


def test_an_error_that_cannot_be_seen_is_within_the_noise_level():
    said = verdict(vv20(1.02, 1.0, 0.0, 0.0, 0.02), "known", "the period", "s")
    assert said == (
        "The simulated value of the period is 0.02 s (uncertainty 0.04 s, k = 2) above the "
        "measured one. The model error is within the noise level: up to 0.06 s could not be seen."
    )


def test_an_error_that_is_seen_is_given_with_its_interval():
    said = verdict(vv20(0.9, 1.0, 0.0, 0.0, 0.02), "known", "the period", "s")
    assert "0.1 s (uncertainty 0.04 s, k = 2) below" in said
    assert "the model error is between 0.06 s and 0.14 s" in said
    assert "noise level" not in said


@pytest.mark.parametrize("found", [None, vv20(1.0, 2.0, 0.0, 0.0, 0.0)])
def test_without_uncertainty_nothing_can_be_judged(found):
    said = verdict(found, "known", "the period", "s")
    assert said == "The period cannot be judged: no uncertainty is known."


def test_parameters_fitted_on_the_same_data_refuse_the_word():
    small = vv20(1.0, 1.0, 0.0, 0.0, 0.1)
    assert verdict(small, "same data", "the period", "s").startswith("Fitted, not validated")
    assert "noise level" not in verdict(small, "same data", "the period", "s")
    assert prediction(0.1, "same data", "the angle", "rad").startswith("Fitted, not validated")


def test_held_out_data_were_not_seen():
    assert "were not used for fitting" in verdict(
        vv20(1.0, 1.0, 0.0, 0.0, 0.1), "held out", "the period", "s"
    )
    assert prediction(0.1, "held out", "the angle", "rad") == (
        "The model predicts data it has not seen within 0.1 rad (root mean square) of the angle."
    )
    assert "known beforehand" in prediction(0.1, "known", "the angle", "rad")


def gap_of(shift, model, noise, *, stated=None):
    chance, t = np.random.default_rng(0), np.linspace(0, 50, 4000)
    truth = np.sin(t)
    best = truth + model * np.sin(7.3 * t)
    return split(
        truth + noise * chance.normal(size=len(t)), best + shift * np.cos(3 * t), best, stated
    )


def test_the_largest_part_comes_first():
    said = made_of(gap_of(0.5, 0.1, 0.01, stated=0.01), "the angle", "rad")
    assert said[0] == "The gap in the angle is 0.36 rad (root mean square)."
    assert said[1].index("the parameters") < said[1].index("the form of the model")
    assert said[1].index("the form of the model") < said[1].index("noise of the measurement")
    other = made_of(gap_of(0.05, 0.4, 0.01, stated=0.01), "the angle", "rad")
    assert other[1].index("the form of the model") < other[1].index("the parameters")
    assert "95 %" in said[2]


def test_clipping_and_estimated_noise_are_told():
    clipped = " ".join(made_of(gap_of(0.5, 0.0, 0.01, stated=0.05), "the angle", "rad"))
    assert "set to zero: it is within the noise level" in clipped
    assert "estimated from the median second difference" in " ".join(
        made_of(gap_of(0.5, 0.1, 0.01), "the angle", "rad")
    )


def test_parts_that_do_not_add_are_told():
    t = np.linspace(0, 20, 500)
    said = made_of(split(np.zeros(500), 0.2 * np.sin(t), np.sin(t), 0.0), "the angle", "rad")
    assert "do not simply add" in " ".join(said)
    assert "takes away" in " ".join(said)
    assert "do not simply add" not in " ".join(
        made_of(gap_of(0.5, 0.1, 0.01, stated=0.01), "the angle", "rad")
    )


def test_no_gap_is_no_gap():
    y = np.sin(np.arange(50.0))
    assert made_of(split(y, y, y, 0.0), "the angle", "rad") == [
        "There is no gap in the angle: the two signals are equal."
    ]


def test_numbers_have_three_digits_and_their_unit():
    assert number(0.123456, "m") == "0.123 m"
    assert number(12.0, "1") == "12"
