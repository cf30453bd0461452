"""Numbers for a page, as JSON holds them: as many digits as are seen, and all finite."""

from __future__ import annotations

import math

from simcompare.model.trajectory import Array

#: digits of what is drawn
_DIGITS = 6


def shortened(value: float | None) -> float | None:
    """A number with as many digits as are seen; ``None`` where it is not finite."""
    if value is None or not math.isfinite(value):
        return None
    return float(f"{value:.{_DIGITS}g}")


def listed(values: Array) -> list[float | None]:
    """The numbers of a line."""
    return [shortened(float(value)) for value in values]
