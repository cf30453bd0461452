"""Parameters from recordings: least squares on the reference, with honest uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simcompare.errors import InputError
from simcompare.trajectory import Array
from simcompare.validation.cases import Case
from simcompare.validation.model import Model

#: samples of one stream that a fit looks at; more would not tell more
MOST_SAMPLES = 1500
#: step of the differences, in sizes of a parameter; references are exact to 1e-9 or better
_STEP = 1e-4


@dataclass(frozen=True)
class Estimate:
    """Fitted parameters.

    Attributes:
        names: the parameters.
        values: estimates, in the units of their names.
        covariance: of the estimates (k, k).
        streams: which were fitted.
        rms: root mean square of what is left, in the unit of the probe.
        single: stream -> estimates of that stream alone.
        how: where the covariance comes from, in words.
        at_bound: parameters that ended at a bound.
    """

    names: tuple[str, ...]
    values: Array
    covariance: Array
    streams: tuple[str, ...]
    rms: float
    how: str
    single: Mapping[str, Array] = field(default_factory=dict)
    at_bound: tuple[str, ...] = ()

    @property
    def u(self) -> Array:
        """Standard uncertainties (k,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)), dtype=float)

    def as_dict(self) -> dict[str, float]:
        """Parameter -> estimate."""
        return dict(zip(self.names, self.values.tolist(), strict=True))


def estimate(
    model: Model,
    cases: Sequence[Case],
    probe: str,
    names: Sequence[str],
    nuisance: Sequence[str] = (),
) -> Estimate:
    """Fits parameters to all cases together, and to each one alone to see how they scatter.

    With three or more streams the covariance is that of the estimates of single streams divided by
    their number, which holds whatever correlates the residuals within a stream. With fewer it is
    s²(JᵀJ)⁻¹ times the residuals' correlation time in samples, and with two the square of half
    their difference is added: what the streams disagree by is not known better than that.

    Args:
        model: the scenario.
        cases: what is fitted.
        probe: what is compared.
        names: the parameters.
        nuisance: parameters that are fitted too and left out of the estimate.

    Raises:
        InputError: a parameter without bounds, or nothing that changes with a parameter.
    """
    names, wanted = (*names, *nuisance), len(names)
    together, residuals, jacobian, bound = _fit(model, cases, probe, names, None)
    single = {}
    if len(cases) > 1:
        for case in cases:
            single[case.stream] = _fit(model, [case], probe, names, together)[0]
    rms = float(np.sqrt(np.mean(residuals**2)))
    if len(cases) >= 3:
        scatter = np.cov(np.array(list(single.values())).T).reshape(len(names), len(names))
        covariance = np.asarray(scatter / len(cases), dtype=float)
        how = f"scatter of {len(cases)} streams fitted alone"
    else:
        spread = float(residuals @ residuals) / max(len(residuals) - len(names), 1)
        length = correlation_length(residuals)
        covariance = np.linalg.pinv(jacobian.T @ jacobian) * spread * length
        how = f"residuals, correlated over {length:.0f} samples"
        if len(cases) == 2:
            first, second = single.values()
            half = (first - second) / 2
            covariance = np.asarray(covariance + np.outer(half, half), dtype=float)
            how += ", and half the difference of two streams fitted alone"
    return Estimate(
        names[:wanted], together[:wanted], covariance[:wanted, :wanted],
        tuple(case.stream for case in cases), rms, how,
        {name: values[:wanted] for name, values in single.items()}, bound,
    )  # fmt: skip


def _fit(
    model: Model,
    cases: Sequence[Case],
    probe: str,
    names: tuple[str, ...],
    start: Array | None,
) -> tuple[Array, Array, Array, tuple[str, ...]]:
    from scipy.optimize import least_squares

    parameters = model.file.parameters
    low = np.array([parameters[name].min for name in names])
    high = np.array([parameters[name].max for name in names])
    first = [cases[0].values.get(name, parameters[name].value) for name in names]
    begin = np.clip(np.array(first) if start is None else start, low, high)
    size = np.maximum(np.abs(begin), 1e-3 * (high - low))
    thinned = [_thinned(case, probe) for case in cases]

    def residuals(x: Array) -> Array:
        values = dict(zip(names, np.clip(x * size, low, high).tolist(), strict=True))
        parts = [
            model.at(case, probe, values, times) - seen
            for case, (times, seen) in zip(cases, thinned, strict=True)
        ]
        return np.concatenate(parts)

    def slopes(x: Array) -> Array:
        here = residuals(x)
        columns = []
        for k in range(len(x)):
            step = _STEP if x[k] + _STEP <= high[k] / size[k] else -_STEP
            moved = x.copy()
            moved[k] += step
            columns.append((residuals(moved) - here) / step)
        return np.column_stack(columns)

    found = least_squares(
        residuals, begin / size, jac=slopes, bounds=(low / size, high / size), xtol=1e-10,
        max_nfev=60,
    )  # fmt: skip
    jacobian = np.asarray(found.jac, dtype=float) / size
    dead = [n for n, column in zip(names, jacobian.T, strict=True) if not np.any(column)]
    if dead:
        raise InputError(
            "calibrate.parameters", [f"{name} changes nothing that was measured" for name in dead]
        )
    values = np.asarray(found.x * size, dtype=float)
    near = np.minimum(values - low, high - values) <= 1e-6 * (high - low)
    bound = tuple(name for name, is_near in zip(names, near, strict=True) if is_near)
    return values, np.asarray(found.fun, dtype=float), jacobian, bound


def _thinned(case: Case, probe: str) -> tuple[Array, Array]:
    seen = case.seen[probe]
    every = -(-len(seen.time_s) // MOST_SAMPLES)
    return seen.time_s[::every], seen.values[::every]


def correlation_length(residuals: Array) -> float:
    """Integrated autocorrelation of residuals in samples, at least 1.

    1 + 2·Σρ_k up to the first lag at which ρ is below 0 (initial positive sequence).
    """
    centred = residuals - residuals.mean()
    size = len(centred)
    spectrum = np.abs(np.fft.rfft(centred, 2 * size)) ** 2
    correlation = np.fft.irfft(spectrum)[: size // 2]
    if correlation[0] <= 0:
        return 1.0
    rho = correlation / correlation[0]
    negative = np.flatnonzero(rho < 0)
    end = int(negative[0]) if len(negative) else len(rho)
    return max(1.0, float(1 + 2 * rho[1:end].sum()))
