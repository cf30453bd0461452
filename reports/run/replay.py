"""The replay of a run: all engines beside the truth, at every contact level."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.model.settings import DEFAULT, TUNED
from simcompare.model.trajectory import TRUTH
from simcompare.reports.render.replays import Replay
from simcompare.reports.render.staging import Source, staged
from simcompare.reports.render.styles import TRUTH_STYLE
from simcompare.reports.run import runs
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

CAPTION = (
    "Play it, slow it down, or drag the slider. Side by side is for the eye: every engine has the"
    " whole scene for itself."
)


def replay_of(run: Run) -> Replay | None:
    """The replay of the nominal repeats; ``None`` where no source tells where a body is."""
    sources = [*_sources(run)]
    return staged(run.record.scene, sources, CAPTION)


def _sources(run: Run) -> Iterator[Source]:
    """The truth, then every engine at every level."""
    true = runs.truth(run)
    if true is not None:
        yield Source(f"truth ({TRUTH})", TRUTH_STYLE.colour, "", true)
    for mode in sorted(runs.modes(run), key=lambda mode: mode not in (TUNED, DEFAULT)):
        for name in runs.names(run):
            trajectory = runs.nominal(run, name, mode)
            if trajectory is not None:
                yield Source(name, look(run, name).colour, runs.mode_title(mode), trajectory)
