"""The verb ``runs``: what is stored, and which of it is to be deleted."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

from simcompare import units
from simcompare.arguments import checked
from simcompare.errors import InputError
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results import stored_runs
from simcompare.results.stored_runs import StoredRun

_HEADS = ("run", "kind", "asked for", "engines", "verdict")


class StoredRuns(Shown, list[StoredRun]):
    """Stored runs, the newest first; ``table()`` has a row for each."""

    def _glance(self) -> Glance:
        columns = [Column(head, text=True) for head in _HEADS]
        rows = tuple(map(_row, self))
        return Glance(
            title=f"{len(self)} stored run{'s' * (len(self) != 1)}",
            table=Table("", (*columns, Column("MB")), (Group("", rows),)),
            more="More: .table(), simcompare.load_run(FOLDER), simcompare.compare([FOLDER, …])",
        )


def _row(run: StoredRun) -> tuple[str, ...]:
    kind = "–" if run.record is None else run.record.kind
    asked, engines = ", ".join(run.asked) or "–", ", ".join(run.engines) or "none"
    told = run.fault or asked
    return run.folder.name, kind, told, engines, run.verdict, f"{run.size_bytes / 1e6:.1f}"


@checked
def runs(folder: str | Path = "runs") -> StoredRuns:
    """The stored runs, fits and validations in a folder, the newest first.

    ::

        simcompare.runs()
        simcompare.load_run(simcompare.runs()[0].folder)  # the newest
        simcompare.compare("runs")

    Args:
        folder: in which their own folders lie.

    Raises:
        InputError: there is no such folder.
    """
    return StoredRuns(stored_runs.of(Path(folder)))


def newest(folder: str | Path = "runs") -> Path:
    """The folder of the newest run in a folder.

    Raises:
        InputError: there is none.
    """
    place = Path(folder)
    whole = [run for run in stored_runs.of(place) if run.record] if place.is_dir() else []
    if not whole:
        raise InputError(str(place), ["holds no run; make one, such as: simcompare run ball"])
    return whole[0].folder


def to_clean(
    found: list[StoredRun],
    *,
    older_than: str | None = None,
    keep: int | None = None,
    now: datetime | None = None,
) -> list[StoredRun]:
    """Those that ``runs --clean`` deletes; what is not ours, or holds files of others, stays.

    Args:
        found: as ``runs`` gives them.
        older_than: an age with its unit, such as "30d"; younger ones stay.
        keep: so many of the newest stay.
        now: the time from which ages are counted; the present where ``None``.

    Raises:
        InputError: neither is given, or one makes no sense.
    """
    if older_than is None and keep is None:
        raise InputError(
            "--clean", ["say which runs go: --older-than 30d, or --keep 10 for all but the newest"]
        )
    if keep is not None and keep < 0:
        raise InputError("--keep", [f"{keep} is not a number of runs; expected 0 or more"])
    age_s = None if older_than is None else _age_s(older_than)
    now = now or datetime.now(UTC)
    return stored_runs.chosen(found, older_than_s=age_s, keep=keep, now=now)


def _age_s(text: str) -> float:
    """An age [s]; a number alone could mean days or seconds."""
    if text.strip().replace(".", "", 1).isdigit():
        raise InputError("--older-than", [f"{text} has no unit; expected such as {text}d or 12h"])
    # a d of a log may be anything; that of an age is a day
    days = text.strip().removesuffix("d")
    is_days = days.lstrip("+-").replace(".", "", 1).isdigit() and days != text.strip()
    age_s = units.to_si(f"{days} day" if is_days else text, "s", "--older-than")
    if age_s < 0:
        raise InputError("--older-than", [f"{text} is no age; expected such as 30d or 12h"])
    return age_s
