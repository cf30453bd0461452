"""Where something is tried, and where along a line it changes."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

from simcompare.engine.calibration.edges import edge

#: steps over which every experiment is looked at [s]
STEPS_S = (0.25e-3, 0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3)


def geometric(low: float, high: float, count: int) -> tuple[float, ...]:
    """So many numbers from low to high, each the same multiple of the one before, in 3 digits."""
    ratio = (high / low) ** (1 / (count - 1))
    return tuple(float(f"{low * ratio**i:.3g}") for i in range(count))


def first_edge(holds: Callable[[float], bool], along: Sequence[float]) -> float | None:
    """The last number along a line up to which something holds; ``None`` if it always does.

    Where it does not even hold for the first number, that is the edge.
    """
    if not holds(along[0]):
        return along[0]
    for inside, outside in itertools.pairwise(along):
        if not holds(outside):
            return edge(holds, inside, outside)
    return None
