"""Turns of groups in the lab's queue, and what a file is by its content."""

import asyncio
import os

import pytest

from simcompare.glossary import LANGUAGES
from simcompare.lab import contents, desk, queue, work
from simcompare.lab.desk import Ending, Task
from simcompare.lab.groups import Groups, key_of
from simcompare.lab.pin import Pin
from simcompare.lab.queue import Job, Queue
from simcompare.lab.refusals import Refused, language_of, sentences
from tests import lab_stand_in


class FakeDesk:
    """Notes what it does; each job takes one turn of the loop."""

    done: list[str]

    def __init__(self, *_):
        pass

    async def do(self, task, limit_s):
        FakeDesk.done.append(task.request["name"])
        await asyncio.sleep(0)
        return Ending(b"{}")

    def end(self):
        pass


def named(name, kind="run"):
    return Job(name[0], Task(kind, {"name": name}))


@pytest.fixture
def order(monkeypatch):
    """The order in which one worker does jobs that wait already, and the places they are told."""
    monkeypatch.setattr(queue, "Desk", FakeDesk)
    FakeDesk.done = []

    def run(*names):
        async def all_of_it():
            waiting = Queue(print, 1)
            jobs = [waiting.add(named(name)) for name in names]
            places = [waiting.place(job) for job in jobs]
            waiting.begin()
            for job in jobs:
                await job.ended.wait()
            await waiting.end()
            return places

        return asyncio.run(all_of_it()), FakeDesk.done

    return run


def test_groups_take_turns_however_many_jobs_one_sends(order):
    ten = [f"a{i}" for i in range(10)]
    places, done = order(*ten, "b0", "c0", "b1")
    assert done == ["a0", "b0", "c0", "a1", "b1", *ten[2:]]
    assert places == [1, 4, 6, 7, 8, 9, 10, 11, 12, 13, 2, 3, 5]


def test_jobs_of_one_group_keep_their_order(order):
    assert order("a0", "a1", "a2") == ([1, 2, 3], ["a0", "a1", "a2"])


def test_a_group_whose_jobs_run_waits_for_those_that_have_none():
    waiting = [("a", "a1"), ("a", "a2"), ("b", "b0")]
    assert queue.in_turn(waiting, {"a": 1}, {}) == ["b0", "a1", "a2"]


def test_recordings_are_read_by_a_worker_of_their_own(monkeypatch):
    done = []

    class Noting(FakeDesk):
        def __init__(self, _, warm="warm"):
            super().__init__()
            self.warm = warm

        async def do(self, task, limit_s):
            done.append((task.kind, self.warm))
            return await super().do(task, limit_s)

    async def all_of_it():
        waiting = Queue(print, 2)
        kinds = ("recording", "run", "fit", "scale", "film")
        jobs = [waiting.add(named(f"{i}", kind)) for i, kind in enumerate(kinds)]
        waiting.begin()
        for job in jobs:
            await job.ended.wait()
        await waiting.end()

    monkeypatch.setattr(queue, "Desk", Noting)
    FakeDesk.done = []
    asyncio.run(all_of_it())
    assert sorted(done) == [
        ("film", "warm"), ("fit", "warm"), ("recording", "warm_reader"), ("run", "warm"),
        ("scale", "warm_reader"),
    ]  # fmt: skip


def test_a_group_may_not_fill_the_queue():
    async def fill():
        waiting = Queue(print, 1)
        for i in range(20):
            waiting.add(named(f"a{i}"))
        with pytest.raises(Refused, match="20 of your jobs wait already"):
            waiting.add(named("a20"))
        waiting.add(named("b0"))

    asyncio.run(fill())


@pytest.mark.parametrize("kind", ["fit", "report", "film"])
def test_one_worker_is_kept_free_of_long_jobs(monkeypatch, kind):
    class Busy(FakeDesk):
        async def do(self, task, limit_s):
            FakeDesk.done.append(task.request["name"])
            if task.kind == kind:
                await asyncio.Event().wait()  # for ever
            return Ending(b"{}")

    monkeypatch.setattr(queue, "Desk", Busy)
    FakeDesk.done = []

    async def fits_and_a_run():
        waiting = Queue(print, 2)
        waiting.begin()
        fits = [waiting.add(named(f"{group}0", kind)) for group in "abc"]
        await waiting.add(named("d0")).ended.wait()
        assert [fit.state for fit in fits] == ["running", "waiting", "waiting"]
        await waiting.end()

    asyncio.run(fits_and_a_run())
    assert FakeDesk.done == ["d0", "a0"] or FakeDesk.done == ["a0", "d0"]


def test_a_job_ends_also_where_no_worker_can_begin(monkeypatch):
    class Barred(FakeDesk):
        async def do(self, task, limit_s):
            raise BlockingIOError("no more processes")

    async def two_jobs():
        waiting = Queue(print, 1)
        waiting.begin()
        for job in [waiting.add(named(name)) for name in ("a0", "b0")]:
            await job.ended.wait()
            assert (job.state, job.ending.fault) == ("failed", "died")
        await waiting.end()

    monkeypatch.setattr(queue, "Desk", Barred)
    asyncio.run(two_jobs())


# ---- workers


def process_of(worker):
    (found,) = worker._pool._processes.values()
    return found


def test_a_run_in_which_an_engine_failed_is_made_again(monkeypatch):
    monkeypatch.setattr(desk, "_runs", {})
    missing = iter((["mujoco: took more than 30 s"], [], ["asked once too often"]))
    task = Task("run", {"scenario": "ball"})
    results = [desk._result(lambda *_: {"missing": next(missing)}, task) for _ in range(3)]
    assert [one["missing"] == [] for one in results] == [False, True, True]


def test_a_worker_ends_with_its_engines_also_when_nobody_kills_it():
    worker = desk.Desk(work.perform)
    process = process_of(worker)
    try:
        worker._warm.result()
        worker._pool.shutdown(wait=False)
        process.join(120)  # far beyond what the slowest machine needs
        assert process.exitcode == 0
    finally:
        worker.end()


def test_a_worker_that_only_begins_when_the_lab_ends_does_nothing(tmp_path):
    worker = desk.Desk(lab_stand_in.perform)
    process, done = process_of(worker), worker._pool.submit(os.mkdir, tmp_path / "done")
    worker.end()
    process.join(120)
    assert process.exitcode == 0
    assert done.cancelled() or done.exception() is not None
    assert not (tmp_path / "done").exists()


# ---- contents


@pytest.mark.parametrize(
    ("head", "wish", "kind"),
    [
        (b"RIFF\0\0\0\0WAVEfmt ", "video", ("sound", "wav")),
        (b"RIFF\0\0\0\0AVI LIST", "sound", ("video", "avi")),
        (b"fLaC\0", "", ("sound", "flac")),
        (b"OggS\0", "", ("sound", "ogg")),
        (b"\x1aE\xdf\xa3....webm", "sound", ("sound", "webm")),
        (b"\x1aE\xdf\xa3....webm", "video", ("video", "webm")),
        (b"\0\0\0\x20ftypM4A ", "", ("sound", "m4a")),
        (b"\0\0\0\x20ftypisom", "", ("video", "mp4")),
        (b"\0\0\0\x14ftypqt  ", "", ("video", "mov")),
        (b"t;y\n0;1\n", "sound", ("table", "csv")),
        ("t;höhe\n".encode("latin-1"), "", ("table", "csv")),
        (b"PK\x03\x04", "table", ("table", "zip")),
        (b"\x7fELF\2\1\1\0\0\0", "sound", None),
        (b"%PDF-1.7", "table", None),
        (b" <html>", "table", None),
        (b"", "", None),
    ],
)
def test_the_kind_of_a_file_is_told_by_its_content(head, wish, kind):
    assert contents.kind_of(head, wish) == kind


# ---- groups


def test_keys_of_groups_are_safe_and_of_one_group_alone():
    keys = [key_of(name) for name in ("Gruppe 1", "Gruppe-1", "Gruppe/1", "../Gruppe 1", "…", "🏀")]
    assert len(set(keys)) == len(keys)
    assert all(set(key) <= set("abcdefghijklmnopqrstuvwxyz0123456789-") for key in keys)
    assert key_of("  gruppe   1 ") == key_of("Gruppe 1")
    assert key_of("Caf\u00e9") == key_of("Cafe\u0301")


def test_a_picture_of_letters_is_a_name(tmp_path):
    name = "\U0001f469\u200d\U0001f52c Lab"  # a woman and a microscope, joined
    assert Groups(tmp_path).join(name).name == name


@pytest.mark.parametrize("name", ["", "   ", "\u200d", "x" * 61, "a\0b", "a\u202eb", "\ud800"])
def test_names_that_are_none_are_refused(tmp_path, name):
    with pytest.raises(Refused):
        Groups(tmp_path).join(name)


def test_a_group_keeps_its_newest_runs_and_all_else(tmp_path):
    def done(number, kind):
        task = Task(kind, {"folder": str(tmp_path)}, tmp_path / "results" / f"{number:016x}")
        assert desk._do(lambda *_: {"sentence": "fine"}, task) == Ending()
        for path in (task.place / "summary.json", task.place):
            os.utime(path, (number, number))

    done(0, "fit")
    for number in range(1, 60):
        done(number, "run")
    kept = sorted(int(path.name, 16) for path in (tmp_path / "results").iterdir())
    assert kept == [0, *range(10, 60)]


def test_damaged_documents_are_passed_over(tmp_path):
    groups = Groups(tmp_path)
    group = groups.join("Newton")
    for kind, name in (("results", "summary.json"), ("recordings", "upload.json")):
        for i, raw in enumerate((b"", b"[" * 99_999, b"\xff", b"7")):
            place = group.folder / kind / f"{i:016x}"
            place.mkdir()
            (place / name).write_bytes(raw)
    assert group.listing()["results"] == group.listing()["recordings"] == []
    (groups.join("Kepler").folder / "group.json").write_bytes(b"{")
    assert [one.name for one in groups.all()] == ["Newton"]


# ---- the PIN and the sentences


def test_after_wrong_pins_one_waits_and_may_then_try_again():
    now = [0.0]
    pin = Pin("4711", lambda: now[0])
    for _ in range(5):
        with pytest.raises(Refused, match="not right"):
            pin.check("0815", "a")
    with pytest.raises(Refused, match="Wait 60 seconds"):
        pin.check("4711", "a")
    pin.check("4711", "b")  # others are not locked out by it
    now[0] = 61.0
    pin.check("4711", "a")


def test_many_addresses_together_may_not_try_all_pins():
    pin = Pin("4711", lambda: 0.0)
    for i in range(50):
        with pytest.raises(Refused, match="not right"):
            pin.check("0815", f"{i}")
    with pytest.raises(Refused, match="Too many wrong PINs"):
        pin.check("0815", "new")


def test_both_languages_say_the_same_things():
    english, german = (sentences(language) for language in LANGUAGES)
    assert english.keys() == german.keys()
    for key, sentence in english.items():
        assert _holes(sentence) == _holes(german[key]), key


def _holes(sentence):
    import string

    return sorted(str(hole) for _, hole, *_ in string.Formatter().parse(sentence) if hole)


@pytest.mark.parametrize(
    ("wish", "accepted", "spoken"),
    [
        (None, "de-AT,de;q=0.9", "de"),
        (None, "fr, de;q=0.5", "de"),
        (None, "", "en"),
        ("en", "de", "en"),
        ("xx", "de", "de"),
        (["de"], "en", "en"),
    ],
)
def test_the_language_is_that_of_the_browser_unless_another_is_asked_for(wish, accepted, spoken):
    assert language_of(wish, accepted) == spoken
