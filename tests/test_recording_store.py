"""A recording on disk is the recording that was stored."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from simcompare.errors import InputError, OutputError, UnknownName
from simcompare.model import recording_store
from simcompare.model.recording import (
    REPAIR,
    Channel,
    Clock,
    Conversion,
    Event,
    Provenance,
    Recording,
    Repair,
    Stream,
    ranges,
)


def a_recording() -> Recording:
    values = np.array([1.0, np.nan, 3.0])
    fast = Stream(
        np.array([0.0, 0.001, 0.0025]),
        {
            "angle_rad": Channel(values, "rad", "joint", 0.01, "encoder", "", "a (deg)"),
            'odd "name"': Channel(
                np.arange(3.0), "1", u=np.array([0.1, 0.2, 0.3]),
                saturated=np.array([False, True, False]),
            ),
        },
        Clock("column t", "2026-01-02T03:04:05+00:00", 12.5, 1e-6, 1e-3),
        (1,),
    )  # fmt: skip
    slow = Stream(np.array([0.0, 1.0]), {"p_Pa": Channel(np.array([1e5, 1.1e5]), "Pa")}, Clock("c"))
    repair = Repair(
        "duplicate_time", REPAIR, "two rows at one time", "fast", "t", ((4, 5), (9, 9)), 3,
        {"rows": 9.0}, {"rows": 6.0},
    )  # fmt: skip
    about = Provenance(
        "log.csv", "ab" * 32, 123, "csv", "0.1.0", "repair",
        (Conversion("a (deg)", "deg", "angle_rad", "rad", 0.0174, 0.0, "mapping"),), (repair,),
        {"licence": "MIT"},
    )  # fmt: skip
    return Recording(
        {"fast": fast, "slow": slow}, about, (Event("impact", 0.5, "fast", 1e-4, 2.0),)
    )


def test_every_value_comes_back(tmp_path):
    stored = a_recording()
    recording_store.save(stored, tmp_path / "x.rec")
    found = recording_store.load(tmp_path / "x.rec")
    assert found.provenance == stored.provenance
    assert found.events == stored.events
    for name, stream in stored.streams.items():
        other = found.streams[name]
        assert (other.clock, other.gaps) == (stream.clock, stream.gaps)
        np.testing.assert_array_equal(other.time_s, stream.time_s)
        assert list(other.channels) == list(stream.channels)
        for key, channel in stream.channels.items():
            np.testing.assert_array_equal(other.channels[key].values, channel.values)
            np.testing.assert_array_equal(other.channels[key].u, channel.u)
            np.testing.assert_array_equal(other.channels[key].saturated, channel.saturated)
            assert other.channels[key].raw == channel.raw


def test_a_recording_is_replaced_and_nothing_else_is(tmp_path):
    place = recording_store.save(a_recording(), tmp_path / "x.rec")
    recording_store.save(a_recording(), place)
    assert [path.name for path in tmp_path.iterdir()] == ["x.rec"]
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "thesis.txt").write_text("years of work")
    with pytest.raises(OutputError, match="exists and is no recording"):
        recording_store.save(a_recording(), mine)
    assert (mine / "thesis.txt").read_text() == "years of work"


def test_channels_may_be_called_as_columns_of_the_table_are(tmp_path):
    names = ["time_s", "u:x", "x", "X", "saturated:x", "x (2)"]
    channels = {name: Channel(np.array([1.0, 2.0]) + i, "1") for i, name in enumerate(names)}
    marked = {"u": np.array([0.1, 0.2]), "saturated": np.array([True, False])}
    channels["x"] = Channel(np.array([7.0, 8.0]), "1", **marked)
    stream = Stream(np.array([0.0, 0.5]), channels, Clock("c"))
    stored = Recording({"s": stream}, a_recording().provenance)
    recording_store.save(stored, tmp_path / "x.rec")
    found = recording_store.load(tmp_path / "x.rec").streams["s"]
    np.testing.assert_array_equal(found.time_s, [0.0, 0.5])
    for name, channel in channels.items():
        np.testing.assert_array_equal(found.channels[name].values, channel.values)
        np.testing.assert_array_equal(found.channels[name].u, channel.u)
        np.testing.assert_array_equal(found.channels[name].saturated, channel.saturated)


def test_a_recording_that_was_stored_without_the_names_of_its_columns_is_read(tmp_path):
    place = recording_store.save(a_recording(), tmp_path / "x.rec")
    head = json.loads((place / "recording.json").read_text())
    for stream in head["streams"].values():
        for channel in stream["channels"].values():
            del channel["columns"]
    (place / "recording.json").write_text(json.dumps(head))
    found = recording_store.load(place).streams["fast"].channels['odd "name"']
    np.testing.assert_array_equal(found.u, [0.1, 0.2, 0.3])
    np.testing.assert_array_equal(found.saturated, [False, True, False])


def test_files_beside_a_recording_are_never_deleted(tmp_path):
    place = recording_store.save(a_recording(), tmp_path / "x.rec")
    (place / "notes.txt").write_text("what I saw")
    with pytest.raises(OutputError, match=r"holds other files .*notes\.txt"):
        recording_store.save(a_recording(), place)
    assert (place / "notes.txt").read_text() == "what I saw"
    assert recording_store.is_recording(place)


@pytest.mark.parametrize("place", [".", "/", ".."])
def test_a_folder_without_a_name_of_its_own_is_refused(tmp_path, monkeypatch, place):
    (tmp_path / "inside").mkdir()
    monkeypatch.chdir(tmp_path / "inside")
    with pytest.raises(OutputError, match="exists and is no recording"):
        recording_store.save(a_recording(), Path(place))


def test_an_old_recording_outlives_a_new_one_that_cannot_be_put_there(tmp_path, monkeypatch):
    place = recording_store.save(a_recording(), tmp_path / "x.rec")
    rename = Path.rename

    def fails(self, target):
        if self.name.endswith(".partial"):
            raise OSError(28, "No space left on device")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", fails)
    with pytest.raises(OutputError, match="No space left"):
        recording_store.save(a_recording(), place)
    assert recording_store.load(place).provenance == a_recording().provenance
    assert [path.name for path in tmp_path.iterdir()] == ["x.rec"]


def test_a_number_that_json_does_not_have_is_no_hindrance(tmp_path):
    stored = a_recording()
    repair = replace(stored.provenance.repairs[0], before={"max": np.inf, "rows": 9.0})
    stored = replace(stored, provenance=replace(stored.provenance, repairs=(repair,)))
    found = recording_store.load(recording_store.save(stored, tmp_path / "x.rec"))
    before = found.provenance.repairs[0].before
    assert np.isnan(before["max"])
    assert before["rows"] == 9.0


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"format": 99}', "{nonsense"])
def test_a_damaged_head_is_named(tmp_path, text):
    place = recording_store.save(a_recording(), tmp_path / "x.rec")
    (place / "recording.json").write_text(text)
    with pytest.raises(InputError, match=r"recording\.json"):
        recording_store.load(place)


def test_a_damaged_table_is_named(tmp_path):
    place = recording_store.save(a_recording(), tmp_path / "x.rec")
    (place / "stream-001.parquet").write_bytes(b"PAR1 nothing")
    with pytest.raises(InputError, match=r"stream-001\.parquet"):
        recording_store.load(place)


def test_a_channel_is_found_by_its_name_with_or_without_unit_and_stream():
    found = a_recording()
    assert found.find("angle") == ("fast", "angle_rad")
    assert found.find("fast/angle_rad") == ("fast", "angle_rad")
    with pytest.raises(UnknownName, match="fast/angle_rad"):
        found.find("angles")


def test_a_name_in_several_streams_is_refused_with_what_to_write():
    channel = {"q_rad": Channel(np.zeros(2), "rad")}
    both = {name: Stream(np.arange(2.0), channel, Clock("c")) for name in ("a", "b")}
    found = Recording(both, a_recording().provenance)
    with pytest.raises(InputError, match=r"q: is the name of 2 channels \(a/q_rad.*write a/q,"):
        found.find("q")
    assert found.find("b/q") == ("b", "q_rad")


def test_rows_are_told_as_ranges():
    assert ranges([3, 4, 5, 9]) == ((3, 5), (9, 9))
    assert ranges([]) == ()
