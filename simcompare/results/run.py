"""What a run found, as one value: the record for run.json, the scores, the trajectories."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from simcompare.comparison.comparison import FAIL
from simcompare.hardware.sensors.drawn_zones import ZoneReading
from simcompare.hardware.sensors.error_model import Reading
from simcompare.model.trajectory import Trajectory
from simcompare.results.records.run import Record
from simcompare.running.jobs import exit_code_of


@dataclass(frozen=True)
class Stored:
    """One trajectory of a run with its place in it.

    Attributes:
        source: name of the source.
        contact: its contact level, empty where it has none.
        repeat: number of the repeat.
        trajectory: what it gave.
        parameters: which ones, "best", "nominal" or "fitted", where there is a recording;
            "motion" of bodies that are only to be played.
        segment: number of the segment of the recording, first is 0.
    """

    source: str
    contact: str
    repeat: int
    trajectory: Trajectory
    parameters: str = ""
    segment: int = 0


@dataclass(frozen=True, eq=False)
class StoredReading:
    """What one device read of one source.

    Attributes:
        source: name of the source.
        contact: its contact level, empty where it has none.
        signal: such as "imu.rate_rad_s".
        reading: measured beside ideal; of many zones, frames.
    """

    source: str
    contact: str
    signal: str
    reading: Reading | ZoneReading


@dataclass(frozen=True)
class Run:
    """Everything that one ``run`` found.

    Attributes:
        record: what run.json holds.
        trajectories: every trajectory that came out, the truth's included.
        folder: where it is stored, ``None`` where it is not.
        stored_readings: what sensors that are not ideal read of the nominal repeats.
    """

    record: Record
    trajectories: tuple[Stored, ...]
    folder: Path | None = None
    stored_readings: tuple[StoredReading, ...] = ()

    @property
    def exit_code(self) -> int:
        """0 fine, 1 a tolerance failed, 3 an engine is broken or none of those asked for ran.

        With ``all``, an engine that is not installed is a row with its reason and no failure. What
        an engine does by itself is no failure either, unless that level was to be judged. A step
        or value at which none of those asked for can do what is asked is the user's to change: 2.
        """
        sources = self.record.sources
        code = exit_code_of(
            [source.status for source in sources],
            self.record.engines_asked,
            out_of_reach=any(source.out_of_reach for source in sources),
        )
        return code or (1 if self.failed_levels else 0)

    @property
    def failed_levels(self) -> frozenset[str]:
        """Contact levels at which a tolerance failed, of those whose failures count."""
        judged = self.record.judge
        failed = frozenset(s.contact for s in self.record.scores if s.verdict == FAIL)
        return failed if judged is None else failed & set(judged)
