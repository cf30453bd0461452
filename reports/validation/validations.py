"""What reports ask of a validation: its record, its trajectories, and the names of its parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from simcompare import units
from simcompare.model.trajectory import TRUTH, Trajectory
from simcompare.reports.render.tables import printable
from simcompare.reports.run import runs
from simcompare.results.run import Run

if TYPE_CHECKING:  # reports of fits use this module too, and need no more of validations
    from simcompare.results.records.validation import Validation

MEASURED = "measured"
BEST, NOMINAL = "best", "nominal"
#: name of the only stream of a log that has one
ONLY = "log"
#: segments of a recording that are drawn; the tables have all
MAX_SEGMENTS = 2
#: judged quantities of which all those segments are drawn; of more, only the worst one
MAX_PROBES = 2
#: letters of a name that a figure or a cell can hold; names come from files
_LETTERS = 28


def validation(run: Run) -> Validation:
    """The record of the validation."""
    from simcompare.results.records.validation import ValidationRecord

    assert isinstance(run.record, ValidationRecord)
    return run.record.validation


def is_fitted(run: Run) -> bool:
    """Whether any parameter was fitted."""
    return validation(run).fit is not None


def stored(run: Run, source: str, parameters: str, segment: int) -> Trajectory | None:
    """One trajectory of a segment."""
    for one in run.trajectories:
        if (one.source, one.parameters, one.segment) == (source, parameters, segment):
            return one.trajectory
    return None


def truth(run: Run, parameters: str, segment: int) -> Trajectory | None:
    """The reference of a segment."""
    return stored(run, TRUTH, parameters, segment)


def judged_probes(run: Run) -> list[str]:
    """Probes that are judged, the leading one first."""
    return [name for name, one in validation(run).compare.items() if one.judged]


def label(run: Run, probe: str) -> str:
    """A compared quantity in words, without its unit."""
    return validation(run).compare[probe].label


def unit(run: Run, probe: str) -> str:
    """The unit of a compared quantity as people write it; "1" for none."""
    return units.symbol(validation(run).compare[probe].unit)


def with_unit(run: Run, probe: str) -> str:
    """A compared quantity with its unit."""
    return label(run, probe) + runs.unit_words(unit(run, probe))


def segment_name(run: Run, stream: str) -> str:
    """The name of a segment, empty where only one was judged."""
    return short(stream) if len(validation(run).streams) > 1 else ""


def titled(run: Run, stream: str, words: str) -> str:
    """Words for a title, with the name of the segment where several were judged."""
    where = segment_name(run, stream)
    return f"{words}, {where}" if where else words


def short(name: str) -> str:
    """A name that came out of a file, on one line and no longer than a figure can hold."""
    line = printable(name)
    return line if len(line) <= _LETTERS else f"{line[: _LETTERS // 2]}…{line[-_LETTERS // 2 :]}"


def last_parameters(run: Run) -> str:
    """The parameters that are judged: the fitted ones where there are any."""
    from simcompare.results.records.validation import FITTED, KNOWN

    return FITTED if is_fitted(run) else KNOWN


def drawn_segments(run: Run) -> list[tuple[int, str]]:
    """Number and name of the segments that are drawn: all, or the best and the worst of many."""
    streams = [case.stream for case in validation(run).cases]
    numbered = list(enumerate(streams))
    if len(numbered) <= _max_drawn(run):
        return numbered
    sizes = {stream: 0.0 for stream in streams}
    for row in validation(run).waveforms:
        if row.judged and row.parameters == last_parameters(run):
            sizes[row.stream] = max(sizes[row.stream], row.nrmse or 0.0)
    order = sorted(numbered, key=lambda pair: sizes[pair[1]])
    return sorted([order[0], order[-1]][-_max_drawn(run) :])


def _max_drawn(run: Run) -> int:
    return MAX_SEGMENTS if len(judged_probes(run)) <= MAX_PROBES else 1


def chosen_words(run: Run) -> str:
    """Which segments are drawn, where that is not all of them."""
    count = len(validation(run).cases)
    if count <= _max_drawn(run):
        return ""
    if _max_drawn(run) == 1:
        return f" Of {count} segments the one with the largest gap."
    return f" Of {count} segments the one with the smallest and the one with the largest gap."


def event_times(run: Run, segment: int) -> list[float]:
    """Events of the recording within a segment, on the clock of the scenario [s]."""
    record = validation(run)
    about = record.cases[segment]
    times = np.array([e.time_s for e in record.events if e.stream == about.stream]) - about.start_s
    alignment = record.alignments[segment] if segment < len(record.alignments) else None
    if alignment is not None:
        times = alignment.to_reference(times)
    return [float(time) for time in times if 0 <= time <= about.duration_s]
