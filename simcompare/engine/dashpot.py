"""The linear spring and damper whose force is clipped at zero, as contacts in engines are."""

from __future__ import annotations

import functools
import math


def restitution(zeta: float) -> float:
    """Coefficient of restitution of a force-clipped spring and damper.

    The contact ends when the force, not the compression, is zero (Schwager and Pöschel, Granular
    Matter 9 (2007) 465): e = exp(-2ζ·arccos ζ/√(1-ζ²)), with arccosh for ζ > 1 and e⁻² at ζ = 1.

    Args:
        zeta: damping ratio c/(2√(k·m)), zero or more.
    """
    if zeta < 0:
        raise ValueError(f"{zeta=} must not be negative")
    spread = 1 - zeta * zeta
    if abs(spread) < 1e-9:
        return math.exp(-2)
    if spread > 0:
        return math.exp(-2 * zeta * math.acos(zeta) / math.sqrt(spread))
    return math.exp(-2 * zeta * math.acosh(zeta) / math.sqrt(-spread))


@functools.lru_cache(maxsize=256)
def damping_ratio(e: float) -> float:
    """Damping ratio that gives the restitution ``e`` (0 < e ≤ 1); inverse of :func:`restitution`.

    Solved by bisection: the function falls strictly, and 100 halvings reach the last bit.
    """
    if not 0 < e <= 1:
        raise ValueError(f"{e=} must be above 0 and not above 1")
    low, high = 0.0, 1.0
    while restitution(high) > e:
        high *= 2
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if restitution(middle) > e else (low, middle)
    return (low + high) / 2
