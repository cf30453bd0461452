"""Angles that begin again after a turn are unwrapped, recorded, and told in their own unit."""

import numpy as np
import pytest

from simcompare.hardware.conditioning.values import angle_wrap, counter_wrap, saturation
from tests.conditioned import work_of

TIME = np.arange(400) / 100
#: slowly round, three times, and back a little
TURNED = np.degrees(6 * np.pi * np.sin(0.5 * TIME))


def wrapped(degrees, low):
    return (degrees - low) % 360 + low


@pytest.mark.parametrize("low", [0.0, -180.0])
@pytest.mark.parametrize(("unit", "size"), [("deg", 1.0), ("rad", np.pi / 180), ("turn", 1 / 360)])
def test_the_turns_of_an_angle_are_added_up(low, unit, size):
    work = work_of(TIME, {"heading": (wrapped(TURNED, low) * size, unit)})
    angle_wrap.check(work)
    (repair,) = work.repairs
    made = work.data[0].values
    np.testing.assert_allclose(made - made[0], (TURNED - TURNED[0]) * size, atol=1e-9)
    assert (repair.rule, repair.severity) == ("angle_wrap", "repair")
    jumps = 1 + np.flatnonzero(np.abs(np.diff(wrapped(TURNED, low))) > 300)
    assert [a for a, b in repair.rows for _ in range(a, b + 1)] == [1 + int(i) for i in jumps]
    assert f"{360 * size:.6g} {unit}" in repair.text


def test_an_angle_that_wraps_is_not_taken_for_a_sensor_at_its_end():
    mapping = {"channels": {"heading": {"column": "h", "unit": "deg", "limits": [0, 360]}}}
    work = work_of(TIME, {"h": (wrapped(TURNED, 0.0), "deg")}, mapping)
    angle_wrap.check(work)
    saturation.check(work)
    assert not work.saturated


@pytest.mark.parametrize(
    ("values", "unit"),
    [
        (TURNED, "deg"),  # never wraps
        (wrapped(TURNED, 0.0), "V"),  # is no angle
        (np.where(TIME < 2, -170.0, 10.0), "deg"),  # half a turn
        (180 * np.sin(3 * TIME), "deg"),  # reaches both ends, slowly
        (np.random.default_rng(1).uniform(-180, 180, 400), "deg"),  # noise
    ],
)
def test_what_does_not_wrap_is_left(values, unit):
    work = work_of(TIME, {"h": (values, unit)})
    angle_wrap.check(work)
    assert not work.repairs
    np.testing.assert_array_equal(work.data[0].values, values)


def test_an_angle_that_also_jumps_by_parts_of_a_turn_is_told_and_left():
    values = wrapped(TURNED, 0.0)
    values[200:] = wrapped(values[200:] + 120.0, 0.0)
    work = work_of(TIME, {"h": (values.copy(), "deg")})
    angle_wrap.check(work)
    assert [repair.severity for repair in work.repairs] == ["warning"]
    assert "wraps: 360" in work.repairs[0].text
    np.testing.assert_array_equal(work.data[0].values, values)


def test_wraps_of_a_mapping_are_told_in_the_unit_of_the_column():
    mapping = {"channels": {"heading": {"column": "h", "unit": "deg", "wraps": 360}}}
    work = work_of(TIME, {"h": (wrapped(TURNED, 0.0), "deg")}, mapping)
    counter_wrap.check(work)
    angle_wrap.check(work)
    (repair,) = work.repairs
    assert "begins again after 360 deg, " in repair.text
