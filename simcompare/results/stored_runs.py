"""The stored runs of a folder: found, listed, chosen and deleted; links are never followed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from simcompare.comparison.comparison import FAIL, PASS
from simcompare.errors import InputError, NoSuchFile, OutputError
from simcompare.results import unfinished
from simcompare.results.fit_file import FILE as FIT
from simcompare.results.readings_file import READINGS
from simcompare.results.records import stored
from simcompare.results.records.run import Record
from simcompare.results.run import Run
from simcompare.results.store import RECORD, SCORES, TRAJECTORIES
from simcompare.results.unfinished import PARTS
from simcompare.results.zones_file import ZONES

#: what we write into the folder of a run
_OURS = (
    RECORD,
    TRAJECTORIES,
    READINGS,
    ZONES,
    SCORES,
    FIT,
    "report.html",
    "report.pdf",
    "report.md",
)
#: and into a folder in it, each with the name of the scenario
_PICTURES, _PICTURE = "figures", r"(run1-)?{scenario}-[\w.-]+\.(png|svg)"
#: what a new folder is called after
_STAMP = re.compile(r"(\d{4})(\d\d)(\d\d)-(\d\d)(\d\d)(\d\d)")


@dataclass(frozen=True, repr=False)
class StoredRun:
    """A run, a fit or a validation in a folder of its own.

    Attributes:
        folder: in which it is stored.
        record: what its run.json says, ``None`` where it is damaged.
        fault: why it cannot be read; empty where it can.
        created: date and time, ISO 8601; empty where neither record nor name tells it.
        files: what we wrote there; none where its run.json cannot be read: nothing says so then.
        others: what else lies there, by name.
        size_bytes: of our files.
        is_unfinished: whether it was ended before it had a run.json, or still runs.
        is_running: whether somebody works on it now; ``None`` where its disk cannot tell.
    """

    folder: Path
    record: Record | None
    fault: str
    created: str
    files: tuple[Path, ...]
    others: tuple[str, ...]
    size_bytes: int
    is_unfinished: bool = False
    is_running: bool | None = False

    def __repr__(self) -> str:
        return f"{self.folder}: {self.fault or self.verdict}"

    @property
    def verdict(self) -> str:
        """What became of it, in one word."""
        if self.record is None:
            return "unfinished" if self.is_unfinished else "damaged"
        if self.record.interrupted:
            return "interrupted"
        code = Run(self.record, ()).exit_code
        judged = any(score.verdict == PASS for score in self.record.scores)
        return _VERDICTS.get(code) or (PASS if judged else "–")

    @property
    def asked(self) -> tuple[str, ...]:
        """What was asked for beside scenario and engines, such as "drop_height=0.3m"."""
        command = () if self.record is None else self.record.command or ()
        return tuple(_options(command[3:]))

    @property
    def engines(self) -> tuple[str, ...]:
        """The engines that ran."""
        sources = () if self.record is None else self.record.sources
        return tuple(dict.fromkeys(s.engine or s.name for s in sources if s.ran))


#: why a run is left alone, by whether it is worked on
RUNNING = {True: "still runs", None: "may still run: its disk has no locks that would tell"}
#: exit code of a run -> what became of it
_VERDICTS = {1: FAIL, 2: "unsupported", 3: "broken"}


def is_run(folder: Path) -> bool:
    """Whether a folder is that of a run; a link to one is none."""
    record = folder / RECORD
    return not folder.is_symlink() and record.is_file() and not record.is_symlink()


def of(folder: Path) -> list[StoredRun]:
    """The runs in a folder, the newest first.

    Raises:
        InputError: there is no such folder.
    """
    if not folder.is_dir():
        raise NoSuchFile(folder, "a folder of stored runs")
    found = [_read(place) for place in sorted(folder.iterdir()) if _is_begun(place)]
    return sorted(found, key=lambda run: (run.created, run.folder.name), reverse=True)


def left(folder: Path) -> list[Path]:
    """Runs in a folder that were ended before they had a run.json, the oldest first."""
    begun = [place for place in sorted(folder.iterdir()) if unfinished.is_unfinished(place)]
    ended = [place for place in begun if unfinished.is_running(place) is False]
    return [place for place in ended if not is_run(place)]


def places(folder: Path) -> list[Path]:
    """Where the runs of a folder lie, the oldest first; empty where there are none.

    They are not read: their order is that of their names, which begin with the time.
    """
    inside = sorted(folder.iterdir()) if folder.is_dir() else []
    return [place for place in inside if is_run(place)]


def chosen(
    runs: Sequence[StoredRun], *, older_than_s: float | None, keep: int | None, now: datetime
) -> list[StoredRun]:
    """The runs that are to go: of those that we can delete, what is old and not among the newest.

    Args:
        runs: the newest first.
        older_than_s: age above which a run is old; ``None``: every run is.
        keep: number of the newest that stay.
        now: the time from which ages are counted.
    """
    rest = runs[keep or 0 :]
    return [run for run in rest if can_go(run) and _is_older(run, older_than_s, now)]


def can_go(run: StoredRun) -> bool:
    """Whether a run is ours, nothing else lies in its folder, and nobody works on it."""
    is_ours = run.record is not None or run.is_unfinished
    return is_ours and not run.others and run.is_running is False


def delete(runs: Iterable[StoredRun]) -> None:
    """Deletes the listed files of runs, and their folders where nothing else is left in them.

    Raises:
        OutputError: one cannot be deleted; the others after it are left.
    """
    for run in runs:
        try:
            if not _is_begun(run.folder):  # it has become a link since it was listed
                continue
            for path in run.files:
                path.unlink(missing_ok=True)
            for folder in (run.folder / _PICTURES, run.folder / PARTS, run.folder):
                if folder.is_dir():
                    folder.rmdir()
        except OSError as error:
            raise OutputError(f"{run.folder}: cannot be deleted ({error.strerror})") from None


def _is_older(run: StoredRun, age_s: float | None, now: datetime) -> bool:
    if age_s is None:
        return True
    if not run.created:
        return False
    return (now - datetime.fromisoformat(run.created)).total_seconds() > age_s


def _is_begun(folder: Path) -> bool:
    return is_run(folder) or unfinished.is_unfinished(folder)


def _read(folder: Path) -> StoredRun:
    kept = unfinished.is_unfinished(folder)
    runs = unfinished.is_running(folder) if kept else False
    record, fault = (None, _ended_early(folder, runs=runs)) if not is_run(folder) else _told(folder)
    is_ours = runs is False and (record is not None or not is_run(folder))  # else files come and go
    scenario = "" if record is None else record.scenario
    files = tuple(_files(folder, scenario)) if is_ours else ()
    inside = tuple(_inside(folder)) if is_ours else ()
    others = {_name(folder, path) for path in inside} - {_name(folder, path) for path in files}
    size = sum(path.lstat().st_size for path in files)
    created = _created(folder, record)
    return StoredRun(
        folder, record, fault, created, files, tuple(sorted(others)), size,
        is_unfinished=not is_run(folder), is_running=runs,
    )  # fmt: skip


def _told(folder: Path) -> tuple[Record | None, str]:
    """What a run.json says, or why it cannot be read."""
    try:
        return stored.read(folder / RECORD), ""
    except InputError as error:
        first, *more = error.faults
        return None, f"{first}, and more" if more else first


def _ended_early(folder: Path, *, runs: bool | None) -> str:
    return RUNNING.get(runs) or f"was ended early; {unfinished.resuming(folder)}"


def _options(words: Sequence[str]) -> Iterator[str]:
    """Options of a command in the words of a list; each stands before its value, if it has one."""
    for i, word in enumerate(words):
        if not word.startswith("--") or word == "--engine":
            continue
        value = next((one for one in words[i + 1 : i + 2] if not one.startswith("--")), "")
        yield value if word == "--set" else f"{word[2:]} {value}".strip()


def _inside(folder: Path) -> Iterator[Path]:
    """All that lies in the folder of a run, pictures one by one; no link is followed."""
    for path in sorted(folder.iterdir()):
        if path.name in (_PICTURES, PARTS) and path.is_dir() and not path.is_symlink():
            yield from sorted(path.iterdir())
        else:
            yield path


def _files(folder: Path, scenario: str) -> Iterator[Path]:
    """The files in it that we wrote."""
    picture = re.compile(_PICTURE.format(scenario=re.escape(scenario)))
    for path in _inside(folder):
        name = path.name
        is_ours = name in _OURS if path.parent == folder else picture.fullmatch(name)
        is_ours = is_ours or unfinished.is_part(path)
        if is_ours and path.is_file() and not path.is_symlink():
            yield path


def _name(folder: Path, path: Path) -> str:
    return path.relative_to(folder).as_posix()


def _created(folder: Path, record: Record | None) -> str:
    """As its record says, else its name."""
    stamp = _STAMP.match(folder.name)
    text = "{}-{}-{}T{}:{}:{}".format(*stamp.groups()) if stamp else ""
    try:
        time = datetime.fromisoformat(text if record is None else record.created)
    except ValueError:
        return ""
    return time.replace(tzinfo=time.tzinfo or UTC).isoformat(timespec="seconds")
