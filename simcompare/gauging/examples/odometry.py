"""Odometry of a robot whose wheels turn at two constant rates: its arc, and how far it strays."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from simcompare.estimation.dead_reckoning import DeadReckoning, Wheels, from_rates
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example

_SPEED_M_S, _RADIUS_M, _TRACK_M = 0.2, 0.03, 0.2
#: relative standard uncertainty of the left wheel's radius
_U_RADIUS = 1e-3
_TIME_S = np.linspace(0.0, 10.0, 101)


def _driven(turn_rad_s: float) -> DeadReckoning:
    """At 0.2 m/s for 10 s, while it turns to the left at this rate."""
    rates = [
        np.full(len(_TIME_S), (_SPEED_M_S + side * turn_rad_s * _TRACK_M / 2) / _RADIUS_M)
        for side in (-1, 1)
    ]
    wheels = Wheels(_RADIUS_M, _RADIUS_M, _TRACK_M, u_left_radius_m=_U_RADIUS * _RADIUS_M)
    return from_rates(_TIME_S, (rates[0], rates[1]), wheels)


def _checks() -> Iterator[Check]:
    straight = _driven(0.0).u[-1]
    yield Check("straight on, u ahead (mm)", "1.000000", 1e3 * float(straight[0]))
    yield Check("straight on, u to the side (mm)", "10.000000", 1e3 * float(straight[1]))
    yield Check("straight on, u of the heading (mrad)", "10.000000", 1e3 * float(straight[2]))
    ahead, aside, _ = _driven(0.01).pose[-1]
    yield Check("turning at 0.01 rad/s, ahead (m)", "1.996668332937", float(ahead))
    yield Check("turning at 0.01 rad/s, to the side (m)", "0.0999166944395", float(aside))


EXAMPLE = Example(
    "Odometry for 10 s at 0.2 m/s: left radius known to 0.1 %, track of 0.2 m",
    "A wheel that is off by the part e turns the robot at ω = v·e/b: heading ω·t, to the side"
    " ½·v·ω·t², ahead v·e·t/2. The arc: (v/ω)·sin ωt and (v/ω)·(1 - cos ωt).",
    _checks,
    kind="exact",
    closed_form=True,
)
