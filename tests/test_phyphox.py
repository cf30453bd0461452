"""Exports of phyphox: one file or a zip, any of its separators, and what its meta files say."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import mapping
from simcompare.hardware.logs import importers
from simcompare.verbs.import_log import import_log

HEAD = '"Time (s)","Acceleration x (m/s^2)","Acceleration y (m/s^2)","Acceleration z (m/s^2)"\n'
ROWS = (
    "9.364549000E-3,1.003170490E0,3.543418407E0,7.366958618E0\n"
    "1.136538300E-2,9.696516991E-1,3.600879431E0,7.357381821E0\n"
    "1.336699700E-2,9.696516991E-1,NaN,7.343016624E0\n"
)
DEVICE = (
    '"property","value"\n"deviceModel","Pixel 6a"\n"accelerometer Name","LSM6DSR"\n'
    '"accelerometer Range","78.4532"\n"linear_acceleration Name","null"\n'
)
TIME = (
    '"event","experiment time","system time","system time text"\n'
    '"START",0.000000000E0,1759650000.000,"2025-10-05 10:20:00.000 UTC+02:00"\n'
    '"PAUSE",1.330727321E0,1759650001.331,"2025-10-05 10:20:01.331 UTC+02:00"\n'
    '"START",1.330727321E0,1759650005.512,"2025-10-05 10:20:05.512 UTC+02:00"\n'
    '"PAUSE",2.310827263E0,1759650006.492,"2025-10-05 10:20:06.492 UTC+02:00"\n'
)


def written(text, separator, comma):
    text = text.replace(",", separator)
    if comma:
        head, _, rows = text.partition("\n")
        text = f"{head}\n{rows.replace('.', ',')}"
    return text


@pytest.fixture
def zipped(tmp_path):
    def make(members, separator=",", comma=False):
        path = tmp_path / "pendulum.zip"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, text in members.items():
                changed = comma and name != "meta/device.csv"
                archive.writestr(name, written(text, separator, changed))
        return path

    return make


def read(path):
    assert importers.recognise(path) == "phyphox"
    return importers.read(path, "phyphox", mapping.NOTHING)


FORMATS = [(",", False), ("\t", False), (";", False), ("\t", True), (";", True)]


@pytest.mark.parametrize(("separator", "comma"), FORMATS)
def test_every_export_setting_gives_the_same_stream(tmp_path, separator, comma):
    path = tmp_path / "x.csv"
    path.write_text(written(HEAD + ROWS, separator, comma), encoding="utf-8")
    found = read(path)
    (stream,) = found.streams
    assert (stream.name, stream.time, len(stream)) == ("log", "Time", 3)
    assert stream.column("Time").values[0] == 0.009364549
    z = stream.column("Acceleration z")
    assert (z.unit, z.kind, z.frame) == ("m/s^2", "specific_force", "sensor")
    assert np.isnan(stream.column("Acceleration y").values[2])
    assert ("decimal_comma" in [r.rule for r in found.repairs]) == comma


@pytest.mark.parametrize(("separator", "comma"), FORMATS)
def test_a_zip_holds_a_stream_for_each_sensor_and_says_when_it_began(zipped, separator, comma):
    linear = HEAD.replace('"Acceleration', '"Linear Acceleration')
    path = zipped(
        {"Accelerometer.csv": HEAD + ROWS, "Linear Accelerometer.csv": linear + ROWS,
         "Gyroscope.csv": '"Time (s)","Gyroscope x (rad/s)"\n', "meta/device.csv": DEVICE,
         "meta/time.csv": TIME},
        separator, comma,
    )  # fmt: skip
    found = read(path)
    assert [stream.name for stream in found.streams] == ["Accelerometer", "Linear Accelerometer"]
    force, moved = (stream.columns[1] for stream in found.streams)
    assert (force.kind, force.sensor, force.limits) == (
        "specific_force", "LSM6DSR", (-78.4532, 78.4532),
    )  # fmt: skip
    assert (moved.kind, moved.sensor) == ("gravity_removed", "")
    assert found.streams[0].clock.start == "2025-10-05T07:40:00.009+00:00"
    assert found.ignored == {"Gyroscope": "holds no samples"}
    assert found.about["deviceModel"] == "Pixel 6a"


def test_a_pause_is_marked_as_it_is_not_seen_in_the_times(zipped):
    members = {"A.csv": HEAD + ROWS, "meta/time.csv": TIME}
    pause = next(r for r in read(zipped(members)).repairs if r.rule == "pause")
    assert pause.severity == "warning"
    assert "paused at 1.33073 s for 4.18 s" in pause.text


def test_an_unzipped_export_is_read_as_a_folder(tmp_path, zipped):
    members = {"A.csv": HEAD + ROWS, "meta/time.csv": TIME, "meta/device.csv": DEVICE}
    with zipfile.ZipFile(zipped(members)) as archive:
        archive.extractall(tmp_path / "folder")
    found = read(tmp_path / "folder")
    assert [(s.name, len(s)) for s in found.streams] == [("A", 3)]


def test_bounces_become_instants_with_heights_marked_as_derived(tmp_path):
    path = tmp_path / "collision.csv"
    path.write_text(
        '"Bounce 0 (s)","Height 0 (m)","Bounce 1 (s)","Height 1 (m)","Energy 1","Bounce 2 (s)",'
        '"Height 2 (m)","Energy 2","Bounce 3 (s)","Height 3 (m)","Energy 3"\n'
        "1.2E0,8.0E-1,1.9E0,6.4E-1,8.0E-1,2.5E0,4.4E-1,7.0E-1,0.0E0,NaN,NaN\n"
    )
    found = read(path)
    (stream,) = found.streams
    assert stream.column("time").values.tolist() == [1.2, 1.9, 2.5]
    assert stream.column("height").values.tolist() == [0.8, 0.64, 0.44]
    assert stream.column("interval").values[1:] == pytest.approx([0.7, 0.6])
    assert [(e.name, e.time_s) for e in found.events] == [
        ("bounce 0", 1.2), ("bounce 1", 1.9), ("bounce 2", 2.5),
    ]  # fmt: skip
    assert [r.channel for r in found.repairs if r.rule == "derived"] == ["height", "energy"]
    assert found.ignored == {"log/Bounce 3": "did not happen (its time is 0)"}
    assert stream.rows.tolist() == [2, 2, 2]


def test_a_stopwatch_becomes_start_and_stop(tmp_path):
    path = tmp_path / "watch.csv"
    path.write_text('"Start (s)";"Stop (s)";"Difference (s)"\n1,2E0;1,9E0;7,0E-1\n')
    found = read(path)
    assert [(e.name, e.time_s) for e in found.events] == [("start", 1.2), ("stop", 1.9)]
    assert found.streams[0].column("interval").values[1] == pytest.approx(0.7)


def test_an_export_becomes_a_recording(zipped):
    members = {"A.csv": (HEAD + ROWS).replace("NaN", "3.6"), "meta/device.csv": DEVICE}
    found = import_log(zipped(members))
    channel = found.streams["A"].channels["acceleration_x_m_s2"]
    assert (channel.kind, channel.sensor) == ("specific_force", "LSM6DSR")


# ---- bad input --------------------------------------------------------------------------------


def test_a_fault_names_the_file_within_the_archive_and_its_line(zipped):
    path = zipped({"A.csv": HEAD + ROWS + "1,2\n2,x,3,4\n", "meta/device.csv": DEVICE})
    with pytest.raises(InputError) as error:
        read(path)
    assert error.value.where == f"{path}/A.csv"
    assert error.value.faults == (
        "line 5: has 2 cells, expected 4",
        "line 6, column 'Acceleration x': 'x' is not a number",
    )


def test_a_damaged_member_is_refused(zipped):
    path = zipped({"A.csv": HEAD + ROWS * 2000, "meta/device.csv": DEVICE})
    data = bytearray(path.read_bytes())
    data[200:260] = bytes(60)
    path.write_bytes(bytes(data))
    with pytest.raises(InputError, match=r"A\.csv: cannot be (unpacked|read)"):
        read(path)


def test_an_export_without_samples_is_refused(zipped):
    path = zipped({"A.csv": HEAD, "meta/device.csv": DEVICE})
    with pytest.raises(InputError, match=r"no sensor has any samples \(A\)"):
        read(path)


def test_a_cut_last_line_is_said_for_its_stream(zipped):
    path = zipped({"A.csv": HEAD + ROWS + "1.5E0,2.0", "meta/device.csv": DEVICE})
    stream = read(path).streams[0]
    assert (len(stream), stream.truncated[:26]) == (3, "line 5 ends in the middle ")


@pytest.mark.parametrize("how", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_damaged_member_of_any_packing_is_refused(tmp_path, how):
    path = tmp_path / "pendulum.zip"
    with zipfile.ZipFile(path, "w", how) as archive:
        archive.writestr("A.csv", HEAD + ROWS * 2000)
        archive.writestr("meta/device.csv", DEVICE)
    data = bytearray(path.read_bytes())
    data[60:200] = b"\xff" * 140
    path.write_bytes(bytes(data))
    with pytest.raises(InputError, match=r"A\.csv: cannot be (read|unpacked)"):
        importers.read(path, "phyphox", mapping.NOTHING)


def test_a_table_without_a_line_end_in_its_head_is_no_trace(zipped):
    path = zipped({"A.csv": HEAD + ROWS, "meta/device.csv": DEVICE, "meta/time.csv": "x" * 70_000})
    assert len(read(path).streams[0]) == 3
