"""Units at the rim: what a user writes becomes the SI number that the name asks for."""

from __future__ import annotations

import math
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simcompare import units
from simcompare.errors import InputError

UNITS = sorted(set(units.UNITS_BY_SUFFIX.values()))
finite = st.floats(-1e12, 1e12, allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("30cm", "m", 0.3),
        (" 30 cm ", "m", 0.3),
        ("1ms", "s", 1e-3),
        ("-.5e1mm", "m", -0.005),
        ("90deg", "rad", math.pi / 2),
        ("36 km/h", "m/s", 10.0),
        ("9.81 m/s^2", "m/s**2", 9.81),
        ("1 g/cm³", "kg/m**3", 1000.0),
        ("2.7g", "kg", 0.0027),
        ("80%", "1", 0.8),
        ("1e-3", "m", 0.001),
        ("0.3", "1", 0.3),
        (0.3, "m", 0.3),
        (3, "m", 3.0),
    ],
)
def test_a_quantity_becomes_si(text, unit, value):
    assert units.to_si(text, unit, "here") == pytest.approx(value, rel=1e-12)


@given(value=finite, unit=st.sampled_from(UNITS))
def test_a_plain_number_is_in_the_units_of_the_name(value, unit):
    assert units.to_si(repr(value), unit, "here") == value
    assert units.to_si(value, unit, "here") == value


@given(value=finite, unit=st.sampled_from(UNITS))
def test_the_unit_that_messages_show_is_understood(value, unit):
    assert units.to_si(f"{value!r} {units.symbol(unit)}", unit, "here") == pytest.approx(value)


@given(value=finite, prefix=st.sampled_from([("k", 1e3), ("c", 1e-2), ("m", 1e-3), ("µ", 1e-6)]))
def test_a_prefix_scales(value, prefix):
    letter, factor = prefix
    assert units.to_si(f"{value!r}{letter}m", "m", "here") == pytest.approx(value * factor)


@pytest.mark.parametrize("text", ["20 degC", "68 degF"])
def test_a_temperature_with_an_offset_is_converted_or_refused_but_never_multiplied(text):
    try:
        value = units.to_si(text, "K", "here")
    except InputError:
        return
    assert value == pytest.approx(293.15)


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("3s", "m", "m or a multiple"),
        ("3 m", "1", "no unit"),
        ("3 furlnog", "m", "'furlnog' is not a unit"),
        ("abc", "kg", "'abc' is not a number; expected a number in kg"),
        ("", "m", "not a number"),
        ("nan", "m", "not a number"),
        ("1,5", "m", "'1,5' has a decimal comma; write 1.5"),
        ("1.5.2", "m", "'.2' is not a unit"),
    ],
)
def test_a_wrong_quantity_is_one_sentence_that_names_the_place(text, unit, expected):
    with pytest.raises(InputError) as error:
        units.to_si(text, unit, "--set height_m")
    assert error.value.where == "--set height_m"
    assert expected in str(error.value)


@pytest.mark.parametrize(
    "text",
    ["2 )", "2 1/0", "3 __import__('os')", "2 'm'", "2 m**(", "2 m\\", "2 0*m", "2 m;m", "2 \0"],
)
def test_a_unit_that_is_no_unit_at_all_is_an_input_error_too(text):
    with pytest.raises(InputError):
        units.to_si(text, "m", "here")


@pytest.mark.parametrize("text", ["1e999", "1e999 mm", "-1e999"])
def test_a_number_too_large_for_a_double_is_refused_at_once(text):
    with pytest.raises(InputError):
        units.to_si(text, "m", "here")


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("drop_height_m", "m"),
        ("gravity_m_s2", "m/s**2"),
        ("speed_m_s", "m/s"),
        ("air_density_kg_m3", "kg/m**3"),
        ("inertia_kg_m2", "kg*m**2"),
        ("damping_N_m_s_rad", "N*m*s/rad"),
        ("restitution", "1"),
        ("drag_coefficient", "1"),
    ],
)
def test_the_longest_suffix_of_a_name_is_its_unit(name, unit):
    assert units.unit_of(name) == unit


def test_a_name_is_found_with_and_without_its_suffix():
    known = ["drop_height_m", "restitution", "gravity_m_s2"]
    assert units.find_name("drop_height_m", known) == "drop_height_m"
    assert units.find_name("drop_height", known) == "drop_height_m"
    assert units.find_name("gravity", known) == "gravity_m_s2"
    assert units.find_name("gravity_m", known) is None
    assert units.find_name("drop", known) is None


def test_a_whole_name_is_preferred_to_a_name_without_its_suffix():
    assert units.find_name("length", ["length_m", "length"]) == "length"


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("10mNm", "N*m", 0.01),
        ("2 Nm", "N*m", 2.0),
        ("9.81m/s2", "m/s**2", 9.81),
        ("3cm2", "m**2", 3e-4),
    ],
)
def test_units_are_read_as_people_write_them(text, unit, value):
    assert units.to_si(text, unit, "--set") == pytest.approx(value)


@pytest.mark.parametrize(("text", "near"), [("mm/sq", "mm/s"), ("turns/mn", "turn/min")])
def test_a_unit_that_is_nearly_one_is_told_with_it(text, near):
    with pytest.raises(InputError) as error:
        units.si_of(text, "here")
    assert f"did you mean {near}" in str(error.value)


def test_a_question_mark_is_no_unit_but_is_to_be_replaced():
    with pytest.raises(InputError, match=r"replace the \?"):
        units.si_of("?", "here")


@pytest.mark.parametrize("unit", sorted(units.MULTIPLES))
def test_what_is_read_without_pint_is_what_pint_makes_of_it(unit):
    si, factor = units.MULTIPLES[unit]
    registry = units._registry()
    for number in (1.0, 3.7, 0.05, 7e-5, 123456.789):
        assert registry.Quantity(number, unit).to(si).magnitude == number * factor


def test_scenarios_with_stated_widths_load_without_pint():
    code = "import sys; from simcompare.scenarios import catalogue; catalogue.load('ball');"
    run = subprocess.run(
        [sys.executable, "-c", code + "print('pint' in sys.modules)"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert run.stdout.strip() == "False"
