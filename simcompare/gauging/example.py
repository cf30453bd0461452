"""A published worked example: its source in words, and its numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeAlias

from simcompare.gauging.check import Check

#: what a formula of an example takes and gives: a number of GTC, or one value of each trial
Number: TypeAlias = Any


def _nothing() -> str:
    return ""


@dataclass(frozen=True)
class Example:
    """A worked example.

    Attributes:
        title: what it is.
        source: where its numbers are published, or who else computed them.
        checks: computes all of its numbers.
        missing: says what is not on this machine and how to get it; empty where nothing lacks.
        closed_form: whether it is of a scenario and no publication; these come last.
    """

    title: str
    source: str
    checks: Callable[[], Iterable[Check]]
    missing: Callable[[], str] = _nothing
    closed_form: bool = False
