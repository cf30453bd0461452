"""The 1000 frequencies of NIST SP 1065 (2008), 12.4, which anybody can make."""

from __future__ import annotations

_FIRST, _FACTOR, _MODULUS, _COUNT = 1234567890, 16807, 2147483647, 1000


def frequencies() -> list[float]:
    """By the generator of Park and Miller, written down with the set."""
    numbers = [_FIRST]
    while len(numbers) < _COUNT:
        numbers.append(_FACTOR * numbers[-1] % _MODULUS)
    return [number / _MODULUS for number in numbers]
