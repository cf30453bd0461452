"""Small files that would cost a machine are refused in one sentence, with little memory."""

import io
import json
import zipfile
import zlib

import pytest

import simcompare
from simcompare.errors import InputError
from simcompare.hardware import confined, reading_process
from tests.attacks import scenarios
from tests.text_samples import zipped

linux = pytest.mark.skipif(
    not confined.fork_is_safe(), reason="limits of memory are those of Linux"
)


def doubled_lists():
    pickle = b"\x80\x02]q\x00" + b"(h\x00h\x00h\x00e" * 1000 + b"."
    return zipped({"l/data.pkl": pickle, "l/version": b"3\n"}, zipfile.ZIP_STORED)


def endless_rows():
    h5py = pytest.importorskip("h5py")
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        for name in ("t_s", "y_m"):
            file.create_dataset(name, (10**12,), chunks=(10**6,), dtype="f8")
    return buffer.getvalue()


def unlike_records():
    return "\n".join(json.dumps({f"t{i}": 1}) for i in range(6000)).encode()


def packed_variable():
    packed = zlib.compress(bytes(2**28))
    about = b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM"
    return about + (15).to_bytes(4, "little") + len(packed).to_bytes(4, "little") + packed


BOMBS = {
    "lists.pt": doubled_lists, "rows.h5": endless_rows, "records.json": unlike_records,
    "packed.mat": packed_variable,
}  # fmt: skip


@linux
@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_ends_in_one_sentence(name, tmp_path, monkeypatch):
    # the less it may take, the sooner it has taken it
    monkeypatch.setenv(reading_process.MEMORY_VARIABLE, "60")
    path = tmp_path / name
    path.write_bytes(BOMBS[name]())
    with pytest.raises(InputError) as fault:
        simcompare.import_log(path)
    assert len(str(fault.value)) < 600
    assert len(fault.value.faults) == 1


@linux
def test_damaged_scenario_files_are_read_or_refused_in_words():
    outcomes, faults, _, _ = scenarios.run(40)
    assert not faults, faults
    # the mutations bite, and do not only destroy
    assert min(outcomes["read"], outcomes["refused"]) > 2
