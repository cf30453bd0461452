"""NumPy arrays and PyTorch tensors: values, axes, damage, and pickles that must not run."""

from __future__ import annotations

import pickle
import struct
import zipfile

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.logs import importers
from simcompare.hardware.logs.binary import torch_pickle
from simcompare.hardware.mapping import NOTHING, of_tree
from simcompare.model.recording import Provenance
from tests.array_logs import START_NS, TIMES, Evil, faults, load, survives, values
from tests.text_samples import zipped


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


def test_lists_that_hold_each_other_are_not_walked_without_end(pt):
    doubled = b"\x80\x02]q\x00" + b"(h\x00h\x00h\x00e" * 1000 + b"."
    path = pt(zipped({"l/data.pkl": doubled, "l/version": b"3\n"}, zipfile.ZIP_STORED))
    assert "repeats its parts more than a million times" in faults(path)


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


# --- the real recordings


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


# --- what a header may claim


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        (b"(50,)", b"(-50,)", "has the shape (-50,)"),
        (b"(50,)", b"(1152921504606846976, 1152921504606846976)", "has 1152921504606846976 comp"),
        (b"(50,)", b"(1152921504606846976, 7)", "ends after 7 of 1152921504606846976 samples"),
        (b"'<f8'", b"'<f8", "has no whole header"),
        (b"(50,)", b"(" * 150, "has no whole header"),
    ],
)
def test_a_header_that_claims_the_impossible_is_refused(npy, old, new, fault):
    path = npy(np.arange(50.0))
    data = path.read_bytes()
    header = data[10:128].replace(old, new).rstrip() + b"\n"
    path.write_bytes(data[:8] + struct.pack("<H", len(header)) + header + data[128:])
    try:
        said = faults(path)
    except pytest.fail.Exception:
        said = load(path).streams[0].truncated  # what is whole is kept
    assert fault in said


def test_a_damaged_member_of_any_packing_is_refused(tmp_path):
    for how in (zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        path = tmp_path / "log.npz"
        with zipfile.ZipFile(path, "w", how) as archive, archive.open("x.npy", "w") as file:
            np.save(file, np.random.default_rng(0).random(5000))
        data = bytearray(path.read_bytes())
        data[60:200] = b"\xff" * 140
        path.write_bytes(bytes(data))
        assert "is a damaged archive of arrays" in faults(path)


def test_a_pickle_that_unpacks_to_a_flood_is_refused(tmp_path):
    path = tmp_path / "log.pt"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("log/data.pkl", b"\x80\x02" + b"N" * (20 << 20))
    assert "data.pkl unpacks to 20971522 bytes, which is not plausible" in faults(path)
