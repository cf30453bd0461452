"""Figures over time: what the probes see, and the mechanical energy."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from simcompare.model.scenario import Probe
from simcompare.model.trajectory import TRUTH, Array, Trajectory
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import TRUTH_STYLE
from simcompare.reports.run import energy, runs
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

TIME = "time (s)"


def probe_figure(run: Run, name: str, probe: Probe) -> Figure:
    """What one probe sees in every source, one panel a contact level."""
    return _probe_figure(run, f"probe-{name}", probe, runs.modes(run))


def motion_figure(run: Run, name: str, probe: Probe, modes: Sequence[str]) -> Figure:
    """The same at some contact levels alone."""
    return _probe_figure(run, f"motion-{name}", probe, modes)


def _probe_figure(run: Run, name: str, probe: Probe, modes: Sequence[str]) -> Figure:
    def curve(trajectory: Trajectory) -> tuple[Array, Array] | None:
        values = runs.observed(trajectory, probe)
        return None if values is None else (trajectory.time_s, values)

    label = f"{probe.label}{runs.unit_words(probe.unit)}"
    caption = "One line for each engine"
    if run.record.repeats > 1:
        caption += (
            f", the middle one of {run.record.repeats} repeats, which may differ from their mean"
            " as much as ± says"
        )
    if runs.truth(run) is not None:
        caption += (
            f". The thick grey line is the truth ({TRUTH}): "
            "an engine that is right runs inside of it"
        )
    title = f"{probe.label} over time"
    panels = _panels(run, label, curve, modes)
    return Figure(name, title, f"{caption}.", panels, share_y=True)


def energy_figure(run: Run) -> Figure | None:
    """Mechanical energy over its start; ``None`` where the scenario does not tell what it takes."""
    probe = energy.height_probe(run)
    if probe is None:
        return None
    gravity = float(run.record.parameters[energy.GRAVITY])

    def curve(trajectory: Trajectory) -> tuple[Array, Array] | None:
        times, values = energy.relative(trajectory, probe, gravity)
        return (times, values) if len(times) else None

    panels = _panels(run, "mechanical energy ÷ that at the start", curve, runs.modes(run))
    if not any(panel.series for panel in panels):
        return None
    caption = (
        "g·h + v²/2 over its value at the start, v from differences of the positions. "
        "A line that rises gains energy from nowhere; "
        "gaps are impacts, where there is no speed to speak of."
    )
    return Figure("energy", "Mechanical energy over time", caption, panels, share_y=True)


def _panels(
    run: Run,
    y_label: str,
    curve: Callable[[Trajectory], tuple[Array, Array] | None],
    modes: Sequence[str],
) -> tuple[Panel, ...]:
    panels = []
    for mode in modes:
        sources = [(f"truth ({TRUTH})", runs.truth(run), TRUTH_STYLE)]
        sources += [(n, runs.nominal(run, n, mode), look(run, n)) for n in runs.names(run)]
        series = []
        for label, trajectory, style in sources:
            points = curve(trajectory) if trajectory is not None else None
            if points is not None:
                series.append(Series(label, *points, style))
        # a solid line would hide dashed ones; the truth is the widest, and at the bottom
        series.sort(key=lambda one: (one.style != TRUTH_STYLE, one.style.dash != "solid"))
        panels.append(Panel(runs.mode_title(mode), TIME, y_label, tuple(series)))
    return tuple(panels)
