"""Two clocks brought together by waveforms: correlation to start, least squares to finish."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simcompare.alignment.clock_line import MIN_SPAN_S, U_SKEW_PRIOR, Alignment, from_centre
from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.statistics.agreement import rms
from simcompare.statistics.correlation import GAP, Wave, peaks, wave_of
from simcompare.statistics.noise import autocovariance, measured_noise

#: greatest number of samples that least squares look at; longer signals are thinned or averaged
_MAX_SAMPLES = 60_000
#: noise below this share of the signal's rms does not call for a smoothing spline
_SMOOTH_ABOVE = 1e-4
#: peaks of the correlation that are tried
_MAX_STARTS = 5


def by_waveform(
    t_ref: ArrayLike, y_ref: ArrayLike, t_log: ArrayLike, y_log: ArrayLike
) -> Alignment:
    """Correlation, then least squares from each of its highest peaks; the closest fit wins.

    Offset and skew are those for which the log follows the reference's cubic spline most closely.
    A noisy reference is laid through a smoothing spline first. The uncertainty is that of the
    Jacobian, with the residuals' scatter widened by √(1 + 2·Σ ρ_r·ρ_J), ρ being autocorrelations
    of residuals and Jacobian (M. S. Bartlett, J. R. Stat. Soc. 98 (1935) 536), and with the noise
    of the reference. Over less than 5 s, or where the data say less than that, s ~ N(0, 50 ppm) is
    one more observation.

    Args:
        t_ref: times of the reference [s].
        y_ref: its values; NaN where there are none.
        t_log: times of the log [s].
        y_log: its values, of the same kind.

    Raises:
        InputError: too few samples, a constant signal, or nothing in common.
    """
    reference, log = wave_of(t_ref, y_ref, "reference"), wave_of(t_log, y_log, "log")
    starts, step = peaks(reference, log)
    fit = _Fit(_thin(reference, log), _thin(log, reference))
    fits: list[Alignment] = []
    for offset_s in starts[:_MAX_STARTS]:
        try:
            fits.append(fit.finish(Alignment(offset_s, 0.0, step, U_SKEW_PRIOR, "correlation")))
        except InputError:
            continue
    if not fits:
        text = "least squares found no offset that fits; name another probe"
        raise InputError("alignment", [text])
    return _closest(fits, step)


def _closest(fits: list[Alignment], step: float) -> Alignment:
    """The fit that leaves least, and of those that leave about as little the nearest one."""
    least = min(f.residual or 0.0 for f in fits)
    good = [f for f in fits if (f.residual or 0.0) <= 1.1 * least]
    best = min(good, key=lambda f: abs(f.offset_s))
    others: list[float] = []
    for one in good:
        distinct = abs(one.offset_s - best.offset_s) > max(2 * step, 1e-9)
        if distinct and all(abs(one.offset_s - known) > step for known in others):
            others.append(one.offset_s)
    if not others:
        return best
    near = ", ".join(f"{offset_s:.4g} s" for offset_s in others[:3])
    text = (
        f"{best.text} Ambiguous: the signal repeats, and other offsets fit about as well: {near}."
        " A longer window of the recording may settle it."
    )
    return replace(best, text=text, ambiguous=True)


def _thin(wave: Wave, other: Wave) -> Wave:
    """A signal that is much faster than needed, averaged over whole numbers of samples."""
    step_s = max(wave.step_s, 0.2 * other.step_s, np.ptp(wave.time_s) / _MAX_SAMPLES)
    many = int(step_s / wave.step_s + 1e-9)
    if many < 2:
        return wave
    count = len(wave.time_s) // many * many
    time_s = wave.time_s[:count].reshape(-1, many)
    # a mean over a gap would belong to neither side
    kept = np.ptp(time_s, axis=1) <= GAP * many * wave.step_s
    values = wave.values[:count].reshape(-1, many).mean(axis=1)
    return Wave(time_s.mean(axis=1)[kept], values[kept], many * wave.step_s)


@dataclass(frozen=True)
class _Solution:
    """Where least squares ended: x = (offset at the centre, skew)."""

    x: Array
    residuals: Array
    jacobian: Array
    used: NDArray[np.bool_]


class _Fit:
    """Least squares of one log against one reference, from any number of starts."""

    def __init__(self, reference: Wave, log: Wave) -> None:
        self.reference, self.log = reference, log
        self.noise = measured_noise(reference.values).value
        self.curve = _curve(reference, self.noise)

    def finish(self, start: Alignment) -> Alignment:
        """Least squares from one start, twice, as samples enter and leave the overlap."""
        centre = self._centre(start)
        x = np.array([float(start.to_log(centre)) - centre, start.skew])
        solution = self._solve(x, centre, 0.0)
        covariance = self._covariance(solution)
        span = float(np.ptp(self.log.time_s[solution.used]))
        free = span >= MIN_SPAN_S and covariance[1, 1] <= U_SKEW_PRIOR**2
        for _ in range(2):
            weight = 0.0 if free else self._weight(solution, covariance)
            solution = self._solve(solution.x, centre, weight)
            covariance = self._covariance(solution)
        if not free:
            known = np.diag([0.0, U_SKEW_PRIOR**-2])
            covariance = np.linalg.inv(np.linalg.pinv(covariance, hermitian=True) + known)
        return self._alignment(centre, solution, covariance, free)

    def _weight(self, solution: _Solution, covariance: Array) -> float:
        """What s/u(s) weighs beside residuals: their rms, and more where they are correlated."""
        slopes = solution.jacobian[:, 1]
        return math.sqrt(float(covariance[1, 1] * (slopes @ slopes))) / U_SKEW_PRIOR

    def _centre(self, start: Alignment) -> float:
        ends = start.to_reference(self.log.time_s[[0, -1]])
        low = max(float(ends[0]), float(self.reference.time_s[0]))
        high = min(float(ends[1]), float(self.reference.time_s[-1]))
        if high <= low:
            text = "the two signals have nothing in common at the offset to start from"
            raise InputError("alignment", [text])
        return (low + high) / 2

    def _solve(self, x: Array, centre: float, weight: float) -> _Solution:
        """One run of least squares with the samples fixed that are compared."""
        from scipy.optimize import least_squares

        used = self._common(x, centre)
        if np.count_nonzero(used) < 8:
            raise InputError("alignment", ["fewer than 8 samples of the log meet the reference"])
        times, values = self.log.time_s[used], self.log.values[used]
        # unknowns of about equal weight: steps of the log, and steps at the end of its span
        step, arm = self.log.step_s, max(float(np.ptp(times)) / 2, self.log.step_s)
        unit = np.array([step, step / arm])

        def residuals(p: Array) -> Array:
            modelled, _ = self._model(p * unit, times, centre)
            return np.append((modelled - values), weight * p[1] * unit[1])

        def jacobian(p: Array) -> Array:
            _, slopes = self._model(p * unit, times, centre)
            return np.asarray(np.vstack((slopes, [0.0, weight])) * unit)

        solution = least_squares(
            residuals, x / unit, jac=jacobian, xtol=1e-10, ftol=1e-12, gtol=1e-12,
            max_nfev=60,
        )  # fmt: skip
        fitted = np.asarray(solution.x * unit)
        modelled, slopes = self._model(fitted, times, centre)
        return _Solution(fitted, modelled - values, slopes, used)

    def _model(self, x: Array, times: Array, centre: float) -> tuple[Array, Array]:
        """The log that the reference would have given, and its derivatives by the unknowns."""
        pace = 1 + x[1]
        run = (times - centre - x[0]) / pace
        values, slope = self.curve.at(centre + run), self.curve.slope_at(centre + run)
        return values, np.column_stack((-slope / pace, -slope * run / pace))

    def _common(self, x: Array, centre: float) -> NDArray[np.bool_]:
        """Samples of the log that fall between two neighbouring samples of the reference."""
        known = self.reference.time_s
        at = centre + (self.log.time_s - centre - x[0]) / (1 + x[1])
        margin = min(2 * self.log.step_s, 0.02 * float(np.ptp(known)))
        inside = (at >= known[0] + margin) & (at <= known[-1] - margin)
        after = np.clip(np.searchsorted(known, at), 1, len(known) - 1)
        # a spline across a gap is an invention
        return np.asarray(inside & (known[after] - known[after - 1] <= GAP * self.reference.step_s))

    def _covariance(self, solution: _Solution) -> Array:
        """Of offset and skew (2, 2) as the data alone tell them."""
        residuals = solution.residuals
        variance = float(residuals @ residuals) / max(1, len(residuals) - 2)
        # noise of the reference shows less in the residuals than in the offset: smoothing does not
        # help there, it only makes that noise last longer
        shared = self.noise**2 * (self.reference.step_s / self.log.step_s - self.curve.kept)
        return sandwich(solution.jacobian, residuals, variance, variance + shared)

    def _alignment(
        self, centre: float, solution: _Solution, covariance: Array, free: bool
    ) -> Alignment:
        size = rms(solution.residuals)
        parts = [f"Least squares on {len(solution.residuals)} samples leave an rms of {size:.3g}."]
        if not free:
            parts.append(
                "The signal tells less about the skew than is known of quartz clocks, so a skew of "
                "0 ± 50 ppm was assumed beside it."
            )
        alignment = Alignment(
            0.0, 0.0, 0.0, 0.0, "least squares", text=" ".join(parts), residual=size
        )
        offset, skew = solution.x.tolist()
        return from_centre(centre, offset, skew, covariance, alignment)


@dataclass(frozen=True)
class _Curve:
    """A cubic spline through a signal.

    Attributes:
        at: its values.
        slope_at: its slope.
        kept: share of the variance of white noise that is left in the values.
    """

    at: Callable[[Array], Array]
    slope_at: Callable[[Array], Array]
    kept: float


def _curve(wave: Wave, noise: float) -> _Curve:
    """A spline through all samples, or a smoothing one where the samples are noisy."""
    from scipy.interpolate import CubicSpline, make_smoothing_spline

    if noise <= _SMOOTH_ABOVE * float(np.std(wave.values)):
        curve = CubicSpline(wave.time_s, wave.values)
        first = curve.derivative()
        return _Curve(lambda t: np.asarray(curve(t)), lambda t: np.asarray(first(t)), 1.0)
    strength, kept = smoothing(wave.values)
    smooth = make_smoothing_spline(wave.time_s / wave.step_s, wave.values, lam=strength)
    slope = smooth.derivative()
    return _Curve(
        lambda t: np.asarray(smooth(t / wave.step_s)),
        lambda t: np.asarray(slope(t / wave.step_s)) / wave.step_s,
        kept,
    )


def smoothing(values: Array) -> tuple[float, float]:
    """Strength of a smoothing spline by generalised cross-validation, over cosines.

    D. Garcia, Robust smoothing of gridded data in one and higher dimensions with missing values,
    Comput. Stat. Data Anal. 54 (2010) 1167.

    Args:
        values: samples, about evenly spaced (n,).

    Returns:
        The strength λ for steps of 1, and the share of white noise's variance that is left.
    """
    from scipy.fft import dct

    n = len(values)
    power = np.asarray(dct(values - values.mean(), norm="ortho")) ** 2
    bend = (2 - 2 * np.cos(np.pi * np.arange(n) / n)) ** 2
    best, least, kept = 0.0, math.inf, 1.0
    for strength in np.geomspace(1e-5, 1e7, 61):
        passed = 1 / (1 + strength * bend)
        score = float(np.mean((1 - passed) ** 2 * power)) / (1 - float(passed.mean())) ** 2
        if score < least:
            best, least, kept = float(strength), score, float(np.mean(passed**2))
    return best, kept


def sandwich(J: Array, residuals: Array, variance: float, least: float) -> Array:
    """Covariance of least-squares estimates with residuals that are correlated in time.

    (JᵀJ)⁻¹·Σ ρ(k)·J(i)·J(i + k)ᵀ·(JᵀJ)⁻¹ times the variance, with the residuals' autocorrelation
    ρ; in no direction less than uncorrelated residuals of a least variance would give.

    Args:
        J: derivatives of the model by the unknowns (n, p).
        residuals: (n,), in order of time.
        variance: of the residuals.
        least: least variance.
    """
    n = len(residuals)
    rho = _autocorrelation(residuals)[: max(2, n // 4)]
    # what white noise shows by chance is not counted
    rho = np.where(np.abs(rho) > 2.5 / math.sqrt(n), rho, 0.0)
    basis, triangle = np.linalg.qr(J)
    size = 1 << (2 * n - 1).bit_length()
    spectra = np.fft.rfft(basis, size, axis=0)
    weight = np.zeros(size)
    weight[: len(rho)] = rho
    weight[size - len(rho) + 1 :] = rho[:0:-1]
    filtered = np.fft.irfft(spectra * np.fft.rfft(weight)[:, None], size, axis=0)[:n]
    middle = basis.T @ filtered
    values, axes = np.linalg.eigh((middle + middle.T) / 2)
    inner = (axes * np.maximum(least, variance * values)) @ axes.T
    turn = np.linalg.pinv(triangle)
    return np.asarray(turn @ inner @ turn.T)


def _autocorrelation(values: Array) -> Array:
    covariance = autocovariance(values)
    return np.asarray(covariance / covariance[0]) if covariance[0] > 0 else np.zeros(len(values))
