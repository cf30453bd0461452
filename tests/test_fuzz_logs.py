"""Damaged logs of every format: refused or repaired in words, never a trace, a hang or a flood.

A small number of seeded mutations; ``python -m tests.attacks.logs`` runs ten thousand of each
format.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from simcompare.hardware import importing, mapping
from simcompare.hardware.logs import importers
from simcompare.model.recording import Channel, Clock, Conversion, Provenance, Recording, Stream
from tests import fuzzing, valid_logs
from tests.mutations import Mutation, mutated
from tests.text_samples import Log

for needed in ("rosbags", "lz4.frame", "nptdms", "h5py", "soundfile"):
    pytest.importorskip(needed)

COUNT = int(os.environ.get("SIMCOMPARE_FUZZ", "1200"))
pytestmark = pytest.mark.skipif(
    not Path("/proc/self/clear_refs").exists(), reason="memory is measured as Linux tells it"
)


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    return valid_logs.all_logs(tmp_path_factory.mktemp("valid"))


def test_there_are_valid_logs_of_every_format(logs):
    assert {log.format for log in logs.values()} == {
        name for name, target in importers.targets().items()
        if target.startswith("simcompare.hardware.logs")
    }  # fmt: skip


def test_valid_logs_are_recognised_and_have_no_defect(logs, tmp_path):
    for log in logs.values():
        path = log.write(tmp_path / "log")
        assert importers.recognise(path) == log.format, log.name
        found = importing.read(path, mapping.of_tree(log.mapping, "map"), strict=True)
        assert found.streams, log.name


def test_damaged_logs_are_refused_or_repaired_in_words(logs, tmp_path):
    names = list(logs)
    tasks = [(names[i % len(names)], i // len(names)) for i in range(COUNT)]
    results = list(fuzzing.run(tasks, tmp_path, limit_s=300))
    assert len(results) == COUNT
    failed = [result for result in results if result.failed]
    assert not failed, "\n\n".join(map(str, failed[:10]))
    # the mutations bite, and do not only destroy
    outcomes = [result.outcome for result in results]
    assert min(map(outcomes.count, ("ok", "repaired", "refused"))) > COUNT / 20


def test_a_mutation_is_the_same_each_time_and_not_the_valid_log(logs):
    others = list(logs.values())
    for log in others:
        made = [mutated(log, seed, others) for seed in range(3)]
        assert made == [mutated(log, seed, others) for seed in range(3)]
        assert any(one.files != log.files for one in made)


# ---- what judges can fail ---------------------------------------------------------------------


def test_a_child_that_dies_or_takes_too_long_is_a_failure_of_its_mutation(tmp_path):
    tasks = [("csv", 0), ("no such log", 1), ("csv", 2)]
    one, *_ = sorted(
        fuzzing.run(tasks, tmp_path, children=1), key=lambda result: result.outcome != "crash"
    )
    assert (one.name, one.seed, one.failed) == ("no such log", 1, True)
    assert "KeyError" in one.text
    (slow,) = fuzzing.run([("csv", 0)], tmp_path, children=1, limit_s=0)
    assert (slow.outcome, slow.failed) == ("hang", True)


TABLE = Log("csv", {"log.csv": b"time (s),x (m)\n0,1\n1,2\n2,3\n3,4\n"}, separator=",")


def recording(times, values):
    channel = Channel(np.array(values, dtype=float), "m", raw="x")
    stream = Stream(np.array(times, dtype=float), {"x_m": channel}, Clock("column time"))
    conversions = (Conversion("x", "m", "x_m", "m"),)
    about = Provenance("log.csv", "", 0, "csv", "", "repair", conversions)
    return Recording({"log": stream}, about)


@pytest.mark.parametrize(
    ("times", "values", "fault"),
    [
        ([0, 1, 2, 3], [1, 2, 3, 4], ""),
        ([0, 1, 3], [1, 2, 4], "3 samples, but 4 plain rows"),
        ([0, 1, 2, 3], [1, 2, 3, 40], "1 plain rows are missing"),
        ([0, 1, 2, 3, 4], [1, 2, 3, np.inf, 4], "infinite"),
        ([0, 2, 1, 3], [1, 2, 3, 4], "do not increase"),
    ],
)
def test_rows_that_vanish_from_a_table_in_silence_are_noticed(times, values, fault):
    found = recording(times, values)
    said = fuzzing.lost(TABLE, Mutation(TABLE.files, ("cell",)), found, found)
    assert fault in said
    assert bool(said) == bool(fault)


def test_a_container_that_was_cut_must_hold_every_value_or_say_so():
    valid = recording([0, 1, 2], [1, 2, 3])
    log = Log("numpy", {"l.npy": b""})
    for found in (recording([0, 1], [1, 2]), recording([0, 1, 2], [1, 2, 0])):
        assert fuzzing.lost(log, Mutation({}, ("cut",)), valid, found)
        assert not fuzzing.lost(log, Mutation({}, ("flip",)), valid, found)
    assert not fuzzing.lost(log, Mutation({}, ("cut",)), valid, valid)
