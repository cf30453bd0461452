"""Frequency responses as series, however they were excited: amplitude and phase over frequency."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from simcompare.measures import Measured, Pairs
from simcompare.model.trajectory import Array

Complex = NDArray[np.complex128]

#: half the power: where a response is said to end
CUTOFF = 1 / math.sqrt(2)
#: a base that moves less than a proton is wide does not move but for rounding [m]
STILL_M = 1e-15
#: an amplitude that is as good as none
LEAST = 1e-9
#: said of a source in which it does not
NOTE = "its base stands still"

SERIES = ("frequency", "amplitude", "phase")
AXES = {"amplitude": "frequency", "phase": "frequency"}
UNITS = {
    "frequency": "Hz",
    "amplitude": "1",
    "phase": "deg",
    "amplitude_error": "1",
    "phase_error": "deg",
    "cutoff_frequency": "Hz",
    "judged_frequencies": "1",
}


def still(base: Array) -> bool:
    """Whether positions of a base (n,) [m] are the same but for rounding."""
    return len(base) == 0 or float(np.ptp(base)) < STILL_M


def as_measured(frequency_Hz: Array, response: Complex, judged_up_to_Hz: float) -> Measured:
    """A response as series and values.

    Args:
        frequency_Hz: frequencies (n,), in any order; none of a base that stands still.
        response: complex ratio of reading to true quantity at each (n,).
        judged_up_to_Hz: highest frequency at which it is held against the truth.
    """
    order = np.argsort(frequency_Hz, kind="stable")
    frequency, response = frequency_Hz[order], response[order]
    amplitude = np.abs(response)
    # rounding must not leave out the highest
    judged = int(np.count_nonzero(frequency <= judged_up_to_Hz * (1 + 1e-9)))
    return Measured(
        values={
            "cutoff_frequency": cutoff(frequency, amplitude),
            "judged_frequencies": float(judged),
        },
        series={"frequency": frequency, "amplitude": amplitude, "phase": phase_of(response)},
        notes=() if len(frequency) else (NOTE,),
    )


def against(measured: Measured, truth: Measured) -> Pairs:
    """What is judged: name -> (value of the source, value of the truth).

    ``amplitude_error`` is the largest relative deviation from the true amplitude and
    ``phase_error`` the largest deviation of the phase, over the judged frequencies; unknown
    (``None``) if the source has not all of these.
    """
    pairs: Pairs = {}
    count = int(truth.values["judged_frequencies"] or 0)
    if count:
        errors = _errors(_head(measured.series, count), _head(truth.series, count))
        pairs = {"amplitude_error": (errors[0], 0.0), "phase_error": (errors[1], 0.0)}
    for name in ("cutoff_frequency", "judged_frequencies"):
        true = truth.values[name]
        if true is not None:
            pairs[name] = (measured.values[name], true)
    return pairs


def phase_of(response: Complex) -> Array:
    """Phase (n,) [deg] from -270 up to 90: what lags by half a turn does not jump."""
    return np.asarray(90 - (90 - np.degrees(np.angle(response))) % 360, dtype=float)


def cutoff(frequency_Hz: Array, amplitude: Array) -> float | None:
    """Frequency at which the amplitude first falls below 1/√2; ``None`` if it never does.

    Between points 1/amplitude² is a parabola of the frequency's square through three of them. Of a
    mass on a spring and a damper it is one: 1/|H|² = 1 + (4ζ² - 2)·r² + r⁴. So its cutoff is exact,
    f_n·√(1 - 2ζ² + √((1 - 2ζ²)² + 1)), however few frequencies there are.
    """
    below = np.flatnonzero(amplitude < CUTOFF)
    if len(below) == 0 or below[0] == 0:
        return None
    k = int(below[0])
    near = slice(max(k - 2, 0), max(k - 2, 0) + 3)
    square = (frequency_Hz[near] / frequency_Hz[k - 1]) ** 2
    missing = np.maximum(amplitude[near], LEAST) ** -2 - 2
    last = (frequency_Hz[k] / frequency_Hz[k - 1]) ** 2
    if last == 1:  # a base that does not follow may show one frequency twice
        return float(frequency_Hz[k])
    share = _crossing((square - 1) / (last - 1), missing, k - 1 - near.start)
    return float(frequency_Hz[k - 1] * math.sqrt(1 + share * (last - 1)))


def _crossing(x: Array, y: Array, k: int) -> float:
    """Where a parabola through all points crosses 0, between x[k] = 0 and x[k + 1] = 1.

    There y[k] <= 0 < y[k + 1], so it does once, at u of c·u² + p·u + y[k] = 0.
    """
    start, rise = float(y[k]), float(y[k + 1] - y[k])
    others = np.flatnonzero((x != 0) & (x != 1))
    c = sum(float((y[i] - start - rise * x[i]) / (x[i] * (x[i] - 1))) for i in others)
    p = rise - c
    root = math.sqrt(p**2 - 4 * c * start)
    # the form in which nothing cancels
    return (root - p) / (2 * c) if p < 0 else -2 * start / (p + root)


def _head(series: Mapping[str, Array], count: int) -> list[Array]:
    return [series[name][:count] for name in SERIES]


def _errors(ours: list[Array], truth: list[Array]) -> tuple[float | None, float | None]:
    (f, amplitude, phase), (true_f, true_amplitude, true_phase) = ours, truth
    if len(f) != len(true_f) or not np.allclose(f, true_f, rtol=1e-6, atol=0):
        return None, None
    turned = (phase - true_phase + 180) % 360 - 180
    return float(np.abs(amplitude / true_amplitude - 1).max()), float(np.abs(turned).max())
