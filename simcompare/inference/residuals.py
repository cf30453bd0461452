"""Least squares of a scenario's reference on what was measured: residuals and their Jacobian.

scipy's ``least_squares`` solves it. Differences are ours: the start of one segment moves no other,
so that its columns cost one segment each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.inference.reference_model import Model
from simcompare.inference.segments import Segment, noise
from simcompare.model.trajectory import Array

#: samples of one stream that a fit looks at; more would not tell more
MAX_SAMPLES = 1500
#: step of the differences, in sizes of a parameter; references are exact to 1e-9 or better
_STEP = 1e-4


@dataclass(frozen=True)
class Block:
    """The samples of one probe in one segment that a fit looks at.

    Attributes:
        segment: the segment of the recording.
        probe: which quantity.
        time_s: (n,) [s].
        values: what was measured (n,).
        weight: residuals are multiplied by it.
    """

    segment: Segment
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
        jacobian: of all residuals, one block after the other (n, k); what the starts of the
            segments would make up for is taken off.
        bound: parameters that ended at a bound.
        starts: what each segment's own start came to.
    """

    values: Array
    residuals: tuple[Array, ...]
    jacobian: Array
    bound: tuple[str, ...]
    starts: tuple[Mapping[str, float], ...] = ()


def blocks_of(segments: Sequence[Segment], probes: Sequence[str]) -> list[Block]:
    """What is fitted; a weight is 1 over the noise of a sample."""
    blocks = []
    for segment in segments:
        for probe in probes:
            observed = segment.observed[probe]
            u = noise(observed)[0]
            stride = -(-len(observed.time_s) // MAX_SAMPLES)
            blocks.append(
                Block(
                    segment,
                    probe,
                    observed.time_s[::stride],
                    observed.values[::stride],
                    1 / (u or 1.0),
                )
            )
    return blocks


def residuals_of(model: Model, blocks: Sequence[Block], values: Mapping[str, float]) -> list[Array]:
    """Weighted reference less measurement, of each block."""
    return [
        (model.at(block.segment, block.probe, values, block.time_s) - block.values) * block.weight
        for block in blocks
    ]


def of_probe(blocks: Sequence[Block], solution: Solution, probe: str) -> tuple[Array, Array]:
    """Residuals of one probe in all segments, and the rows of the Jacobian that belong to them."""
    ends = np.cumsum([len(residuals) for residuals in solution.residuals])
    parts = [
        (residuals, solution.jacobian[end - len(residuals) : end])
        for block, residuals, end in zip(blocks, solution.residuals, ends, strict=True)
        if block.probe == probe
    ]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])


def solve(
    model: Model,
    blocks: Sequence[Block],
    names: Sequence[str],
    start: Array | None = None,
    *,
    starts: Sequence[str] = (),
) -> Solution:
    """Least squares of the reference on what was measured.

    Args:
        model: the scenario.
        blocks: what was measured.
        names: the parameters.
        start: where to begin; what is known of the first segment, or the scenario's own values,
            where ``None``.
        starts: parameters that each segment has for itself, with what was read off as a prior.

    Raises:
        InputError: nothing changes with a parameter.
    """
    from scipy.optimize import least_squares

    problem = _Problem(model, tuple(blocks), tuple(names), tuple(starts))
    low, high, size = problem.low, problem.high, problem.size
    shared = problem.first[: len(names)] if start is None else start
    begin = np.clip(np.concatenate((shared, problem.first[len(names) :])), low, high)

    def residuals(x: Array) -> Array:
        return np.concatenate(problem.residuals(x * size))

    def slopes(x: Array) -> Array:
        return problem.jacobian(x * size) * size

    solution = least_squares(
        residuals, begin / size, jac=slopes, bounds=(low / size, high / size), xtol=1e-10,
        max_nfev=60,
    )  # fmt: skip
    values = np.asarray(solution.x * size, dtype=float)
    jacobian = np.asarray(solution.jac, dtype=float) / size
    shared_columns = jacobian[:, : len(names)]
    dead = [n for n, column in zip(names, shared_columns.T, strict=True) if not np.any(column)]
    if dead:
        raise InputError(
            "calibrate.parameters", [f"{name} changes nothing that was measured" for name in dead]
        )
    rest = jacobian[:, len(names) :]
    if rest.shape[1]:  # what a start makes up for tells nothing of a parameter
        scaled = rest / np.linalg.norm(rest, axis=0)
        shared_columns = shared_columns - scaled @ (np.linalg.pinv(scaled) @ shared_columns)
    count = len(names)
    near = np.minimum(values - low, high - values)[:count] <= 1e-6 * (high - low)[:count]
    bound = tuple(name for name, is_near in zip(names, near, strict=True) if is_near)
    parts = problem.residuals(values)[: len(blocks)]
    samples = sum(map(len, parts))
    return Solution(
        values[:count], tuple(parts), np.asarray(shared_columns[:samples], dtype=float), bound,
        tuple(problem.starts_at(values, number) for number in range(len(problem.segments))),
    )  # fmt: skip


@dataclass(frozen=True)
class _Problem:
    """Parameters that all segments share, and then those of the start of each segment."""

    model: Model
    blocks: tuple[Block, ...]
    names: tuple[str, ...]
    starts: tuple[str, ...]

    @property
    def segments(self) -> list[Segment]:
        segments: list[Segment] = []
        for block in self.blocks:
            if not any(block.segment is segment for segment in segments):
                segments.append(block.segment)
        return segments

    @property
    def every(self) -> list[str]:
        return [*self.names, *(name for _ in self.segments for name in self.starts)]

    @property
    def low(self) -> Array:
        return np.array([self.model.file.parameters[name].min for name in self.every])

    @property
    def high(self) -> Array:
        return np.array([self.model.file.parameters[name].max for name in self.every])

    @property
    def first(self) -> Array:
        known = self.blocks[0].segment.values
        shared = [known.get(n, self.model.file.parameters[n].value) for n in self.names]
        return np.array(
            [*shared, *(segment.values[n] for segment in self.segments for n in self.starts)]
        )

    @property
    def size(self) -> Array:
        return np.maximum(np.abs(self.first), 1e-3 * (self.high - self.low))

    def _values(self, x: Array, segment: int) -> dict[str, float]:
        at = len(self.names) + segment * len(self.starts)
        held = np.clip(x, self.low, self.high).tolist()
        of_case = dict(zip(self.starts, held[at : at + len(self.starts)], strict=True))
        return {**dict(zip(self.names, held[: len(self.names)], strict=True)), **of_case}

    def starts_at(self, x: Array, segment: int) -> dict[str, float]:
        """The start of one segment."""
        values = self._values(x, segment)
        return {name: values[name] for name in self.starts}

    def residuals(self, x: Array, only: int | None = None) -> list[Array]:
        """Those of every block, and then how far each start is from what was read off.

        Args:
            x: the numbers that are sought.
            only: number of the segment that is looked at; the blocks of the others are empty.
        """
        by_block, prior = [], []
        for number, segment in enumerate(self.segments):
            values = self._values(x, number)
            for name in self.starts:
                u = max(segment.u[name], 1e-9)
                prior.append((values[name] - segment.values[name]) / u)
        for block in self.blocks:
            number = next(i for i, segment in enumerate(self.segments) if segment is block.segment)
            if only in (None, number):
                by_block += residuals_of(self.model, [block], self._values(x, number))
            else:
                by_block.append(np.full(len(block.values), np.nan))
        return [*by_block, np.array(prior)]

    def jacobian(self, x: Array) -> Array:
        """Differences; a start is moved in its own segment alone."""
        here = np.concatenate(self.residuals(x))
        columns = []
        for k in range(len(x)):
            step = _STEP * self.size[k]
            step = step if x[k] + step <= self.high[k] else -step
            moved = x.copy()
            moved[k] += step
            past = k - len(self.names)
            only = None if past < 0 else past // len(self.starts)
            after = np.concatenate(self.residuals(moved, only))
            columns.append(np.where(np.isnan(after), 0.0, (after - here) / step))
        return np.column_stack(columns)
