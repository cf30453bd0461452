"""Angle of a joint from two accelerometers at rest: its uncertainty."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.measures.joint_angle_estimate import angle_between
from simcompare.model.trajectory import Array
from simcompare.statistics.distributions import normal

#: noise of every axis over gravity
_NOISE = 0.02


def _angle_mrad(first_x: Array, first_z: Array, second_x: Array, second_z: Array) -> Array:
    return 1e3 * angle_between((first_x, first_z), (second_x, second_z))


def _checks() -> Iterator[Check]:
    axes = {
        "first_x": normal(0.0, _NOISE), "first_z": normal(1.0, _NOISE),
        "second_x": normal(0.0, _NOISE), "second_z": normal(1.0, _NOISE),
    }  # fmt: skip
    found = monte_carlo.repeated(_angle_mrad, axes)
    yield monte_carlo.uncertainty(found, "28.28993", "mrad")


EXAMPLE = Example(
    "Joint angle from two accelerometers, each axis with noise of 0.02 g",
    "Second moment of the angle by Gauss-Hermite quadrature, 60 x 60 nodes. The first order,"
    " √2·s/g = 28.28427 mrad, lacks what is of second order in the noise.",
    _checks,
    kind="exact",
    closed_form=True,
)
