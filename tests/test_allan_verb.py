"""The verb ``allan``: arrays, logs and recordings in; sentences, numbers and a plot out."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from simcompare import cli
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.recordings import registry
from simcompare.hardware.sensors import data_sheet, error_model
from simcompare.model.trajectory import Array
from simcompare.reports import builder
from simcompare.reports.allan import page, words
from simcompare.statistics.streams import stream
from simcompare.verbs.allan import allan
from simcompare.verbs.allan_shown import Allan
from tests import noise_records

RATE_HZ = 100.0
DEGREE = np.pi / 180
runner = CliRunner()


def gyroscope(count: int = 6000) -> Array:
    """Three axes with the noise density 0.005 °/s/√Hz, one-sided."""
    draw = np.random.default_rng(11)
    columns = [noise_records.white(draw, count, RATE_HZ) for _ in range(3)]
    return np.asarray(np.column_stack(columns) * (0.005 * DEGREE / np.sqrt(2)))


@pytest.fixture(scope="module")
def found() -> Allan:
    return allan(gyroscope(), rate_Hz=RATE_HZ, unit="rad/s", sheet="mpu6050")


def test_white_noise_of_each_axis_is_told_in_the_unit_of_the_sheet(found: Allan) -> None:
    for axis in found.axes:
        white = axis.term("N")
        assert white.value is not None
        assert 2**0.5 * white.value / white.sheet_size == pytest.approx(0.005, rel=0.04)
        assert white.sheet_unit == "°/s/√Hz"
        assert axis.term("B").value is None
    assert "°/s/√Hz (x, y and z), one-sided density" in words.answer(found)[0]


def test_it_is_held_against_a_data_sheet(found: Allan) -> None:
    assert [row.ratio for row in found.against] == pytest.approx([1, 1, 1], rel=0.04)
    (said,) = words.against(found)
    assert said.startswith("Beside the typical noise of mpu6050, gyroscope: ")
    assert said.endswith("times (as the sheet says).")


def test_a_notebook_and_a_page_show_it(found: Allan) -> None:
    assert "noise density n" in found._repr_html_()
    assert len(found.deviations()) == 3 * len(found.axes[0].tau_s)
    assert found.plot().axes
    text = builder.html_of([page.block_of(found)])
    assert "Gyroscope" in text


def test_a_ramp_is_called_what_warming_up_does() -> None:
    rates = gyroscope()[:, 0] + 1e-5 * np.arange(6000) / RATE_HZ
    said = words.notes(allan(rates, rate_Hz=RATE_HZ, unit="rad/s"))
    assert any("a sensor that warms up does that" in one for one in said)


def log(tmp_path: Path, values: Array) -> Path:
    """A log of a gyroscope."""
    time_s = np.arange(len(values)) / RATE_HZ
    path = tmp_path / "gyro.csv"
    rows = [f"{t:.3f},{x:.9f},{y:.9f},{z:.9f}" for t, (x, y, z) in zip(time_s, values, strict=True)]
    head = "time_s,rate_x_rad_s,rate_y_rad_s,rate_z_rad_s"
    path.write_text("\n".join([head, *rows]), encoding="utf-8")
    return path


def test_the_longest_still_stretch_is_found(tmp_path: Path) -> None:
    values = gyroscope(4000)
    values[1000:1800] += 0.3 * np.sin(np.arange(800) / 30)[:, None]
    found = allan(log(tmp_path, values), channel="rate_x")
    # blocks of half a second
    assert found.start_s == pytest.approx(18.0, abs=1.0)
    assert found.end_s == pytest.approx(39.99)
    assert "the longest stretch in which nothing moves" in words.stretch(found)
    given = allan(tmp_path / "gyro.csv", channel="rate_x", start="5s", until="30s")
    (moving,) = [one for one in words.notes(given) if one.startswith("Something may move")]
    assert re.search(r"--from 1[789][.\d]*s --until (29|30)[.\d]*s\.$", moving)


@pytest.mark.parametrize("rate_rad_s", [0.2, 7.0, 12.0, 60.0])
def test_a_record_that_never_rests_is_refused(tmp_path: Path, rate_rad_s: float) -> None:
    swing = 3 * np.sin(rate_rad_s * np.arange(2000) / RATE_HZ)
    moving = log(tmp_path, gyroscope(2000) + swing[:, None])
    with pytest.raises(InputError, match="no still stretch is found in it; record it at rest, or"):
        allan(moving)
    assert allan(moving, start="1s", until="12s").chosen == "given"


def test_a_claim_is_of_one_kind_of_sensor(tmp_path: Path) -> None:
    path = log(tmp_path, gyroscope(600))
    head = "time_s,rate_x_rad_s,rate_y_rad_s,acceleration_x_m_s2"
    path.write_text(path.read_text(encoding="utf-8").replace(path.read_text().split("\n")[0], head))
    claims = {"density": 1e-4}
    told = "in rad/s and m/s², and a claim is of one unit; choose with channel"
    with pytest.raises(InputError, match=told):
        allan(path, audit=True, claims=claims, start=0.0)
    assert allan(path, channel="rate", audit=True, claims=claims, start=0.0).audited


def test_a_claim_that_is_given_twice_is_refused() -> None:
    cli.register()
    twice = ["--claim", "density=1", "--claim", "density=2"]
    result = runner.invoke(cli.app, ["allan", "x.csv", "--audit", *twice])
    assert result.exit_code == 2
    assert "density is given twice" in result.output


def test_the_command_line_prints_what_was_asked(tmp_path: Path) -> None:
    path = log(tmp_path, gyroscope(1500))
    cli.register()
    asked = ["allan", str(path), "--channel", "rate_y", "--from", "2s", "--until", "9s", "--json"]
    result = runner.invoke(cli.app, asked)
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert [axis["channel"] for axis in told["axes"]] == ["rate_y_rad_s"]
    assert (told["start_s"], told["chosen"]) == (2.0, "given")
    plain = runner.invoke(cli.app, asked[:-1])
    assert "Taken: 2 s to 9 s of 14.99 s, as asked for" in plain.output


def test_gaps_and_missing_values_are_left_out() -> None:
    values = gyroscope(3000)
    values[1000, 1] = np.nan
    found = allan(values, rate_Hz=RATE_HZ)
    assert found.chosen == "gap"
    assert found.start_s == pytest.approx(10.01)
    assert "the longest stretch without a gap there" in words.stretch(found)


@pytest.mark.parametrize(
    ("values", "more", "fault"),
    [
        (np.zeros(500), {"rate_Hz": 100}, "all 500 readings of readings are the same; there is no"),
        (np.ones(30), {"rate_Hz": 100}, "holds 30 of 30 readings; expected 64"),
        (np.ones(300), {}, "readings need their rate, such as rate_Hz=100"),
        (gyroscope(300), {"rate_Hz": 100, "start": "2.9s"}, "holds 10 of 300 readings"),
        (object(), {"rate_Hz": 100}, "object is no recording and holds no numbers"),
    ],
)
def test_what_cannot_be_analysed_is_refused(values: object, more: dict, fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        allan(values, **more)


def test_a_channel_without_noise_is_told() -> None:
    values = gyroscope(1000)
    values[:, 1] = 0.25
    found = allan(values, rate_Hz=RATE_HZ)
    assert [axis.channel for axis in found.axes] == ["x", "z"]
    assert "No noise at all in y: every reading is the same." in words.notes(found)
    told = allan(values, rate_Hz=RATE_HZ, audit=True)
    assert [one.channel for one in told.findings if one.fault] == ["y"]


def test_a_channel_that_there_is_not(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="rate_x_rad_s"):
        allan(log(tmp_path, gyroscope(200)), channel="acc")


def test_uneven_readings_are_refused(tmp_path: Path) -> None:
    path = log(tmp_path, gyroscope(400))
    lines = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([lines[0], *lines[1:100], *lines[100::2]]), encoding="utf-8")
    with pytest.raises(InputError, match="unevenly"):
        allan(path, start="0s", until="3.9s")


@pytest.mark.skipif(registry.place("imu_broad_translation") is None, reason="not on this machine")
def test_white_noise_of_a_real_sensor() -> None:
    found = allan("imu_broad_translation", channel="acc", start="0s", until="32.8s")
    white = [axis.term("N") for axis in found.axes]
    told = [2**0.5 * (term.value or 0.0) / term.sheet_size for term in white]
    # first differences, one-sided: 381, 419 and 600 µg/√Hz
    assert told == pytest.approx([381, 419, 600], rel=0.03)


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("adxl345", "accelerometer"), ("lsm6dso", "accelerometer"), ("lsm6dso", "gyroscope"),
        ("bmp280", "barometer"), ("bmp388", "barometer"),
    ],
)  # fmt: skip
def test_a_device_of_a_sheet_is_recovered_from_its_own_simulation(name: str, part: str) -> None:
    device = data_sheet.load(name).part(part).typical()
    ends = np.array([0.0, (2**14 - 1) / device.rate_Hz])
    still = np.ones((2, device.axes))
    read = error_model.measured(device, ends, still, stream(4, name, part)).measured
    unit = data_sheet.load(name).part(part).unit
    found = allan(read, rate_Hz=device.rate_Hz, unit=unit, sheet=name)
    # five times the 0.7 % that so many readings tell
    assert [row.ratio for row in found.against] == pytest.approx([1] * device.axes, abs=0.035)
    # a count of the ADXL345 is twice its noise: its rounding is told, and no noise of the chip
    assert any("Rounding to whole counts" in one for one in words.against(found)) is (
        name == "adxl345"
    )


def test_rounding_that_is_no_noise_is_not_taken_off() -> None:
    # a quarter of a count: 5 % of all readings are not 0
    noise = 0.25 * np.random.default_rng(3).normal(size=4000)
    found = allan(np.rint(noise), rate_Hz=100.0, unit="rad/s", sheet="mpu6050")
    white = found.axes[0].term("N").value
    assert white is not None
    assert found.against[0].found == pytest.approx(2**0.5 * white)
