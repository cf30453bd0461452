"""Where between two numbers something no longer holds."""

from __future__ import annotations

import math
from collections.abc import Callable


def edge(holds: Callable[[float], bool], inside: float, outside: float, halvings: int = 6) -> float:
    """Where between two positive numbers something no longer holds.

    The gap is halved by its ratio: scipy's root finders would need a number that changes its sign.

    Args:
        holds: what is asked.
        inside: where it holds.
        outside: where it does not.
        halvings: how often the gap is halved.

    Returns:
        The last number that was tried and for which it holds.
    """
    for _ in range(halvings):
        middle = math.sqrt(inside * outside)
        if holds(middle):
            inside = middle
        else:
            outside = middle
    return inside
