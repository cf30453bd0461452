"""Closed form of the bouncing ball: times of impacts, and a table-tennis ball in air."""

from __future__ import annotations

import math
from collections.abc import Iterator

from simcompare.gauging import scenario_values
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.scenarios.ball import reference

_IMPACTS_S = ("0.451600756", "1.17416196", "1.75221093", "2.21465011", "2.58460145", "2.88056252")
_DRAG = {"drag_coefficient": 0.47, "air_density_kg_m3": 1.2}


def _checks() -> Iterator[Check]:
    flights = reference.flights(scenario_values.of("ball"), 10.0)
    for k, (exact, flight) in enumerate(zip(_IMPACTS_S, flights, strict=False)):
        yield Check(f"impact {k + 1} (s)", exact, flight.end_s)
    yield Check("comes to rest (s)", "4.0644068", flights[-1].end_s)
    drag = scenario_values.of("ball", **_DRAG)
    first, second = reference.flights(drag, 1.0)[:2]
    terminal = reference.terminal_speed(drag)
    yield Check("in air: terminal speed (m/s)", "8.64395971", terminal)
    yield Check("in air: first impact (s)", "0.461541198", first.end_s)
    speed = terminal * math.tanh(drag["gravity_m_s2"] * first.end_s / terminal)
    yield Check("in air: speed there (m/s)", "4.15334598", speed)
    yield Check("in air: first apex (m)", "0.524996931", second.apex_m)


EXAMPLE = Example(
    "Bouncing ball: 1 m, restitution 0.8, in vacuum and in air",
    "Newton's restitution, √(2h/g)·(1 + 2·(e + e² + …)), and quadratic drag (Timmerman and van der"
    " Weele, Am. J. Phys. 67, 1999); computed with mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
