"""Contact per pair turned into values per body, for engines that multiply."""

from __future__ import annotations

import pytest

from simcompare.errors import Unsupported
from simcompare.pairs import friction_per_body, restitution_per_body, touching_pairs
from simcompare.scenario import Scenario
from simcompare.settings import TUNED, Settings

FACTORS = {
    "restitution": lambda scenario: restitution_per_body(scenario, Settings(TUNED), "toy"),
    "friction": lambda scenario: friction_per_body(scenario, "toy"),
}
BALL = {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "shapes": [{"type": "sphere", "radius_m": 1}]}
FIXED = {"fixed": True, "shapes": [{"type": "plane"}]}


def scene(bodies, contacts, **more):
    return Scenario.model_validate(
        {
            "name": "toy",
            "title": "Toy",
            "question": "?",
            "world": {"duration_s": 1},
            "bodies": bodies,
            "contacts": [
                {"pair": pair, "restitution": e, "friction": mu} for pair, e, mu in contacts
            ],
            **more,
        }
    )


def test_pairs_that_can_touch():
    scenario = scene(
        {"a": BALL, "b": BALL, "floor": FIXED, "wall": FIXED, "ghost": {**BALL, "shapes": []}},
        [(["floor", "a"], 0.5, 0.1)],
        joints={"j": {"type": "hinge", "parent": "a", "child": "b"}},
    )
    found = {frozenset(c.pair): c.restitution for c in touching_pairs(scenario)}
    pairs = [{"a", "floor"}, {"a", "wall"}, {"b", "floor"}, {"b", "wall"}]
    assert set(found) == {frozenset(pair) for pair in pairs}
    assert found[frozenset({"a", "floor"})] == 0.5
    assert found[frozenset({"a", "wall"})] == 0.0


def products(scenario, prop):
    values = FACTORS[prop](scenario)
    return {
        tuple(c.pair): (values[c.pair[0]] * values[c.pair[1]], getattr(c, prop))
        for c in touching_pairs(scenario)
    }


@pytest.mark.parametrize("prop", ["restitution", "friction"])
def test_the_products_are_the_values_of_the_pairs(prop):
    scenario = scene(
        {"a": BALL, "b": BALL, "floor": FIXED},
        [(["floor", "a"], 0.8, 0.3), (["b", "floor"], 0.5, 0.2), (["a", "b"], 0.4, 0.06)],
    )
    found = products(scenario, prop)
    assert len(found) == 3
    for got, wanted in found.values():
        assert got == pytest.approx(wanted, abs=1e-12)


def test_what_no_product_gives_is_refused_with_the_pair():
    scenario = scene(
        {"a": BALL, "b": BALL, "floor": FIXED},
        [(["floor", "a"], 0.8, 0), (["b", "floor"], 0.5, 0), (["a", "b"], 0.9, 0)],
    )
    with pytest.raises(Unsupported, match=r"a-b = 0\.9"):
        FACTORS["restitution"](scenario)
    with pytest.raises(Unsupported):
        FACTORS["restitution"](
            scene({"a": BALL, "f": FIXED, "g": FIXED}, [(["a", "f"], 0.8, 0), (["a", "g"], 0.1, 0)])
        )


def test_a_body_that_touches_nothing_fixed_is_not_refused_when_values_exist():
    """Two balls in free space with e = 0.81: 0.9 each, or any pair of values with that product."""
    found = products(scene({"a": BALL, "b": BALL}, [(["a", "b"], 0.81, 0)]), "restitution")
    assert found["a", "b"][0] == pytest.approx(0.81)
