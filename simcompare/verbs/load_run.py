"""The verb ``load_run``: a stored run, fit or validation, read again."""

from __future__ import annotations

import contextlib
from pathlib import Path

from simcompare.arguments import checked
from simcompare.errors import UnknownName
from simcompare.reports import glances
from simcompare.results import store
from simcompare.verbs.damaged import told_as_damaged
from simcompare.verbs.result import Result


@checked
def load_run(place: str | Path) -> Result:
    """Reads a stored run, fit or validation.

    ::

        run = simcompare.load_run("runs/20260101-120000-ball")
        run.table()
        run.samples("mujoco", "tuned")

    Args:
        place: its folder, or run.json in it.

    Raises:
        InputError: there is none, or its files are damaged; names the file.
    """
    found = store.load(place)
    result = Result(found.record, found.trajectories, found.folder, found.stored_readings)
    with contextlib.suppress(UnknownName), told_as_damaged([place], "table"):
        glances.table(result)  # where there is nothing to tell it says so later
    return result
