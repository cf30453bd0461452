"""A recording on disk is the recording that was stored."""

import numpy as np
import pytest

from simcompare import recording_store
from simcompare.errors import InputError, OutputError, UnknownName
from simcompare.recording import (
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


def test_rows_are_told_as_ranges():
    assert ranges([3, 4, 5, 9]) == ((3, 5), (9, 9))
    assert ranges([]) == ()
