"""Damaged stores are refused in a sentence, and never give data that were not stored.

``python -m tests.attacks.stores`` makes as many mutations as are asked for.
"""

from __future__ import annotations

import json
import os
import random
import shutil

import pytest

import simcompare
from simcompare.errors import InputError
from simcompare.model import recording_store
from simcompare.results import store
from simcompare.scenarios import catalogue
from tests.attacks import stores
from tests.test_recording_store import a_recording
from tests.test_store import synthetic

#: of each of two kinds of stores; all are drawn from fixed seeds
COUNT = 100


@pytest.fixture
def recording(tmp_path):
    return recording_store.save(a_recording(), tmp_path / "x.rec")


@pytest.mark.parametrize("kind", ["recording", "run"])
def test_no_mutation_of_a_store_ends_in_a_traceback_or_other_data(kind, tmp_path):
    whole = tmp_path / kind / "x.rec"
    if kind == "recording":
        use = load_recording
        recording_store.save(a_recording(), whole)
    else:
        use = load_run
        whole = store.save(synthetic(), tmp_path / kind).folder
    right = use(whole, random.Random(0))
    found = [stores.attack(kind, whole, use, seed, right) for seed in range(COUNT)]
    bad = [str(one) for one in found if one.outcome in (stores.FAILED, stores.WRONG)]
    assert bad == []
    assert sum(one.outcome == stores.CLEAN for one in found) > COUNT / 2


def load_recording(place, _):
    streams = recording_store.load(place).streams.values()
    return [c.values for one in streams for c in one.channels.values()]


def load_run(place, _):
    found = simcompare.load_run(place)
    moved = [one.trajectory for one in found.trajectories]
    return [array for one in moved for array in (one.time_s, *one.signals.values())]


def edit(folder, change, **more):
    """Changes what recording.json says of its first stream."""
    path = folder / "recording.json"
    head = json.loads(path.read_text(encoding="utf-8"))
    head |= more
    change(head["streams"]["fast"])
    path.write_text(json.dumps(head), encoding="utf-8")


@pytest.mark.parametrize(
    "name",
    ["../b.rec/stream-001.parquet", "/etc/passwd", "*.parquet", "stream-00?.parquet", "", ".",
     "s/stream-001.parquet", "stream-001.parquet\n", "stream-1.parquet", "\udcfc",
     "recording.json"],
)  # fmt: skip
def test_a_table_has_one_of_our_names(recording, name):
    edit(recording, lambda stream: stream.update(table=name))
    with pytest.raises(InputError, match=r"streams\.fast\.table: .* is no name of a table; expec"):
        recording_store.load(recording)


@pytest.mark.parametrize("kind", ["link", "pipe", "device", "folder", "nothing"])
def test_a_table_is_a_file_in_the_folder(recording, kind, tmp_path):
    table = recording / "stream-001.parquet"
    table.rename(tmp_path / "elsewhere.parquet")
    make = {
        "link": lambda: table.symlink_to(tmp_path / "elsewhere.parquet"),
        "pipe": lambda: os.mkfifo(table),
        "device": lambda: table.symlink_to("/dev/zero"),
        "folder": table.mkdir,
        "nothing": lambda: None,
    }
    make[kind]()
    with pytest.raises(InputError, match=r"stream-001\.parquet: cannot be read: "):
        recording_store.load(recording)


def test_the_table_of_another_stream_is_told(recording):
    shutil.copy(recording / "stream-002.parquet", recording / "stream-001.parquet")
    with pytest.raises(InputError, match=r"stream-001\.parquet: is not what was written"):
        recording_store.load(recording)


def test_a_recording_of_an_older_simcompare_is_read(recording):
    edit(recording, lambda stream: stream.pop("sha256"), format=1)
    assert len(recording_store.load(recording).streams["fast"].time_s) == 3


def test_a_digest_that_was_taken_away_is_missed(recording):
    edit(recording, lambda stream: stream.pop("sha256"))
    told = r"streams\.fast\.sha256: is missing; expected the digest of stream-001\.parquet; import "
    with pytest.raises(InputError, match=told):
        recording_store.load(recording)


def test_a_description_without_end_is_not_read(recording):
    with (recording / "recording.json").open("ab") as file:
        file.truncate(20 * 10**9)  # no byte of it is on the disk
    with pytest.raises(InputError, match=r"recording\.json: has more than 64 MB, which no such f"):
        recording_store.load(recording)


def test_the_samples_of_an_old_recording_are_counted(recording):
    edit(recording, lambda stream: (stream.pop("sha256"), stream.update(samples=4)), format=1)
    with pytest.raises(InputError, match=r"holds 3 rows; expected 4; import the log again"):
        recording_store.load(recording)


def test_what_a_newer_simcompare_added_is_told(recording):
    edit(recording, lambda stream: stream.update(drift=0.1))
    with pytest.raises(InputError, match=r"not known here: streams\.fast\.drift; a newer simcompa"):
        recording_store.load(recording)


def test_what_is_no_file_is_called_what_it_is(tmp_path):
    os.mkfifo(tmp_path / "mine.yaml")
    with pytest.raises(InputError, match=r"mine\.yaml: is a named pipe; expected a file"):
        catalogue.find(str(tmp_path / "mine.yaml"))
    with pytest.raises(InputError, match=r"/dev/zero: is a device; expected a file"):
        catalogue.find("/dev/zero")
    os.mkfifo(tmp_path / "run.json")
    with pytest.raises(InputError, match=r"run\.json: is a named pipe; expected a file"):
        store.load(tmp_path)
    (tmp_path / "run.json").unlink()
    (tmp_path / "run.json").mkdir()
    with pytest.raises(InputError, match=r"run\.json: is a folder; expected a file"):
        store.load(tmp_path)


def test_no_foreign_command_is_offered_for_pasting(tmp_path):
    folder = store.save(synthetic(), tmp_path).folder
    record = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    record["command"] = ["rm", "-r", "runs"]
    (folder / "run.json").write_text(json.dumps(record), encoding="utf-8")
    with pytest.raises(InputError, match=r"run\.json: command: is none of simcompare"):
        store.load(folder)
