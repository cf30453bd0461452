"""What reports ask of a validation: its record, its trajectories, and the names of its parts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from simcompare import units
from simcompare.model.trajectory import TRUTH, Trajectory
from simcompare.reports.render.tables import printable
from simcompare.reports.run import runs
from simcompare.results.records.validation import ValidationRecord
from simcompare.results.run import Run

MEASURED = "measured"
BEST, NOMINAL = "best", "nominal"
KNOWN, FITTED = "known before", "fitted"
#: name of the only stream of a log that has one
ONLY = "log"
#: stretches of a recording that are drawn; the tables have all
MOST_STRETCHES = 2
#: judged quantities of which all those stretches are drawn; of more, only the worst one
MOST_PROBES = 2
#: letters of a name that a figure or a cell can hold; names come from files
_LETTERS = 28


def validation(run: Run) -> Mapping[str, Any]:
    """The record of the validation."""
    assert isinstance(run.record, ValidationRecord)
    found: Mapping[str, Any] = run.record.validation
    return found


def is_fitted(run: Run) -> bool:
    """Whether any parameter was fitted."""
    return validation(run)["fit"] is not None


def stored(run: Run, source: str, variant: str, case: int) -> Trajectory | None:
    """One trajectory of a case."""
    for one in run.trajectories:
        if (one.source, one.contact, one.repeat) == (source, variant, case):
            return one.trajectory
    return None


def truth(run: Run, variant: str, case: int) -> Trajectory | None:
    """The reference of a case."""
    return stored(run, TRUTH, variant, case)


def judged_probes(run: Run) -> list[str]:
    """Probes that are judged, the leading one first."""
    return [name for name, one in validation(run)["compare"].items() if one["judged"]]


def label(run: Run, probe: str) -> str:
    """A compared quantity in words, without its unit."""
    return str(validation(run)["compare"][probe]["label"])


def unit(run: Run, probe: str) -> str:
    """The unit of a compared quantity as people write it; "1" for none."""
    return units.symbol(validation(run)["compare"][probe]["unit"])


def with_unit(run: Run, probe: str) -> str:
    """A compared quantity with its unit."""
    return label(run, probe) + runs.unit_words(unit(run, probe))


def stretch(run: Run, stream: str) -> str:
    """The name of a stretch, empty where only one was judged."""
    several = len({case["stream"] for case in validation(run)["cases"]}) > 1
    return short(stream) if several else ""


def parameter(name: str) -> str:
    """A parameter as people say it."""
    return name.removesuffix(units.suffix_of(name)).replace("_", " ")


def short(name: str) -> str:
    """A name that came out of a file, on one line and no longer than a figure can hold."""
    line = printable(name)
    return line if len(line) <= _LETTERS else f"{line[: _LETTERS // 2]}…{line[-_LETTERS // 2 :]}"


def last_parameters(run: Run) -> str:
    """The parameters that are judged: the fitted ones where there are any."""
    return FITTED if is_fitted(run) else KNOWN


def drawn_cases(run: Run) -> list[tuple[int, str]]:
    """Number and name of the stretches that are drawn: all, or the best and the worst of many."""
    streams = [str(case["stream"]) for case in validation(run)["cases"]]
    found = list(enumerate(streams))
    if len(found) <= _most_drawn(run):
        return found
    sizes = {stream: 0.0 for stream in streams}
    for row in validation(run)["waveforms"]:
        if row["judged"] and row["parameters"] == last_parameters(run):
            sizes[row["stream"]] = max(sizes[row["stream"]], row["nrmse"] or 0.0)
    order = sorted(found, key=lambda pair: sizes[pair[1]])
    return sorted([order[0], order[-1]][-_most_drawn(run) :])


def _most_drawn(run: Run) -> int:
    return MOST_STRETCHES if len(judged_probes(run)) <= MOST_PROBES else 1


def chosen_words(run: Run) -> str:
    """Which stretches are drawn, where that is not all of them."""
    count = len(validation(run)["cases"])
    if count <= _most_drawn(run):
        return ""
    if _most_drawn(run) == 1:
        return f" Of {count} stretches the one with the largest gap."
    return f" Of {count} stretches the one with the smallest and the one with the largest gap."


def event_times(run: Run, case: int) -> list[float]:
    """Events of the recording within a stretch, on the clock of the scenario [s]."""
    found = validation(run)
    about = found["cases"][case]
    alignments = found.get("alignments") or []
    aligned = alignments[case] if case < len(alignments) else None
    offset, skew = (aligned["offset_s"], aligned["skew"]) if aligned else (0.0, 0.0)
    times = [
        (event["time_s"] - about["start_s"] - offset) / (1 + skew)
        for event in found["events"]
        if event["stream"] == about["stream"]
    ]
    return [time for time in times if 0 <= time <= about["duration_s"]]
