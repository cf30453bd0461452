"""What a run holds as tables of pandas: its scores, and the samples of its trajectories."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING

from simcompare.comparison.comparison import Score
from simcompare.errors import InputError, UnknownName
from simcompare.inference.simulated import MOTION
from simcompare.measures import observe
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Array, Trajectory
from simcompare.results.run import Run, Stored

if TYPE_CHECKING:
    import pandas as pd


def scores(run: Run) -> pd.DataFrame:
    """One row for each score; the columns are those of scores.csv."""
    import pandas as pd

    columns = [field.name for field in fields(Score)]
    rows = [vars(score) for score in run.record.scores]
    return pd.DataFrame(rows, columns=columns).astype({"index": "Int64"})


def samples(
    run: Run, source: str | None = None, contact: str | None = None, repeat: int | None = None
) -> pd.DataFrame:
    """Samples of trajectories, one below the other: whose they are, time, probes and signals.

    Args:
        run: the run.
        source: an engine or "closed form"; every one where ``None``.
        contact: contact level; every one where ``None``.
        repeat: number of the repeat, first is 0; the middle one where ``None``.

    Raises:
        UnknownName: no such source or level.
        InputError: there are no samples of what was asked for.
    """
    import pandas as pd

    rows = [_frame(one, run.record.probes) for one in chosen(run, source, contact, repeat)]
    table = pd.concat(rows, ignore_index=True)
    unused = [name for name in ("parameters", "segment") if not table[name].any()]
    return table.drop(columns=unused)


def chosen(
    run: Run, source: str | None, contact: str | None, repeat: int | None = None
) -> list[Stored]:
    """The trajectories of which ``samples`` gives a table; one or more."""
    wanted = run.record.repeats // 2 if repeat is None else repeat
    check_names(run, source, contact)
    found = [
        one
        for one in run.trajectories
        if source in (None, one.source)
        and contact in (None, one.contact)
        and one.repeat == wanted
        and one.parameters != MOTION
    ]
    if not found:
        raise InputError("samples", _reasons(run, source, contact, wanted))
    return found


def columns(trajectory: Trajectory, probes: Mapping[str, Probe]) -> dict[str, Array]:
    """Time, what probes see and every signal, one column for each component."""
    time, *signals = trajectory.to_columns().items()
    seen = {name: values for name, probe in probes.items()
            if (values := _observed(trajectory, probe)) is not None}  # fmt: skip
    return dict([time, *seen.items(), *signals])


def _frame(one: Stored, probes: Mapping[str, Probe]) -> pd.DataFrame:
    import pandas as pd

    names = ("source", "contact", "repeat", "parameters", "segment")
    whose = {name: getattr(one, name) for name in names}
    return pd.DataFrame({**whose, **columns(one.trajectory, probes)})


def _observed(trajectory: Trajectory, probe: Probe) -> Array | None:
    try:
        return observe(trajectory, probe)
    except UnknownName:
        return None


def check_names(run: Run, source: str | None, contact: str | None) -> None:
    """Refuses names of sources and of contact levels that the run does not have."""
    named = [(one.name, one.contact) for one in run.record.sources]
    named += [(one.source, one.contact) for one in run.trajectories]
    known, levels = (dict.fromkeys(filter(None, names)) for names in zip(*named, strict=True))
    if source is not None and source not in known:
        raise UnknownName("source of this run", source, known)
    if contact is not None and contact not in levels:
        raise UnknownName("contact level of this run", contact, levels)


def _reasons(run: Run, source: str | None, contact: str | None, repeat: int) -> list[str]:
    """Why there are no samples of what was asked for."""
    faults = [
        f"{one.name}, {one.contact}: {one.reason or one.status}"
        for one in run.record.sources
        if source in (None, one.name) and contact in (None, one.contact) and not one.ran
    ]
    repeats = [one.repeat for one in run.trajectories]
    known = f"from 0 to {max(repeats)}" if repeats else "none: no samples are stored"
    return faults or [f"there is no repeat {repeat}; expected {known}"]
