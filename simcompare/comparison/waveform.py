"""How far one waveform is from another: bias, RMSE, greatest deviation, magnitude and phase.

All deviations are simulated minus measured, so a positive bias says that the simulation is high.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.statistics.agreement import coverage, rms

#: what NRMSE is divided by
NORMALISER = "range of the measurement"


@dataclass(frozen=True)
class Waveform:
    """Measures of the deviation simulated - measured, in the unit of the input where they have one.

    Attributes:
        n: number of samples that both have.
        masked: number of samples left out because one of the two is missing there.
        bias: mean deviation.
        rmse: root of the mean squared deviation.
        mae: mean absolute deviation.
        max_abs: greatest absolute deviation.
        at: index of the sample with the greatest deviation.
        nrmse: rmse over the range of the measurement [1]; ``None`` where that is zero.
        normaliser: what nrmse is divided by, in words.
        fit_percent: 100·(1 - |m - c|/|m - mean(m)|) [%]; ``None`` for a constant measurement.
        magnitude: Sprague-Geers magnitude error M [1]: 0 for the same energy, 0.1 for 10 % more
            amplitude in the simulation; ``None`` where the measurement is zero throughout.
        phase: Sprague-Geers phase error P [1]: 0 in phase, 1 in antiphase.
        combined: Sprague-Geers comprehensive error C = √(M² + P²) [1].
        rms_over_u: root of the mean square of deviation over standard uncertainty [1]; about 1
            where the deviation is noise alone; ``None`` without an uncertainty.
        within: share of the samples within ±2 standard uncertainties [1], or ``None``.
    """

    n: int
    masked: int
    bias: float
    rmse: float
    mae: float
    max_abs: float
    at: int
    nrmse: float | None
    normaliser: str
    fit_percent: float | None
    magnitude: float | None
    phase: float | None
    combined: float | None
    rms_over_u: float | None = None
    within: float | None = None


def waveform(measured: ArrayLike, simulated: ArrayLike, *, u: ArrayLike | None = None) -> Waveform:
    """How far the simulated waveform is from the measured one, on common instants.

    M and P: M. A. Sprague and T. L. Geers, A spectral-element method for modelling cavitation in
    transient fluid-structure interaction, Int. J. Numer. Meth. Engng 60 (2004) 2467-2499, eqs 45
    to 47, here as sums over equally weighted samples. Fit: L. Ljung, System Identification
    Toolbox, "compare" (normalised root mean square fit).

    Args:
        measured: measured values (n,); NaN where nothing was measured.
        simulated: simulated values at the same instants (n,); NaN outside of the simulation.
        u: standard uncertainty of the measured values, one number or one per sample.

    Raises:
        InputError: the lengths differ, nothing is in common, or an uncertainty is negative.
    """
    m, c = np.asarray(measured, dtype=float).ravel(), np.asarray(simulated, dtype=float).ravel()
    if len(m) != len(c):
        text = f"{len(m)} measured and {len(c)} simulated values; bring both to the same instants"
        raise InputError("waveform", [text])
    both = np.flatnonzero(np.isfinite(m) & np.isfinite(c))
    if not len(both):
        raise InputError("waveform", ["no sample has both a measured and a simulated value"])
    known, sample = m[both], c[both]
    deviation = sample - known
    rmse = rms(deviation)
    worst = int(np.argmax(np.abs(deviation)))
    span, spread = float(np.ptp(known)), rms(known - known.mean())
    magnitude, phase = _sprague_geers(known, sample)
    relative = None if u is None else _over_u(deviation, u, both, len(m))
    return Waveform(
        n=len(both),
        masked=len(m) - len(both),
        bias=float(deviation.mean()),
        rmse=rmse,
        mae=float(np.abs(deviation).mean()),
        max_abs=float(abs(deviation[worst])),
        at=int(both[worst]),
        nrmse=rmse / span if span > 0 else None,
        normaliser=NORMALISER,
        fit_percent=100 * (1 - rmse / spread) if spread > 0 else None,
        magnitude=magnitude,
        phase=phase,
        combined=None if magnitude is None or phase is None else math.hypot(magnitude, phase),
        rms_over_u=None if relative is None else rms(relative),
        within=None if relative is None else coverage(relative, 1.0),
    )


def _sprague_geers(measured: Array, simulated: Array) -> tuple[float | None, float | None]:
    size_m, size_c = rms(measured), rms(simulated)
    if size_m == 0:
        return None, None
    if size_c == 0:
        # nothing simulated: all magnitude is missing, and a phase has no meaning
        return -1.0, None
    m, c = measured / size_m, simulated / size_c
    # the angle whose cosine is mean(m·c), without the loss of half the digits near 0 and π
    angle = 2 * math.atan2(rms(c - m), rms(c + m))
    return size_c / size_m - 1, angle / math.pi


def _over_u(deviation: Array, u: ArrayLike, both: np.ndarray, total: int) -> Array | None:
    each = np.broadcast_to(np.asarray(u, dtype=float), (total,))[both]
    if np.any(each < 0):
        raise InputError("waveform", ["a standard uncertainty is negative; it must be positive"])
    if not np.all(np.isfinite(each) & (each > 0)):
        return None
    return np.asarray(deviation / each)
