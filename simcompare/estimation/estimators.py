"""The estimators by name: a module each, which declares what it needs.

A module of an estimator has ``estimate(given) -> Estimate`` and declares in capitals ``SIGNALS``,
what it must be given, role -> :class:`Role`, and ``TITLE``. It may declare ``OPTIONS``, name ->
:class:`Option`, ``TRUTHS``, what it is judged by, and ``STUDY``, a module that asks how well chips
tell it. A scenario names it under ``estimate:``, and says there which probe or sensor plays which
role; nothing else knows of both.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Protocol

from simcompare.errors import InputError, UnknownName
from simcompare.estimation.estimate import Estimate, Given
from simcompare.statistics.streams import stream
from simcompare.statistics.suspicions import Suspicion

#: each is a module of this room; another one is a word more
ESTIMATORS = ("speed_filter", "pose_filter", "odometry", "joint_angle")
#: larger than any place, angle or size of a scene on a table or in a garden, SI
FAR = 1e6


class Function(Protocol):
    """Tells states from signals."""

    def __call__(self, given: Given) -> Estimate:
        """The estimate.

        Raises:
            InputError: the signals, or the options, do not allow one.
        """
        ...


@dataclass(frozen=True)
class Role:
    """What one signal of an estimator is.

    Attributes:
        text: in a few words.
        unit: SI unit as pint writes it, "1" for a number.
        components: 1, or 3 for a vector.
        needed: whether there is no estimate without it.
    """

    text: str
    unit: str
    components: int = 1
    needed: bool = True


@dataclass(frozen=True)
class Option:
    """One number of an estimator; its unit is in its name.

    Attributes:
        text: in a few words.
        default: used where nothing is said; ``None``: the scenario must say it.
        least: smallest value that makes sense.
        most: largest; beyond it sums of squares lose all digits.
        bias_of: signal whose constant error it makes a state where it is 1; empty for none.
        adds_up: signal that it reads as a sum where it is 1, so that the errors of neighbouring
            differences no longer cancel; empty for none.
        u: option with its standard uncertainty, by which it is off in each draw of a simulation;
            empty where it is told as it is.
        loosens: whether a larger one lets the motion differ more from its model.
    """

    text: str
    default: float | None = None
    least: float = 0.0
    most: float = FAR
    loosens: bool = False
    bias_of: str = ""
    adds_up: str = ""
    u: str = ""


@dataclass(frozen=True)
class Estimator:
    """An estimator and what it needs.

    Attributes:
        name: of its module.
        title: a few words.
        estimate: the function.
        signals: role -> what is measured.
        truths: role -> what it is judged by.
        options: name -> number.
        study: name of the module of this room that asks how well chips tell it; empty for none.
        suspected: finds the mistake in what is given that explains why it misses the truth.
    """

    name: str
    title: str
    estimate: Function
    signals: Mapping[str, Role]
    truths: Mapping[str, Role] = field(default_factory=dict)
    options: Mapping[str, Option] = field(default_factory=dict)
    study: str = ""
    suspected: Callable[[Given], Suspicion | None] | None = None

    @property
    def loosening(self) -> tuple[str, ...]:
        """Options that let the motion differ more from its model."""
        return tuple(name for name, one in self.options.items() if one.loosens)

    def biases(self, signals: Collection[str]) -> tuple[str, ...]:
        """Options that make a constant error of one of these signals a state."""
        return tuple(name for name, one in self.options.items() if one.bias_of in signals)

    def sums(self, signals: Collection[str]) -> tuple[str, ...]:
        """Options that read one of these signals as a sum."""
        return tuple(name for name, one in self.options.items() if one.adds_up in signals)

    def as_told(self, options: Mapping[str, float], seed: int) -> dict[str, float]:
        """The options as one draw is told them: those that are known with a u only, off by it."""
        every = self.with_defaults(options)
        return every | {
            name: every[name] + every[one.u] * float(stream(seed, name).standard_normal())
            for name, one in self.options.items()
            if one.u
        }

    def with_defaults(self, options: Mapping[str, float]) -> dict[str, float]:
        """All its options, those that are not said at their defaults."""
        usual = {k: one.default for k, one in self.options.items() if one.default is not None}
        return {**usual, **options}


@cache
def load(name: str) -> Estimator:
    """The estimator of that name.

    Raises:
        UnknownName: there is none.
    """
    if name not in ESTIMATORS:
        raise UnknownName("estimator", name, ESTIMATORS)
    module = importlib.import_module(f"simcompare.estimation.{name}")
    return Estimator(
        name,
        module.TITLE,
        module.estimate,
        module.SIGNALS,
        getattr(module, "TRUTHS", {}),
        getattr(module, "OPTIONS", {}),
        getattr(module, "STUDY", ""),
        getattr(module, "suspected", None),
    )


def apply(estimator: Estimator, given: Given) -> Estimate:
    """What an estimator tells, with its options checked and those not said at their defaults.

    Raises:
        InputError: all that is missing, unknown or out of bounds, at once.
    """
    faults = [*_signal_faults(estimator, given), *option_faults(estimator, given.options).values()]
    if faults:
        raise InputError(f"estimate, {estimator.name}", faults)
    return estimator.estimate(replace(given, options=estimator.with_defaults(given.options)))


def _signal_faults(estimator: Estimator, given: Given) -> Iterator[str]:
    for role, wanted in estimator.signals.items():
        if wanted.needed and role not in given.signals:
            yield f"the signal {role} is missing: {wanted.text}"
    for role in given.signals:
        if role not in estimator.signals:
            yield str(UnknownName("signal of the estimator", role, estimator.signals))


def option_faults(estimator: Estimator, options: Mapping[str, float]) -> dict[str, str]:
    """What is wrong with its options, as option -> sentence."""
    found = {}
    for name, one in estimator.options.items():
        value = options.get(name, one.default)
        if value is None:
            found[name] = f"the option {name} is missing: {one.text}"
        elif not one.least <= value <= one.most:
            found[name] = f"{name} = {value:g} is not within {one.least:g} … {one.most:g}"
    for name in options:
        if name not in estimator.options:
            found[name] = str(UnknownName("option of the estimator", name, estimator.options))
    return found
