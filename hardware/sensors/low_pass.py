"""Butterworth low-pass of a sensor, exact between samples: for the signal, and for white noise.

The filter is that of continuous time, so a bandwidth may reach up to half of the rate, where the
usual bilinear filters fail. The signal is taken as straight between its samples. White noise of a
one-sided density n leaves it with the standard deviation n·√B, where the noise bandwidth B is
f·π/2 for one pole and f·1.1107, 1.0472, 1.0262 for two to four (f: the bandwidth at -3 dB).

Sampled noise keeps both: its density n at low frequencies and n·√B, where B is half of the rate at
most. A chip filters in digital form before it gives a reading, so nothing folds back from above.
"""

from __future__ import annotations

import math

import numpy as np

from simcompare.model.trajectory import Array

#: bandwidth times sample interval, in radians, below which the bilinear filter is the same to 1e-4,
#: while the exact one of several poles loses digits
_SLOW = 0.01
#: noise bandwidth, part of the rate, above which sampled noise is white
_WHITE = 0.4995
#: bandwidth, part of the rate, by which the sampled noise of any number of poles is white
_WIDEST = 3.0


def noise_bandwidth(bandwidth_Hz: float, poles: int, rate_Hz: float = math.inf) -> float:
    """Width of the ideal filter that lets the same white noise through [Hz].

    Args:
        bandwidth_Hz: -3 dB of the filter; infinite where nothing is smoothed.
        poles: 1 to 4.
        rate_Hz: samples in a second, which show no more than half of it; infinite: not sampled.
    """
    share = math.pi / (2 * poles)
    return min(bandwidth_Hz * share / math.sin(share), rate_Hz / 2)


def _folded(part: float, poles: int) -> float:
    """Power at 0 Hz once the filter's output is sampled and folds: Σ 1/(1 + (j/part)^(2·poles))."""
    # the sum over all whole j, by its residues
    at = math.pi * part * np.exp(1j * math.pi * (np.arange(poles) + 0.5) / poles)
    return float(np.real(np.mean(at / np.tan(at))))


def smoothed(values: Array, step_s: float, bandwidth_Hz: float, poles: int) -> Array:
    """Evenly spaced samples (n, …) after the filter, which was at rest at the first one.

    Args:
        values: the signal, straight between its samples.
        step_s: time between them [s].
        bandwidth_Hz: -3 dB of the filter; infinite: nothing is changed.
        poles: 1 to 4.
    """
    if math.isinf(bandwidth_Hz) or len(values) < 2:
        return values
    from scipy import signal

    turn = 2 * math.pi * bandwidth_Hz * step_s  # time in units of 1/ω
    if poles > 1 and turn < _SLOW:
        pairs = signal.butter(poles, turn / math.pi, output="sos")
        at_rest = signal.sosfilt_zi(pairs).reshape(*pairs.shape[:1], 2, *[1] * (values.ndim - 1))
        return np.asarray(signal.sosfilt(pairs, values, axis=0, zi=at_rest * values[:1])[0])
    num, den = signal.butter(poles, 1.0, analog=True)
    rows, a, _ = signal.cont2discrete((num, den), turn, method="foh")
    b = rows.ravel()
    rest = signal.lfilter_zi(b, a).reshape(-1, *[1] * (values.ndim - 1))
    out, _ = signal.lfilter(b, a, values, axis=0, zi=rest * values[:1])
    return np.asarray(out, dtype=float)


def noise_filter(step_s: float, bandwidth_Hz: float, poles: int) -> tuple[Array, Array]:
    """Numerator b and denominator a that make sampled white noise what leaves the filter.

    Noise of standard deviation n·√(f/2) at the rate f goes in, noise of n·√B comes out, with the
    density n at low frequencies and the correlation of a continuous filter.
    """
    if noise_bandwidth(bandwidth_Hz, poles) * step_s > _WHITE:
        return np.ones(1), np.ones(1)
    part = _sampled_part(bandwidth_Hz * step_s, poles)
    turn = 2 * math.pi * part
    if poles == 1:
        return np.array([-math.expm1(-turn)]), np.array([1.0, -math.exp(-turn)])
    if turn < _SLOW:
        from scipy import signal

        b, a = signal.butter(poles, turn / math.pi)
        return np.asarray(b, dtype=float), np.asarray(a, dtype=float)
    b, a = _sampled_noise(turn, poles)
    return b / math.sqrt(_folded(part, poles)), a


def _sampled_part(part: float, poles: int) -> float:
    """Bandwidth, part of the rate, whose noise is that of ``part`` once nothing folds back."""
    from scipy import optimize

    def less(wider: float) -> float:
        return wider / _folded(wider, poles) - part

    return float(optimize.brentq(less, part, _WIDEST, xtol=1e-15))


def _sampled_noise(turn: float, poles: int) -> tuple[Array, Array]:
    """The filter in discrete time with the same autocovariance, by spectral factorisation."""
    from scipy import linalg, signal

    num, den = signal.butter(poles, 1.0, analog=True)
    A, B, C, _ = signal.tf2ss(num, den)
    step = linalg.expm(A * turn)
    spread = linalg.solve_continuous_lyapunov(A, -B @ B.T)
    a = np.poly(step)
    added = spread - step @ spread @ step.T  # covariance that one step adds
    rows, row = [], C * 0.0
    for i in range(poles):  # a(z)·y as a moving sum of what each step adds
        row = row @ step + a[i] * C
        rows.append(row)
    moving = [
        sum(float((rows[i] @ added @ rows[i + j].T).item()) for i in range(poles - j))
        for j in range(poles)
    ]
    zeros = np.roots([*moving[:0:-1], *moving])
    b = np.atleast_1d(np.poly(zeros[np.abs(zeros) < 1]))
    # in units of what goes in: intensity 1 of continuous noise is 1/turn of a sample
    return np.real(b * math.sqrt(moving[0] / float(np.sum(b**2)) * turn)), np.real(a)


def through(white: Array, b: Array, a: Array, first: Array) -> Array:
    """Rows of white noise (…, n) after a filter that has been running for ever.

    Args:
        white: standard normal numbers.
        b: numerator.
        a: denominator.
        first: standard normal numbers (…, p) that make its state, p the number of poles.
    """
    if len(a) == 1:
        return np.asarray(white * b[0], dtype=float)
    from scipy import signal

    state = first @ _state_root(b, a).T
    return np.asarray(signal.lfilter(b, a, white, axis=-1, zi=state)[0], dtype=float)


def _state_root(b: Array, a: Array) -> Array:
    """Square root of the covariance of the states of a filter whose input is white."""
    from scipy import linalg

    poles = len(a) - 1
    if poles == 1:
        taken = b[1] if len(b) > 1 else 0.0
        return np.array([[abs(taken - a[1] * b[0]) / math.sqrt(1 - a[1] ** 2)]])
    whole = np.zeros(poles + 1)
    whole[: len(b)] = b
    shift = np.eye(poles, k=1)
    shift[:, 0] = -a[1:]
    gain = (whole[1:] - a[1:] * whole[0])[:, None]
    covariance = linalg.solve_discrete_lyapunov(shift, gain @ gain.T)
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.clip(values, 0.0, None)), dtype=float)
