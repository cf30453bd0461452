"""Parameters from recordings: least squares on the reference, with honest uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simcompare.errors import InputError
from simcompare.trajectory import Array
from simcompare.validation.cases import Case
from simcompare.validation.judging import noise
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
        rms: root mean square of what is left, in the unit of the leading probe.
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


@dataclass(frozen=True)
class Block:
    """The samples of one probe in one case that a fit looks at.

    Attributes:
        case: the stretch of the recording.
        probe: which quantity.
        time_s: (n,) [s].
        values: what was measured (n,).
        weight: residuals are multiplied by it; 1 where only one probe is fitted.
    """

    case: Case
    probe: str
    time_s: Array
    values: Array
    weight: float = 1.0


@dataclass(frozen=True)
class Solution:
    """A least-squares fit.

    Attributes:
        values: the parameters (k,).
        residuals: weighted, of each block.
        jacobian: of all residuals, one block after the other (n, k).
        bound: parameters that ended at a bound.
    """

    values: Array
    residuals: tuple[Array, ...]
    jacobian: Array
    bound: tuple[str, ...]


def estimate(
    model: Model,
    cases: Sequence[Case],
    probe: str | Sequence[str],
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
        probe: what is compared; several weigh by the noise of their samples.
        names: the parameters.
        nuisance: parameters that are fitted too and left out of the estimate.

    Raises:
        InputError: a parameter without bounds, or nothing that changes with a parameter.
    """
    names, wanted = (*names, *nuisance), len(names)
    blocks = blocks_of(cases, (probe,) if isinstance(probe, str) else probe)
    together = solve(model, blocks, names)
    single = {}
    if len(cases) > 1:
        for case in cases:
            own = [block for block in blocks if block.case is case]
            single[case.stream] = solve(model, own, names, together.values).values
    covariance, how = _covariance(blocks, together, single)
    leading = [
        left / block.weight
        for block, left in zip(blocks, together.residuals, strict=True)
        if block.probe == blocks[0].probe
    ]
    return Estimate(
        names[:wanted], together.values[:wanted], covariance[:wanted, :wanted],
        tuple(case.stream for case in cases),
        float(np.sqrt(np.mean(np.concatenate(leading) ** 2))), how,
        {name: values[:wanted] for name, values in single.items()}, together.bound,
    )  # fmt: skip


def blocks_of(cases: Sequence[Case], probes: Sequence[str]) -> list[Block]:
    """What is fitted; a weight is 1 over the noise of a sample where there are several probes."""
    found = []
    for case in cases:
        for probe in probes:
            seen = case.seen[probe]
            u = noise(seen)[0] if len(probes) > 1 else 1.0
            every = -(-len(seen.time_s) // MOST_SAMPLES)
            found.append(
                Block(case, probe, seen.time_s[::every], seen.values[::every], 1 / (u or 1.0))
            )
    return found


def residuals_of(model: Model, blocks: Sequence[Block], values: Mapping[str, float]) -> list[Array]:
    """Weighted reference less measurement, of each block."""
    return [
        (model.at(block.case, block.probe, values, block.time_s) - block.values) * block.weight
        for block in blocks
    ]


def _covariance(
    blocks: Sequence[Block], found: Solution, single: Mapping[str, Array]
) -> tuple[Array, str]:
    """Covariance of the estimates, and where it comes from in words."""
    count = found.jacobian.shape[1]
    if len(single) >= 3:
        scatter = np.cov(np.array(list(single.values())).T).reshape(count, count)
        how = f"scatter of {len(single)} streams fitted alone"
        return np.asarray(scatter / len(single), dtype=float), how
    size = np.linalg.norm(found.jacobian, axis=0)
    inverse = np.linalg.pinv((found.jacobian / size).T @ (found.jacobian / size))
    inverse /= np.outer(size, size)
    middle, lengths = np.zeros((count, count)), []
    for probe in dict.fromkeys(block.probe for block in blocks):
        left, rows = of_probe(blocks, found, probe)
        spread = float(left @ left) / max(len(left) - count, 1)
        lengths.append(correlation_length(left))
        middle += rows.T @ rows * spread * lengths[-1]
    covariance = np.asarray(inverse @ middle @ inverse, dtype=float)
    words = " and ".join(f"{length:.0f}" for length in lengths)
    how = f"residuals, correlated over {words} samples"
    if len(single) == 2:
        first, second = single.values()
        half = (first - second) / 2
        covariance = np.asarray(covariance + np.outer(half, half), dtype=float)
        how += ", and half the difference of two streams fitted alone"
    return covariance, how


def of_probe(blocks: Sequence[Block], found: Solution, probe: str) -> tuple[Array, Array]:
    """Residuals of one probe in all cases, and the rows of the Jacobian that belong to them."""
    ends = np.cumsum([len(left) for left in found.residuals])
    parts = [
        (left, found.jacobian[end - len(left) : end])
        for block, left, end in zip(blocks, found.residuals, ends, strict=True)
        if block.probe == probe
    ]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])


def solve(
    model: Model, blocks: Sequence[Block], names: Sequence[str], start: Array | None = None
) -> Solution:
    """Least squares of the reference on what was measured.

    Args:
        model: the scenario.
        blocks: what was measured.
        names: the parameters.
        start: where to begin; what is known of the first case, or the scenario's own values, where
            ``None``.

    Raises:
        InputError: nothing changes with a parameter.
    """
    from scipy.optimize import least_squares

    parameters = model.file.parameters
    low = np.array([parameters[name].min for name in names])
    high = np.array([parameters[name].max for name in names])
    first = [blocks[0].case.values.get(name, parameters[name].value) for name in names]
    begin = np.clip(np.array(first) if start is None else start, low, high)
    size = np.maximum(np.abs(begin), 1e-3 * (high - low))

    def parts(x: Array) -> list[Array]:
        values = np.clip(x * size, low, high).tolist()
        return residuals_of(model, blocks, dict(zip(names, values, strict=True)))

    def residuals(x: Array) -> Array:
        return np.concatenate(parts(x))

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
    return Solution(values, tuple(parts(found.x)), jacobian, bound)


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
