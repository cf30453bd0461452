"""TDMS files of LabVIEW: values, units, clocks, and what is cut off."""

from __future__ import annotations

import struct
import tracemalloc

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.logs import importers
from simcompare.hardware.mapping import NOTHING
from simcompare.model.recording import Provenance
from tests.array_logs import faults, load

nptdms = pytest.importorskip("nptdms")

START = np.datetime64("2024-03-01T12:00:00.250000", "us")
WAVE = {"wf_start_time": START, "wf_increment": 0.001, "wf_start_offset": 0.0}
COUNT = 1000


@pytest.fixture
def write(tmp_path):
    def save(*segments, root=None, groups=()):
        path = tmp_path / "log.tdms"
        with nptdms.TdmsWriter(path) as writer:
            head = [nptdms.RootObject(root or {})]
            head += [nptdms.GroupObject(name, properties) for name, properties in groups]
            for number, channels in enumerate(segments):
                objects = [nptdms.ChannelObject(*channel) for channel in channels]
                writer.write_segment(objects if number else head + objects)
        return path

    return save


def wave(name, values, unit="V", **more):
    return ("bench", name, np.asarray(values), {**WAVE, "unit_string": unit, **more})


def test_channels_of_a_group_are_one_stream_with_units_and_an_even_clock(write):
    volts, amps = np.sin(np.arange(COUNT)), np.arange(COUNT) / 7
    log = load(write([wave("u", volts), wave("i", amps, "A")]))
    (one,) = log.streams
    assert (one.name, one.time, one.increment_s) == ("bench", None, 0.001)
    assert one.clock.start == "2024-03-01T12:00:00.250000000Z"
    assert [(c.name, c.unit) for c in one.columns] == [("u", "V"), ("i", "A")]
    assert np.array_equal(one.columns[0].values, volts)
    assert np.array_equal(one.columns[1].values, amps)


def test_a_start_offset_is_kept(write):
    log = load(write([wave("u", np.zeros(COUNT), wf_start_offset=1.5)]))
    assert log.streams[0].start_s == 1.5


def test_channels_with_other_rates_or_lengths_are_streams_of_their_own(write):
    log = load(write([
        wave("a", np.zeros(COUNT)), wave("b", np.ones(COUNT)),
        wave("c", np.ones(COUNT), wf_increment=0.01), wave("d", np.ones(10)),
    ]))  # fmt: skip
    assert [s.name for s in log.streams] == ["bench/a+b", "bench/c", "bench/d"]
    assert [s.increment_s for s in log.streams] == [0.001, 0.01, 0.001]


def test_segments_are_joined(write):
    log = load(write([wave("u", np.arange(600.0))], [wave("u", np.arange(600.0, 1000.0))]))
    assert np.array_equal(log.streams[0].columns[0].values, np.arange(1000.0))


def test_a_channel_that_is_the_time_is_the_clock(write):
    times = np.cumsum(np.full(COUNT, 0.002))
    log = load(write([("g", "Time (ms)", times, {}), ("g", "x [mm]", times * 2, {})]))
    (one,) = log.streams
    assert one.time == "Time"
    assert {c.name: c.unit for c in one.columns} == {"Time": "ms", "x": "mm"}


def test_time_stamps_become_seconds_from_the_first(write):
    stamps = START + np.arange(COUNT) * np.timedelta64(1500, "us")
    log = load(write([("g", "time", stamps, {}), ("g", "x", np.arange(COUNT), {})]))
    (one,) = log.streams
    assert one.column("time").unit == "s"
    assert one.column("time").values == pytest.approx(
        0.0015 * np.arange(COUNT), abs=1.01e-6
    )  # the writer of the test rounds to microseconds
    assert one.clock.start.startswith("2024-03-01T12:00:00.25")
    assert "time_origin" in [r.rule for r in log.repairs]


def test_properties_are_kept(write):
    path = write(
        [wave("u", np.zeros(10), Sensor="LEM 25")],
        root={"Operator": "Ada"}, groups=[("bench", {"Note": "warm"})],
    )  # fmt: skip
    about = load(path).about
    assert about["Operator"] == "Ada"
    assert about["bench.Note"] == "warm"
    assert about["bench/u.Sensor"] == "LEM 25"


def test_text_is_left_out_with_the_reason(write):
    log = load(write([wave("u", np.zeros(3)), ("bench", "remark", np.array(["a", "b", "c"]), {})]))
    assert "no real numbers" in log.ignored["bench/remark"]


def test_a_scaled_channel_is_read_in_its_unit(write):
    scale = {
        "NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": 0.5, "NI_Scale[0]_Linear_Y_Intercept": 10.0,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF, "NI_Scaling_Status": "unscaled",
    }  # fmt: skip
    counts = np.arange(10, dtype=np.int16)
    log = load(write([wave("u", counts, **scale)]))
    assert np.array_equal(log.streams[0].columns[0].values, 10 + 0.5 * np.arange(10))


def test_a_file_becomes_a_recording_in_si_units(write):
    path = write([wave("force", np.arange(COUNT) / 3, "mV")])
    done = condition(load(path), NOTHING, Provenance(path.name, "", 0, "tdms", "", "repair"))
    found = done.streams["bench"]
    assert found.channels["force_V"].values == pytest.approx(np.arange(COUNT) / 3000)
    assert found.time_s[-1] == pytest.approx(0.999)


def test_a_truncated_file_gives_what_is_whole_and_says_what_is_missing(write):
    path = write([wave("u", np.arange(600.0))], [wave("u", np.arange(600.0, 1000.0))])
    data = path.read_bytes()
    path.write_bytes(data[:-800])
    (one,) = load(path).streams
    assert len(one) == 900
    assert np.array_equal(one.columns[0].values, np.arange(900.0))
    assert "800 bytes of the last segment are missing" in one.truncated


def test_a_segment_that_was_never_finished_is_told(write):
    path = write([wave("u", np.arange(600.0))], [wave("u", np.arange(600.0, 1000.0))])
    data = bytearray(path.read_bytes())
    last = data.rindex(b"TDSm")
    data[last + 12 : last + 20] = b"\xff" * 8
    path.write_bytes(data)
    (one,) = load(path).streams
    assert np.array_equal(one.columns[0].values[:600], np.arange(600.0))
    assert f"byte {last}" in one.truncated


def test_an_index_and_a_beginning_are_refused(tmp_path, write):
    index = tmp_path / "log.tdms_index"
    index.write_bytes(b"TDSh" + b"\0" * 60)
    assert "give the file log.tdms itself" in faults(index)
    path = write([wave("u", np.arange(600.0))])
    path.write_bytes(path.read_bytes()[:20])
    assert "byte 0" in faults(path)


def test_a_file_cut_or_changed_anywhere_gives_a_typed_error_or_numbers(write):
    path = write([wave("u", np.arange(50.0)), wave("i", np.arange(50.0), "A")])
    path.with_suffix(".tdms_index").unlink(missing_ok=True)
    data = path.read_bytes()
    random = np.random.default_rng(1)
    for number in range(200):
        bad = bytearray(data[: random.integers(1, len(data))] if number % 2 else data)
        bad[random.integers(0, len(bad))] = random.integers(0, 256)
        path.write_bytes(bad)
        try:
            log = importers.read(path, "tdms", NOTHING)
        except InputError:
            continue
        assert all(len(c.values) == len(s) for s in log.streams for c in s.columns)


def test_what_the_library_notices_is_recorded_and_not_printed(write, capfd):
    path = write([wave("u", np.arange(50.0)), wave("i", np.arange(50.0), "A")])
    path.with_suffix(".tdms_index").unlink(missing_ok=True)
    data = path.read_bytes()
    number = struct.pack("<IIQ", 10, 1, 50)  # type, dimension, number of values
    assert number in data
    path.write_bytes(data.replace(number, struct.pack("<IIQ", 10, 1, 70), 1))
    (told,) = [r for r in load(path).repairs if r.rule == "damaged_record"]
    assert (told.severity, "not a multiple of the chunk size" in told.text) == ("warning", True)
    assert capfd.readouterr() == ("", "")


def test_a_text_that_claims_four_gigabytes_is_no_request_for_memory(write):
    path = write([wave("u", np.arange(50.0), Note="warm")])
    path.with_suffix(".tdms_index").unlink(missing_ok=True)
    data = path.read_bytes()
    text = struct.pack("<I", 4) + b"warm"
    assert text in data
    path.write_bytes(data.replace(text, struct.pack("<I", 2**32 - 1) + b"warm", 1))
    tracemalloc.start()
    faults(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1 << 20
