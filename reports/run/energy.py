"""Mechanical energy from positions alone, so that no engine's own idea of velocity is in it."""

from __future__ import annotations

import math

import numpy as np

from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Array, Trajectory
from simcompare.reports.run import runs
from simcompare.results.run import Run

GRAVITY = "gravity_m_s2"
#: a body in contact is at rest below this part of the speed of falling from the start
_REST = 0.01
#: a change of speed within one sample, as part of the same speed, that is an impact
_IMPACT = 0.02


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
