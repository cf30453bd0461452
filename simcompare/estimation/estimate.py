"""WHAT is estimated: signals in, states with their uncertainty out, beside the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.measures.heading import wrapped
from simcompare.model.trajectory import Array


@dataclass(frozen=True, eq=False)
class Signal:
    """One quantity over time, as a sensor gave it or as it truly was.

    Attributes:
        time_s: (n,), increasing [s].
        values: (n,), or (n, k) of several components; NaN where nothing was measured.
        u: standard uncertainty of one sample by noise, one number or one a component; ``None``
            where it is not known.
    """

    time_s: Array
    values: Array
    u: float | Array | None = None

    def at(self, time_s: Array) -> Array:
        """Values at other times, on straight lines between samples; NaN beyond the ends."""
        rows = self.values.reshape(len(self.values), -1).T
        found = [np.interp(time_s, self.time_s, row, left=np.nan, right=np.nan) for row in rows]
        return np.array(found).T.reshape(len(time_s), *self.values.shape[1:])


@dataclass(frozen=True, eq=False)
class Given:
    """What an estimator is given.

    Attributes:
        signals: role -> what was measured.
        truth: role -> what is true; empty where nobody knows.
        options: its numbers.
        seed: for estimators that draw.
    """

    signals: Mapping[str, Signal]
    truth: Mapping[str, Signal] = field(default_factory=dict)
    options: Mapping[str, float] = field(default_factory=dict)
    seed: int = 0

    def signal(self, role: str) -> Signal:
        """What was measured in a role.

        Raises:
            InputError: nothing was.
        """
        if role not in self.signals:
            have = ", ".join(self.signals) or "none"
            raise InputError("estimate", [f"the signal {role} is missing (there are: {have})"])
        return self.signals[role]

    def truth_at(self, role: str, time_s: Array) -> Array | None:
        """What was true at these times (n,); ``None`` where nobody knows."""
        return self.truth[role].at(time_s) if role in self.truth else None


@dataclass(frozen=True, eq=False)
class State:
    """One state over time, as one way of estimating tells it.

    Attributes:
        values: (n,).
        u: standard uncertainty (n,), ``None`` where that way states none.
        truth: (n,), NaN where it is not known; ``None`` where nobody knows.
        circular: whether it is an angle, whose error lies within ±π.
    """

    values: Array
    u: Array | None = None
    truth: Array | None = None
    circular: bool = False

    @property
    def error(self) -> Array | None:
        """Estimate less truth (n,)."""
        if self.truth is None:
            return None
        error = self.values - self.truth
        return wrapped(error) if self.circular else error

    @property
    def rms_error(self) -> float | None:
        """Root of the mean squared error, ``None`` where the truth is not known."""
        error = self.error
        known = None if error is None else error[np.isfinite(error)]
        return None if known is None or not len(known) else float(np.sqrt(np.mean(known**2)))


@dataclass(frozen=True, eq=False)
class Way:
    """One way of telling the states, such as the filter or the wheel alone.

    Attributes:
        name: a few words, for legends and tables.
        time_s: (n,) [s].
        states: name, with its unit -> values.
    """

    name: str
    time_s: Array
    states: Mapping[str, State]

    @property
    def last(self) -> dict[str, Number]:
        """The states at the end as key numbers."""
        found = {}
        for name, one in self.states.items():
            u = None if one.u is None else float(one.u[-1])
            found[f"last_{name}"] = Number(float(one.values[-1]), units.unit_of(name), u)
        return found


@dataclass(frozen=True)
class Number:
    """One number that an estimator found.

    Attributes:
        value: SI.
        unit: as pint writes it.
        u: standard uncertainty, ``None`` where none is stated.
    """

    value: float
    unit: str
    u: float | None = None


@dataclass(frozen=True, eq=False)
class Innovations:
    """What the consistency of a filter is judged by.

    Attributes:
        nis: normalised innovation squared (n,), NaN where nothing was read.
        used: readings that it is made of (n,).
        whitened: reading -> innovations in units of their uncertainty, without gaps.
        refused: reading -> how many the gate kept out.
        nees: normalised error squared (n,); ``None`` where the truth is not known.
        states: degrees of freedom of the NEES.
        counted: readings that are differences of counts, whose errors cancel.
    """

    nis: Array
    used: Array
    whitened: Mapping[str, Array]
    refused: Mapping[str, int] = field(default_factory=dict)
    nees: Array | None = None
    states: int = 0
    counted: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Estimate:
    """What an estimator tells.

    Attributes:
        ways: ways of telling the states; the first one is the estimator's own answer.
        labels: state -> what it is, for axes and tables; the one that leads first.
        innovations: of a filter; ``None`` for an estimator that has none.
        numbers: name -> key number.
        notes: what the reader must know.
    """

    ways: tuple[Way, ...]
    labels: Mapping[str, str]
    innovations: Innovations | None = None
    numbers: Mapping[str, Number] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def best(self) -> Way:
        """The estimator's own answer."""
        return self.ways[0]
