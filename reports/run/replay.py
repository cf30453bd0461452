"""The replay of a run: all engines beside the truth, at every contact level."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.model.settings import DEFAULT, TUNED
from simcompare.model.trajectory import TRUTH
from simcompare.reports.render.replays import Replay
from simcompare.reports.render.staging import Source, staged
from simcompare.reports.render.styles import MEASURED_STYLE, TRUTH_STYLE
from simcompare.reports.run import runs
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

CAPTION = (
    "Play it, slow it down, or drag the slider. Side by side is for the eye: every engine has the"
    " whole scene for itself."
)
#: what is added where a sensor looks
_RAYS = (
    "Lines go from the sensor to what the middle of each zone meets; a zone that sees nothing has"
    " none."
)
#: who moves bodies and is no engine: name and look
_OTHERS = {TRUTH: (f"truth ({TRUTH})", TRUTH_STYLE), "measured": ("measured", MEASURED_STYLE)}
#: with which parameters it moves them
_WITH = {
    "": "", "motion": "", "nominal": "with the given parameters",
    "best": "with the fitted parameters", "fitted": "with the fitted parameters",
}  # fmt: skip


def replay_of(run: Run) -> Replay | None:
    """The replay of the nominal repeats; ``None`` where no source tells where a body is.

    Of a fit or a validation, the first segment of the recording with the engines beside it.
    """
    if run.record.kind == "run":
        return staged(run.record.scene, [*_sources(run)], _caption(run), run.record.eyes)
    found = [*_beside_recording(run)]
    engines = [one for one in found if one.label in runs.names(run)]
    return staged(run.record.scene, found, _caption(run), run.record.eyes) if engines else None


def _caption(run: Run) -> str:
    return f"{CAPTION} {_RAYS}" if run.record.eyes else CAPTION


def _beside_recording(run: Run) -> Iterator[Source]:
    """What was measured where that tells of bodies, the truth, and every engine."""
    first = min((one.segment for one in run.trajectories), default=0)
    for one in run.trajectories:
        if one.segment != first or one.repeat:
            continue
        if one.source in _OTHERS:
            label, style = _OTHERS[one.source]
            yield Source(label, style.colour, _WITH.get(one.parameters, ""), one.trajectory)
        elif one.source in runs.names(run):
            style = look(run, one.source)
            yield Source(one.source, style.colour, _WITH[one.parameters], one.trajectory)


def _sources(run: Run) -> Iterator[Source]:
    """The truth, then every engine at every level."""
    true = runs.truth(run)
    if true is not None:
        yield Source(_OTHERS[TRUTH][0], TRUTH_STYLE.colour, "", true)
    for mode in sorted(runs.modes(run), key=lambda mode: mode not in (TUNED, DEFAULT)):
        for name in runs.names(run):
            trajectory = runs.nominal(run, name, mode)
            if trajectory is not None:
                yield Source(name, look(run, name).colour, runs.mode_title(mode), trajectory)
