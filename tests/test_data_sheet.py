"""Data sheets become distributions, and distributions become devices."""

from __future__ import annotations

import numpy as np
import pytest

from simcompare.hardware.sensors import data_sheet


@pytest.mark.parametrize("name", data_sheet.names())
def test_every_sheet_loads_and_every_line_has_its_source(name):
    sheet = data_sheet.load(name)
    for part in sheet.parts.values():
        assert part.terms
        for entry in part.terms.values():
            assert entry.source
            assert entry.page
            assert entry.distribution.u >= 0


def test_the_first_of_many_devices_is_the_one_device():
    part = data_sheet.load("mpu6050").part("accelerometer")
    one = part.drawn(7, "imu")
    many = part.drawn_many(7, 3, "imu")
    assert np.array_equal(many.device(0).sensitivity, one.sensitivity)
    assert np.array_equal(many.device(0).offset, one.offset)
    assert not np.array_equal(many.device(1).offset, one.offset)
