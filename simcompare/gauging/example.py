"""A worked example: the source of its reference numbers in words, and these numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeAlias

from simcompare.gauging.check import Check, Kind

#: what a formula of an example takes and gives: a number of GTC, or one value of each trial
Number: TypeAlias = Any


def _nothing() -> str:
    return ""


@dataclass(frozen=True)
class Example:
    """A worked example.

    Attributes:
        title: what it is.
        source: where its numbers were read, or the formula or method that gives all their digits.
        checks: computes all of its numbers.
        missing: says what is not on this machine and how to get it; empty where nothing lacks.
        kind: of the references that do not say another one.
        closed_form: whether it belongs to a scenario and no publication; these come last.
    """

    title: str
    source: str
    checks: Callable[[], Iterable[Check]]
    missing: Callable[[], str] = _nothing
    kind: Kind = "published"
    closed_form: bool = False
