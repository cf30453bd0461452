"""Parameters moved by their standard uncertainties, one at a time, to see what each one does."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.inference.estimate import Estimate
from simcompare.inference.segments import Segment
from simcompare.scenarios.scenario_file import ScenarioFile


def moves(
    file: ScenarioFile, segment: Segment, fit: Estimate | None
) -> dict[str, dict[str, float]]:
    """Parameters moved by one standard uncertainty, one by one; fitted ones along their axes.

    The axes are the principal ones of the covariance, so that correlations are kept; each is
    named after the parameter that moves most in it. With a parameter that was known the fitted
    ones move as the fit would have moved. What would leave a bound moves the other way.
    """
    best = {} if fit is None else fit.as_dict()
    steps = {name: {name: u} for name, u in segment.u.items() if u > 0 and name not in best}
    if fit is not None:
        for name in steps:  # the fit would have made up for some of it
            if name in fit.follows:
                steps[name].update(zip(fit.names, fit.follows[name].tolist(), strict=True))
        sizes, axes = np.linalg.eigh(fit.covariance)
        for size, axis in zip(np.maximum(sizes, 0.0), axes.T, strict=True):
            step = dict(zip(fit.names, (np.sqrt(size) * axis).tolist(), strict=True))
            shares = np.abs(list(step.values())) / np.where(fit.u > 0, fit.u, 1.0)
            lead = f"{fit.names[int(np.argmax(shares))]} (fitted)"
            while lead in steps:
                lead += "'"
            if size > 0:
                steps[lead] = step
    return {
        lead: {**best, **_within(file, {**segment.values, **best}, step)}
        for lead, step in steps.items()
    }


def _within(
    file: ScenarioFile, values: Mapping[str, float], step: Mapping[str, float]
) -> dict[str, float]:
    """Values after a step, or after its opposite where the step would leave a bound."""
    for sign in (1, -1):
        moved = {name: values[name] + sign * change for name, change in step.items()}
        if all(file.parameters[n].min <= v <= file.parameters[n].max for n, v in moved.items()):
            return moved
    return {
        name: min(max(value, file.parameters[name].min), file.parameters[name].max)
        for name, value in moved.items()
    }
