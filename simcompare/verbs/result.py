"""What ``run``, ``fit``, ``validate`` and ``load_run`` give to Python: a run that shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare.arguments import checked
from simcompare.reports import glances
from simcompare.reports.render import frames, matplotlib_
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.results import frames as run_frames
from simcompare.results import sensing_frames
from simcompare.results.run import Run
from simcompare.verbs import report

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Result(Shown, Run):
    """What a run, a fit or a validation found.

    A notebook shows the answer, one table and one figure. Besides::

        result = simcompare.run("ball", engine="mujoco,pymunk")
        result.table()  # engines and levels
        result.plot("height_m")  # any figure of the report
        result.samples("mujoco", "tuned")  # every signal over time

    Attributes:
        record: everything, as in run.json.
        trajectories: every trajectory, the truth's included.
        folder: where it is stored, ``None`` where it is not.
    """

    @property
    def scores(self) -> pd.DataFrame:
        """Every measured value in a row of its own, as in scores.csv."""
        return run_frames.scores(self)

    @property
    def passed(self) -> bool:
        """Whether every tolerance that counts is met and every engine ran."""
        return self.exit_code == 0

    @checked
    def table(self, measure: str | None = None) -> pd.DataFrame:
        """Engines as rows, levels as columns, each value with its scatter and verdict.

        Args:
            measure: such as "restitution"; what the scenario asks for where ``None``.

        Raises:
            UnknownName: it was not measured; names what was.
        """
        return frames.frame(glances.table(self, measure))

    @checked
    def plot(self, name: str | None = None) -> Figure:
        """A figure of the report, which ``.savefig("ball.pdf")`` stores.

        Args:
            name: a probe such as "height_m", or the name of a figure; the first where ``None``.

        Raises:
            UnknownName: there is none of that name; names those that there are.
        """
        return matplotlib_.canvas(glances.figure(self, name))

    @checked
    def samples(
        self, engine: str | None = None, contact: str | None = None, repeat: int | None = None
    ) -> pd.DataFrame:
        """Signals over time, one row a sample: whose it is, time, probes, then every signal.

        Args:
            engine: its name, or "closed form"; every one where ``None``.
            contact: contact level; every one where ``None``.
            repeat: number of the repeat, first is 0; the middle one where ``None``.

        Raises:
            UnknownName: no such engine or level.
            InputError: it did not run; says why.
        """
        return run_frames.samples(self, engine, contact, repeat)

    @property
    def sensors(self) -> pd.DataFrame:
        """What was drawn for every sensor that is not ideal, one row a number."""
        return sensing_frames.sensors(self)

    @checked
    def readings(
        self, signal: str | None = None, engine: str | None = None, contact: str | None = None
    ) -> pd.DataFrame:
        """What sensors read, one row a sample: whose it is, time, ideal, measured, saturated.

        Args:
            signal: sensor or signal, such as "imu" or "imu.rate_rad_s"; every one where ``None``.
            engine: its name, or "closed form"; every one where ``None``.
            contact: contact level; every one where ``None``.

        Raises:
            UnknownName: no such signal, engine or level was read.
            InputError: the run has only ideal sensors; says how to ask for others.
        """
        return sensing_frames.readings(self, signal, engine, contact)

    def report(
        self, out: str | Path | None = None, *, format: str = "html", open: bool = False
    ) -> Path:
        """Writes the report and returns its file; see :func:`simcompare.report`."""
        return report.report(self, format=format, out=out, open=open)

    def _glance(self) -> Glance:
        return glances.glance_of(self)
