"""95 % intervals of what is told of a bounce, held against drops of known truth.

Every drop has another ball, height and clock, and nobody tells the law. In one family it is a
power of the speed or constant, with and without drag; in the others the restitution falls with
the speed or with its logarithm. Instants have a stated uncertainty, intervals have none. For speed,
drops of one length are minimised side by side; what is made of the minima is made as in every fit.
"""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.fitting.bounces import initial_guess, likelihood, model_selection
from simcompare.fitting.bounces.averaging import averaged
from simcompare.fitting.bounces.bounce_models import MODELS, bounces, restitution_at
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.problem import build

#: impacts of a drop, and the standard uncertainty of their instants [s]
COUNTS = range(5, 13)
U_S = np.geomspace(5e-6, 1e-3, len(COUNTS))
#: 95 % are promised: of 200 such intervals fewer than 91 %, or more than 99 %, hold the truth in
#: one of a hundred sets
LOW, HIGH = 0.91, 0.99


def truth(family, count, generator):
    """Parameters of a drop that bounces that often."""
    values = {
        "drop_height_m": generator.uniform(0.2, 2.0), "restitution": generator.uniform(0.5, 0.95),
        "release_time_s": generator.uniform(0.1, 1.0), "exponent": 0.0,
        "terminal_speed_m_s": generator.choice([math.inf, generator.uniform(5.0, 40.0)]),
    }  # fmt: skip
    if family == "linear":  # up to 0.03 for each m/s
        values["exponent"] = generator.uniform(0.0, 0.12 / values["restitution"])
    elif family == "logarithmic" or generator.random() < 0.5:
        values["exponent"] = generator.uniform(0.0, 0.12)
    exact = bounces(MODELS[family], values, count)
    rolls = np.diff(exact.impact_s).min() < 0.02 or exact.restitution.max() > 0.995
    return truth(family, count, generator) if rolls else values


def minima(drops):
    """Fits of every model to drops of one length and one uncertainty: (model, drop) -> fit."""
    found = {}
    for model in MODELS.values():
        try:
            problems = [build([drop], model) for drop in drops]
        except InputError:
            continue  # too few impacts
        starts = np.stack([initial_guess.of(problem) for problem in problems])
        data = np.stack([problem.data for problem in problems])
        best = likelihood.minimise(problems[0], starts, data)
        for i, problem in enumerate(problems):
            one = {name: getattr(best, name)[i : i + 1] for name in vars(best)}
            s2 = float(best.chi2[i]) / problem.freedom if problem.freedom else 1.0
            s2 = max(1.0, s2) if problem.u_known else s2
            spread = likelihood.spread(problem, s2, problem.freedom)
            one["jacobian"] = one["jacobian"] / spread
            scaled = problem.widened(spread)
            found[model.name, i] = likelihood.summary(
                problem, scaled, replace(best, **one), s2, problem.freedom
            )
    return found


def told(family, values, choice):
    """Quantity -> its 95 % interval, and the truth."""
    found = averaged(choice)
    for name, speed in zip(("slowest", "fastest"), choice.best.speeds_m_s, strict=True):
        exact = float(restitution_at(MODELS[family], values, np.array(speed)))
        yield name, found.restitution_at(speed)[2:], exact
    for name in choice.best.names:
        row = found.unknown(name)
        yield name, (row.low, row.high), values[name]


def stated(values, family, count, generator):
    """Instants of that many impacts, whose uncertainty grows with their number."""
    u_s = np.full(count, U_S[count - COUNTS[0]])
    exact = bounces(MODELS[family], values, count).impact_s
    return Impacts(exact + generator.normal(0, u_s), u_s, (*range(1, count + 1),))


def unstated(values, family, count, generator):
    """Intervals whose errors of 0.03 to 1 ms nobody states."""
    exact = np.diff(bounces(MODELS[family], values, count + 1).impact_s)
    error = generator.normal(0, np.exp(generator.uniform(*np.log((3e-5, 1e-3)))), count)
    return Impacts(
        intervals_s=exact + error, u_intervals_s=np.full(count, math.nan),
        interval_numbers=(*range(1, count + 1),),
    )  # fmt: skip


@functools.cache
def covered(recorded, families):
    """Quantity -> whether each interval holds the truth."""
    generator = np.random.default_rng(17)
    hits = {}
    for count in COUNTS:
        kinds = [families[i % len(families)] for i in range(200 // len(COUNTS))]
        # an interval needs an impact at both its ends
        values = [truth(kind, count + 1, generator) for kind in kinds]
        drops = [recorded(v, k, count, generator) for k, v in zip(kinds, values, strict=True)]
        found = minima(drops)
        for i, drop in enumerate(drops):
            choice = choice_of(drop, {m: fit for (m, k), fit in found.items() if k == i})
            for name, (low, high), exact in told(kinds[i], values[i], choice):
                hits.setdefault(name, []).append(low <= exact <= high)
    return hits


def choice_of(drop, fits):
    """The choice among laws that were fitted already."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(model_selection, "fit", lambda _, name, **__: fits[name])
        return model_selection.compare(drop, tuple(fits))


OURS, OTHERS = ("power",), ("linear", "logarithmic")
CASES = pytest.mark.parametrize(
    ("recorded", "families"),
    [(stated, OURS), (stated, OTHERS), (unstated, (*OURS, *OTHERS))],
    ids=["ours", "others", "unstated"],
)


@CASES
@pytest.mark.parametrize("name", ["fastest", "slowest", "restitution", "drop_height_m"])
def test_95_percent_intervals_hold_the_truth_in_95_percent(recorded, families, name):
    hits = covered(recorded, families)[name]
    assert len(hits) == 200
    assert LOW <= np.mean(hits) <= HIGH


@pytest.mark.parametrize("families", [OURS, OTHERS], ids=["ours", "others"])
def test_95_percent_intervals_of_the_release_hold_it(families):
    hits = covered(stated, families)["release_time_s"]
    assert len(hits) == 200
    assert LOW <= np.mean(hits) <= HIGH


@CASES
@pytest.mark.parametrize("name", ["terminal_speed_m_s", "exponent"])
def test_what_is_told_where_a_law_has_it_holds_the_truth(recorded, families, name):
    hits = covered(recorded, families)[name]
    # told in a part of the drops only: two standard deviations of 50 draws are 6.2 %
    assert len(hits) > 50
    assert np.mean(hits) > 0.93 - 0.062
