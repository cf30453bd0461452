"""Parameters from recordings: least squares on the reference, with honest uncertainty."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simcompare.inference.reference_model import Model
from simcompare.inference.residuals import Block, Solution, blocks_of, of_probe, residuals_of, solve
from simcompare.inference.segments import Segment
from simcompare.model.trajectory import Array
from simcompare.statistics.agreement import rms
from simcompare.statistics.noise import correlation_length

#: part of its standard uncertainty by which what was known is moved
_SMALL = 0.01


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
        follows: parameter that was known -> how far each estimate moves when that moves by its
            standard uncertainty: a fit makes up for much of what is not known.
    """

    names: tuple[str, ...]
    values: Array
    covariance: Array
    streams: tuple[str, ...]
    rms: float
    how: str
    single: Mapping[str, Array] = field(default_factory=dict)
    at_bound: tuple[str, ...] = ()
    follows: Mapping[str, Array] = field(default_factory=dict)

    @property
    def u(self) -> Array:
        """Standard uncertainties (k,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)), dtype=float)

    def as_dict(self) -> dict[str, float]:
        """Parameter -> estimate."""
        return dict(zip(self.names, self.values.tolist(), strict=True))


def estimate(
    model: Model,
    segments: Sequence[Segment],
    probe: str | Sequence[str],
    names: Sequence[str],
    nuisance: Sequence[str] = (),
    *,
    starts: Sequence[str] = (),
    known: Mapping[str, float] | None = None,
) -> Estimate:
    """Fits parameters to all segments together, and to each one alone to see how they scatter.

    The covariance is s²(JᵀJ)⁻¹ times the residuals' correlation time in samples. What single
    streams differ by is added: of three or more their covariance divided by their number, of two
    the square of half their difference.

    Args:
        model: the scenario.
        segments: what is fitted.
        probe: what is compared; several weigh by the noise of their samples.
        names: the parameters.
        nuisance: parameters that are fitted too and left out of the estimate.
        starts: parameters that each segment has for itself; they were read off with the standard
            uncertainties of the segment, and may move within these.
        known: standard uncertainties of parameters that are not fitted.

    Raises:
        InputError: a parameter without bounds, or nothing that changes with a parameter.
    """
    names, count = (*names, *nuisance), len(names)
    blocks = blocks_of(segments, (probe,) if isinstance(probe, str) else probe)
    together = solve(model, blocks, names, starts=starts)
    single = {}
    if len(segments) > 1:
        for segment in segments:
            blocks_of_case = [block for block in blocks if block.segment is segment]
            single[segment.stream] = solve(
                model, blocks_of_case, names, together.values, starts=starts
            ).values
    covariance, how = _covariance(blocks, together, single)
    leading = [
        residuals / block.weight
        for block, residuals in zip(blocks, together.residuals, strict=True)
        if block.probe == blocks[0].probe
    ]
    return Estimate(
        names[:count], together.values[:count], covariance[:count, :count],
        tuple(segment.stream for segment in segments),
        rms(np.concatenate(leading)), how,
        {name: values[:count] for name, values in single.items()}, together.bound,
        {n: moved[:count] for n, moved in _follows(model, blocks, names, together, known or {})},
    )  # fmt: skip


def _follows(
    model: Model, blocks: Sequence[Block], names: Sequence[str], solution: Solution,
    known: Mapping[str, float],
) -> Iterator[tuple[str, Array]]:  # fmt: skip
    """-J⁺·∂r/∂k·u_k for every parameter k that was known (implicit function theorem)."""
    values = dict(zip(names, solution.values.tolist(), strict=True))
    here = np.concatenate(residuals_of(model, blocks, values)) if known else np.zeros(0)
    inverse = np.linalg.pinv(solution.jacobian)
    for name, u in known.items():
        before = blocks[0].segment.values[name]
        step = _SMALL * u  # a whole one would not be straight
        step = step if before + step <= model.file.parameters[name].max else -step
        moved = residuals_of(model, blocks, {**values, name: before + step})
        yield name, np.asarray(-inverse @ (np.concatenate(moved) - here) * (u / step), dtype=float)


def _covariance(
    blocks: Sequence[Block], solution: Solution, single: Mapping[str, Array]
) -> tuple[Array, str]:
    """Covariance of the estimates, and where it comes from in words."""
    count = solution.jacobian.shape[1]
    size = np.linalg.norm(solution.jacobian, axis=0)
    inverse = np.linalg.pinv((solution.jacobian / size).T @ (solution.jacobian / size))
    inverse /= np.outer(size, size)
    middle, lengths = np.zeros((count, count)), []
    for probe in dict.fromkeys(block.probe for block in blocks):
        residuals, rows = of_probe(blocks, solution, probe)
        spread = float(residuals @ residuals) / max(len(residuals) - count, 1)
        lengths.append(correlation_length(residuals))
        middle += rows.T @ rows * spread * lengths[-1]
    covariance = np.asarray(inverse @ middle @ inverse, dtype=float)
    words = " and ".join(f"{length:.0f}" for length in lengths)
    how = f"residuals, correlated over {words} samples"
    if len(single) >= 3:
        scatter = np.cov(np.array(list(single.values())).T).reshape(count, count)
        covariance = np.asarray(covariance + scatter / len(single), dtype=float)
        how += f", and the scatter of {len(single)} streams fitted alone"
    if len(single) == 2:
        first, second = single.values()
        half = (first - second) / 2
        covariance = np.asarray(covariance + np.outer(half, half), dtype=float)
        how += ", and half the difference of two streams fitted alone"
    return covariance, how
