"""Logs of libRSF: one measurement a line, the truth in a file beside."""

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import mapping
from simcompare.hardware.logs import importers
from simcompare.verbs.import_log import import_log

SENSORS = (
    "range2 0.1 2.5 0.01 0 0 105 0\nodom2diff 0.1 0.2 0.3 0 0.08 0.0004 0.0004 0.0004\n"
    "range2 0.2 1.5 0.01 0 2 107 0\nodom2diff 0.2 0.4 0.5 0 0.08 0.0004 0.0004 0.0004\n"
    "range2 0.3 2.4 0.01 0 0 105 0\nodom2diff 0.3 0.6 0.7 0 0.08 0.0004 0.0004 0.0004\n"
)
TRUTH = "point2 0.1 1 2 0 0 0 0\npoint2 0.2 1.1 2 0 0 0 0\npoint2 0.3 1.2 2 0 0 0 0\n"


@pytest.fixture
def write_log(tmp_path):
    def make(text, truth=None, name="run_Input.txt"):
        if truth is not None:
            (tmp_path / "run_GT.txt").write_text(truth)
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return make


def read(path):
    assert importers.recognise(path) == "librsf"
    return importers.read(path, "librsf", mapping.NOTHING)


def test_each_kind_is_a_stream_and_each_beacon_has_its_own(write_log):
    log = read(write_log(SENSORS))
    assert [s.name for s in log.streams] == ["range2_105", "odom2diff", "range2_107"]
    odometry = log.streams[1]
    np.testing.assert_array_equal(odometry.column("velocity_right").values, [0.2, 0.4, 0.6])
    np.testing.assert_array_equal(odometry.column("velocity_left").values, [0.3, 0.5, 0.7])
    np.testing.assert_array_equal(odometry.rows, [2, 4, 6])


def test_covariances_become_uncertainties_and_zeros_are_none(write_log):
    recording = import_log(
        write_log(SENSORS + SENSORS.replace("2 0.", "2 1.").replace("f 0.", "f 1."), TRUTH)
    )
    channel = recording.streams["odom2diff"].channels["velocity_left_m_s"]
    np.testing.assert_allclose(channel.u, 0.02)
    assert channel.unit == "m/s"
    assert recording.streams["point2"].channels["x_m"].u is None
    assert not [name for s in recording.streams.values() for name in s.channels if "cov" in name]


def test_the_truth_beside_is_read_and_that_is_noted(write_log):
    log = read(write_log(SENSORS, TRUTH))
    assert log.streams[-1].name == "point2"
    assert [r.rule for r in log.repairs] == ["second_file"]
    assert "run_GT.txt" in log.repairs[0].text


def test_another_name_has_no_truth_beside_it(write_log):
    log = read(write_log(SENSORS, TRUTH, name="run.txt"))
    assert "point2" not in [s.name for s in log.streams]


def test_a_last_line_that_is_cut_off_is_left_out_and_told(write_log):
    log = read(write_log(SENSORS + "odom2diff 0.4 0.6 0."))
    assert all("line, 7" in s.truncated for s in log.streams)
    assert len(log.streams[1]) == 3


def test_wrong_lines_are_told_all_at_once(write_log):
    wrong = (
        SENSORS + "odom2diff 0.4 0.6\nodom2diff 0.5 a 0 0 0 0 0 0\npoint9 0 0\n"
        "odom2diff nan 0 0 0 0 0 0 0\n"
    )
    with pytest.raises(InputError) as caught:
        read(write_log(wrong))
    assert [fault.split(":")[0] for fault in caught.value.faults] == [
        "line 7", "line 8", "line 9", "line 10",
    ]  # fmt: skip
    assert "expected 9" in caught.value.faults[0]
    assert "range2, odom2diff, point2" in caught.value.faults[2]


def test_of_many_wrong_lines_twenty_are_shown(write_log):
    with pytest.raises(InputError) as caught:
        read(write_log(SENSORS + "odom2diff 1\n" * 30))
    assert len(caught.value.faults) == 21
    assert caught.value.faults[-1] == "and 10 more lines like these"


def test_other_texts_are_none(write_log):
    assert importers.recognise(write_log("time x y\n0 1 2\n1 2 3\n")) != "librsf"
