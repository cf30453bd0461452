"""A number that was written otherwise than it is read: one sentence, and what to write instead."""

from __future__ import annotations

import pytest

import simcompare
from simcompare import notation, units
from simcompare.errors import InputError

TUNE = ("tune", "--restitution")
FIT = ("fit", "ball", "-r", "jena_2021_table_tennis", "--engine", "pymunk")
RUN = ("run", "ball", "--engine", "pymunk", "--no-report")


@pytest.mark.parametrize(
    ("words", "instead"),
    [
        ((*RUN, "--set", "drop_height=0,5m"), "drop_height_m: '0,5m' has a decimal comma; write"),
        ((*RUN, "--set", "drop_height=0,5m"), "0.5m"),
        ((*RUN, "--set", "drop_height=1.000,5 mm"), "write 1000.5mm"),
        ((*RUN, "--set", "restitution=0,8"), "write 0.8"),
        ((*RUN, "--step", "0,5ms"), "write 0.5ms"),
        ((*RUN, "--step", "1ms,2,5ms"), "write 1ms,2.5ms"),
        ((*TUNE, "0,8"), "--restitution: '0,8' has a decimal comma; write 0.8"),
        ((*TUNE, "0.8", "--speed", "0,5..2m/s"), "write 0.5m/s"),
        ((*TUNE, "0.8", "--step", "0,5ms"), "write 0.5ms"),
        ((*FIT, "--fix", "gravity=9,81"), "--fix gravity: '9,81' has a decimal comma; write 9.81"),
        ((*FIT, "--prior", "drop_height=0,5m:2mm"), "write 0.5m"),
        ((*FIT, "--prior", "drop_height=1m:2,5mm"), "write 2.5mm"),
        ((*FIT, "--u-time", "0,5ms"), "write 0.5ms"),
    ],
    ids=lambda value: " ".join(value[-2:]) if isinstance(value, tuple) else "",
)
def test_a_decimal_comma_is_told_with_the_number_that_is_read(call, words, instead):
    code, out, err = call(*words)
    assert (code, out) == (2, "")
    assert instead in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("text", "pointed"),
    [
        ("0,5m", "0.5m"), (" -0,5 m ", "-0.5m"), ("1.234,5", "1234.5"), ("3,14rad", "3.14rad"),
        ("1ms,2ms", None), ("0.5m", None), ("0,5,1", None), (",5m", None), ("1.5,2", None),
    ],
)  # fmt: skip
def test_only_a_decimal_comma_is_taken_for_one(text, pointed):
    found = units.with_point(text)
    assert found == pointed
    if found:
        units.to_si(found, "1" if found[-1].isdigit() else found.lstrip("-.0123456789"), "here")


def test_a_wrong_unit_is_told_before_the_comma():
    with pytest.raises(InputError, match="the unit 'kg' does not fit; expected m"):
        units.to_si("0,5kg", "m", "here")


@pytest.mark.parametrize("step", ["1ms,2ms", "0.001,0.002"])
def test_steps_with_commas_are_several_steps(step):
    run = simcompare.run("ball", engine="pymunk", contact="default", step=step, seeds=1)
    assert len(run.record.sources) == 2


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (
            (*RUN, "--step", "5"),
            "a bare number is in seconds, and 5 s is too long for 4.105 s",
        ),
        ((*RUN, "--step", "5"), "such as 5ms"),
        ((*RUN, "--step", "5s"), "--step: 5s is too long"),
        ((*RUN, "--step", "1e-12"), "is too short for 4.105 s; use 420 ns to 41 ms, such as 1ms"),
        (("validate", "pendulum", "-r", "pendulum_free_swing", "--step", "5"), "such as 5ms"),
        (("fit", "pendulum", "-r", "pendulum_free_swing", "--step", "5"), "such as 5ms"),
        (("export", "ball", "--format", "script", "--engine", "mujoco", "--step", "5"), "5ms"),
        (("characterize", "--step", "2"), "a bare number is in seconds, and 2 s is no step"),
        ((*TUNE, "0.8", "--step", "2"), "such as 2ms"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_a_step_that_is_too_long_is_told_with_one_that_is_not(call, words, sentence):
    code, out, err = call(*words)
    assert (code, out) == (2, "")
    assert sentence in err


def test_a_controlled_run_refuses_such_a_step_too():
    with pytest.raises(InputError, match="such as 5ms"):
        simcompare.control("robot", lambda *_: {}, engine="mujoco", step=5)


@pytest.mark.parametrize("step", ["5ms", "41ms", "420ns"])
def test_the_steps_that_the_message_names_are_taken(step):
    from simcompare.comparison.repeats import sample_step_s
    from simcompare.scenarios import catalogue

    assert sample_step_s(catalogue.load("ball"), {}, None, step) > 0


@pytest.mark.parametrize(
    ("setting", "sentence"),
    [
        ("drop_height=50", "drop_height_m = 50 m is outside 1 cm to 20 m; did you mean "
         "drop_height=50cm?"),
        ("gravity=98", "gravity_m_s2 = 98 m/s² is outside 0.1 m/s² to 30 m/s²\n"),
        ("drop_height=5000", "did you mean drop_height=5000mm?"),
        ("drop_height=-1", "drop_height_m = -1 m is outside 1 cm to 20 m\n"),
    ],
)  # fmt: skip
def test_a_number_out_of_bounds_is_told_with_the_unit_that_was_forgotten(call, setting, sentence):
    code, _, err = call(*RUN, "--set", setting)
    assert code == 2
    assert sentence in err


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.01, "m", "1 cm"), (20.0, "m", "20 m"), (0.5, "kg", "500 g"), (0.0, "m", "0 m"),
        (-0.002, "s", "-2 ms"), (0.1, "m/s**2", "0.1 m/s²"), (0.7, "1", "0.7"),
        (0.02, "N*m", "20 mN·m"), (0.3, "rad", "0.3 rad"),
    ],
)  # fmt: skip
def test_an_amount_is_said_in_the_unit_that_people_use_and_can_be_typed_so(value, unit, text):
    assert notation.amount(value, unit) == text
    assert units.to_si(text, unit, "here") == pytest.approx(value)


def test_bounds_in_two_digits_are_within_the_exact_ones():
    assert notation.rounded_within(4.1046e-7, 0.041046) == pytest.approx((4.2e-7, 0.041))
    assert notation.rounded_within(0.01, 20.0) == pytest.approx((0.01, 20.0))
