"""A rate or an interval in the lines above a table is its clock."""

from __future__ import annotations

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import importing
from simcompare.hardware.mapping import NOTHING

ROWS = "x (m),y (m)\n" + "".join(f"{0.1 * i:.1f},{-i}\n" for i in range(40))


@pytest.fixture
def read(tmp_path):
    def of(text):
        (tmp_path / "log.csv").write_text(text, encoding="utf-8")
        (stream,) = importing.read(tmp_path / "log.csv", NOTHING).streams.values()
        return stream

    return of


@pytest.mark.parametrize(
    ("line", "step_s"),
    [
        ("Sample rate: 100 Hz", 0.01), ("Sampling frequency (kHz),0.1", 0.01),
        ("# fs = 100", 0.01), ("Frame Rate;100", 0.01), ("Sample interval (ms),10", 0.01),
        ("Sampling period: 0.01 s", 0.01), ("dt = 0.01", 0.01), ("Time interval,:,0.4uS", 4e-7),
        ("Delta t = 0,01 s", 0.01), ("Data rate: 1.5e3 S/s", 1 / 1500),
    ],
)  # fmt: skip
def test_what_the_head_says_is_the_clock(read, line, step_s):
    stream = read(f"{line}\n{ROWS}")
    assert stream.time_s == pytest.approx(step_s * np.arange(40))
    assert [*stream.channels] == ["x_m", "y_m"]


@pytest.mark.parametrize(
    "line",
    [
        "Sample rate: 1,000 Hz",  # one, or a thousand
        "Sample interval: 10",  # seconds, or milliseconds
        "Baud rate: 9600", "Sample rate: 20 V", "Sample rate: 0 Hz", "Sample rate: fast",
    ],
)  # fmt: skip
def test_what_may_be_read_in_two_ways_is_no_clock(read, line):
    with pytest.raises(InputError, match="no column is a time"):
        read(f"{line}\n{ROWS}")


def test_a_column_of_times_goes_before_the_head(read):
    rows = "t (s),x (m)\n" + "".join(f"{0.02 * i:.2f},{i}\n" for i in range(40))
    assert read(f"Sample rate: 100 Hz\n{rows}").time_s[-1] == pytest.approx(0.78)


def test_increments_of_an_oscilloscope_stand_beside_its_names(read):
    text = "CH1V,CH2V,t0 =-5.0e-02, tInc = 1.0e-05,\n" + "".join(
        f"{0.1 * i:.1f},{-i},,\n" for i in range(40)
    )
    stream = read(text)
    assert stream.time_s == pytest.approx(1e-5 * np.arange(40))
    assert stream.clock.first_s == pytest.approx(-0.05)
    assert stream.channels["ch1_V"].values[3] == 0.3
