"""The Kalman filter: what is believed of a state, moved with the motion and mended by measurements.

A belief is a mean x and a covariance P. Between measurements it moves,

    x ← F·x        P ← F·P·Fᵀ + Q

and a measurement z = H·x + noise of covariance R mends it. What z says beyond what was expected is
the innovation y = z - H·x, of covariance S = H·P·Hᵀ + R; the gain K = P·Hᵀ·S⁻¹ weighs it:

    x ← x + K·y    P ← (I - K·H)·P·(I - K·H)ᵀ + K·R·Kᵀ

That last line is Joseph's form. The short one, P ← (I - K·H)·P, is the same for this gain alone:
with any other one, or with rounding, it can turn a variance negative. Joseph's never does.
In the extended filter F and H are the derivatives of what the motion and the sensors really do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.model.trajectory import Array

#: a covariance whose condition number is larger is singular to the digits of a computer
_MAX_CONDITION = 1e14


@dataclass(frozen=True, eq=False)
class Belief:
    """What is believed of a state.

    Attributes:
        mean: x (n,).
        covariance: P (n, n).
    """

    mean: Array
    covariance: Array


@dataclass(frozen=True, eq=False)
class Motion:
    """How the mean moved in one step, and what that step leaves open.

    Attributes:
        mean: where it is afterwards (n,).
        transition: F (n, n), its derivative after the mean before.
        noise: Q (n, n).
    """

    mean: Array
    transition: Array
    noise: Array


@dataclass(frozen=True, eq=False)
class Expected:
    """What the sensors should read in a state.

    Attributes:
        values: (m,).
        observation: H (m, n), their derivative after the state.
        noise: R (m, m).
    """

    values: Array
    observation: Array
    noise: Array


@dataclass(frozen=True, eq=False)
class Filtered:
    """Everything that a filter went through; n instants, k states, m readings.

    Attributes:
        predicted_means: before each measurement (n, k).
        predicted_covariances: (n, k, k).
        means: after it (n, k).
        covariances: (n, k, k).
        transitions: F of the step to each instant (n, k, k); that to the first is not used.
        innovations: (n, m), NaN where nothing was read or a reading was refused.
        innovation_u: their standard uncertainties (n, m).
        nis: yᵀ·S⁻¹·y of what was used (n,), NaN where nothing was.
        used: how many readings that were (n,).
        refused: readings that the gate kept out (n, m).
    """

    predicted_means: Array
    predicted_covariances: Array
    means: Array
    covariances: Array
    transitions: Array
    innovations: Array
    innovation_u: Array
    nis: Array
    used: Array
    refused: Array

    @property
    def uncertainties(self) -> Array:
        """Standard uncertainties of the states (n, k)."""
        return np.sqrt(np.diagonal(self.covariances, axis1=1, axis2=2))


@dataclass(frozen=True, eq=False)
class Mended:
    """A belief after a measurement, with the innovation y, its covariance S and the NIS."""

    belief: Belief
    innovation: Array
    covariance: Array
    nis: float


def predict(belief: Belief, motion: Motion) -> Belief:
    """The belief after a step: P ← F·P·Fᵀ + Q."""
    moved = motion.transition @ belief.covariance @ motion.transition.T + motion.noise
    return Belief(motion.mean, moved)


def update(belief: Belief, measured: Array, expected: Expected) -> Mended:
    """The belief after a measurement z (m,).

    Raises:
        InputError: the covariance of the innovation is singular.
    """
    innovation = measured - expected.values
    covariance = innovation_covariance(belief, expected)
    _refuse_singular(covariance, "innovations")
    gain = np.asarray(
        np.linalg.solve(covariance, expected.observation @ belief.covariance).T, dtype=float
    )
    mean = belief.mean + gain @ innovation
    nis = float(innovation @ np.linalg.solve(covariance, innovation))
    return Mended(Belief(mean, joseph(belief, gain, expected)), innovation, covariance, nis)


def innovation_covariance(belief: Belief, expected: Expected) -> Array:
    """S = H·P·Hᵀ + R."""
    h = expected.observation
    return np.asarray(h @ belief.covariance @ h.T + expected.noise)


def joseph(belief: Belief, gain: Array, expected: Expected) -> Array:
    """Covariance after a measurement that was weighed with any gain, right or wrong."""
    kept = np.eye(len(belief.mean)) - gain @ expected.observation
    return np.asarray(kept @ belief.covariance @ kept.T + gain @ expected.noise @ gain.T)


def run(
    start: Belief,
    measured: Array,
    move: Callable[[Array, int], Motion],
    expect: Callable[[Array, int], Expected],
    *,
    gate: float | None = None,
    after_refusal: Callable[[Belief, Array, Array], Belief] | None = None,
) -> Filtered:
    """Filters a whole series; the start is the belief at its first instant.

    Args:
        start: belief before the first measurement.
        measured: readings (n, m), NaN where there is none.
        move: the motion from the instant before to one of a number, ``move(mean, number)``.
        expect: what is read there, ``expect(mean, number)``.
        gate: a reading whose innovation is larger than this many of its standard uncertainties
            is refused; none where ``None``.
        after_refusal: what a refused reading undoes of the belief, ``after_refusal(belief, reading,
            refused)``.

    Raises:
        InputError: a covariance that is singular, or a state that is no number any more.
    """
    _refuse_singular(start.covariance, "start")
    steps = []
    belief, motion = start, Motion(start.mean, np.eye(len(start.mean)), 0 * start.covariance)
    for number, reading in enumerate(measured):
        if number:
            motion = move(belief.mean, number)
            belief = predict(belief, motion)
        step = _step(belief, motion, reading, expect(belief.mean, number), gate)
        if after_refusal is not None and step.refused.any():
            step = replace(step, after=after_refusal(step.after, reading, step.refused))
        steps.append(step)
        belief = step.after
        if not np.all(np.isfinite(belief.mean)):
            text = f"the filter has diverged: its state is no number from measurement {number + 1}"
            cure = "expected shorter steps, or a model that is nearer to the motion"
            raise InputError("filter", [f"{text} on; {cure}"])
    return _gathered(steps)


@dataclass(frozen=True, eq=False)
class _Step:
    before: Belief
    after: Belief
    transition: Array
    innovation: Array
    u: Array
    nis: float
    used: int
    refused: Array


def _step(
    belief: Belief, motion: Motion, reading: Array, expected: Expected, gate: float | None
) -> _Step:
    """One measurement, or as much of it as there is and as passes the gate."""
    u = np.sqrt(np.diag(innovation_covariance(belief, expected)))
    there = np.isfinite(reading)
    refused = np.zeros(len(reading), dtype=bool)
    if gate is not None:
        refused = there & (np.abs(reading - expected.values) > gate * u)
    part = np.flatnonzero(there & ~refused)
    innovation = np.full(len(reading), np.nan)
    if not len(part):
        return _Step(belief, belief, motion.transition, innovation, u, np.nan, 0, refused)
    mended = update(belief, reading[part], _part_of(expected, part))
    innovation[part] = mended.innovation
    return _Step(
        belief, mended.belief, motion.transition, innovation, u, mended.nis, len(part), refused
    )


def _part_of(expected: Expected, part: NDArray[np.intp]) -> Expected:
    """Only some of the readings."""
    noise = expected.noise[np.ix_(part, part)]
    return Expected(expected.values[part], expected.observation[part], noise)


def _gathered(steps: Sequence[_Step]) -> Filtered:
    return Filtered(
        predicted_means=np.array([one.before.mean for one in steps]),
        predicted_covariances=np.array([one.before.covariance for one in steps]),
        means=np.array([one.after.mean for one in steps]),
        covariances=np.array([one.after.covariance for one in steps]),
        transitions=np.array([one.transition for one in steps]),
        innovations=np.array([one.innovation for one in steps]),
        innovation_u=np.array([one.u for one in steps]),
        nis=np.array([one.nis for one in steps]),
        used=np.array([one.used for one in steps]),
        refused=np.array([one.refused for one in steps]),
    )


def _refuse_singular(covariance: Array, whose: str) -> None:
    """Ends where a covariance could not be inverted, or is none."""
    scale = np.sqrt(np.abs(np.diag(covariance)))
    # parts in units of their own uncertainty, so that metres and radians do not matter
    with np.errstate(all="ignore"):
        parts = covariance / np.outer(scale, scale)
    if np.all(np.isfinite(parts)):
        values = np.linalg.eigvalsh(parts)
        if values[0] > 0 and values[-1] / values[0] < _MAX_CONDITION:
            return
    raise InputError(
        "filter",
        [
            f"the covariance of the {whose} is singular: its standard uncertainties are"
            f" {', '.join(f'{u:.3g}' for u in scale)}; expected each above 0, and no quantity that"
            " another one tells exactly"
        ],
    )
