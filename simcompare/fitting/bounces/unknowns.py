"""Unknowns of a fit of bounces: their names, limits and priors, and the internal number of each.

The terminal speed v_t is 1/v_t² inside, in which the data are nearly linear and vacuum is 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from simcompare.errors import UnknownName
from simcompare.fitting.bounces.bounce_models import DEFAULTS
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_forms import Prior

#: unknowns of which every drop has its own
OF_A_DROP = ("drop_height_m", "release_time_s", "floor_m")
SPEED = "terminal_speed_m_s"
GRAVITY, CLOCK, SCALE = "gravity_m_s2", "clock_skew", "scale"
#: of the place and the recorder, not of the ball: every fit has those that a prior tells of
OF_THE_RECORDING = (GRAVITY, CLOCK, SCALE)
#: where nothing else is said; a fit does not leave them
BOUNDS = {
    "restitution": (0.01, 0.9999), "exponent": (-0.5, 1.0), SPEED: (0.5, np.inf),
    "drop_height_m": (1e-4, 100.0), "release_time_s": (-np.inf, np.inf),
    CLOCK: (-0.01, 0.01), "floor_m": (-np.inf, np.inf), SCALE: (0.1, 10.0),
    GRAVITY: (0.01, 1000.0),
}  # fmt: skip
#: usual sizes, for differences and steps
SIZES = {
    "restitution": 1.0, "exponent": 1.0, SPEED: 0.01, "drop_height_m": 0.3,
    "release_time_s": 0.3, CLOCK: 1e-2, "floor_m": 0.1, SCALE: 1.0, GRAVITY: 10.0,
}  # fmt: skip


def base(name: str) -> str:
    """The name without the number of a drop: drop_height_m for drop_height_m[2]."""
    return name.partition("[")[0]


def own_drop(name: str) -> int | None:
    """Number of the drop (from 0) to which an unknown belongs; ``None`` for all."""
    _, bracket, rest = name.partition("[")
    if bracket:
        return int(rest[:-1]) - 1
    return None


def internal(name: str, value: float) -> float:
    """The internal number for a value of an unknown."""
    return 1 / value**2 if base(name) == SPEED else value


def external(name: str, x: Array | float) -> Array:
    """The value of an unknown from the internal number; infinite speed for no drag."""
    if base(name) != SPEED:
        return np.asarray(x, dtype=float)
    k = np.asarray(x, dtype=float)
    return np.where(k > 0, 1 / np.sqrt(np.where(k > 0, k, 1.0)), np.inf)


def slope(name: str, value: float) -> float:
    """Derivative of the internal number to the value."""
    return -2 / value**3 if base(name) == SPEED else 1.0


def faults(
    chosen: Sequence[str],
    fixed: Mapping[str, float],
    priors: Mapping[str, Prior],
) -> list[str]:
    """Every fault of the names and numbers that were given."""
    unknown = [n for n in dict.fromkeys((*chosen, *priors)) if base(n) not in BOUNDS]
    found = [str(UnknownName("unknown of a bounce", name, BOUNDS)) for name in unknown]
    for name in fixed:
        if base(name) not in DEFAULTS:
            found.append(str(UnknownName("parameter of a bounce", name, DEFAULTS)))
    for name in dict.fromkeys(chosen):
        if name in fixed:
            found.append(f"{name} is both sought and fixed at {fixed[name]:g}; choose one")
        if list(chosen).count(name) > 1:
            found.append(f"{name} is sought twice")
    for name, prior in priors.items():
        found += _prior_faults(name, prior)
    if not chosen:
        found.append("nothing is sought; name at least one unknown")
    return found


def _prior_faults(name: str, prior: Prior) -> list[str]:
    if not (np.isfinite(prior.value) and np.isfinite(prior.u) and prior.u > 0):
        return [f"the prior {prior.value:g} ± {prior.u:g} of {name} is no normal distribution; give"
                " a finite value and an uncertainty above 0"]  # fmt: skip
    if base(name) == SPEED and not prior.value > 0:
        return [f"the prior of {name} is {prior.value:g}; a speed is above 0"]
    return []
