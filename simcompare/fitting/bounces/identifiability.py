"""What the data can tell and what they cannot, in plain words.

The Jacobian of the data's residuals, without priors and with columns of length one, has as many
singular values as there are unknowns. Their ratio says how much worse the worst combination of
unknowns is known than the best one; the last singular vector names that combination.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.unknowns import SPEED, base, shown, slope
from simcompare.model.trajectory import Array
from simcompare.statistics import least_squares
from simcompare.statistics.least_squares import covariance_of

#: condition above which a combination of unknowns is practically unidentifiable
WEAK = 500.0
#: condition above which nothing at all tells a combination
BLIND = 1e7
#: correlation that is told
CORRELATED = 0.95
#: share of a direction below which an unknown is not named in it
_SHARE = 0.15
_TITLES = {
    "restitution": "restitution", "exponent": "velocity exponent", SPEED: "terminal speed",
    "drop_height_m": "drop height", "release_time_s": "release time", "clock_skew": "clock skew",
    "floor_m": "floor level", "scale": "length scale",
}  # fmt: skip
_UNITS = {SPEED: " m/s", "drop_height_m": " m", "release_time_s": " s", "floor_m": " m"}


@dataclass(frozen=True)
class Direction:
    """A combination of unknowns and how far it may move.

    Attributes:
        singular_value: of the Jacobian with columns of length one.
        moves: unknown -> by how much it changes when the data change by one standard deviation.
        weak: whether the data practically do not determine it.
    """

    singular_value: float
    moves: dict[str, float]
    weak: bool


@dataclass(frozen=True)
class Identifiability:
    """How well the data alone, and with priors, determine the unknowns.

    Attributes:
        names: the unknowns.
        singular_values: largest first (p,).
        condition: largest over smallest.
        u_data: standard uncertainties from the data alone (p,).
        u: standard uncertainties with the priors (p,).
        correlation: from the data alone (p, p).
        directions: one for each singular value.
        words: what a reader must know, one sentence each.
    """

    names: tuple[str, ...]
    singular_values: Array
    condition: float
    u_data: Array
    u: Array
    correlation: Array
    directions: tuple[Direction, ...]
    words: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "names": list(self.names),
            "singular_values": self.singular_values.tolist(),
            "condition": self.condition if np.isfinite(self.condition) else None,
            "u_data": [float(v) if np.isfinite(v) else None for v in self.u_data],
            "u": [float(v) if np.isfinite(v) else None for v in self.u],
            "correlation": self.correlation.tolist(),
            "directions": [
                {"singular_value": d.singular_value, "moves": d.moves, "weak": d.weak}
                for d in self.directions
            ],
            "words": list(self.words),
        }


@dataclass(frozen=True)
class Language:
    """How unknowns are called, and what would help where they cannot be told apart.

    Attributes:
        title: unknown -> its name in a sentence.
        unit: unknown -> its unit after a number, with a space before it.
        advise: names of unknowns that the data do not separate -> what would.
    """

    title: Callable[[str], str]
    unit: Callable[[str], str]
    advise: Callable[[set[str]], str]


def identifiability(fit: Fit) -> Identifiability:
    """What the data of a fit can tell about its unknowns."""
    problem = fit.problem
    jacobian = least_squares.jacobian_of(
        lambda x: problem.residuals(x, priors=False), fit.x[None, :], problem.size
    )[0] / problem.size  # fmt: skip
    language = Language(
        _title, lambda name: _UNITS.get(base(name), ""), lambda names: _advice(fit, names)
    )
    found = of_jacobian(fit.names, jacobian, language, slopes=_slopes(fit), u=fit.u)
    for k, name in enumerate(fit.names):
        helped = problem.priors.get(name)
        if helped is not None and fit.u[k] > 0.9 * helped.u:
            more = f"{_title(name)} is known from its prior alone; the data add nothing"
            found = replace(found, words=(*found.words, more))
    return found


def of_jacobian(
    names: Sequence[str],
    jacobian: Array,
    language: Language,
    *,
    slopes: Array | None = None,
    u: Array | None = None,
) -> Identifiability:
    """What data can tell about unknowns, from how they change with them.

    Args:
        names: the unknowns.
        jacobian: of the residuals over their standard uncertainty (n, p).
        language: how the unknowns are called.
        slopes: derivatives of the unknowns as shown to those of the Jacobian (p,); 1 where
            ``None``.
        u: standard uncertainties with all that is known (p,); those of the data where ``None``.
    """
    slopes = np.ones(len(names)) if slopes is None else slopes
    length = np.linalg.norm(jacobian, axis=0)
    length = np.where(length > 0, length, 1e-150)
    _, values, vectors = np.linalg.svd(jacobian / length, full_matrices=False)
    missing = len(names) - len(values)  # fewer data than unknowns
    values = np.concatenate((values, np.zeros(missing)))
    vectors = np.linalg.svd(jacobian / length)[2] if missing else vectors
    condition = float(values[0] / values[-1]) if values[-1] > 0 else np.inf
    covariance = covariance_of(jacobian) * np.outer(slopes, slopes)
    u_data = np.sqrt(np.diag(covariance))
    directions = tuple(
        _direction(names, s, v / length * slopes, u_data, values[0])
        for s, v in zip(values, vectors, strict=True)
    )
    correlation = covariance / np.outer(u_data, u_data)
    words = _words(names, directions, condition, correlation, language)
    return Identifiability(
        tuple(names), values, condition, u_data, u_data if u is None else u, correlation,
        directions, tuple(words),
    )  # fmt: skip


def _slopes(fit: Fit) -> Array:
    """Derivatives of the unknowns to the sought numbers; at no drag those of 1/v_t² itself."""
    return np.array([
        1 / slope(name, float(value)) if np.isfinite(value) else -1.0
        for name, value in zip(fit.names, shown_values(fit), strict=True)
    ])  # fmt: skip


def shown_values(fit: Fit) -> list[float]:
    """Estimates as the reader sees them."""
    return [float(shown(name, x)) for name, x in zip(fit.names, fit.x, strict=True)]


def _direction(
    names: Sequence[str], value: float, along: Array, u: Array, largest: float
) -> Direction:
    moves = along / max(value, 1e-12)
    lead = int(np.argmax(np.abs(moves) / u))
    moves = moves * np.sign(moves[lead])
    named = np.abs(moves) / u > _SHARE
    found = {n: float(m) for n, m, k in zip(names, moves, named, strict=True) if k}
    return Direction(float(value), found, bool(largest > WEAK * value))


def _words(
    names: Sequence[str],
    directions: tuple[Direction, ...],
    condition: float,
    rho: Array,
    language: Language,
) -> list[str]:
    weak = [d for d in directions if d.weak]
    if not weak:
        said = [f"all unknowns are determined by the data (condition {condition:.0f})"]
    else:
        said = [_weak(d, directions[0].singular_value, language) for d in weak]
    pairs = [
        (abs(rho[i, j]), i, j)
        for i in range(len(names))
        for j in range(i)
        if abs(rho[i, j]) > CORRELATED
    ]
    for size, i, j in sorted(pairs, reverse=True)[:4]:
        a, b = language.title(names[j]), language.title(names[i])
        said.append(
            f"{a} and {b} are correlated by {np.sign(rho[i, j]) * size:+.3f}: an error of one is"
            " made up for by the other, so neither should be quoted without it"
        )
    return said


def _weak(direction: Direction, largest: float, language: Language) -> str:
    """One combination that the data do not determine, and what would help."""
    kinds = {base(name) for name in direction.moves}
    moves = ", ".join(
        f"{language.title(name)} {move:+.2g}{language.unit(name)}"
        for name, move in direction.moves.items()
    )
    advice = language.advise(kinds)
    if largest > BLIND * direction.singular_value:
        names = ", ".join(language.title(name) for name in direction.moves)
        return f"nothing in the data tells {names} apart: {advice}"
    return (
        f"{advice}. Changing {moves} together moves the data by one standard"
        f" deviation only (condition {largest / direction.singular_value:.0f})"
    )


def _advice(fit: Fit, kinds: set[str]) -> str:
    what = "video" if any(drop.track for drop in fit.problem.drops) else "sound"
    if {SPEED, "exponent"} <= kinds:
        return (f"{what} cannot separate drag from velocity dependence: give the terminal speed"
                " (√(2·m·g/(ρ·c_d·A)) from mass and diameter) as a prior")  # fmt: skip
    if "clock_skew" in kinds:
        return "a fast clock looks like a weaker gravity or a lower drop: give the clock's skew"
    if "scale" in kinds:
        return "a length scale looks like another gravity or drop height: measure a length in it"
    names = " and ".join(_TITLES[kind] for kind in sorted(kinds))
    return f"{what} cannot separate {names}: fix one of them or give a prior"


def _title(name: str) -> str:
    head, _, rest = name.partition("[")
    return _TITLES[head] + (f" of drop {rest[:-1]}" if rest else "")
