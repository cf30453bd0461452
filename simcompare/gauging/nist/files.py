"""Reads the files of NIST's nonlinear regression problems; none is copied into this project."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.model.trajectory import Array

#: folder of the files below that of all published data
FOLDER = "nist_strd"
#: a line "b1 = start 1, start 2, certified value, certified standard deviation"
_PARAMETER = re.compile(r"^\s*b\d+ =((?:\s+\S+){4})\s*$", re.MULTILINE)


@dataclass(frozen=True)
class Problem:
    """One set of data with its certified answer.

    Attributes:
        starts: from where to begin (2, p).
        certified: values of the parameters (p,).
        deviations: their certified standard deviations (p,).
        response: what was measured (n,).
        predictors: what it depends on (k, n).
    """

    starts: Array
    certified: Array
    deviations: Array
    response: Array
    predictors: Array


def folder() -> Path | None:
    """Where the files are; ``None`` where they are not on this machine."""
    data = os.environ.get("SIMCOMPARE_DATA")
    place = Path(data) / FOLDER if data else None
    return place if place is not None and place.is_dir() else None


def read(path: Path) -> Problem:
    """One file of NIST.

    Raises:
        InputError: it is none.
    """
    head, _, data = path.read_text(encoding="utf-8", errors="replace").rpartition("Data:")
    lines = [line.split() for line in data.splitlines()[1:] if line.strip()]
    try:
        table = np.array([row.split() for row in _PARAMETER.findall(head)], dtype=float)
        rows = np.array(lines, dtype=float)
    except ValueError:
        table = rows = np.empty(0)
    if not len(table) or rows.ndim != 2:
        fault = "holds no parameters and data as NIST writes them; expected the file as downloaded"
        raise InputError(str(path), [f"{fault} from itl.nist.gov/div898/strd"])
    response = np.log(rows[:, 0]) if "log[y]" in head else rows[:, 0]
    return Problem(table[:, :2].T, table[:, 2], table[:, 3], response, rows[:, 1:].T)
