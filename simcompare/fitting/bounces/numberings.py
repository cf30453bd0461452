"""Numberings of impacts that two flights propose.

Flights of a bouncing ball last ever shorter, by a factor that changes slowly. Two flights propose
that factor; how many of the other impacts it explains tells how good the proposal is (M. A.
Fischler and R. C. Bolles, Comm. ACM 24 (1981) 381).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array

#: a missed impact counts against a proposal as half an impact
MISSED = 0.5
#: flights that a proposal may reach over when others knocked in between
REACH = 4
#: by what the logarithm of the factor shrinks from flight to flight: drag, and e(v)
_SLOWER = (1.0, 0.94, 0.88, 0.82)
#: flights that a proposal foretells, backwards and forwards
_BACK, _ON = 6, 24
#: proposals that are refined
_BEST = 4


def proposals(times: Array) -> list[NDArray[np.int64]]:
    """Numberings that explain most of the impacts, best first."""
    found: dict[bytes, tuple[float, NDArray[np.int64]]] = {}
    for start, flight, e in _pairs(times):
        for slower in _SLOWER:
            numbers, score = _explained(times, start, flight, e, slower)
            key = numbers.tobytes()
            if score > found.get(key, (-math.inf,))[0]:
                found[key] = score, numbers
    ranked = sorted(found.values(), key=lambda one: -one[0])
    return [numbers for _, numbers in ranked[:_BEST]]


def _pairs(times: Array) -> Iterator[tuple[float, float, float]]:
    """Two flights: when the first began, how long it lasted, and the factor to the next."""
    for i in range(len(times) - 2):
        for j in range(i + 1, min(i + REACH, len(times) - 1)):
            for k in range(j + 1, min(j + REACH, len(times))):
                start, flight = float(times[i]), float(times[j] - times[i])
                ratio = float(times[k] - times[j]) / flight
                if 0.1 < ratio < 0.99:
                    yield start, flight, ratio
                if j == i + 1 and k == j + 1:
                    # the second of them missed an impact: e + e²; or the first: e²/(1 + e)
                    e = (math.sqrt(1 + 4 * ratio) - 1) / 2
                    if 0.1 < e < 0.99:
                        yield start, flight, e
                    e = (ratio + math.sqrt(ratio * ratio + 4 * ratio)) / 2
                    if 0.1 < e < 0.99:
                        yield start, flight / (1 + e), e


def _explained(
    times: Array, start: float, flight: float, e: float, slower: float
) -> tuple[NDArray[np.int64], float]:
    """Numbers of the impacts that lie where the proposal foretells one, and how well they do."""
    change = math.log(e) * slower ** np.arange(_ON)
    on = flight * np.exp(np.concatenate(([0.0], np.cumsum(change))))
    change = math.log(e) / slower ** np.arange(1, _BACK + 1)
    back = flight * np.exp(-np.cumsum(change))
    flights = np.concatenate((back[::-1], on))
    places = start - back.sum() + np.concatenate(([0.0], np.cumsum(flights)))
    flights = np.append(flights, flights[-1])
    off = np.abs(times[:, None] - places) / flights
    nearest = np.argmin(off, axis=1)
    # the factor changes slowly: farther away less is known
    tolerance = np.minimum(0.08 + 0.03 * np.abs(nearest - _BACK - 1), 0.25)
    worth = np.maximum(0.0, 1 - (off[np.arange(len(times)), nearest] / tolerance) ** 2)
    numbers = one_each(np.where(worth > 0, nearest, -1), worth)
    used = numbers[numbers >= 0]
    if len(used) < 2:
        return numbers, 0.0
    gaps = int(np.ptp(used)) + 1 - len(used)
    numbers = np.where(numbers >= 0, numbers - used.min(), -1)
    return numbers, float(worth[numbers >= 0].sum()) - MISSED * gaps


def one_each(numbers: NDArray[np.intp], worth: Array) -> NDArray[np.int64]:
    """Of several impacts with one number only the best keeps it."""
    kept = numbers.astype(np.int64)
    for number in np.unique(kept[kept >= 0]):
        same = np.flatnonzero(kept == number)
        kept[same[same != same[np.argmax(worth[same])]]] = -1
    return kept
