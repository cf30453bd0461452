"""Real range sensors of many zones in runs: frames beside ideal ranges, and their file."""

import csv

import numpy as np
import pytest

import simcompare
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors import drawn_zones, multizone, zone_view
from simcompare.hardware.sensors.multizone import NOTHING
from simcompare.reports.sensing import words
from simcompare.scenarios import catalogue
from simcompare.statistics.streams import stream
from tests.present import need

SAID = {"eye": "vl53l5cx", "eye.ambient_klux": 5, "eye.reflectance.ball": 0.05}
FRAMES, ZONES = 15, 64


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    need("mujoco")
    return simcompare.run("time_of_flight", engine="mujoco", contact="tuned,assisted",
                          sensor=SAID, out=tmp_path_factory.mktemp("runs"))  # fmt: skip


def told(run, source="mujoco", contact="tuned"):
    (found,) = (
        one.reading for one in run.stored_readings if (one.source, one.contact) == (source, contact)
    )
    return found


# --- what is read ---------------------------------------------------------------------------------


def test_a_run_tells_what_the_device_tells_of_its_motion(run):
    scene = catalogue.load("time_of_flight").resolve()
    device = multizone.drawn(seed=0, device_name="eye", ambient_klux=5.0)
    moved = next(one.trajectory for one in run.trajectories if one.contact == "tuned")
    noise = stream(0, "eye.range_m", "noise")
    times, frames = zone_view.frames(device, scene, "eye", moved, noise, {"ball": 0.05})
    read = told(run)
    np.testing.assert_array_equal(read.time_s, times)
    np.testing.assert_array_equal(read.frames.range_m, frames.range_m)
    np.testing.assert_array_equal(read.frames.status, frames.status)


def test_the_ideal_ranges_are_those_of_the_instant_at_which_a_frame_is_told(run):
    read, samples = told(run), run.samples("mujoco", "tuned")
    at_last = samples.iloc[-1][[f"eye.range_m.{zone}" for zone in range(ZONES)]]
    np.testing.assert_allclose(read.ideal[-1], at_last.to_numpy(dtype=float), atol=1e-12)


def test_what_was_not_found_is_told_and_never_filled(run):
    frames = told(run).frames
    nothing = frames.status == NOTHING
    assert 0 < nothing.sum() < nothing.size
    assert np.isnan(frames.range_m[nothing]).all()
    assert np.isfinite(frames.range_m[~nothing]).all()
    nearer = simcompare.sense(run, "eye", "vl53l5cx", engine="mujoco")
    assert (nearer.reading.frames.status == NOTHING).sum() < nothing.sum()  # white, in the dark


def test_what_stays_is_told_with_the_scatter_of_what_is_told(run):
    term = run.record.sensing.sensors[0].terms[0]
    assert (term.term, term.axis) == ("stays", "mean of zones")
    scene = catalogue.load("time_of_flight").resolve()
    told = [
        next(drawn_zones.of_sensor(scene, "eye", {"sheet": "vl53l5cx"}, seed).terms()).value
        for seed in range(400)
    ]
    # 400 draws tell a standard deviation within 3.5 %; that of one zone is 40 % more
    assert np.std(told) == pytest.approx(term.u, rel=0.1)


def test_scores_stay_ideal(run):
    ideal = simcompare.run("time_of_flight", engine="mujoco", contact="tuned,assisted")
    assert run.scores.equals(ideal.scores)


def test_the_same_device_reads_every_source(run):
    first, second = told(run), told(run, "closed form", "")
    np.testing.assert_array_equal(first.frames.range_m, second.frames.range_m)  # they move alike


# --- where it is kept and shown -------------------------------------------------------------------


def test_zones_are_stored_in_a_table_that_anybody_reads(run):
    with (run.folder / "zones.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3 * FRAMES * ZONES
    assert list(rows[0])[3:] == [
        "time_s", "zone", "ideal_m", "range_m", "status", "targets", "sigma_m"
    ]  # fmt: skip
    for row in rows:
        assert (row["range_m"] == "") == (row["sigma_m"] == "") == (row["status"] == "255")
    assert [int(row["zone"]) for row in rows[:ZONES]] == list(range(ZONES))


def test_a_stored_run_is_read_back_whole(run):
    again = simcompare.load_run(run.folder)
    (first,), (second,) = run.record.sensing.sensors, again.record.sensing.sensors
    assert (second.deviations, second.zones, second.terms) == (
        first.deviations, first.zones, first.terms
    )  # fmt: skip
    assert again.readings().equals(run.readings())


def test_a_changed_table_is_refused(run, tmp_path):
    import shutil

    copy = tmp_path / "run"
    shutil.copytree(run.folder, copy)
    with (copy / "zones.csv").open("a", encoding="utf-8") as file:
        file.write("\n")
    with pytest.raises(InputError, match=r"zones\.csv: is not what was written"):
        simcompare.load_run(copy)


def test_words_count_what_is_missing(run):
    (sensor,) = run.record.sensing.sensors
    (line,) = words.sensor_lines(sensor)
    assert "read by one VL53L5CX (8×8 zones, 15 frames a second): off by" in line
    frames = told(run, "closed form", "").frames
    missing = int((frames.status == NOTHING).sum())
    assert f"of {frames.status.size} readings {missing} see nothing and " in line


def test_the_report_shows_the_picture_the_device_and_every_source(run):
    page = run.report().read_text(encoding="utf-8")
    for said in ("What eye.range_m reads", "nothing found", "distance (m)", "ball 5 %", "5 klux",
                 "DS13754 p. 20, Table 18", "Not trusted", 'name="rays"'):  # fmt: skip
        assert said in page
    run.plot("sensor-eye-range_m")


def test_a_run_is_sensed_afterwards(run):
    read = simcompare.sense(run, "eye", {"sheet": "vl53l5cx", "reflectance": {"wall": 0.1}}, seed=2)
    assert read.samples().shape == (FRAMES * ZONES, 7)
    assert "eye.range_m, read by one VL53L5CX" in repr(read)
    assert "<img" in read._repr_html_()
    assert "DS13754" in read.table().to_string()


def test_the_command_repeats_it(run):
    assert "--sensor eye.reflectance.ball=0.05" in " ".join(run.record.command)


# --- what cannot be -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"eye": "mpu6050"}, "eye=mpu6050: sheet mpu6050: it says nothing of zones"),
        ({"eye": "vl53l5"}, "no data sheet is called 'vl53l5'; did you mean vl53l5cx"),
        ({"eyes": "vl53l5cx"}, "no sensor or signal of time_of_flight is called 'eyes'"),
        ({"eye.ambient_klux": 1}, "eye has no sheet; give that too, such as eye=SHEET"),
        ({**SAID, "eye.rate_Hz": 60}, "rate_Hz is 60.0; expected a number above 0, at most 15"),
        (
            {"eye.range_m": "vl53l5cx", "eye.ambient_klux": 1},
            "eye.ambient_klux: eye has no sheet; write eye.range_m.ambient_klux",
        ),
        ({**SAID, "eye.rate_Hz": 0.5}, "a frame takes 2 s and the scenario 1 s"),
        ({**SAID, "eye.rate_Hz": "5 Hz"}, "rate_Hz is '5 Hz'; expected a number above 0"),
        ({**SAID, "eye.rate_Hz.": 5}, "rate_Hz is {'': 5.0}; expected a number above 0"),
        ({**SAID, "eye.ambient": 1}, "no setting of a range sensor is called 'ambient'"),
        ({**SAID, "eye.reflectance.bal": 1}, "no body is called 'bal'; did you mean ball"),
        ({**SAID, "eye.reflectance.wall": 2}, "reflectance of wall is 2.0; expected 0 to 1"),
        ({**SAID, "eye.reflectance": 0.5}, "eye.reflectance is given too; expected one of them"),
        ({"eye": "vl53l5cx", "eye.reflectance": 0.5}, "reflectance is of a body, such as"),
    ],
)
def test_what_cannot_be_is_told_before_anything_is_simulated(asked, said):
    with pytest.raises(InputError) as error:
        simcompare.run("time_of_flight", engine="mujoco", sensor=asked)
    assert said in str(error.value)


def test_the_command_line_tells_it_and_ends_with_2(call):
    words = ("run", "time_of_flight", "--sensor", "eye=vl53l5cx", "--sensor", "eye.rate_Hz=60")
    code, _, told = call(*words)
    assert code == 2
    text = " ".join(told.split())
    assert "--sensor: eye=vl53l5cx: rate_Hz is 60.0; expected a number above 0, at most 15" in text


def test_all_faults_are_told_at_once():
    asked = {**SAID, "eye.rate_Hz": 60, "eye.order": "best", "way": "mpu6050", "cart.rate_Hz": 1,
             "eye.reflectance": 1}  # fmt: skip
    with pytest.raises(InputError) as error:
        simcompare.run("time_of_flight", engine="mujoco", sensor=asked)
    assert len(error.value.faults) == 5


def test_a_sheet_of_zones_reads_no_other_sensor():
    with pytest.raises(InputError, match=r"it measures distance .*, not imu\.specific_force_m_s2"):
        simcompare.run("robot", engine="mujoco", sensor={"imu": "vl53l5cx"})


def test_zones_need_a_scene(run):
    moved = run.trajectories[0].trajectory
    with pytest.raises(InputError, match="look at a scene, and a trajectory has none"):
        simcompare.sense(moved, "eye", "vl53l5cx")
    with pytest.raises(UnknownName, match="no data sheet"):
        simcompare.sense(run, "eye", "vl53")


def test_other_sensors_take_their_settings_too():
    need("mujoco")
    asked = {"imu": "mpu6050", "imu.rate_Hz": 100, "imu.range": "4 g"}
    found = simcompare.run("robot", engine="mujoco", contact="tuned", sensor=asked)
    force = found.record.sensing.sensors[0]
    assert (force.rate_Hz, force.full_scale) == (100.0, pytest.approx(4 * 9.80665))
    with pytest.raises(InputError, match="no term of these errors is called 'rate'"):
        simcompare.run("robot", engine="mujoco", sensor={"imu": "mpu6050", "imu.rate": 100})
