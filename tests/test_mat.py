"""MATLAB files of versions 5 to 7.3: vectors, matrices, structs, cells, and damaged files."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest
import scipy.io

from simcompare.errors import InputError
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.logs import importers
from simcompare.hardware.logs.binary import mat_check
from simcompare.hardware.mapping import NOTHING, of_tree
from simcompare.model.recording import Provenance

h5py = pytest.importorskip("h5py")

TIMES = np.arange(100) * 0.01


def save_5(path, tree):
    scipy.io.savemat(path, tree, do_compression=True)


def save_73(path, tree):
    """A version 7.3 file as MATLAB writes it: HDF5 behind a head of 512 bytes."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in tree.items():
            put(file, file, name, value)
    with path.open("r+b") as file:
        head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 ."
        file.write(head.ljust(124) + b"\0\2IM")


def put(file, group, name, value):
    if isinstance(value, dict):
        inner = group.create_group(name)
        inner.attrs["MATLAB_class"] = np.bytes_("struct")
        for key, item in value.items():
            put(file, inner, key, item)
        return
    if isinstance(value, np.ndarray) and value.dtype == object:
        refs = np.empty(value.T.shape, dtype=h5py.ref_dtype)
        for i, cell in enumerate(value.reshape(-1)):
            key = f"c{len(file.require_group('#refs#'))}"
            put(file, file["#refs#"], key, cell)
            refs.reshape(-1)[i] = file[f"#refs#/{key}"].ref
        item = group.create_dataset(name, data=refs, dtype=h5py.ref_dtype)
        item.attrs["MATLAB_class"] = np.bytes_("cell")
        return
    if isinstance(value, str):
        item = group.create_dataset(name, data=np.array([[ord(c)] for c in value], np.uint16))
        item.attrs["MATLAB_class"] = np.bytes_("char")
        return
    array = np.atleast_2d(np.asarray(value))
    if array.shape[0] == 1 and array.shape[1] > 1:
        array = array.reshape(1, -1)
    item = group.create_dataset(name, data=array.T)
    item.attrs["MATLAB_class"] = np.bytes_("double")


@pytest.fixture(params=[save_5, save_73], ids=["v5", "v7.3"])
def save(request, tmp_path):
    def write(tree, name="log.mat"):
        path = tmp_path / name
        request.param(path, tree)
        return path

    return write


def load(path, mapping=NOTHING):
    return importers.read(path, importers.recognise(path), mapping)


def faults(path):
    with pytest.raises(InputError) as error:
        load(path)
    assert path.name in str(error.value)
    return " | ".join(error.value.faults)


def stream(log, name):
    return next(one for one in log.streams if one.name == name)


def cells(*arrays):
    made = np.empty((len(arrays), 1), dtype=object)
    for i, array in enumerate(arrays):
        made[i, 0] = array
    return made


def test_vectors_of_equal_length_are_one_stream_with_its_time(save):
    log = load(save({"t": TIMES[:, None], "angle": np.sin(TIMES)[None, :]}))
    (one,) = log.streams
    assert (one.name, one.time) == ("log", "t")
    assert np.array_equal(one.column("t").values, TIMES)
    assert np.array_equal(one.column("angle").values, np.sin(TIMES))


def test_a_matrix_becomes_columns_along_its_longer_dimension(save):
    table = np.arange(300.0).reshape(100, 3)
    for matrix in (table, table.T):
        (one,) = load(save({"t": TIMES[:, None], "Y": matrix})).streams
        assert {c.name for c in one.columns} == {"t", "Y.0", "Y.1", "Y.2"}
        assert np.array_equal(one.column("Y.2").values, table[:, 2])


def test_a_struct_is_flattened_with_dots(save):
    log = load(save({"run": {"time": TIMES[:, None], "motor": {"u": TIMES[:, None] * 2}}}))
    names = {c.name for s in log.streams for c in s.columns}
    assert names == {"run.time", "run.motor.u"}


def test_cells_of_times_and_data_pair_up_by_name_and_length(save):
    log = load(save({
        "Time_id": cells(TIMES[:, None], TIMES[:90, None]),
        "Y_id": cells(np.ones((2, 100)), np.full((2, 90), 3.0)),
        "Time_vad": cells(TIMES[:, None]),
        "Y_vad": cells(np.zeros((2, 100))),
        "dt": 0.01,
    }))  # fmt: skip
    assert [s.name for s in log.streams] == ["id.0", "id.1", "vad.0"]
    second = stream(log, "id.1")
    assert second.time == "Time_id"
    assert [c.name for c in second.columns] == ["Time_id", "Y_id.0", "Y_id.1"]
    assert set(second.column("Y_id.1").values) == {3.0}
    assert float(log.about["dt"]) == 0.01
    assert [r.severity for r in log.repairs if r.rule == "cells_paired"] == ["info"] * 3


def test_cells_without_times_are_one_stream_each(save):
    log = load(save({"Y": cells(np.ones((2, 100)), np.zeros((2, 50))), "fs": 200.0}))
    assert [s.name for s in log.streams] == ["Y.0", "Y.1"]
    assert [s.increment_s for s in log.streams] == [0.005, 0.005]
    assert "even_samples" in [r.rule for r in log.repairs]


def test_a_single_dt_is_the_clock_where_no_column_is(save):
    (one,) = load(save({"x": np.arange(50.0)[:, None], "dt": 0.002})).streams
    assert (one.time, one.increment_s) == (None, 0.002)


def test_without_any_clock_the_user_is_told_what_to_write(save):
    path = save({"x": np.arange(50.0)[:, None]})
    with pytest.raises(InputError, match="rate_Hz"):
        condition(load(path), NOTHING, Provenance(path.name, "", 0, "mat", "", "repair"))


def test_variables_of_other_lengths_are_streams_of_their_own(save):
    log = load(save({"DRp": np.zeros((90, 4)), "GT": np.zeros((90, 4)), "TD": np.ones((40, 4))}))
    assert {s.name: len(s) for s in log.streams} == {"DRp+GT": 90, "TD": 40}


def test_short_matrices_beside_a_log_are_parameters(save):
    log = load(
        save({"t": TIMES[:, None], "x": TIMES[:, None], "gains": np.array([[1.0, 2.0, 3.0]])})
    )
    assert len(log.streams) == 1
    assert "3 samples beside 100" in log.ignored["gains"]
    assert "2." in log.about["gains"]


def test_a_square_matrix_is_left_out_because_its_axes_cannot_be_told(save):
    log = load(save({"t": TIMES[:, None], "x": TIMES[:, None], "P": np.eye(20)}))
    assert "rows or columns may be samples" in log.ignored["P"]
    assert "20×20" in faults(save({"P": np.eye(20)}))


def test_text_is_kept_as_what_the_log_says_of_itself(save):
    log = load(save({"t": TIMES[:, None], "x": TIMES[:, None], "device": "cart 3"}))
    assert log.about["device"] == "cart 3"


def test_whole_numbers_beyond_2_to_53_keep_their_steps_in_a_time(tmp_path):
    path = tmp_path / "log.mat"
    stamps = 1_700_000_000_000_000_001 + np.arange(50, dtype=np.int64) * 10_000_001
    save_5(path, {"timestamp": stamps[:, None], "x": np.arange(50.0)[:, None]})
    (one,) = load(path).streams
    assert np.array_equal(one.column("timestamp").values, np.arange(50) * 10_000_001.0)
    assert one.clock.start == "2023-11-14T22:13:20.000000001Z"


def test_complex_and_sparse_variables_are_left_out_with_the_reason(tmp_path):
    path = tmp_path / "log.mat"
    sparse = scipy.sparse.eye(30, 40).tocsc()
    save_5(path, {"t": TIMES[:, None], "x": TIMES[:, None], "z": np.ones(100) * 1j, "s": sparse})
    log = load(path)
    assert "no real numbers" in log.ignored["z"]
    assert "sparse" in log.ignored["s"]


def test_a_truncated_file_is_refused_with_its_byte(tmp_path):
    path = tmp_path / "log.mat"
    random = np.random.default_rng(1)
    save_5(path, {"t": TIMES[:, None], "x": random.random((100, 3))})
    data = path.read_bytes()
    path.write_bytes(data[:-200])
    text = faults(path)
    assert "byte " in text
    assert "200 of them are missing" in text


def test_a_truncated_file_of_version_7_3_is_refused(tmp_path):
    path = tmp_path / "log.mat"
    save_73(path, {"t": TIMES[:, None], "x": np.zeros((100, 3))})
    path.write_bytes(path.read_bytes()[:2000])
    assert "damaged" in faults(path)


def test_a_file_changed_or_cut_anywhere_gives_a_typed_error_or_numbers(save):
    path = save({"Time": TIMES[:, None], "Y": np.arange(200.0).reshape(100, 2), "n": {"a": TIMES}})
    data = path.read_bytes()
    random = np.random.default_rng(2)
    for number in range(150):
        bad = bytearray(data[: random.integers(130, len(data))] if number % 3 == 0 else data)
        bad[random.integers(128, len(bad))] = random.integers(0, 256)
        path.write_bytes(bad)
        try:
            log = importers.read(path, "mat", NOTHING)
        except InputError:
            continue
        assert all(len(c.values) == len(s) for s in log.streams for c in s.columns)


# --- the real recordings


def test_the_real_pendulum_has_its_six_swings(real):
    path = real / "pendulum_free_swing/SinglePendulumDataForParameterEstimation.mat"
    log = load(path)
    assert [s.name for s in log.streams] == ["id.0", "id.1", "id.2", "id.3", "vad.0", "vad.1"]
    raw = scipy.io.loadmat(path)
    one = stream(log, "vad.1")
    assert np.array_equal(one.column("Y_vad.0").values, raw["Y_vad"][1, 0][0])
    assert np.array_equal(one.column("Time_vad").values, raw["Time_vad"][1, 0][:, 0])
    assert sum(len(s) for s in log.streams) * 0.001 == pytest.approx(55.0, abs=0.01)


def test_the_real_pendulum_becomes_a_recording_with_a_mapping(real):
    path = real / "pendulum_free_swing/SinglePendulumDataForParameterEstimation.mat"
    mapping = of_tree(
        {"channels": {"angle": {"column": "id.2/Y_id.0", "unit": "rad", "offset": -3.0}},
         "streams": ["id.2"]}, "map",
    )  # fmt: skip
    done = condition(
        load(path, mapping), mapping, Provenance(path.name, "", 0, "mat", "", "repair")
    )
    found = done.streams["id.2"]
    assert len(found.time_s) == 9167
    assert np.nanmean(np.diff(found.time_s)) == pytest.approx(1e-3, rel=1e-6)
    raw = scipy.io.loadmat(path)["Y_id"][2, 0][0]
    assert np.array_equal(found.channels["angle_rad"].values, raw - 3.0)


def test_the_real_odometry_has_its_tables(real):
    log = load(real / "odometry_plaza/Plaza1_.mat")
    assert {s.name: len(s) for s in log.streams} == {"DRp+GT": 9658, "DR": 9657, "TD": 3529}
    assert "TL" in log.about


# ---- what would end the program, or claim all memory, in the library that reads it --------------


@pytest.fixture
def plain(tmp_path):
    """A file of version 5 that is not compressed, with bytes of it replaced."""

    def write(old=b"", new=b"", *, packed=False, tree=None):
        path = tmp_path / "log.mat"
        scipy.io.savemat(path, tree or {"t": TIMES, "x": TIMES * 2}, do_compression=packed)
        data = path.read_bytes()
        assert old in data
        path.write_bytes(data.replace(old, new, 1))
        return path

    return write


def tag(kind, size):
    return struct.pack("<II", kind, size)


DAMAGE = {
    "a type that is none": (tag(9, 800), tag(200, 800), "800 bytes of the type 200"),
    "more numbers than its size": (
        tag(5, 8) + tag(1, 100), tag(5, 8) + tag(1, 99), "holds 100 numbers; its size says 99"
    ),
    "a size beyond all memory": (
        tag(5, 8) + tag(1, 100), tag(5, 8) + tag(2**31 - 1, 2**31 - 1), "its size says 4611686014"
    ),
    "a negative size": (tag(5, 8) + tag(1, 100), tag(5, 8) + tag(2**32 - 1, 100), "has the size"),
    "a part longer than the whole": (tag(5, 8), tag(5, 96_000), "type 5 with 96000 bytes"),
    "another element": (tag(14, 848), tag(7, 848), "of the type 7; expected 14 or 15"),
}  # fmt: skip


@pytest.mark.parametrize("name", DAMAGE)
def test_a_damaged_element_is_refused_before_it_is_read(plain, name):
    old, new, fault = DAMAGE[name]
    said = faults(plain(old, new))
    assert fault in said
    assert "byte 128: the variable that begins there" in said


def test_what_scipy_writes_is_taken_for_whole(plain):
    cells_ = cells(TIMES, "text", np.zeros((2, 0)), {"a": 1.0, "b": cells(np.arange(3))})
    tree = {"t": TIMES, "c": cells_, "z": TIMES + 1j, "e": np.empty((0, 0)), "s": "µ", "n": {}}
    for packed in (False, True):
        path = plain(packed=packed, tree=tree)
        mat_check.check(path)
        assert len(load(path).streams) >= 1


def test_a_variable_that_unpacks_to_a_flood_is_refused(plain, monkeypatch):
    monkeypatch.setattr(mat_check, "MIN_LIMIT", 1 << 20)
    path = plain(packed=True, tree={"t": np.zeros(1 << 18)})
    assert "unpacks to more than 1 MB, which is not plausible" in faults(path)


def test_what_follows_a_packed_variable_in_its_element_is_refused(plain):
    path = plain(packed=True)
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 132)[0]
    body = zlib.compress(zlib.decompress(data[136 : 136 + size]) + b"\0" * 1000)
    path.write_bytes(data[:128] + tag(15, len(body)) + body + data[136 + size :])
    assert "byte 128" in faults(path)
    assert "followed by more" in faults(path)


def test_two_variables_of_one_name_are_refused(plain):
    path = plain(tree={"tt": TIMES, "xx": TIMES * 2})
    path.write_bytes(path.read_bytes().replace(b"xx", b"tt"))
    assert "has the name b'tt', as another one has" in faults(path)
