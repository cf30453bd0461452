"""The contact of Hunt and Crossley: its effective restitution, and the contact of a restitution.

The contact F = K·xⁿ·(1 + χ·ẋ) (J. Appl. Mech. 42 (1975) 440) gives an effective restitution e that
depends on y = χ·v alone: y·(1 + e) = ln((1 + y)/(1 - y·e)), for every n, K and mass (Marhefka and
Orin, IEEE Trans. Syst. Man Cybern. A 29 (1999) 566, checked in the tests by integration). It is
stated here by its restitution at a reference speed, as the other laws are.
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.polynomial.polynomial import polyval

from simcompare.model.trajectory import Array
from simcompare.results.records.fit_forms import REFERENCE_M_S

#: speed at which the restitution of a law that depends on speed is stated [m/s]
REFERENCE_SPEED = REFERENCE_M_S
#: largest χ·v of the table of Hunt and Crossley's restitution
_FASTEST = 12.0
#: of √(2(x - ln(1 + x)))/x squared, near 0
_LOG_SERIES = (1.0, -2 / 3, 2 / 4, -2 / 5, 2 / 6, -2 / 7)


def dissipation(e: Array) -> Array:
    """χ [s/m] of the contact that has this restitution at ``REFERENCE_SPEED``."""
    return _inverse(e) / REFERENCE_SPEED


def restitution(y: Array) -> Array:
    """Effective restitution at y = χ·v, to rounding."""
    given = np.maximum(np.asarray(y, dtype=float), 0.0)
    y = np.clip(given, 1e-12, _FASTEST)
    places, guesses = _table()
    z = _improved(np.interp(y / (1 + y), places, guesses), -y * _root_ratio(y))
    found = np.where(given <= 1e-12, 1.0, -z / y)
    if np.any(given > _FASTEST):
        # the ball creeps out: q·exp(-q) = (1 + y)·exp(-1 - y) with small q = 1 - y·e
        near = (1 + given) * np.exp(-(1 + given))
        slow = (1 - near * (1 + near * (1 + 1.5 * near))) / np.maximum(given, 1.0)
        found = np.where(given > _FASTEST, slow, found)
    return np.asarray(found)


@functools.cache
def _table() -> tuple[Array, Array]:
    """Z = -y·e at places of y/(1 + y), from which one Newton step reaches rounding."""
    places = np.linspace(0, _FASTEST / (1 + _FASTEST), 4001)
    y = places / (1 - places)
    near = (1 + y) * np.exp(-(1 + y))
    z = np.maximum(1 - y / (1 + 2 * y / 3), near * np.exp(near * np.exp(near))) - 1
    goal = -y * _root_ratio(y)
    for _ in range(6):
        z = _improved(z, goal)
    return places, z


def _improved(z: Array, goal: Array) -> Array:
    """One Newton step towards S(z) = goal; S is smooth and free of the trivial root z = y.

    S(x) = ±√(2(x - ln(1 + x))), and the relation of Hunt and Crossley is S(-y·e) = -S(y).
    """
    ratio = _root_ratio(z)
    return np.maximum(z - (z * ratio - goal) * (1 + z) * ratio, (z - 1) / 2)


def _inverse(e: Array) -> Array:
    """Y = χ·v at which the restitution is e."""
    e = np.clip(np.asarray(e, dtype=float), 1.001 / _FASTEST, 1 - 1e-12)
    places, z = _table()
    y = places[1:] / (1 - places[1:])
    # the table's restitution falls, and interpolation wants it to rise
    guess = np.interp(-e, np.concatenate(([-1.0], z[1:] / y)), places)
    y = np.maximum(guess / (1 - guess), 1e-13)
    ours, theirs = _root_ratio(y), _root_ratio(-e * y)
    slope = _root_slope(y, ours) + e * e * _root_slope(-e * y, theirs)
    return np.asarray(y - (ours - e * theirs) / slope)


def _root_ratio(x: Array) -> Array:
    """√(2(x - ln(1 + x)))/|x|, 1 at 0."""
    small = np.abs(x) < 0.003
    safe = np.where(small, 0.5, x)
    near = polyval(x, _LOG_SERIES)
    return np.sqrt(np.where(small, near, 2 * (safe - np.log1p(safe)) / (safe * safe)))


def _root_slope(x: Array, ratio: Array) -> Array:
    small = np.abs(x) < 1e-4
    safe = np.where(small, 1.0, x)
    exact = (1 / ((1 + safe) * ratio) - ratio) / safe
    return np.where(small, -1 / 3 + 7 * x / 18, exact)
