"""Runs whose sensors are not ideal: beside the ideal signals, and never in their scores."""

import json
import shutil

import numpy as np
import pytest

import simcompare
from simcompare.errors import InputError, UnknownName
from tests.present import need

SCENE = """
extends: {base}
name: robot_with_errors
title: Robot with errors
question: What does it read?
sensors:
  imu:
    errors:
      rate_Hz: 250
      bandwidth_Hz: 100
      offset_m_s2: {{typ: 0.5}}
      noise_m_s2_per_rtHz: 0.01
      full_scale_m_s2: 9
actuators:
  left_motor:
    errors: {{resolution_N_m: 0.004}}
"""


@pytest.fixture(scope="module")
def ideal():
    need("mujoco")
    return simcompare.run("robot", engine="mujoco", contact="tuned,assisted")


@pytest.fixture(scope="module")
def sensed(tmp_path_factory):
    need("mujoco")
    return simcompare.run(
        "robot", engine="mujoco", contact="tuned,assisted", sensor={"imu": "mpu6050"},
        out=tmp_path_factory.mktemp("runs"),
    )  # fmt: skip


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """A user's scenario that says what its sensors lack."""
    from simcompare.scenarios import catalogue

    need("mujoco")
    path = tmp_path_factory.mktemp("own") / "robot_with_errors.yaml"
    path.write_text(SCENE.format(base=catalogue.load("robot").path), encoding="utf-8")
    return simcompare.run(path, engine="mujoco", contact="assisted")


# --- one device for all ---------------------------------------------------------------------------


def test_errors_change_no_score_and_no_ideal_signal(ideal, sensed):
    assert sensed.scores.equals(ideal.scores)
    assert sensed.record.answer == ideal.record.answer
    assert sensed.exit_code == ideal.exit_code
    assert sensed.samples("mujoco", "tuned").equals(ideal.samples("mujoco", "tuned"))


def test_every_source_is_read_by_the_same_device(sensed):
    read = sensed.readings("imu.specific_force_m_s2")
    assert set(map(tuple, read[["source", "contact"]].values)) == {
        ("mujoco", "tuned"), ("mujoco", "assisted"), ("closed form", "")
    }  # fmt: skip
    # at the end of a straight drive engine and closed form agree: so do their readings
    last = read.groupby(["source", "contact"])[["measured.x", "measured.y", "measured.z"]].last()
    assert np.ptp(last.to_numpy(), axis=0) == pytest.approx(np.zeros(3), abs=0.01)


def test_readings_stand_beside_the_ideal_signal(sensed):
    read = sensed.readings("imu", "mujoco", "tuned")
    assert set(read["signal"]) == {"imu.specific_force_m_s2", "imu.rate_rad_s"}
    samples = sensed.samples("mujoco", "tuned")
    force = read[read["signal"] == "imu.specific_force_m_s2"]
    assert np.allclose(force["ideal.x"], samples["imu.specific_force_m_s2.x"], atol=1e-9)
    assert not np.allclose(force["measured.x"], force["ideal.x"], atol=0.05)


def test_what_was_drawn_is_told_with_its_distribution_and_source(sensed):
    drawn = sensed.sensors
    offsets = drawn[(drawn["signal"] == "imu.specific_force_m_s2") & (drawn["term"] == "offset")]
    assert offsets["axis"].tolist() == ["x", "y", "z"]
    assert set(offsets["kind"]) == {"normal"}
    assert offsets["u"].tolist() == pytest.approx([0.4903, 0.4903, 0.7845], rel=1e-3)
    assert set(offsets["source"]) == {"p. 13"}


def test_adding_a_sensor_changes_no_other(sensed):
    more = simcompare.run(
        "robot", engine="mujoco", contact="tuned",
        sensor={"chassis.rate_rad_s": "mpu6050", "imu": "mpu6050"},
    )  # fmt: skip
    for signal in ("imu.specific_force_m_s2", "imu.rate_rad_s"):
        first = sensed.readings(signal, "mujoco", "tuned")
        assert more.readings(signal, "mujoco", "tuned").equals(first)
    assert "chassis.rate_rad_s" in set(more.sensors["signal"])


def test_another_seed_is_another_device(sensed):
    other = simcompare.run(
        "robot", engine="mujoco", contact="tuned", sensor={"imu": "mpu6050"}, seed=1
    )
    assert other.record.sensing.seed == 1
    assert not np.allclose(other.sensors["value"], sensed.sensors["value"])
    assert other.record.command[-2:] == ("--seed", "1")


# --- in a scenario's file -------------------------------------------------------------------------


def test_errors_of_a_scenario_are_read_without_being_asked_for(own):
    force = own.readings("imu", "mujoco")
    assert set(force["signal"]) == {"imu.specific_force_m_s2"}
    assert len(force) == 256
    assert force["saturated.z"].all()
    assert (force["measured.z"] == 9.0).all()
    torque = own.readings("left_motor", "mujoco")
    assert set(torque["measured"]) == {0.02}


# --- on disk --------------------------------------------------------------------------------------


def test_a_stored_run_is_read_back_whole(sensed):
    again = simcompare.load_run(sensed.folder)
    assert again.readings().equals(sensed.readings())
    assert again.sensors.equals(sensed.sensors)
    assert again.record == sensed.record


def test_a_changed_file_of_readings_is_refused(sensed, tmp_path):
    copy = tmp_path / "run"
    shutil.copytree(sensed.folder, copy)
    with (copy / "readings.parquet").open("ab") as file:
        file.write(b"more")
    with pytest.raises(InputError, match=r"readings\.parquet: is not what was written: "):
        simcompare.load_run(copy)


def test_digests_that_were_taken_away_are_missed(sensed, tmp_path):
    copy = tmp_path / "run"
    shutil.copytree(sensed.folder, copy)
    record = json.loads((copy / "run.json").read_text(encoding="utf-8"))
    del record["tables"]
    (copy / "run.json").write_text(json.dumps(record), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        simcompare.load_run(copy)
    assert caught.value.faults == (
        "tables: tells no digest of trajectories.parquet; run it again",
        "tables: tells no digest of readings.parquet; run it again",
    )


def test_a_run_of_ideal_sensors_stores_none(sweep):
    assert not (sweep[0].folder / "readings.parquet").exists()
    assert sweep[0].sensors.empty
    with pytest.raises(InputError, match="all sensors of this run are ideal"):
        sweep[0].readings()


# --- what is shown --------------------------------------------------------------------------------


def test_the_terminal_tells_each_signal_in_a_line(call):
    need("mujoco")
    code, out, _ = call("run", "robot", "--engine", "mujoco", "--contact", "tuned",
                        "--sensor", "imu=mpu6050", "--no-report")  # fmt: skip
    assert code == 0
    text = " ".join(out.split())
    assert (
        "imu.specific_force_m_s2, read by one MPU-6050 (accelerometer): off by x +0.278, y +0.133,"
        " z −0.55 m/s² in the mean, scatter up to 0.035 m/s²." in text
    )
    assert "imu.rate_rad_s, read by one MPU-6050 (gyroscope): off by" in text
    assert "nothing that a sensor reads goes into a score. Another draw: --seed 1." in text


def test_json_holds_the_device_and_its_deviations(call):
    need("mujoco")
    _, out, _ = call("run", "robot", "--engine", "mujoco", "--contact", "tuned", "--json",
                     "--sensor", "imu=mpu6050", "--no-report")  # fmt: skip
    sensing = json.loads(out)["sensing"]
    assert sensing["seed"] == 0
    assert [one["signal"] for one in sensing["sensors"]] == [
        "imu.specific_force_m_s2", "imu.rate_rad_s"
    ]  # fmt: skip
    assert {"term", "axis", "value", "unit", "u"} <= sensing["sensors"][0]["terms"][0].keys()
    assert [one["source"] for one in sensing["sensors"][0]["deviations"]] == [
        "mujoco", "closed form"
    ]  # fmt: skip


def test_the_report_has_a_section_with_picture_device_and_deviations(sensed):
    page = sensed.report().read_text(encoding="utf-8")
    for words in (
        "What the sensors read", "The device that reads imu.rate_rad_s", "normal, u = 0.49",
        "How far imu.specific_force_m_s2 is off", "±50 mg",
    ):  # fmt: skip
        assert words in page
    sensed.plot("sensor-imu-rate_rad_s")


def test_a_notebook_tells_how_far_readings_are_off(sensed, ideal):
    assert "imu.rate_rad_s, read by one MPU-6050 (gyroscope): off by" in repr(sensed)
    assert ".sensors, .readings(signal, engine)" in repr(sensed)
    assert ".readings" not in repr(ideal)


# --- what cannot be -------------------------------------------------------------------------------


def test_unknown_sensors_and_sheets_are_told_at_once():
    with pytest.raises(InputError) as error:
        simcompare.run("robot", sensor={"imi": "mpu6050", "imu": "mpu605", "left": "mpu6050.yaml"})
    assert len(error.value.faults) == 3
    told = str(error.value)
    assert "no sensor or signal of robot is called 'imi'; did you mean imu?" in told
    assert "no data sheet is called 'mpu605'; did you mean mpu6050 or" in told
    assert "mpu6050.yaml" in told


def test_a_sheet_that_measures_something_else_is_refused():
    with pytest.raises(InputError, match=r"it measures specific force .*, not left_tyre\.normal"):
        simcompare.run("robot", sensor={"left_tyre": "mpu6050"})


def test_a_negative_seed_is_refused():
    with pytest.raises(InputError, match="seed: -1 is below 0"):
        simcompare.run("robot", seed=-1)


@pytest.mark.parametrize("word", ["imu", "imu=", "=mpu6050"])
def test_a_sensor_without_a_sheet_is_told(call, word):
    code, _, told = call("run", "robot", "--sensor", word)
    assert code == 2
    assert "--sensor" in told
    assert "is not of the form NAME=SHEET, such as imu=mpu6050" in " ".join(told.split())


def test_what_was_not_read_is_told(sensed):
    with pytest.raises(UnknownName, match="no signal that was read is called 'wheel'"):
        sensed.readings("wheel")
    with pytest.raises(UnknownName, match="no source of this run is called 'ode'"):
        sensed.readings(engine="ode")
