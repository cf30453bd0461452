"""What fit.json says of a fit by tosses, from what was found."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from simcompare.engine.assist import ALL, NONE
from simcompare.engine.helps import known
from simcompare.fitting.bounces.engine_fit import contact_rows
from simcompare.fitting.tosses.engines import EngineTosses, How
from simcompare.fitting.tosses.roles import TossRoles
from simcompare.fitting.tosses.search import estimates, interval
from simcompare.fitting.tosses.setup import Setup
from simcompare.fitting.tosses.tosses import Errors, Toss, samples_in_flight
from simcompare.model.scenario import Scenario
from simcompare.results.records.fit_engines import RunWith
from simcompare.results.records.fit_tosses import (
    TossErrors,
    TossFit,
    TossRange,
    TossSource,
    TriedPoint,
)


def of_fit(
    roles: TossRoles,
    setup: Setup,
    engines: Sequence[EngineTosses],
    given: Mapping[str, float],
    how: How,
    scene: Scenario,
) -> TossFit:
    """The whole record of a fit, but for its sentences.

    Args:
        roles: the scenario.
        setup: what was fitted and predicted.
        engines: what was found for each.
        given: parameters of the scenario that were set.
        how: how engines were run.
        scene: one of the scenes.
    """
    sources = tuple(_source(one, how.contact) for one in engines)
    return TossFit(
        contact=how.contact,
        assist=ALL if how.helps is None else known(how.helps) or NONE,
        scenario=roles.file.name,
        settings=given,
        unknowns=tuple(setup.grids),
        width_m=roles.width_m({}),
        fitted=tuple(toss.name for toss in setup.fitted),
        held_out=tuple(toss.name for toss in setup.held),
        scale=setup.scale,
        witnesses=setup.witnesses,
        told=setup.told,
        sources=sources,
        valid=_valid(roles, setup, scene),
        run_with=RunWith(
            closed={},
            engines={
                source.name: {name: own.value for name, own in source.parameters.items()}
                for source in sources if source.parameters
            },
        ),
    )  # fmt: skip


def _source(one: EngineTosses, contact: str) -> TossSource:
    outcome, search = one.outcome, one.search
    row = TossSource(
        name=one.engine, version=outcome.facts.version, contact=contact, status=outcome.status,
        reason=outcome.reason, simulations=one.simulations, wall_s=one.wall_s,
    )  # fmt: skip
    if not one.is_ok:
        return row
    parameters = estimates(search)
    costs = [(point, search.cost(point)) for point in search.tried]
    return replace(
        row,
        parameters=parameters,
        cost=search.cost(search.best),
        identifiable=not any(own.open for own in parameters.values()),
        holdout=_held(one.held),
        tried=tuple(
            TriedPoint(search.values(p), c if math.isfinite(c) else None) for p, c in costs
        ),
        native=() if outcome.trajectory is None else contact_rows(outcome.trajectory),
    )


def _held(errors: Sequence[Errors]) -> TossErrors | None:
    if not errors:
        return None
    positions = tuple(one.position for one in errors)
    rotations = tuple(one.rotation for one in errors)
    return TossErrors(interval(positions), interval(rotations), positions, rotations)


def _valid(roles: TossRoles, setup: Setup, scene: Scenario) -> TossRange:
    speeds = [_speed_m_s(toss, roles.width_m({})) for toss in setup.fitted]
    longest_s = max(float(toss.time_s[-1]) for toss in setup.fitted)
    world = scene.world
    return TossRange(world.step_s, world.engine_step_s, longest_s, (min(speeds), max(speeds)))


def _speed_m_s(toss: Toss, width_m: float) -> float:
    """Speed of the centre before the first touch."""
    last = min(max(samples_in_flight(toss, width_m), 2), len(toss.time_s)) - 1
    way = toss.position_m[last] - toss.position_m[last - 1]
    return float(np.linalg.norm(way) / (toss.time_s[last] - toss.time_s[last - 1]))
