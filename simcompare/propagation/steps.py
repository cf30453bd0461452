"""How far an input is moved to see what the result does (JCGM 100:2008, 5.1.3, note 2)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from simcompare.propagation.inputs import Known
from simcompare.scenarios.scenario_file import Parameter
from simcompare.statistics.budget import u_of

#: smaller relative steps read how the time steps fall, and not the input
_LEAST = 3e-3


class Ends(NamedTuple):
    """Two values of an input, its estimate between them or at one of them."""

    low: float
    high: float


Steps = Mapping[str, Ends]


def steps_of(known: Known, parameter: Parameter) -> Ends:
    """The estimate ± u, or ± a little more, within what the parameter may be."""
    center = known.distribution.center
    step = max(u_of(known.distribution), _LEAST * abs(center))
    return Ends(max(center - step, parameter.min), min(center + step, parameter.max))
