"""Variants of pymunk: how often its solver goes over all constraints in a step."""

from __future__ import annotations

from simcompare.engine.variants import Variant

_REFERENCE = "pymunk documentation, Space.iterations"

#: what is set: the number of iterations
VARIANTS = {
    f"iterations{count}": Variant(
        f"the solver goes {count} times over all constraints in a step, in place of 10, or of as"
        " often as tuned asks for",
        _REFERENCE,
        count,
    )
    for count in (1, 10, 100)
}
