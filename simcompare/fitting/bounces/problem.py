"""One fit put together: drops, model, unknowns, priors and bounds become weighted residuals."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from simcompare.errors import InputError
from simcompare.fitting.bounces import bounce_models, enough
from simcompare.fitting.bounces.bounce_models import DEFAULTS, Bounces, Model
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.unknowns import (
    BOUNDS,
    OF_A_DROP,
    OF_THE_RECORDING,
    SCALE,
    SIZES,
    SPEED,
    base,
    faults,
    internal,
    own_drop,
    slope,
)
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_forms import Prior

#: uncertainties of times [s] and of heights [m], where none is stated, until the scatter tells
U_ASSUMED_S, U_ASSUMED_M = 1e-3, 1e-3


@dataclass(frozen=True)
class Block:
    """Measured numbers of one kind of one drop.

    Attributes:
        kind: "times", "intervals", "heights" or "track".
        drop: number of the drop.
        data: (n,).
        whiten: multiplies residuals to unit variance: one number each (n,), or a matrix (n, n).
    """

    kind: str
    drop: int
    data: Array
    whiten: Array


@dataclass(frozen=True)
class Problem:
    """What a fit minimises.

    Attributes:
        model: which.
        drops: the measurements.
        names: unknowns; those of one of several drops end with its number, "drop_height_m[2]".
        fixed: what is not fitted, by name.
        priors: by name of the unknown.
        blocks: measured numbers.
        u_known: whether the measurements' uncertainties are stated; else the scatter tells.
    """

    model: Model
    drops: tuple[Impacts, ...]
    names: tuple[str, ...]
    fixed: Mapping[str, float]
    priors: Mapping[str, Prior]
    blocks: tuple[Block, ...] = field(repr=False)
    u_known: bool = True

    @property
    def data(self) -> Array:
        """All measured numbers (n,)."""
        return np.concatenate([block.data for block in self.blocks])

    @property
    def low(self) -> Array:
        """Lower bounds of the internal numbers (p,)."""
        return np.array([min(_both(name, BOUNDS[base(name)])) for name in self.names])

    @property
    def high(self) -> Array:
        """Upper bounds of the internal numbers (p,)."""
        return np.array([max(_both(name, BOUNDS[base(name)])) for name in self.names])

    @property
    def size(self) -> Array:
        """Usual sizes (p,)."""
        return np.array([SIZES[base(name)] for name in self.names])

    @property
    def prior_rows(self) -> tuple[Array, Array, Array]:
        """Index, mean and standard uncertainty of the priors on the internal numbers."""
        index, mean, u = [], [], []
        for name, prior in self.priors.items():
            index.append(self.names.index(name))
            mean.append(internal(name, prior.value))
            u.append(prior.u * abs(slope(name, prior.value)))
        return np.array(index, dtype=int), np.array(mean), np.array(u)

    @property
    def firm(self) -> Problem:
        """The same with those priors alone that are held to be as sure as the data.

        Those of the place and the recorder, and those that nobody stated: what is assumed of these
        counts like one more measured number, where a prior that the user states may contradict.
        """
        kept = {n: p for n, p in self.priors.items() if p.reason or base(n) in OF_THE_RECORDING}
        return replace(self, priors=kept)

    @property
    def freedom(self) -> int:
        """Measured numbers and priors less unknowns."""
        return len(self.data) + len(self.priors) - len(self.names)

    def values(self, x: Array, drop: int) -> dict[str, Array | float]:
        """Parameters of one drop for sets of internal numbers (…, p)."""
        found: dict[str, Array | float] = {**DEFAULTS, **self.fixed}
        for k, name in enumerate(self.names):
            if own_drop(name) in (None, drop):
                found["drag_k" if base(name) == SPEED else base(name)] = x[..., k]
        return found

    def bounces(self, x: Array, drop: int, count: int) -> Bounces:
        """So many bounces of one drop for sets of internal numbers (…, p)."""
        return bounce_models.bounces(self.model, self.values(x, drop), count)

    def predicted(self, x: Array) -> Array:
        """What would be measured (…, n)."""
        parts = []
        for number, impacts in enumerate(self.drops):
            values = self.values(x, number)
            found = bounce_models.bounces(self.model, values, impacts.count)
            for block in self.blocks:
                if block.drop == number:
                    parts.append(observed_in(block, impacts, found, values, x.shape[:-1]))
        return np.concatenate(parts, axis=-1)

    def residuals(self, x: Array, data: Array | None = None, mean: Array | None = None) -> Array:
        """Whitened residuals, those of the priors last (…, n + m).

        Args:
            x: internal numbers (…, p).
            data: other data than the measured ones, (n,) or (B, n).
            mean: other means of the priors (m,) or (B, m).
        """
        residual = (self.data if data is None else data) - self.predicted(x)
        parts, at = [], 0
        for block in self.blocks:
            part = residual[..., at : at + len(block.data)]
            at += len(block.data)
            matrix = block.whiten.ndim == 2
            parts.append(part @ block.whiten.T if matrix else part * block.whiten)
        index, centre, u = self.prior_rows
        if len(index):
            parts.append(((centre if mean is None else mean) - x[..., index]) / u)
        return np.concatenate(parts, axis=-1)

    def noise(self, generator: np.random.Generator, draws: int) -> Array:
        """Draws of the measurement errors (draws, n)."""
        parts = []
        for block in self.blocks:
            white = generator.standard_normal((draws, len(block.data)))
            if block.whiten.ndim == 2:
                parts.append(np.linalg.solve(block.whiten, white.T).T)
            else:
                parts.append(white / block.whiten)
        return np.concatenate(parts, axis=-1)

    def widened(self, factor: float) -> Problem:
        """The same with all measurement uncertainties multiplied."""
        blocks = tuple(replace(block, whiten=block.whiten / factor) for block in self.blocks)
        return replace(self, blocks=blocks)


def build(
    drops: Sequence[Impacts],
    model: Model,
    *,
    unknowns: Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    priors: Mapping[str, Prior] | None = None,
) -> Problem:
    """Checks what was asked and puts it together.

    Args:
        drops: the measurements, one for each drop of the ball.
        model: which.
        unknowns: what is fitted; by default all of the model, and height and release of each
            drop. What a prior tells of the place and the recorder is fitted beside it.
        fixed: values of what is not fitted.
        priors: what is known of unknowns; a name without a number holds for every drop.

    Raises:
        InputError: every fault of the request.
    """
    fixed, priors = dict(fixed or {}), dict(priors or {})
    drops = [enough.without_exact(drop, fixed) for drop in drops]
    chosen = [SPEED if n == "terminal_speed" else n for n in unknowns or usual(drops, model)]
    if unknowns is None:
        chosen = [name for name in chosen if name not in fixed]
    found = faults(chosen, fixed, priors)
    sought = [n for name in chosen for n in _numbered(name, drops)]
    names = [*sought, *_of_the_recording(drops, priors, {*fixed, *sought})]
    blocks = [b for k, drop in enumerate(drops) for b in _blocks(drop, k)]
    known = all(drop.u_known for drop in drops)
    rows = sum(len(block.data) for block in blocks)
    spread_priors = {n: p for name, p in priors.items() for n in _numbered(name, drops)}
    spread_priors = {n: p for n, p in spread_priors.items() if n in names}
    stated = sum(name in sought for name in spread_priors)
    if not found:
        found += enough.faults(drops, sought, rows, stated, known=known)
    if found:
        raise InputError("fit", found)
    return Problem(model, tuple(drops), tuple(names), fixed, spread_priors, tuple(blocks), known)


def _both(name: str, bounds: tuple[float, float]) -> tuple[float, float]:
    return internal(name, bounds[0]), internal(name, bounds[1])


def usual(drops: Sequence[Impacts], model: Model) -> list[str]:
    """What a fit seeks where nothing is said: the model, and where and when each drop began."""
    return [*model.own, *(n for n in OF_A_DROP if any(_is_told(n, drop) for drop in drops))]


def _of_the_recording(
    drops: Sequence[Impacts], priors: Mapping[str, Prior], taken: Collection[str]
) -> list[str]:
    """What priors tell of the place and the recorder; only a video has a scale."""
    filmed = any(drop.track is not None for drop in drops)
    return [
        name for name in OF_THE_RECORDING
        if name in priors and name not in taken and (name != SCALE or filmed)
    ]  # fmt: skip


def _is_told(name: str, drop: Impacts) -> bool:
    """Whether a drop tells an unknown of its own: intervals and heights know no clock."""
    if name == "floor_m":
        return drop.track is not None
    return name != "release_time_s" or bool(len(drop.times_s)) or drop.track is not None


def _numbered(name: str, drops: Sequence[Impacts]) -> list[str]:
    if len(drops) == 1 or name not in OF_A_DROP:
        return [name]
    return [f"{name}[{k + 1}]" for k, drop in enumerate(drops) if _is_told(name, drop)]


def _blocks(drop: Impacts, number: int) -> list[Block]:
    """Measured numbers of one drop; a track stands for the times and heights drawn from it."""
    blocks = []
    if drop.track is not None:
        u = np.where(np.isfinite(drop.track.u_m), drop.track.u_m, U_ASSUMED_M)
        return [Block("track", number, drop.track.height_m, 1 / u)]
    if len(drop.times_s):
        covariance = drop.covariance(U_ASSUMED_S)
        if drop.covariance_s2 is not None:
            blocks.append(Block("times", number, drop.times_s, _whitening(covariance)))
        else:
            blocks.append(Block("times", number, drop.times_s, 1 / np.sqrt(np.diag(covariance))))
    if len(drop.intervals_s):
        u = np.where(np.isfinite(drop.u_intervals_s), drop.u_intervals_s, U_ASSUMED_S)
        blocks.append(Block("intervals", number, drop.intervals_s, 1 / u))
    if len(drop.heights_m):
        u = np.where(np.isfinite(drop.u_heights_m), drop.u_heights_m, U_ASSUMED_M)
        blocks.append(Block("heights", number, drop.heights_m, 1 / u))
    return blocks


def _whitening(covariance: Array) -> Array:
    """Inverse of the Cholesky factor."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance)))


def observed_in(
    block: Block,
    impacts: Impacts,
    found: Bounces,
    values: Mapping[str, Array | float],
    shape: tuple[int, ...],
) -> Array:
    """What bounces look like in the measured numbers of a block, for parameter sets of a shape."""
    if block.kind == "track":
        assert impacts.track is not None
        track = impacts.track
        part = bounce_models.height_at(found, values, track.time_s, track.flight)
    elif block.kind == "heights":
        part = found.apex_m[..., np.array(impacts.height_numbers)]
    elif block.kind == "intervals":
        at = np.array(impacts.interval_numbers)
        part = found.impact_s[..., at] - found.impact_s[..., at - 1]
    else:
        part = found.impact_s[..., np.array(impacts.numbers) - 1]
    return np.broadcast_to(part, (*shape, len(block.data)))
