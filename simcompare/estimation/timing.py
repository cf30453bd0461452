"""Readings of several sensors on one row of times, and marks counted in gates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation.estimate import Signal
from simcompare.hardware.sensors.encoder import counted_speeds, gate_uncertainty
from simcompare.model.trajectory import Array
from simcompare.statistics.streams import stream

#: times that are nearer than this are one [s]
SAME_S = 1e-7


def merged(signals: Sequence[Signal]) -> Array:
    """All times at which something is read (n,) [s]."""
    every = np.sort(np.concatenate([one.time_s for one in signals]))
    return every[np.concatenate(([True], np.diff(every) > SAME_S))]


def placed(signals: Sequence[Signal], time_s: Array) -> Array:
    """Readings at their own times (n, m), NaN at those of the others; earlier ones are left out."""
    found = np.full((len(time_s), len(signals)), np.nan)
    for i, one in enumerate(signals):
        late = one.time_s >= time_s[0] - SAME_S
        found[np.searchsorted(time_s, one.time_s[late] - SAME_S), i] = one.values[late]
    return found


def counted(counts: Signal, marks: float, gate_s: float) -> Signal:
    """Rates of a wheel [rad/s] from the marks that pass in gates, stamped at the gates' ends.

    Raises:
        InputError: the marks of a turn are not known, or no two gates fit in.
    """
    if marks < 1:
        fault = f"marks = {marks:g}; expected the marks in one turn of the wheel, 1 or more"
        raise InputError("estimate", [fault])
    gates = int(np.floor((counts.time_s[-1] - counts.time_s[0]) / gate_s + 1e-9))
    if gates < 2:
        fault = f"gate_s = {gate_s:g} leaves {gates} gates; expected a shorter gate"
        raise InputError("estimate", [fault])
    ends = counts.time_s[0] + gate_s * np.arange(gates + 1)
    rates = counted_speeds(held(counts, ends), int(marks), gate_s)
    return Signal(ends[1:], rates, gate_uncertainty(int(marks), gate_s))


def turned(counts: Signal, marks: float, gate_s: float) -> Signal:
    """Angle of a wheel since the first count, once in each gate [rad].

    Each is off by what lies before and behind a mark, evenly. At a steady speed and even times that
    repeats in a pattern; so each count is taken anywhere in its gate, and has an error of its own.

    Raises:
        InputError: the marks of a turn are not known, or no two gates fit in.
    """
    ends = counted(counts, marks, gate_s).time_s
    early_s = gate_s * stream(0, "counts").uniform(size=len(ends))
    places = np.searchsorted(counts.time_s, ends - early_s + SAME_S, side="right") - 1
    places = np.unique(np.concatenate(([0], places)))
    turned_rad = 2 * np.pi / marks * (counts.values[places] - counts.values[0])
    return Signal(counts.time_s[places], turned_rad, 2 * np.pi / marks / np.sqrt(12))


def held(counts: Signal, time_s: Array) -> Array:
    """What a counter shows, which holds its number until the next mark (n,)."""
    place = np.searchsorted(counts.time_s, time_s + SAME_S, side="right") - 1
    return np.asarray(counts.values[place])


def variance_of(signal: Signal, name: str) -> float:
    """Variance of one reading by noise.

    Raises:
        InputError: it is not known.
    """
    if signal.u is None:
        fault = f"the noise of {name} is not known; expected a data sheet, or its u"
        raise InputError("estimate", [fault])
    return float(np.mean(np.square(signal.u)))
