"""The verb ``sensor``: what it says of a sheet, in words, numbers, JSON and a page."""

from __future__ import annotations

import functools
import json
import math

import numpy as np
import pytest
from typer.testing import CliRunner

import simcompare
from simcompare import cli
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors import data_sheet
from simcompare.reports import builder
from simcompare.reports.sensor import figures, page, words
from simcompare.verbs import sensor as verb

G = 9.80665


told = functools.cache(simcompare.sensor)


def printed(*arguments: str) -> str:
    cli.register()
    result = CliRunner().invoke(cli.app, ["sensor", *arguments], env={"COLUMNS": "200"})
    assert result.exit_code == 0, result.output
    return " ".join(result.stdout.split())


def test_the_answer_is_one_sentence():
    assert words.answer(told("mpu6050")) == (
        "A reading of 1 g on the z axis of any MPU-6050 (accelerometer), as it leaves the factory,"
        " is uncertain by u = 0.84 m/s² (86 mg); offset does most of it, 87 % of the variance."
    )
    assert words.answer(told("bmp280")) == (
        "A reading of 1013.25 hPa of any BMP280 (barometer), as it leaves the factory, is uncertain"
        " by u = 100 Pa; offset does most of it, 100 % of the variance."
    )
    # 1 % of 100 °/s and 1 °/s: neither does more than half
    assert "sensitivity and offset do most of it" in words.answer(told("lsm6dso", part="gyroscope"))


def test_what_must_be_said_besides():
    assert list(words.further(told("mpu6050", part="gyroscope"))) == [
        "Settings: range 250 °/s, 1000 samples a second, bandwidth 42 Hz (noise bandwidth 66 Hz),"
        " 25 °C.",
        "10 000 devices drawn from the sheet give u = 0.35 rad/s (20 °/s), which agrees with the"
        " first order; 95 % of them read between 61 and 140 °/s.",
        "A typical value is taken as one standard deviation. If it were two, it would be"
        " u = 0.18 rad/s (10 °/s).",
        "The other axes feel nothing here (across = 0), so cross-axis sensitivity adds nothing.",
        "The sheet states noise twice: 0.005 °/s/√Hz, and 0.05 °/s at 100 Hz (p. 12). From the"
        " first and one pole one expects 25 % more than the second; they agree for a filter that"
        " ends sharply at its bandwidth.",
        "All 8 lines in use were read in the maker's own text.",
    ]
    last = list(words.further(told("ina219")))[-1]
    assert last == (
        "1 of 5 lines in use was not read in the maker's own text (sensitivity): hold it against"
        " the sheet before you rely on it."
    )


def test_shares_add_to_the_whole():
    found = told("icm20948", across="1 g", temperature=45.0)
    assert math.fsum(row.share for row in found.shares) == pytest.approx(1.0)
    rows = {row.term: row.contribution for row in found.shares}
    assert rows["cross_axis"] == pytest.approx(0.02 * G)
    assert rows["offset_per_K"] == pytest.approx(20 * 0.8e-3 * G)
    assert found.u == pytest.approx(math.hypot(*rows.values()))


def test_the_meaning_of_typical_can_be_chosen():
    whole, half = told("mpu6050"), told("mpu6050", typ_is_sigma=0.5)
    assert half.u == pytest.approx(whole.u_if_two_sigma)
    assert half.u < 0.55 * whole.u


def test_a_reading_at_the_end_of_the_range_is_said_to_be_cut_off():
    found = told("mpu6050", reading="2 g")
    assert not found.agrees
    text = " ".join(words.further(found))
    assert "of them are cut off at the end of the range" in text
    assert "trust the draws" in text


def test_what_grows_with_time_is_left_out_of_one_reading(tmp_path):
    lines = (
        "      - {term: bias_instability, says: in-run, typ: 40 µg, page: 1, confirmed: true}\n"
        "      - {term: random_walk, says: ramp, typ: 2 µg/√s, page: 1, confirmed: true}\n"
    )
    path = tmp_path / "slow.yaml"
    path.write_text(verb.template() + lines, encoding="utf-8")
    found = simcompare.sensor(path)
    assert "Bias instability and random walk grow with time and are left out of one reading." in (
        words.further(found)
    )
    assert found.agrees
    device = data_sheet.load(path).part().drawn(0)
    assert device.bias_instability == pytest.approx(np.full(3, 40e-6 * G))
    assert device.random_walk == pytest.approx(np.full(3, 2e-6 * G))


def test_a_few_cut_off_are_told_where_both_ways_agree():
    found = told("mpu6050", reading="1.8 g")
    assert found.agrees
    assert "1.9 % of them are cut off at the end of the range." in " ".join(words.further(found))


def test_the_figures_show_what_was_counted():
    found = told("mpu6050")
    assert sum(found.counts) == found.draws
    shares, drawn = figures.shares(found), figures.readings(found)
    assert shares.panels[0].bars[0].heights.sum() == pytest.approx(100.0)
    bell, points = drawn.panels[0].series
    # the same density, within five standard deviations of the counts in the fullest bin
    assert points.y.max() == pytest.approx(bell.y.max(), rel=5 / math.sqrt(max(found.counts)))
    with pytest.raises(UnknownName, match="no figure is called 'share'; did you mean shares"):
        found.plot("share")


def test_devices_are_those_of_the_same_seed():
    first = told("adxl345", draw=3, seed=4).devices
    assert len(first) == 3
    assert first == told("adxl345", draw=3, seed=4).devices
    assert first != told("adxl345", draw=3, seed=5).devices
    assert len(told("adxl345", draw=2).drawn()) == 6


def test_a_notebook_shows_answer_table_and_figure():
    found = told("mpu6050")
    assert "<img" in found._repr_html_()
    assert "offset does most of it" in repr(found)
    assert "±80 mg" in found.table().to_string()
    assert "mpu6050" in told().table().to_string()


def test_all_sheets_are_listed():
    text = printed()
    assert "mpu6050 accelerometer specific force 2 g, 4 g, 8 g, 16 g 4 to 1000 13 0" in text
    rows = json.loads(printed("--json"))["sheets"]
    assert {row["name"] for row in rows} >= {"adxl345", "bmp280", "vl53l5cx"}


def test_the_table_says_where_each_value_comes_from():
    text = printed("adxl345")
    assert "offset, z ±40 mg typical, -250 mg to 250 mg p. 3 normal, cut off" in text
    assert "noise, z 430 µg/√Hz p. 33 normal 0.03 0.5 yes" in text


def test_rules_can_be_repeated():
    text = printed("--rules")
    assert "u = a/√3" in text
    assert "two devices of three are within it" in text
    assert "u = LSB/√12" in text


def test_json_is_one_object():
    found = json.loads(printed("mpu6050", "--bandwidth", "94Hz", "--json"))
    assert found["bandwidth_Hz"] == 94.0
    assert found["agrees"] is True
    assert {row["name"] for row in found["entries"]} >= {"offset_xy", "offset_z", "resolution"}
    assert json.loads(printed("ina219", "--json"))["bandwidth_Hz"] is None


def test_the_template_can_be_used_at_once(tmp_path):
    path = tmp_path / "mine.yaml"
    cli.register()
    path.write_text(CliRunner().invoke(cli.app, ["sensor", "--template"]).stdout, encoding="utf-8")
    assert "A reading of 1 g on the z axis of any MY-SENSOR (accelerometer)" in printed(str(path))


def test_the_page_holds_answer_lines_and_rules(tmp_path):
    found = told("mpu6050", draw=2)
    path = builder.write_html_of([page.block_of(found, verb.rules())], tmp_path / "page.html")
    text = path.read_text(encoding="utf-8")
    for part in (
        "offset does most of it",
        "Zero-G Output",
        "Drawn devices",
        "JCGM 100:2008, 4.3.7",
    ):
        assert part in text


@pytest.mark.parametrize(
    ("given", "fault"),
    [
        ({"across": "3 g"}, "across: 3 g is beyond the range 2 g; choose another range"),
        ({"reading": math.nan}, "reading: nan m/s² is beyond the range 2 g; choose another range"),
        ({"reading": "3 g"}, "reading: 3 g is beyond the range 2 g; choose another range"),
        ({"reading": "3 m"}, "'m' is no unit that fits; expected a number with a unit"),
        ({"axis": "w"}, "no axis of the accelerometer is called 'w'; known: x, y, z"),
        ({"temperature": 900.0, "draw": -1}, "2 faults"),
        ({"rate": "fast"}, "'fast' is not a number; expected a number in Hz"),
        ({"typ_is_sigma": 0.0}, "expected a number above 0 and up to 3"),
    ],
)
def test_what_cannot_be_is_refused(given, fault):
    with pytest.raises((InputError, UnknownName), match=fault):
        told("mpu6050", **given)
