"""Data sheets become distributions, and distributions become devices."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from simcompare.errors import InputError, NoSuchFile, UnknownName
from simcompare.hardware.sensors import data_sheet, reading_uncertainty, sheet_units
from simcompare.hardware.sensors.reading_uncertainty import Situation
from simcompare.hardware.sensors.sheet_rules import RULE_OF_KIND, RULES, Stated
from simcompare.verbs import sensor

G = 9.80665
DEGREE = math.pi / 180
TEMPLATE = sensor.template()
#: what is said of the template after all changes of the test below
FAULTS = (
    "line 21, parts.accelerometer.ranges.2 g.full_scale: '-2 g' is not above 0",
    "line 22, parts.accelerometer.ranges.8 g.count: '4096' is no size of one count; "
    "expected one such as 100 LSB/mg or 0.01 mg/LSB",
    "line 29, parts.accelerometer.usual.rate: 50 Hz is none of the rates above",
    "line 29, parts.accelerometer.usual.bandwidth: 45 Hz is above half the rate, 25 Hz: "
    "noise and motion beyond it would come back at wrong frequencies; choose a lower "
    "bandwidth or a higher rate",
    "line 32, parts.accelerometer.entries.0.max: 3 % is below the typical 4 %; expected more",
    "line 33, parts.accelerometer.entries.1.term: no term is called 'crossaxis'; known: "
    "sensitivity, cross_axis, offset, nonlinearity, sensitivity_per_K, offset_per_K, noise,"
    " noise_per_reading, bias_instability, random_walk, rate",
    "line 34, parts.accelerometer.entries.2.rule: no rule is called 'gaussian' that can be "
    "chosen; known: rectangular, normal, truncated_normal, triangular, u_shaped, three_sigma, "
    "normal_95",
    "line 36, parts.accelerometer.entries.3.typ: 'mm' is no unit that fits; expected a "
    "number with a unit, such as 1 mg",
    "line 37, parts.accelerometer.entries.4.typ: '60' has no unit; expected a number with a"
    " unit, such as 1 mg",
    "line 38, parts.accelerometer.entries.5: rms says nothing of sensitivity_per_K; "
    "expected typ or max or min and max or typ and max",
    "line 40, parts.accelerometer.entries.6.over_C: 70 to 0 is no range; expected the lower"
    " one first",
    "line 41, parts.accelerometer.entries.7.density: -150 µg/√Hz is no size; expected a "
    "number above 0",
)


def written(tmp_path: Path, *changes: tuple[str, str]) -> Path:
    """The template as a file, with some of its texts changed."""
    text = TEMPLATE
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path = tmp_path / "mine.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", data_sheet.names())
def test_every_sheet_loads_and_every_line_has_its_source(name):
    sheet = data_sheet.load(name)
    assert sheet.read
    for part in sheet.parts.values():
        assert part.terms
        assert part.page
        for entry in part.terms.values():
            assert entry.source
            assert entry.page
            assert entry.says
            assert entry.distribution.u >= 0
            assert entry.rule_in_words.startswith(f"{entry.title}: the sheet says ")
        for one in part.ranges.values():
            assert one.page
            part.typical(range=one.name)


def test_the_seven_chips_of_the_course_are_there():
    course = {"adxl345", "mpu6050", "icm20948", "lsm6dso", "bmp280", "bmp388", "vl53l5cx"}
    assert course <= set(data_sheet.names())


@pytest.mark.parametrize(
    ("text", "unit", "per", "size"),
    [
        ("50 mg", "m/s**2", "", 0.05 * G),
        ("±50mg", "m/s**2", "", 0.05 * G),
        ("400 µg/√Hz", "m/s**2", "√Hz", 400e-6 * G),
        ("400 μg/sqrt(Hz)", "m/s**2", "√Hz", 400e-6 * G),
        ("0.80 mg/°C", "m/s**2", "K", 0.8e-3 * G),
        ("-150 mg", "m/s**2", "", -0.15 * G),
        ("20 °/s", "rad/s", "", 20 * DEGREE),
        ("0.005 °/s/√Hz", "rad/s", "√Hz", 0.005 * DEGREE),
        ("3.8 mdps/√Hz", "rad/s", "√Hz", 3.8e-3 * DEGREE),
        ("10 °/h", "rad/s", "", 10 * DEGREE / 3600),
        ("0.2 °/√h", "rad", "√s", 0.2 * DEGREE / 60),
        ("0.12 hPa", "Pa", "", 12.0),
        ("1.5 Pa/K", "Pa", "K", 1.5),
        ("0.02 %/°C", "1", "K", 2e-4),
        ("0.5 % FS", "1", "", 0.005),
        ("15 mm", "m", "", 0.015),
    ],
)
def test_units_of_sheets_are_read_in_si(text, unit, per, size):
    assert sheet_units.amount(text, unit, per) == pytest.approx(size, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "unit", "size"),
    [
        ("16384 LSB/g", "m/s**2", G / 16384),
        ("131 LSB/(°/s)", "rad/s", DEGREE / 131),
        ("0.061 mg/LSB", "m/s**2", 61e-6 * G),
        ("8.75 mdps", "rad/s", 8.75e-3 * DEGREE),
        ("2 LSB/mg", "m/s**2", 0.5e-3 * G),
    ],
)
def test_the_size_of_one_count_is_read_either_way(text, unit, size):
    assert sheet_units.step(text, unit) == pytest.approx(size, rel=1e-12)


@pytest.mark.parametrize(
    ("stated", "shape", "u"),
    [
        (Stated("typ", typ=2.0), "normal", 2.0),
        (Stated("typ", typ=2.0, typ_is_sigma=0.5), "normal", 1.0),
        (Stated("max", low=-3.0, high=3.0), "rectangular", 3 / math.sqrt(3)),
        (Stated("min_max", low=-1.0, high=3.0), "rectangular", 2 / math.sqrt(3)),
        # a normal distribution that is cut off at one standard deviation keeps 0.540 of it
        (Stated("typ_max", typ=1.0, low=-1.0, high=1.0), "truncated_normal", 0.53956),
        (Stated("rms", typ=0.3), "normal", 0.3),
        (Stated("density", typ=0.3), "fixed", 0.0),
        (Stated("resolution", typ=1.0), "rectangular", 1 / math.sqrt(12)),
    ],
)
def test_each_kind_of_value_has_its_rule(stated, shape, u):
    known = RULES[RULE_OF_KIND[stated.kind]].known(stated)
    assert known.kind == shape
    assert known.u == pytest.approx(u, rel=1e-4)  # digits of the number above


@pytest.mark.parametrize(
    ("rule", "u"),
    [("triangular", 6 / math.sqrt(6)), ("u_shaped", 6 / math.sqrt(2)), ("normal_95", 6 / 1.96),
     ("three_sigma", 2.0), ("rectangular", 6 / math.sqrt(3))],
)  # fmt: skip
def test_a_sheet_can_ask_for_another_rule(tmp_path, rule, u):
    path = written(tmp_path, ("max: 0.5 % FS,", f"max: 6 % FS, rule: {rule},"))
    entry = data_sheet.load(path).part().terms["nonlinearity"]
    assert entry.distribution.u == pytest.approx(u / 100, rel=1e-9)


def test_limits_in_counts_are_deviations_from_the_nominal():
    limits = data_sheet.load("adxl345").part().terms["sensitivity"].stated
    assert (limits.low, limits.high) == pytest.approx((230 / 256 - 1, 282 / 256 - 1))


def test_a_change_over_temperatures_is_a_slope_from_25_degrees():
    terms = data_sheet.load("mpu6050").part("accelerometer").terms
    assert terms["offset_per_K_xy"].distribution.u == pytest.approx(0.035 * G / 45)


def test_a_device_does_not_depend_on_other_sensors_or_terms(tmp_path):
    part = data_sheet.load("mpu6050").part("accelerometer")
    one = part.drawn(7, "imu")
    many = part.drawn_many(7, 3, "imu")
    assert np.array_equal(many.device(0).sensitivity, one.sensitivity)
    assert np.array_equal(many.device(0).offset, one.offset)
    assert not np.array_equal(many.device(1).offset, one.offset)
    assert not np.array_equal(part.drawn(7, "other").offset, one.offset)

    whole = data_sheet.load(written(tmp_path)).part().drawn(7)
    line = next(row for row in TEMPLATE.splitlines(keepends=True) if "term: cross_axis" in row)
    less = data_sheet.load(written(tmp_path, (line, ""))).part().drawn(7)
    assert np.array_equal(whole.offset, less.offset)
    assert np.array_equal(np.diag(whole.sensitivity), np.diag(less.sensitivity))


def test_drawn_devices_are_those_of_the_sheet():
    part = data_sheet.load("mpu6050").part("accelerometer")
    many = part.drawn_many(0, 20_000, "imu")
    # a standard deviation of 20 000 draws is known to 0.5 %; five times that
    assert many.offset.std(axis=0) == pytest.approx(np.array([0.05, 0.05, 0.08]) * G, rel=0.025)
    ones = np.diagonal(many.sensitivity, axis1=1, axis2=2)
    assert (ones - 1).std() == pytest.approx(0.03, rel=0.025)
    assert np.abs(many.nonlinearity).max() <= 0.005


@pytest.mark.parametrize("name", ["mpu6050", "adxl345", "bmp280", "ina219"])
def test_intervals_of_95_percent_cover_drawn_devices(name):
    part = data_sheet.load(name).part()
    now = Situation(part.axes[-1], part.reading, 0.0, part.settings())
    u = reading_uncertainty.combined(reading_uncertainty.shares(part, now))
    drawn = reading_uncertainty.drawn(part, now, 2000, seed=1)
    # k of 95 %: 1.96 where normal terms do most of it; a rectangular one ends at 1.73·u
    rectangular = name == "ina219"
    within = (
        np.abs(drawn.values - part.reading) <= (0.95 * math.sqrt(3) if rectangular else 1.96) * u
    )
    assert 0.93 <= within.mean() <= 0.97


def test_first_order_and_drawn_devices_agree_on_every_sheet():
    for name in data_sheet.names():
        for part in data_sheet.load(name).parts.values():
            now = Situation(part.axes[0], part.reading, 0.0, part.settings())
            u = reading_uncertainty.combined(reading_uncertainty.shares(part, now))
            assert reading_uncertainty.agree(
                u, reading_uncertainty.drawn(part, now, 4000, seed=0)
            ), f"{name} {part.name}"


def test_noise_is_the_density_behind_the_low_pass():
    part = data_sheet.load("mpu6050").part("accelerometer")
    now = Situation("z", G, 0.0, part.settings(bandwidth_Hz=44.0))
    noise = next(row for row in reading_uncertainty.shares(part, now) if row.term == "noise")
    # one pole of 44 Hz lets the noise of 44 Hz·π/2 through
    assert noise.u == pytest.approx(400e-6 * G * math.sqrt(44 * math.pi / 2), rel=1e-9)


def test_an_rms_of_one_reading_stays_what_it_is_at_any_rate():
    part = data_sheet.load("bmp280").part()
    for rate in (1.0, 20.0):
        device = part.typical(rate_Hz=rate)
        # white noise of a density n that is sampled f times a second: n·√(f/2)
        assert device.noise_density[0] * math.sqrt(rate / 2) == pytest.approx(1.3)


def test_two_lines_that_state_noise_are_held_against_each_other():
    check = reading_uncertainty.cross_checks(data_sheet.load("mpu6050").part("gyroscope"))[0]
    assert check.rms / DEGREE == pytest.approx(0.05)
    assert check.expected / DEGREE == pytest.approx(0.063, abs=5e-4)  # digits as published
    assert check.sharp / DEGREE == pytest.approx(0.05, rel=2e-3)  # rounding to counts adds 0.1 %


def test_an_rms_in_counts_holds_the_rounding_to_counts():
    checks = reading_uncertainty.cross_checks(data_sheet.load("adxl345").part())
    assert [check.rms * 256 / G for check in checks] == pytest.approx([0.75, 1.1])
    # 100 samples a second show 50 Hz of noise, in counts of 1/256 g, and 1/√12 count
    expected = [math.hypot(256e-6 * n * math.sqrt(50), 12**-0.5) for n in (290, 430)]
    assert [check.expected * 256 / G for check in checks] == pytest.approx(expected, rel=1e-9)


def test_a_relative_accuracy_turns_about_its_reading():
    part = data_sheet.load("bmp280").part()
    many = part.drawn_many(3, 2000)
    at_1000_hPa = many.sensitivity[:, 0, 0] * 1e5 + many.offset[:, 0] - 1e5
    # the slope is right there, so the absolute accuracy is all that is left: 1 hPa
    assert at_1000_hPa.std() == pytest.approx(100.0, rel=0.08)  # five times 1/√(2·2000)
    spread = (many.sensitivity[:, 0, 0] - 1).std() * 1e4
    assert spread == pytest.approx(12.0, rel=0.08)  # 0.12 hPa within 100 hPa


def test_settings_are_those_of_the_chip():
    part = data_sheet.load("mpu6050").part("accelerometer")
    assert part.settings(range="±4g").range.name == "4 g"
    assert (
        data_sheet.load("mpu6050").part("gyroscope").settings(range="500").range.name == "500 °/s"
    )
    # where the rate is too low for the usual bandwidth, the widest that fits is taken
    assert part.settings(rate_Hz=50.0).bandwidth_Hz == 21.0
    assert data_sheet.load("adxl345").part().settings(rate_Hz=800.0).bandwidth_Hz == 400.0


@pytest.mark.parametrize(
    ("settings", "fault"),
    [
        ({"range": "3 g"}, "no range of MPU-6050 accelerometer is called '3 g'"),
        ({"rate_Hz": 2000.0}, "a rate of 2000 Hz is not from 4 to 1000 Hz"),
        ({"bandwidth_Hz": 43.0}, "it has no bandwidth of 43 Hz; it has 5, 10, 21, 44, 94, 184"),
        ({"rate_Hz": 100.0, "bandwidth_Hz": 94.0}, "94 Hz is above half the rate, 50 Hz"),
    ],
)
def test_settings_that_the_chip_does_not_have_are_refused(settings, fault):
    part = data_sheet.load("mpu6050").part("accelerometer")
    with pytest.raises((InputError, UnknownName), match=fault):
        part.drawn(0, **settings)


def test_unknown_sheets_and_parts_are_named():
    with pytest.raises(UnknownName, match="no data sheet is called 'mpu60'; did you mean mpu6050"):
        data_sheet.load("mpu60")
    with pytest.raises(NoSuchFile):
        data_sheet.load("mine.yaml")
    with pytest.raises(NoSuchFile, match="is a folder; expected a data sheet in YAML"):
        data_sheet.load(Path(__file__).parent)
    with pytest.raises(UnknownName, match="no part of MPU-6050 is called 'magnetometer'"):
        data_sheet.load("mpu6050").part("magnetometer")


def test_the_template_is_a_sheet(tmp_path):
    part = data_sheet.load(written(tmp_path)).part("accelerometer")
    assert part.terms["sensitivity"].distribution.kind == "truncated_normal"
    assert part.drawn(0).bandwidth_Hz == 45.0


def test_all_faults_of_a_sheet_are_told_at_once(tmp_path):
    path = written(
        tmp_path,
        ("density: 150 µg/√Hz", "density: -150 µg/√Hz"),
        ("typ: 1 %, max: 3 %", "typ: 4 %, max: 3 %"),
        ("usual: {range: 2 g, rate: 100 Hz, bandwidth: 45 Hz}",
         "usual: {range: 2 g, rate: 50 Hz, bandwidth: 45 Hz}"),
        ("typ: 40 mg", "typ: 40 mm"),
        ("typ: 60 mg", "typ: 60"),
        ("max: 0.5 % FS,", "max: 0.5 % FS, rule: gaussian,"),
        ("typ: 0.02 %/°C", "rms: 0.02 %"),
        ("term: cross_axis, says", "term: crossaxis, says"),
        ("over_C: [0, 70]", "over_C: [70, 0]"),
        ("2 g: {full_scale: 2 g", "2 g: {full_scale: -2 g"),
        ("count: 4096 LSB/g", "count: 4096"),
    )  # fmt: skip
    with pytest.raises(InputError) as caught:
        data_sheet.load(path)
    assert caught.value.where == str(path)
    assert caught.value.faults == FAULTS


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("axes: 3   ", "axes: 2   ", "parts.accelerometer.axes: expected 1 or 3, found 2"),
        ("axes: xy,", "axes: xq,", "axes: is not written as it must be"),
        ("name: MY-SENSOR", "nme: MY-SENSOR", "name: is missing"),
        ("axes: z,", "axes: yz,", "offset of these axes and ranges stands twice; keep one"),
        ("range: 2 g, rate", "range: 4 g, rate", "no range is called '4 g'; known: 2 g, 8 g"),
        ("rate: 100 Hz, b", "rate: 150 Hz, b", "usual.rate: 150 Hz is none of the rates above"),
        ("width: 45 Hz}\n", "width: 40 Hz}\n", "40 Hz is none of the bandwidths above"),
        ("rms: 1.2 mg,", "rms: 1.2 mg, typ: 1 mg,", "expected one value or a pair: typ, max"),
        (
            "reading: 1 g",
            "reading: 100 g",
            "parts.accelerometer.reading: 100 g is beyond the usual range 2 g; expected one within",
        ),
        ("count: 16384 LSB/g", "count: 3 g", "one count, 3 g, is more than the full scale 2 g"),
        ("typ: 30 mg, over_C: [0, 70]", "typ: 30 mg", "the unit of '30 mg' does not fit"),
        ("FS, page: 12", "FS, rule: normal, page: 12", "rule: normal needs a typical value"),
        ("typ: 40 mg,", "typ: 40 mg, rule: truncated_normal,", "truncated_normal needs limits"),
        ("µg/√Hz, page", "µg/√Hz, rule: normal, page", "noise has the rule of its kind"),
        ("poles: 1  ", "poles: 9  ", "poles: expected a number of at most 4, found 9"),
    ],
)
def test_a_sheet_that_cannot_be_is_refused(tmp_path, old, new, fault):
    with pytest.raises(InputError) as caught:
        data_sheet.load(written(tmp_path, (old, new)))
    assert fault in str(caught.value)
