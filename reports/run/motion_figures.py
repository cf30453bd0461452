"""Figures over time: what the probes see, and the mechanical energy.

The energy comes from positions alone, so that no engine's own idea of velocity is in it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from simcompare.model.scenario import Probe
from simcompare.model.trajectory import TRUTH, Array, Trajectory
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import TRUTH_STYLE
from simcompare.reports.run import runs
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

TIME = "time (s)"
GRAVITY = "gravity_m_s2"
#: a body in contact is at rest below this part of the speed of falling from the start
_REST = 0.01
#: a change of speed within one sample, as part of the same speed, that is an impact
_IMPACT = 0.02


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
    probe = height_probe(run)
    if probe is None:
        return None
    gravity = float(run.record.parameters[GRAVITY])

    def curve(trajectory: Trajectory) -> tuple[Array, Array] | None:
        times, values = relative(trajectory, probe, gravity)
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


def height_probe(run: Run) -> Probe | None:
    """The first probe that is a height, where the scenario tells its gravity; else ``None``.

    Where joints or motors do work, height and speed of one body are not all of the energy.
    """
    if not run.record.parameters.get(GRAVITY) or run.record.has_joints:
        return None
    for probe in runs.probes(run).values():
        if probe.observe.endswith(".position_m") and probe.component == 2 and probe.unit == "m":
            return probe
    return None


def relative(trajectory: Trajectory, probe: Probe, gravity_m_s2: float) -> tuple[Array, Array]:
    """Times (m,) and g·h + v²/2 over its value at the start (m,); the mass cancels.

    The speed is the central difference of the positions, exact on a parabola. NaN where it means
    nothing: over an impact, and while a contact that holds elastic energy moves. Rotation is left
    out. Empty arrays where there is no energy to start from.
    """
    height = runs.observed(trajectory, probe)
    if height is None or len(height) < 3:
        return np.zeros(0), np.zeros(0)
    time_s, position = trajectory.time_s, trajectory.signals[probe.observe]
    span = time_s[2:] - time_s[:-2]
    speed = np.linalg.norm(position[2:] - position[:-2], axis=1) / span
    energy = gravity_m_s2 * height[1:-1] + speed**2 / 2
    if energy[0] <= 0:
        return np.zeros(0), np.zeros(0)
    bend = np.linalg.norm(position[2:] - 2 * position[1:-1] + position[:-2], axis=1)
    change = bend / (span / 2)
    scale = math.sqrt(2 * float(energy[0]))
    # free fall itself changes the speed by g·dt a sample
    impact = change > np.maximum(_IMPACT * scale, 3 * gravity_m_s2 * span / 2)
    lowest = np.minimum(np.minimum(height[:-2], height[1:-1]), height[2:])
    meaningless = impact | ((lowest <= 0) & (speed > _REST * scale))
    return time_s[1:-1], np.where(meaningless, np.nan, energy / energy[0])
