"""First guesses for a fit of bounces, from ratios of flights or of heights."""

from __future__ import annotations

import numpy as np

from simcompare.fitting.bounces.bounce_models import DEFAULTS
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.problem import Problem
from simcompare.fitting.bounces.unknowns import GRAVITY, SPEED, base, internal, own_drop
from simcompare.model.trajectory import Array

_RESTITUTION = 0.8


def of(problem: Problem) -> Array:
    """A first guess of the internal numbers (p,)."""
    known = problem.priors.get(GRAVITY)
    gravity = float(problem.fixed.get(GRAVITY, known.value if known else DEFAULTS[GRAVITY]))
    guesses = [_drop(drop, gravity) for drop in problem.drops]
    found = []
    for name in problem.names:
        kind, drop = base(name), own_drop(name)
        prior = problem.priors.get(name)
        if kind == SPEED:
            # vacuum is a fair start, and the only one from which no data lead astray
            value = 0.0 if prior is None else internal(name, prior.value)
        elif kind in guesses[0]:
            chosen = guesses if drop is None else [guesses[drop]]
            value = float(np.mean([guess[kind] for guess in chosen]))
        else:
            value = DEFAULTS[kind] if prior is None else prior.value
        found.append(value)
    return np.asarray(np.clip(np.array(found), problem.low, problem.high))


def _drop(drop: Impacts, gravity: float) -> dict[str, float]:
    """Restitution, drop height, release time and floor of one drop."""
    e = _restitution(drop)
    guess = {"restitution": e, "drop_height_m": 1.0, "release_time_s": 0.0, "floor_m": 0.0}
    if len(drop.times_s):
        speed = _first_speed(drop, e, gravity)
        guess["drop_height_m"] = max(speed**2 / (2 * gravity), 1e-3)
        first = float(drop.times_s[0])
        before = sum(2 * speed * e**n / gravity for n in range(1, drop.numbers[0]))
        guess["release_time_s"] = first - before - speed / gravity
    elif len(drop.intervals_s):
        speed = gravity * float(drop.intervals_s[0]) / 2 / e ** drop.interval_numbers[0]
        guess["drop_height_m"] = max(speed**2 / (2 * gravity), 1e-3)
    elif len(drop.heights_m):
        guess["drop_height_m"] = float(drop.heights_m[0] / e ** (2 * drop.height_numbers[0]))
    if drop.track is not None:
        guess["floor_m"] = float(drop.track.height_m.min())
    return guess


def _first_speed(drop: Impacts, e: float, gravity: float) -> float:
    """Speed of the first impact, from the first flight (or flights) that was recorded."""
    if drop.track is not None and len(drop.heights_m):
        return float(np.sqrt(2 * gravity * drop.heights_m[0]) / e ** drop.height_numbers[0])
    if len(drop.times_s) < 2:
        return float(np.sqrt(2 * gravity))
    a, b = drop.numbers[:2]
    flights = sum(e**n for n in range(a, b))
    return float(gravity * (drop.times_s[1] - drop.times_s[0]) / (2 * flights))


def _restitution(drop: Impacts) -> float:
    """Median ratio of neighbouring flights, or of neighbouring heights."""
    numbers, times = np.array(drop.numbers), drop.times_s
    if len(times) > 2:
        steps, gaps = np.diff(times), np.diff(numbers)
        both = (gaps[1:] == 1) & (gaps[:-1] == 1)
        if both.any():
            return float(np.clip(np.median((steps[1:] / steps[:-1])[both]), 0.05, 0.99))
        # flights over several impacts: what shrinks from middle to middle
        middles = (numbers[1:] + numbers[:-1]) / 2
        rate = np.polyfit(middles, np.log(steps / gaps), 1)[0]
        return float(np.clip(np.exp(rate), 0.05, 0.99))
    if len(drop.intervals_s) > 1:
        gaps = np.diff(np.array(drop.interval_numbers))
        ratios = (drop.intervals_s[1:] / drop.intervals_s[:-1]) ** (1 / gaps)
        return float(np.clip(np.median(ratios), 0.05, 0.99))
    if len(drop.heights_m) > 1:
        gaps = np.diff(np.array(drop.height_numbers))
        ratios = (drop.heights_m[1:] / drop.heights_m[:-1]) ** (0.5 / gaps)
        return float(np.clip(np.median(ratios), 0.05, 0.99))
    return _RESTITUTION
