"""How a fit becomes a calibration: its readings, what is left of each, what was assumed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simcompare.hardware.sensors.calibration import Assumption, Calibration, Pose
from simcompare.hardware.sensors.linear_fit import Fitted
from simcompare.model.trajectory import Array


@dataclass(frozen=True, eq=False)
class Readings:
    """Mean readings of a sensor, each while something known acted on it.

    Attributes:
        names: one for each pose.
        means: (p, k).
        u: standard uncertainties of these means (p, k), ``None`` where they are not known.
        u_from: where they come from.
        degrees_of_freedom: of these.
    """

    names: tuple[str, ...]
    means: Array
    u: Array | None = None
    u_from: str = "what the fit leaves"
    degrees_of_freedom: float = np.inf


@dataclass(frozen=True)
class About:
    """What a kind of calibration is, apart from its numbers.

    Attributes:
        kind: its name.
        unit: of readings.
        not_separable: what it cannot tell apart.
        assumptions: what it took as known.
        scale: the source of uncertainty that scales all known values alike; a reading that is held
            against the same value does not feel it.
    """

    kind: str
    unit: str
    not_separable: tuple[str, ...]
    assumptions: tuple[Assumption, ...]
    scale: str


def calibration_of(
    about: About,
    found: Fitted,
    readings: Readings,
    used: NDArray[np.bool_],
    known: Array,
    size: float,
) -> Calibration:
    """A calibration from a fit to the ``used`` readings; the others verify.

    Args:
        about: the kind of calibration.
        found: by the fit.
        readings: all of them.
        used: which of them were fitted (p,).
        known: what acted in these (u, k).
        size: of what acted in the others.
    """
    bare = Calibration(
        about.kind, about.unit, found.sensitivity, found.offset, found.covariance, found.shares,
        found.degrees_of_freedom, found.noise.mean(axis=0), readings.u_from, found.chi2,
        float(found.spare), found.condition, about.not_separable, about.assumptions, (),
    )  # fmt: skip
    fitted = iter(zip(known, found.left, strict=True))
    poses = []
    for name, mean, taking_part in zip(readings.names, readings.means, used, strict=True):
        if taking_part:
            poses.append(_fitted(bare, name, mean, *next(fitted)))
        else:
            poses.append(_verified(bare, name, mean, size, about.scale))
    return replace(bare, poses=tuple(poses))


def _fitted(bare: Calibration, name: str, mean: Array, known: Array, left: Array) -> Pose:
    size = float(np.linalg.norm(known))
    along = known / size if size else mean / np.linalg.norm(mean)
    before, after = mean - known, bare.apply(mean) - known
    seen = np.linalg.solve(bare.sensitivity.T, along)
    u_after = math.sqrt(max(float(seen @ left @ seen), 0.0))
    return Pose(name, size, mean, float(along @ before), float(along @ after), u_after)


def _verified(bare: Calibration, name: str, mean: Array, size: float, scale: str) -> Pose:
    """A pose that took no part in a fit: its size alone is known."""
    corrected = bare.apply(mean)
    found = float(np.linalg.norm(corrected))
    seen = replace(bare, covariance=bare.covariance - bare.shares.get(scale, 0.0))
    along = corrected / found
    u = float(np.sqrt(along @ seen.covariance_of(mean, bare.noise)[0] @ along))
    return Pose(name, size, mean, float(np.linalg.norm(mean)) - size, found - size, u, False)
