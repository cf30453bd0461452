"""HDF5, NumPy, PyTorch and Parquet: values, clocks, axes, damage, and pickles that must not run."""

from __future__ import annotations

import os
import pickle
import struct
import zipfile
from pathlib import Path

import duckdb
import numpy as np
import pandas as pd
import pytest

from simcompare.errors import InputError
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.logs import importers, torch_pickle
from simcompare.hardware.logs.mapping import NOTHING, of_tree
from simcompare.recording import Provenance

h5py = pytest.importorskip("h5py")

TIMES = np.arange(100) * 0.01
START_NS = 1_700_000_000_000_000_001


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
def npz(tmp_path):
    def save(**tree):
        path = tmp_path / "log.npz"
        np.savez_compressed(path, **tree)
        return path

    return save


@pytest.fixture
def npy(tmp_path):
    def save(array):
        path = tmp_path / "log.npy"
        np.save(path, array)
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


def load(path):
    return importers.read(path, importers.recognise(path), NOTHING)


def faults(path):
    with pytest.raises(InputError) as error:
        load(path)
    assert path.name in str(error.value)
    return " | ".join(error.value.faults)


def values(log, name, stream=0):
    return log.streams[stream].column(name).values


def survives(path, kind, data, count=150, seed=3):
    """Changes and cuts a valid file; every time there are numbers or a typed error."""
    random = np.random.default_rng(seed)
    refused = 0
    for number in range(count):
        bad = bytearray(data[: random.integers(8, len(data))] if number % 3 == 0 else data)
        for at in random.integers(0, len(bad), random.integers(1, 4)):
            bad[at] = random.integers(0, 256)
        path.write_bytes(bad)
        try:
            log = importers.read(path, kind, NOTHING)
        except InputError:
            refused += 1
            continue
        assert all(len(c.values) == len(s) for s in log.streams for c in s.columns)
    return refused


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


# --- NumPy


def test_an_npy_matrix_has_its_columns_by_number(npy):
    table = np.random.default_rng(0).random((500, 5)).astype(np.float32)
    log = load(npy(table))
    assert [c.name for c in log.streams[0].columns] == [f"data.{i}" for i in range(5)]
    assert np.array_equal(values(log, "data.4"), table[:, 4].astype(float))


def test_a_structured_npy_has_its_fields(npy):
    table = np.zeros(50, dtype=[("time (ms)", "f8"), ("force (N)", "f4"), ("n", "i4")])
    table["time (ms)"] = np.arange(50) * 20
    log = load(npy(table))
    (one,) = log.streams
    assert one.time == "time"
    assert {c.name: c.unit for c in one.columns} == {"time": "ms", "force": "N", "n": ""}


def test_columns_stored_in_fortran_order_are_read(npy):
    table = np.asfortranarray(np.arange(300.0).reshape(100, 3))
    assert np.array_equal(values(load(npy(table)), "data.1"), table[:, 1])


def test_archives_of_vectors_are_one_stream(npz):
    log = load(npz(time_s=TIMES, acc=np.ones((100, 3)), mass=np.float64(0.37)))
    (one,) = log.streams
    assert one.time == "time_s"
    assert [c.name for c in one.columns] == ["time_s", "acc.x", "acc.y", "acc.z"]
    assert float(log.about["mass"]) == 0.37


def test_nanosecond_stamps_keep_their_nanoseconds(npz):
    stamps = START_NS + np.arange(100, dtype=np.int64) * 10_000_001
    log = load(npz(timestamp=stamps, x=TIMES))
    assert np.array_equal(values(log, "timestamp"), np.arange(100) * 10_000_001.0)
    assert log.streams[0].clock.start == "2023-11-14T22:13:20.000000001Z"


def test_dates_of_numpy_become_seconds(npz):
    stamps = np.datetime64("2024-01-01T00:00:00") + np.arange(100) * np.timedelta64(250, "ms")
    log = load(npz(time=stamps, x=TIMES))
    assert np.array_equal(values(log, "time"), np.arange(100) * 0.25)
    assert log.streams[0].column("time").unit == "s"
    assert log.streams[0].clock.start == "2024-01-01T00:00:00.000000000Z"


def test_large_counts_that_are_no_time_are_rounded_with_a_warning(npz):
    log = load(npz(t=TIMES, count=np.full(100, (1 << 60) + 1)))
    assert [r.severity for r in log.repairs if r.rule == "rounded"] == ["warning"]


def test_stacked_items_are_cut_by_their_lengths_and_named_by_their_numbers(npz):
    state = np.random.default_rng(0).random((60, 13)).astype(np.float32)
    log = load(npz(state=state, length=np.array([10, 30, 20]), toss_id=np.array([3, 4, 9])))
    assert [(s.name, len(s)) for s in log.streams] == [
        ("toss.3", 10),
        ("toss.4", 30),
        ("toss.9", 20),
    ]
    assert np.array_equal(values(log, "state.12", 1), state[10:40, 12].astype(float))
    assert log.streams[2].first_row == 41
    assert "stacked_items" in [r.rule for r in log.repairs]


def test_an_array_of_objects_is_never_loaded(tmp_path):
    mark = tmp_path / "ran"
    path = tmp_path / "log.npy"
    np.save(path, np.array([Evil(mark), None], dtype=object), allow_pickle=True)
    assert "never loaded" in faults(path)
    assert not mark.exists()
    path = tmp_path / "log.npz"
    np.savez(path, t=TIMES, x=np.array([Evil(mark)], dtype=object))
    assert "array x: holds Python objects" in faults(path)
    assert not mark.exists()


def test_axes_of_a_lone_wide_matrix_are_refused(npy):
    assert "shape 5×13" in faults(npy(np.zeros((5, 13))))


def test_a_wide_matrix_is_turned_where_a_vector_tells(npz):
    log = load(npz(t=TIMES, y=np.arange(200.0).reshape(2, 100)))
    assert np.array_equal(values(log, "y.1"), np.arange(100.0, 200.0))


def test_a_truncated_array_gives_its_whole_samples(npy):
    path = npy(np.arange(3000.0).reshape(1000, 3))
    path.write_bytes(path.read_bytes()[:-100])
    (one,) = load(path).streams
    assert len(one) == 995
    assert one.truncated == "the file ends after 995 of 1000 samples"


def test_a_truncated_archive_is_refused(npz):
    path = npz(t=TIMES, x=TIMES)
    path.write_bytes(path.read_bytes()[:-60])
    with pytest.raises(InputError, match="damaged"):
        importers.read(path, "numpy", NOTHING)


def test_a_header_that_promises_a_terabyte_needs_no_memory(npy):
    path = npy(np.zeros((1000, 3)))
    data = (
        path.read_bytes()
        .replace(b"(1000, 3), }", b"(9999999999, 3), }")
        .replace(b"      \n", b"\n", 1)
    )
    path.write_bytes(data)
    (one,) = load(path).streams
    assert 990 <= len(one) <= 1001
    assert "of 9999999999 samples" in one.truncated


def test_changed_arrays_give_a_typed_error_or_numbers(npy, npz):
    path = npy(np.arange(300.0).reshape(100, 3))
    assert survives(path, "numpy", path.read_bytes()) > 10
    path = npz(t=TIMES, y=np.ones((100, 3)))
    assert survives(path, "numpy", path.read_bytes()) > 10


def test_a_log_becomes_a_recording_with_a_mapping(npz):
    path = npz(state=np.arange(300.0).reshape(100, 3))
    mapping = of_tree(
        {"time": {"rate_Hz": 148.0}, "channels": {"x": {"column": "state.x", "unit": "cm"}}}, "map"
    )
    log = importers.read(path, "numpy", mapping)
    done = condition(log, mapping, Provenance(path.name, "", 0, "numpy", "", "repair"))
    (found,) = done.streams.values()
    assert found.channels["x_m"].values == pytest.approx(np.arange(0, 300, 3) / 100)
    assert found.time_s[-1] == pytest.approx(99 / 148)


# --- PyTorch


class Evil:
    """Runs a command when it is unpickled."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return os.system, (f"touch {self.mark}",)


def storage(key, count, kind="DoubleStorage"):
    def text(words):
        return b"X" + struct.pack("<I", len(words)) + words.encode()

    return (
        b"(" + text("storage") + b"ctorch\n" + kind.encode() + b"\n" + text(key) + text("cpu")
        + b"J" + struct.pack("<i", count) + b"NtQ"
    )  # fmt: skip


def numbers(*items):
    return b"(" + b"".join(b"J" + struct.pack("<i", n) for n in items) + b"t"


def tensor(key, shape, strides, count, kind="DoubleStorage"):
    return (
        b"ctorch._utils\n_rebuild_tensor_v2\n(" + storage(key, count, kind) + b"K\x00"
        + numbers(*shape) + numbers(*strides) + b"\x89ccollections\nOrderedDict\n)RtR"
    )  # fmt: skip


def legacy(body, data, key="7"):
    keys = b"\x80\x02]X" + struct.pack("<I", len(key)) + key.encode() + b"a."
    head = torch_pickle.MAGIC + b"\x80\x02M\xe9\x03." + b"\x80\x02}."
    return head + b"\x80\x02" + body + b"." + keys + struct.pack("<q", len(data)) + data.tobytes()


@pytest.fixture
def pt(tmp_path):
    def save(data):
        path = tmp_path / "toss.pt"
        path.write_bytes(data)
        return path

    return save


def test_a_tensor_of_the_older_format_has_its_values_to_the_bit(pt):
    data = np.random.default_rng(0).random((1, 40, 19))
    path = pt(legacy(tensor("7", (1, 40, 19), (760, 19, 1), 760), data.ravel()))
    log = load(path)
    assert [c.name for c in log.streams[0].columns] == [f"data.{i}" for i in range(19)]
    for i in range(19):
        assert np.array_equal(values(log, f"data.{i}"), data[0, :, i])


def test_a_transposed_view_of_floats_is_read_by_its_strides(pt):
    data = np.arange(200.0, dtype=np.float32)
    path = pt(legacy(tensor("7", (100, 2), (1, 100), 200, "FloatStorage"), data))
    assert np.array_equal(values(load(path), "data.1"), np.arange(100.0, 200.0))


def test_tensors_in_a_dictionary_keep_their_names(pt):
    body = b"}(X\x01\x00\x00\x00t" + tensor("7", (50,), (1,), 50) + b"u"
    log = load(pt(legacy(body, TIMES[:50])))
    assert log.streams[0].time == "t"


def test_the_zipped_format_is_read_too(tmp_path):
    path = tmp_path / "toss.pt"
    data = np.arange(300.0)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("toss/data.pkl", b"\x80\x02" + tensor("0", (100, 3), (3, 1), 300) + b".")
        archive.writestr("toss/version", "3\n")
        archive.writestr("toss/data/0", data.tobytes())
    assert np.array_equal(values(load(path), "data.2"), np.arange(2.0, 300.0, 3))


@pytest.mark.parametrize("protocol", [0, 1, 2, 3, 4, 5])
def test_a_pickle_that_wants_to_run_a_command_is_refused_and_leaves_no_trace(
    tmp_path, pt, protocol
):
    mark = tmp_path / "ran"
    body = pickle.dumps(Evil(mark), protocol)
    start = torch_pickle.MAGIC + b"\x80\x02M\xe9\x03." + b"\x80\x02}."
    text = faults(pt(start + body + b"\x80\x02]."))
    assert not mark.exists()
    assert "system" in text
    assert "byte " in text


@pytest.mark.parametrize(
    ("body", "named"),
    [
        (b"cos\nsystem\n(X\x02\x00\x00\x00lstR", "os.system"),
        (b"cbuiltins\neval\n", "builtins.eval"),
        (b"(X\x02\x00\x00\x00lsios\nsystem\n", "INST"),
        (b"ccollections\nOrderedDict\n)\x81", "NEWOBJ"),
        (b"ccollections\nOrderedDict\n)R}b", "BUILD"),
        (b"\x82\x01", "EXT1"),
        (b"ccollections\nOrderedDict\n(K\x01tR", "collections.OrderedDict"),
        (b"(X\x06\x00\x00\x00modulectorch\nDoubleStorage\nX\x01\x00\x00\x007tQ", "BINPERSID"),
    ],
)
def test_every_step_that_is_not_needed_is_refused_with_its_name_and_byte(pt, body, named):
    text = faults(pt(legacy(body, np.zeros(1))))
    assert named in text
    assert "byte " in text


def test_a_command_in_a_zipped_pickle_does_not_run(tmp_path):
    mark, path = tmp_path / "ran", tmp_path / "toss.pt"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("toss/data.pkl", pickle.dumps(Evil(mark), 2))
    assert "system" in faults(path)
    assert not mark.exists()


def test_a_tensor_that_reaches_beyond_its_storage_is_refused(pt):
    path = pt(legacy(tensor("7", (100, 2), (2, 1), 100), np.zeros(100)))
    assert "does not fit 100 numbers" in faults(path)
    path = pt(legacy(tensor("7", (1000000, 1000000), (0, 0), 100), np.zeros(100)))
    assert "does not fit 100 numbers" in faults(path)
    path = pt(legacy(tensor("7", (10, 2), (-2, 1), 100), np.zeros(100)))
    assert "strides" in faults(path)


def test_a_truncated_tensor_is_refused_with_its_byte(pt):
    whole = legacy(tensor("7", (100, 2), (2, 1), 200), np.zeros(200))
    assert "80 bytes of the numbers are missing" in faults(pt(whole[:-80]))


def test_changed_tensors_give_a_typed_error_or_numbers(pt):
    whole = legacy(tensor("7", (100, 2), (2, 1), 200), np.zeros(200))
    head = len(whole) - 1600
    path = pt(whole)
    random = np.random.default_rng(5)
    refused = 0
    for _ in range(400):
        bad = bytearray(whole)
        bad[random.integers(0, head)] = random.integers(0, 256)
        path.write_bytes(bad)
        try:
            importers.read(path, "numpy", NOTHING)
        except InputError:
            refused += 1
    assert refused > 100


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


@pytest.fixture(scope="module")
def real():
    folder = os.environ.get("SIMCOMPARE_DATA")
    if not folder:
        pytest.skip("SIMCOMPARE_DATA is not set: it names the folder of real recordings")
    return Path(folder)


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


def test_the_real_tosses_are_cut_into_their_428_streams(real):
    path = real / "cube_toss/tosses.npz"
    log = load(path)
    raw = np.load(path)
    assert len(log.streams) == 428
    assert [len(s) for s in log.streams] == raw["length"].tolist()
    assert [s.name for s in log.streams] == [f"toss.{i}" for i in raw["toss_id"]]
    ends = np.cumsum(raw["length"])
    assert np.array_equal(
        values(log, "state.2", 1), raw["state"][ends[0] : ends[1], 2].astype(float)
    )


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_real_tensor_is_the_toss_in_units_of_half_its_width(real, number):
    log = load(real / f"cube_toss/original_format/{number}.pt")
    raw = np.load(real / "cube_toss/tosses.npz")
    start = int(raw["length"][:number].sum())
    state = raw["state"][start : start + int(raw["length"][number])]
    table = np.column_stack([values(log, f"data.{i}") for i in range(19)])
    assert table.shape == (len(state), 19)
    scale = np.r_[np.full(3, 0.0524), np.ones(4), np.full(3, 0.0524), np.ones(3)]
    assert table[:, :13] * scale == pytest.approx(state, rel=1e-6, abs=1e-6)
    assert not table[:, 13:].any()
