"""Variants of PyBullet: what its users set against bounces that are wrong."""

from __future__ import annotations

from typing import NamedTuple

from simcompare.engine.variants import Variant


class Recipe(NamedTuple):
    """Parameters that have setters and no getters.

    Attributes:
        world: of ``setPhysicsEngineParameter``.
        bodies: of ``changeDynamics``, for every body.
    """

    world: dict[str, float]
    bodies: dict[str, float]


VARIANTS = {
    "recipe": Variant(
        "no threshold for bounces, no contact before bodies touch, no correction of depths: what"
        " users found against bounces that depend on where in a step they fall",
        "bulletphysics/bullet3 issues 1530, 3094",
        Recipe(
            {"restitutionVelocityThreshold": 0.0, "erp": 0.0, "contactERP": 0.0},
            {"contactProcessingThreshold": 0.0},
        ),
    ),
}
