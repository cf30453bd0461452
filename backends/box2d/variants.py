"""Variants of Box2D: into how many substeps it divides a step."""

from __future__ import annotations

from simcompare.engine.variants import Variant

_REFERENCE = "Box2D documentation, Simulation: b2World_Step, subStepCount"

#: what is given to each step: the number of its substeps
VARIANTS = {
    f"substeps{count}": Variant(
        f"{count} substep{'s' if count > 1 else ''} in a step, in place of 4, or of those that"
        " tuned asks for",
        _REFERENCE,
        count,
    )
    for count in (1, 4, 16)
}
