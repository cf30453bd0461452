"""Several processes write into one folder at once: each result is whole."""

from __future__ import annotations

import multiprocessing
import os
from dataclasses import replace

import numpy as np

from simcompare.model import recording_store
from simcompare.model.recording import Channel, Clock, Stream
from simcompare.results import store
from tests.test_recording_store import a_recording
from tests.test_store import synthetic

COUNT = 10


def at_once(write, place):
    """Lets as many processes write at the same time; returns their exit codes."""
    context = multiprocessing.get_context("fork")
    start = context.Barrier(COUNT)

    def one(number):
        try:
            start.wait(60)
            write(number, place)
        except BaseException:  # noqa: BLE001  (the parent sees the code alone)
            os._exit(1)
        os._exit(0)

    writers = [context.Process(target=one, args=(number,)) for number in range(COUNT)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    return [writer.exitcode for writer in writers]


def a_run(number):
    """A run in which everything tells its number."""
    run = synthetic()
    moved = [
        replace(
            one, trajectory=replace(one.trajectory, signals={"x": one.trajectory.time_s + number})
        )
        for one in run.trajectories
    ]
    return replace(run, record=replace(run.record, seed=number), trajectories=tuple(moved))


def a_numbered(number):
    """A recording in which everything tells its number."""
    times = np.arange(100.0 + number)
    stream = Stream(times, {"x_m": Channel(np.full_like(times, number), "m")}, Clock("c"))
    about = replace(a_recording().provenance, file=f"{number}.csv")
    return replace(a_recording(), streams={"log": stream}, provenance=about, events=())


def test_ten_runs_in_one_folder_are_all_whole(tmp_path):
    assert at_once(lambda i, place: store.save(a_run(i), place), tmp_path) == [0] * COUNT
    found = [store.load(place) for place in tmp_path.iterdir()]
    assert sorted(run.record.seed for run in found) == list(range(COUNT))
    for run in found:
        for one in run.trajectories:
            moved = one.trajectory
            assert np.array_equal(moved.signals["x"], moved.time_s + run.record.seed)


def test_of_ten_recordings_in_one_place_one_whole_one_stays(tmp_path):
    for _ in range(3):
        codes = at_once(lambda i, place: recording_store.save(a_numbered(i), place), tmp_path / "x")
        assert codes == [0] * COUNT
        found = recording_store.load(tmp_path / "x")
        number = int(found.provenance.file.partition(".")[0])
        stream = found.streams["log"]
        assert len(stream.time_s) == 100 + number
        assert set(stream.channels["x_m"].values) == {number}
        assert [path.name for path in tmp_path.iterdir()] == ["x"]
