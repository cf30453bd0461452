"""HDF5 and Parquet: values, clocks, axes and damage."""

from __future__ import annotations

import duckdb
import numpy as np
import pandas as pd
import pytest

from simcompare.hardware.logs import importers
from tests.array_logs import START_NS, TIMES, faults, load, survives, values

h5py = pytest.importorskip("h5py")


@pytest.fixture
def hdf5(tmp_path):
    def save(tree, attributes=None, **options):
        path = tmp_path / "log.h5"
        with h5py.File(path, "w") as file:
            file.attrs.update(attributes or {})
            for name, value in tree.items():
                values, more = value if isinstance(value, tuple) else (value, {})
                file.create_dataset(name, data=values, **options).attrs.update(more)
        return path

    return save


@pytest.fixture
def parquet(tmp_path):
    def save(query="SELECT * FROM frame", frame=None, more=""):
        path = tmp_path / "log.parquet"
        with duckdb.connect() as base:
            if frame is not None:
                base.register("frame", frame)
            base.execute(f"COPY ({query}) TO '{path}' (FORMAT parquet{more})")
        return path

    return save


# --- HDF5


def test_data_sets_of_a_group_are_one_stream_with_the_rate_of_its_attribute(hdf5):
    path = hdf5(
        {"acc": np.arange(300.0).reshape(100, 3), "ok": TIMES > 0.5}, {"sampling_rate": 200.0}
    )
    (one,) = load(path).streams
    assert [c.name for c in one.columns] == ["acc.x", "acc.y", "acc.z", "ok"]
    assert (one.time, one.increment_s) == (None, 0.005)
    assert np.array_equal(one.column("acc.y").values, np.arange(1.0, 300.0, 3))
    assert one.column("ok").unit == "1"
    assert one.column("ok").values.tolist() == [0.0] * 51 + [1.0] * 49


def test_units_come_from_attributes_and_from_names(hdf5):
    path = hdf5({"p": (TIMES, {"units": "kPa"}), "v [mm]": TIMES, "time_ms": TIMES})
    (one,) = load(path).streams
    assert {c.name: c.unit for c in one.columns} == {"p": "kPa", "v": "mm", "time_ms": "ms"}
    assert one.time == "time_ms"


def test_each_group_and_each_length_is_a_stream(hdf5):
    log = load(hdf5({
        "imu/time": TIMES, "imu/acc": np.ones((100, 3)),
        "cam/t": TIMES[:40], "cam/x": TIMES[:40], "cam/slow": TIMES[:20],
    }))  # fmt: skip
    assert {s.name: len(s) for s in log.streams} == {"imu": 100, "cam/t+x": 40, "cam/slow": 20}


def test_a_quaternion_is_named_and_its_order_is_recorded(hdf5):
    log = load(hdf5({"t": TIMES, "opt_quat": np.tile([1.0, 2, 3, 4], (100, 1))}))
    assert values(log, "opt_quat.w")[0] == 1.0
    assert "quaternion_order" in [r.rule for r in log.repairs]


def test_components_before_samples_are_turned_where_the_neighbours_tell(hdf5):
    log = load(hdf5({"t": TIMES, "acc": np.arange(300.0).reshape(3, 100)}))
    assert np.array_equal(values(log, "acc.z"), np.arange(200.0, 300.0))
    assert "turned_axes" in [r.rule for r in log.repairs]


def test_axes_that_nothing_tells_are_refused(hdf5):
    text = faults(hdf5({"acc": np.zeros((3, 100)), "also": np.zeros((5, 5))}))
    assert "acc has the shape 3×100" in text
    assert "also has the shape 5×5" in text
    assert "beside a vector of times" in text


def test_a_table_with_fields_becomes_columns(hdf5):
    table = np.zeros(100, dtype=[("t", "f8"), ("acc", "f4", (3,)), ("name", "S3")])
    table["t"], table["acc"] = TIMES, 2.5
    log = load(hdf5({"log": table}))
    assert [c.name for c in log.streams[0].columns] == ["t", "acc.x", "acc.y", "acc.z"]
    assert "field_left_out" in [r.rule for r in log.repairs]


def test_links_to_other_files_are_not_followed(tmp_path, hdf5):
    path = hdf5({"t": TIMES, "x": TIMES})
    other = tmp_path / "secret.h5"
    with h5py.File(other, "w") as file:
        file["key"] = TIMES
    with h5py.File(path, "a") as file:
        file["stolen"] = h5py.ExternalLink(str(other), "/key")
    log = load(path)
    assert "link to another file" in log.ignored["stolen"]
    assert [c.name for c in log.streams[0].columns] == ["t", "x"]


def test_a_file_with_a_block_of_the_users_own_before_it_is_recognised(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(path, "w", userblock_size=1024) as file:
        file["t"], file["x"] = TIMES, TIMES
    assert importers.recognise(path) == "hdf5"
    assert len(load(path).streams[0]) == 100


def test_a_damaged_chunk_ends_the_stream_and_is_named(hdf5):
    random = np.random.default_rng(0).random(4000)
    path = hdf5(
        {"time": np.arange(4000.0), "x": random}, chunks=(500,), compression="gzip", fletcher32=True
    )
    with h5py.File(path) as file:
        place = file["x"].id.get_chunk_info(5)
    data = bytearray(path.read_bytes())
    data[place.byte_offset + 50] ^= 0xFF
    path.write_bytes(data)
    (one,) = load(path).streams
    assert len(one) == 2500
    assert np.array_equal(one.column("x").values, random[:2500])
    assert "cannot be read from sample 2501" in one.truncated


def test_a_truncated_hdf5_file_is_refused(hdf5):
    path = hdf5({"t": TIMES, "x": TIMES})
    path.write_bytes(path.read_bytes()[:-100])
    assert "truncated" in faults(path)


def test_a_changed_hdf5_file_gives_a_typed_error_or_numbers(hdf5):
    path = hdf5({"t": TIMES, "g/x": TIMES}, {"rate": 3.0}, chunks=(20,), compression="gzip")
    assert survives(path, "hdf5", path.read_bytes()) > 20


# --- Parquet


def test_numeric_columns_of_a_table_are_one_stream(parquet):
    frame = pd.DataFrame(
        {"time_s": TIMES, "force (N)": TIMES / 3, "on": TIMES > 0.5, "n": range(100)}
    )
    log = load(parquet(frame=frame))
    (one,) = log.streams
    assert (one.time, one.row_word) == ("time_s", "row")
    units = {c.name: c.unit for c in one.columns}
    assert (units["force"], units["on"], units["n"]) == ("N", "1", "")
    assert np.array_equal(values(log, "force"), TIMES / 3)
    assert np.array_equal(values(log, "n"), np.arange(100.0))
    assert values(log, "on").sum() == 49


def test_what_is_null_is_missing(parquet):
    path = parquet(
        "SELECT i / 10.0 AS t, CASE WHEN i = 3 THEN NULL ELSE i END AS x FROM range(20) r(i)"
    )
    assert np.flatnonzero(np.isnan(values(load(path), "x"))).tolist() == [3]


def test_time_stamps_of_a_table_keep_their_nanoseconds(parquet):
    stamps = pd.to_datetime(START_NS + np.arange(100, dtype=np.int64) * 10_000_001)
    log = load(parquet(frame=pd.DataFrame({"time": stamps, "x": TIMES})))
    got = np.rint(values(log, "time") * 1e9).astype(np.int64)
    assert np.array_equal(got, np.arange(100) * 10_000_001)
    assert log.streams[0].clock.start == "2023-11-14T22:13:20.000000001Z"


def test_nanoseconds_as_whole_numbers_are_counted_from_the_first(parquet):
    stamps = START_NS + np.arange(100, dtype=np.int64) * 10_000_001
    log = load(parquet(frame=pd.DataFrame({"timestamp": stamps, "x": TIMES})))
    assert np.array_equal(values(log, "timestamp"), np.arange(100) * 10_000_001.0)


def test_lists_of_equal_length_become_columns(parquet):
    path = parquet("SELECT i * 0.01 AS t, [i, 2 * i, 3 * i] AS acc, ['a'] AS s FROM range(50) r(i)")
    log = load(path)
    assert np.array_equal(values(log, "acc.z"), 3.0 * np.arange(50))
    assert "no numbers" in log.ignored["s"]


def test_a_long_table_keeps_its_order(parquet):
    path = parquet(
        "SELECT i * 0.001 AS t, i AS x FROM range(700000) r(i)", more=", ROW_GROUP_SIZE 50000"
    )
    assert np.array_equal(values(load(path), "x"), np.arange(700000.0))


def test_names_with_quotes_are_only_names(parquet):
    path = parquet("""SELECT i AS t, i AS "a""; DROP VIEW log; --" FROM range(9) r(i)""")
    assert load(path).streams[0].columns[1].name.startswith('a"; DROP')


def test_a_truncated_table_is_refused_with_its_byte(parquet):
    path = parquet("SELECT i AS t, i AS x FROM range(999) r(i)")
    data = path.read_bytes()
    path.write_bytes(data[:-50])
    assert f"byte {len(data) - 54}" in faults(path)


def test_changed_tables_give_a_typed_error_or_numbers(parquet):
    path = parquet("SELECT i * 0.01 AS t, random() AS x FROM range(500) r(i)")
    assert survives(path, "parquet", path.read_bytes(), 100) > 20


# --- the real recordings


def test_the_real_inertial_recording_has_its_arrays(real):
    path = real / "imu_broad/11_undisturbed_slow_translation_B.hdf5"
    (one,) = load(path).streams
    assert one.increment_s == pytest.approx(0.0035)
    assert len(one) == 54214
    with h5py.File(path) as file:
        assert np.array_equal(one.column("imu_acc.z").values, file["imu_acc"][:, 2])
        assert np.array_equal(
            one.column("opt_quat.w").values, file["opt_quat"][:, 0], equal_nan=True
        )
        assert np.array_equal(one.column("movement").values, file["movement"][:].astype(float))
    assert one.column("imu_acc.x").unit == ""
