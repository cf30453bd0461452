"""The verb estimate: engines measured with drawn sensors, filtered, and judged by their truth."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import simcompare
from simcompare import cli
from simcompare.errors import InputError, UnknownName
from simcompare.estimation import estimators
from simcompare.estimation.consistency import Verdict
from simcompare.estimation.estimate import Given, Signal
from simcompare.model import plain
from simcompare.reports import builder
from simcompare.reports.estimation import figures, page, words
from simcompare.verbs import estimating

SCENARIO = "robot_motor"
pytestmark = pytest.mark.usefixtures("one_motion")
needs_mujoco = pytest.mark.engines("mujoco")


@pytest.fixture(scope="module")
def found(one_motion):
    return simcompare.estimate(SCENARIO, engine="mujoco", draws=8)


def rms(result, way, state="speed_m_s"):
    return result.done[0].error_of(way, state).rms_error


@needs_mujoco
def test_the_filter_is_better_than_each_sensor_and_the_smoother_better_still(found):
    assert rms(found, "smoothed") < rms(found, "filtered") < rms(found, "wheel alone") / 2
    assert rms(found, "wheel alone") < rms(found, "acceleration summed up")
    acceleration = "acceleration_m_s2"
    alone = rms(found, "accelerometer alone", acceleration)
    assert rms(found, "filtered", acceleration) < alone / 2


@needs_mujoco
def test_counting_errs_as_a_triangle_says(found):
    # one count of 960 marks in 10 ms, over √6; 8 draws of 48 gates tell it to 4 %, and the phase of
    # the marks hardly moves at the steady speed of the end
    mark_m = np.pi * 0.065 / 960
    assert rms(found, "wheel alone") == pytest.approx(mark_m / 0.01 / np.sqrt(6), rel=0.2)


@needs_mujoco
def test_errors_of_neighbouring_counts_cancel_and_that_is_said():
    found = simcompare.estimate(SCENARIO, engine="mujoco", draws=8, options={"by_way": 0})
    reading = found.done[0].readings[0]
    assert reading.name == "wheel"
    assert reading.whiteness.outcome == "not white"
    # two neighbours share one end of a gate: -1/2, a little less after filtering
    assert -0.55 < reading.whiteness.lag_1 < -0.3
    assert any("Neighbouring innovations of wheel cancel" in one for one in found.sentences)
    command = f"simcompare estimate {SCENARIO} --engine mujoco --draws 8 --option by_way=1"
    assert f"Read the counts as a sum, a state more: {command}" in found.sentences


@needs_mujoco
def test_marks_are_read_as_a_way_so_they_are_white_and_the_filter_knows_its_error(found):
    assert found.done[0].readings[0].whiteness.outcome == "consistent"
    assert found.done[0].nees.outcome == "consistent"
    # rms over the drive, the start included; single counts say 8.7 mm/s
    told = found.done[0].error_of("filtered", "speed_m_s")
    assert told.u == pytest.approx(told.rms_error, rel=0.35)  # NEES of 8 runs: 1.1 to 3.2 for 2
    assert told.u < 0.0035


@needs_mujoco
def test_a_bias_that_is_no_state_makes_the_filter_diverge_and_the_cure_is_said():
    found = simcompare.estimate(SCENARIO, engine="mujoco", draws=5, options={"bias": 0})
    assert found.done[0].nees.outcome == "diverged"
    assert rms(found, "filtered") > rms(found, "wheel alone")
    text = "\n".join(found.sentences)
    assert "The filter has diverged: its errors are far larger than it says, NEES" in text
    cure = next(one for one in found.sentences if "make it a state" in one)
    command = cure.partition("state: ")[2].split()
    assert command == [
        "simcompare", "estimate", SCENARIO, "--engine", "mujoco", "--draws", "5", "--option",
        "bias=1",
    ]  # fmt: skip


@needs_mujoco
def test_a_motion_that_is_taken_for_too_smooth_surprises_the_filter():
    smooth = {"settling_s": 0, "jerk_density_m2_s5": 0.01}
    found = simcompare.estimate(SCENARIO, engine="mujoco", draws=8, options=smooth)
    assert found.done[0].nis.outcome in ("too sure", "diverged")
    text = "\n".join(found.sentences)
    assert "surprise it: NIS" in text or "errs more than it says" in text
    cure = text.partition("Let the motion differ more from the model: ")[2].partition("\n")[0]
    assert {"settling_s=0", "jerk_density_m2_s5=0.1"} < set(cure.split())


@needs_mujoco
def test_the_same_seed_draws_the_same_and_another_one_others(found):
    # the first draw is the same, however many there are
    again = simcompare.estimate(SCENARIO, engine="mujoco", draws=1)
    other = simcompare.estimate(SCENARIO, engine="mujoco", draws=1, seed=1)
    # as text: where no truth is known stands NaN, which is not equal to itself
    assert repr(again.done[0].curves) == repr(found.done[0].curves)
    assert repr(other.done[0].curves) != repr(found.done[0].curves)


@needs_mujoco
def test_another_data_sheet_is_another_noise():
    options = {"engine": "mujoco", "draws": 2}
    noisy = simcompare.estimate(SCENARIO, sensors={"imu": "adxl345"}, **options)
    assert noisy.sensors["imu"].sheet == "adxl345"
    assert "imu=adxl345" in noisy.command


@needs_mujoco
def test_the_pose_filter_knows_the_turning_rate_better_than_the_wheels():
    found = simcompare.estimate(SCENARIO, estimator="pose_filter", engine="mujoco", draws=3)
    assert rms(found, "filtered", "rate_rad_s") < rms(found, "wheels alone", "rate_rad_s") / 3
    assert "path" in [figure.name for figure in figures.figures(found)]


@needs_mujoco
def test_an_estimation_shows_itself(found):
    table = found.table()
    assert list(table.columns)[-2:] == ["NEES", "Filter"]
    assert "Filtered, the speed is off by" in repr(found)
    assert "<img" in found._repr_html_()
    assert found.plot("nees") is not None
    with pytest.raises(UnknownName, match="no figure is called 'speed'"):
        found.plot("speed")
    text = builder.html_of([page.block_of(found)])
    for word in ("Tests of consistency", "NEES", "imu mpu6050 at 100 Hz", "bias = 1"):
        assert word in text


@needs_mujoco
def test_the_command_line_prints_what_python_gives(tmp_path, found):
    cli.register()
    words_ = ["estimate", SCENARIO, "--engine", "mujoco", "--draws", "8", "--json", "--no-report"]
    done = CliRunner().invoke(cli.app, [*words_, "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    told = json.loads(done.output)
    assert set(told) == {
        "format", "created", "title", "question", "scenario", "estimator", "sensors", "options",
        "loosen", "biases", "sums", "draws", "seed", "recording", "engines_asked", "sentences",
        "sources", "command", "software", "folder", "exit_code",
    }  # fmt: skip
    assert told["sentences"] == list(found.sentences)
    stored = next(tmp_path.glob("*/estimate.json"))
    assert json.loads(stored.read_text(encoding="utf-8"))["sources"] == told["sources"]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"scenario": "ball"}, "ball: nothing is estimated of it; .*has it: .*robot_motor"),
        ({"estimator": "speed"}, "no estimator of robot_motor is called 'speed'"),
        ({"sensors": "imu"}, "'imu' is not of the form sensor=sheet, such as imu=mpu6050"),
        ({"sensors": {"gyro": "mpu6050"}}, "no sensor of this estimate is called 'gyro'"),
        ({"sensors": {"imu": "mpu6051"}}, "no data sheet is called 'mpu6051'; did you mean mpu60"),
        ({"options": {"jerk": 1}}, "no option of the estimator is called 'jerk'"),
        ({"options": {"gate_s": -1}}, "gate_s = -1 is not within"),
        (
            {"options": {"u_start_acceleration": 1e200}},
            r"u_start_acceleration_m_s2 = 1e\+200 is not within 1e-09 … 1e\+06",
        ),
        (
            {"options": {"jerk_density_m2_s5": 1e300, "gate_s": "1e9s"}},
            r"gate_s = 1e\+09 is not within 0.0001 … 1e\+06\n  - jerk_density_m2_s5 = 1e\+300",
        ),
        ({"options": {"gate": 1, "gate_s": 2}}, "gate_s is given twice, with and without its unit"),
        ({"sensors": "imu=mpu6050, imu=adxl345"}, "imu is given twice"),
        ({"sensors": "adxl345,adxl345"}, "adxl345 is given twice"),
        ({"options": {"diameter": "1 kg"}}, "diameter_m"),
        ({"mapping": "map.yaml"}, "says what a recording cannot; give one with recording"),
        ({"draws": 0}, "0 is no number of draws; expected 1 to 10000"),
        ({"seed": -1}, "-1 is below 0"),
        ({"contact": "exact"}, "no contact level is called 'exact'"),
    ],
)
def test_what_cannot_be_estimated_is_said(given, told):
    arguments = {"scenario": SCENARIO, "engine": "mujoco", **given}
    with pytest.raises((InputError, UnknownName), match=told):
        simcompare.estimate(arguments.pop("scenario"), **arguments)


@needs_mujoco
def test_a_chip_that_does_not_measure_so_is_said():
    told = r"bmp280.*measures pressure .Pa, 1 axis., not imu.specific_force"
    with pytest.raises(InputError, match=told):
        simcompare.estimate(SCENARIO, engine="mujoco", sensors="imu=bmp280")


def test_a_filter_that_refuses_every_reading_is_still_told():
    time_s = np.arange(0.0, 1.0, 0.1)
    rates = {side: Signal(time_s, np.full(10, 50.0), 0.01) for side in ("left_rate", "right_rate")}
    options = {"radius_m": 0.03, "track_m": 0.1, "u_start_speed_m_s": 1e-3, "u_start_m": 1e-4,
               "u_push_m_s2": 1e-9, "u_turn_rad_s2": 1e-9, "jerk_density_m2_s5": 1e-9,
               "turn_jerk_density_rad2_s5": 1e-9}  # fmt: skip
    one = estimators.apply(estimators.load("pose_filter"), Given(rates, {}, options))
    found = estimating.of_source("robot", None, [one])
    assert found.nis is None
    assert [row.refused for row in found.readings] == [10.0, 10.0]
    assert json.loads(plain.text(found))["nis"] is None


@pytest.mark.parametrize(
    ("outcome", "said"),
    [
        ("consistent", "The filter errs as much as it says: NEES 2, within 1.7 … 2.3."),
        ("too careful", "The filter errs less than it says: NEES 2, below 1.7 … 2.3."),
        ("too sure", "The filter errs more than it says: NEES 2, above 1.7 … 2.3."),
        (
            "diverged",
            "The filter has diverged: its errors are far larger than it says, NEES 2 where 1.7 … 2"
            ".3 is expected.",
        ),
    ],
)
def test_every_outcome_has_its_sentence(outcome, said):
    verdict = Verdict("NEES", 2.0, 1.7, 2.3, 0.9, 2, 200, outcome)
    assert words._said(outcome, [verdict]) == said


def test_every_option_of_every_estimator_has_bounds():
    options = [
        (f"{name}.{option}", one)
        for name in estimators.ESTIMATORS
        for option, one in estimators.load(name).options.items()
    ]
    assert len(options) > 40
    endless = [name for name, one in options if not np.isfinite([one.least, one.most]).all()]
    assert not endless


def test_a_cure_replaces_the_option_that_it_changes():
    command = ("simcompare", "estimate", "robot", "--option", "bias=0", "--option", "gate=0.02")
    cured = words.with_options(command, {"bias": 1.0})
    assert cured == "simcompare estimate robot --option gate=0.02 --option bias=1"
