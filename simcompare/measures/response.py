"""Frequency response to one sine after another: IQ demodulation of a reading and of its base."""

from __future__ import annotations

import math

import numpy as np

from simcompare.measures import Measured, Request, _transfer
from simcompare.model.trajectory import Array, Trajectory

#: samples in the shortest period that is looked for
MIN_SAMPLES = 4
#: samples times frequencies that are looked at at once: a few megabytes
_AT_ONCE = 40_000

SERIES = _transfer.SERIES
AXES = _transfer.AXES
UNITS = _transfer.UNITS
ROLES = ("base",)
OPTIONS = ("dwell_s", "settle_s", "dwells", "gain", "judged_up_to_Hz")

against = _transfer.against


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Amplitude and phase of gain·(probe) over the acceleration of the base, at each frequency.

    Each dwell holds a whole number of periods of its frequency; which number, is taken from the
    motion of the base: the one whose sine leaves the least. In the settled part of the dwell the
    positions y of the base and the probe are fitted by least squares with cosine, sine, offset and
    straight line. The base's acceleration is -ω²·y, so that no differences are taken and no stored
    velocity is used. The truth may hold the transient that is left after settling: it is in both.

    Series, one entry per dwell, lowest frequency first: ``frequency``, ``amplitude``, ``phase``
    (negative: the reading lags). Values: ``cutoff_frequency`` (amplitude 1/√2) and
    ``judged_frequencies`` (how many are held against the truth).

    Args:
        trajectory: the source, evenly sampled.
        request: its probe sees what the reading is made of, its role ``base`` the position of the
            base [m]; ``dwell_s`` is how long each frequency is held, from the start on, ``dwells``
            how many there are, ``settle_s`` the part of each that is left out, ``gain`` the
            reading [m/s²] for one unit of the probe, ``judged_up_to_Hz`` the highest frequency at
            which errors count.
    """
    options = request.options
    time_s, probe, base = (
        trajectory.time_s,
        request.observed(trajectory),
        request.observed(trajectory, "base"),
    )
    frequencies, ratios = [], []
    for k in range(round(options["dwells"])):
        start_s = k * options["dwell_s"]
        inside = _dwell(time_s, start_s + options["settle_s"], start_s + options["dwell_s"])
        dwell = _demodulated(
            time_s[inside] - start_s, base[inside], probe[inside], options["dwell_s"]
        )
        if dwell is not None:
            frequencies.append(dwell[0])
            ratios.append(options["gain"] * dwell[1])
    return _transfer.as_measured(
        np.array(frequencies, dtype=float),
        np.array(ratios, dtype=complex),
        options["judged_up_to_Hz"],
    )


def _dwell(time_s: Array, start_s: float, end_s: float) -> slice:
    """Samples from ``start_s`` to before ``end_s``, whatever rounding does to their times."""
    slack_s = 1e-6 * (end_s - start_s)
    first, last = np.searchsorted(time_s, (start_s - slack_s, end_s - slack_s))
    return slice(int(first), int(last))


def _demodulated(
    time_s: Array, base: Array, probe: Array, dwell_s: float
) -> tuple[float, complex] | None:
    """Frequency [Hz] and probe over the base's acceleration; ``None`` if the base is still."""
    if len(time_s) < 2 * MIN_SAMPLES or _transfer.still(base):
        return None
    step_s = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    max_periods = math.floor(dwell_s / (MIN_SAMPLES * step_s))
    frequencies_Hz = np.arange(1, max_periods + 1) / dwell_s
    frequency = float(frequencies_Hz[np.argmin(_left(time_s, base, frequencies_Hz))])
    moved = _fitted(time_s, base, frequency)
    if abs(moved) < _transfer.STILL_M:
        return None
    read = _fitted(time_s, probe, frequency)
    return frequency, read / (-((2 * math.pi * frequency) ** 2) * moved)


def _left(time_s: Array, values: Array, frequencies_Hz: Array) -> Array:
    """Norm of what a sine of each frequency beside a straight line leaves."""
    line, _ = np.linalg.qr(np.column_stack((np.ones(len(time_s)), time_s - time_s.mean())))
    values = (values - line @ (line.T @ values))[:, None]
    size = max(1, _AT_ONCE // len(time_s))
    found = []
    for i in range(0, len(frequencies_Hz), size):
        turns = 2 * math.pi * frequencies_Hz[i : i + size, None] * time_s
        waves = np.stack((np.cos(turns), np.sin(turns)), axis=-1)
        beside, _ = np.linalg.qr(waves - line @ (line.T @ waves))
        left = values - beside @ (beside.swapaxes(1, 2) @ values)
        found.append(np.linalg.norm(left[..., 0], axis=1))
    return np.concatenate(found)


def _fitted(time_s: Array, values: Array, frequency_Hz: float) -> complex:
    """Complex amplitude of a sine beside a straight line."""
    turns = 2 * math.pi * frequency_Hz * time_s
    middle = time_s - time_s.mean()
    design = np.column_stack((np.cos(turns), np.sin(turns), np.ones(len(time_s)), middle))
    scale = np.linalg.norm(design, axis=0)
    weights = np.linalg.lstsq(design / scale, values, rcond=None)[0] / scale
    # the real part of (a - j·b)·exp(jωt) is a·cos + b·sin
    return complex(weights[0], -weights[1])
