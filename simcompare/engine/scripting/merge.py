"""Two traces of one scene become one, whose numbers follow the phase."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from simcompare.engine.scripting.trace import Assign, Attribute, Call, Event, Result
from simcompare.errors import Unsupported


@dataclass(frozen=True)
class Varying:
    """A number that follows the phase: ``first`` at 0, ``last`` at 1."""

    first: float
    last: float


def merged(first: Sequence[Event], last: Sequence[Event]) -> list[Event]:
    """One trace out of two of the same scene at both ends of the phase.

    Raises:
        Unsupported: the two scenes are not made by the same calls.
    """
    if len(first) != len(last):
        raise Unsupported("the scene is made by other calls at the other end of the phase")
    known: dict[int, Call] = {}
    found: list[Event] = []
    for a, b in zip(first, last, strict=True):
        if isinstance(a, Assign) and isinstance(b, Assign) and a.attribute == b.attribute:
            value = _both(a.value, b.value, known)
            idle = a.idle and b.idle
            found.append(Assign(_both(a.owner, b.owner, known), a.attribute, value, idle))
        elif isinstance(a, Call) and isinstance(b, Call):
            args = tuple(_both(x, y, known) for x, y in zip(a.args, b.args, strict=True))
            kwargs = {key: _both(a.kwargs[key], b.kwargs[key], known) for key in a.kwargs}
            call = Call(_both(a.target, b.target, known), args, kwargs, a.pure, a.idle and b.idle)
            known[id(a)] = call
            found.append(call)
        else:
            raise Unsupported("the scene is made by other calls at the other end of the phase")
    return found


def _both(a: Any, b: Any, known: Mapping[int, Call]) -> Any:  # noqa: ANN401
    if isinstance(a, Result):
        return Result(known[id(a.call)], a.index)
    if isinstance(a, Attribute):
        return Attribute(_both(a.owner, b.owner, known), a.name)
    if isinstance(a, float) and isinstance(b, float | int) and a != b:
        return Varying(a, float(b))
    if isinstance(a, np.ndarray) and not np.array_equal(a, b):
        return _both(a.tolist(), b.tolist(), known)
    if isinstance(a, tuple | list) and len(a) == len(b):
        members = [_both(x, y, known) for x, y in zip(a, b, strict=True)]
        return members if isinstance(a, list) else tuple(members)
    return a
