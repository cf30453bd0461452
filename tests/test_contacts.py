"""Contact per pair turned into values per body, and who may touch whom."""

from __future__ import annotations

import pytest

from simcompare.engine.combination import combined, per_body
from simcompare.engine.contacts import plan_contacts, touching_pairs
from simcompare.errors import Unsupported
from simcompare.model.scenario import Scenario
from simcompare.model.settings import TUNED, Settings


def plan(scene, level=TUNED):
    return plan_contacts(scene, Settings(level), {})


FACTORS = {
    "restitution": lambda scene: plan(scene).restitution_per_body("product", "toy"),
    "friction": lambda scene: plan(scene).friction_per_body("product", "toy"),
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


PAIRS = {("a", "floor"): 0.6, ("b", "floor"): 0.3, ("a", "b"): 0.2}
#: values of a, b and the floor, and what each rule makes of them
KNOWN = {"product": (0.5, 0.25, 1.0), "min": (0.6, 0.3, 1.0), "max": (0.2, 0.5, 0.1),
         "mean": (0.6, 0.2, 0.4), "root": (0.5, 0.2, 1.0), "harmonic": (0.6, 0.2, 0.4)}  # fmt: skip


@pytest.mark.parametrize("rule", KNOWN)
def test_every_rule_finds_values_where_there_are_some(rule):
    names = dict(zip(("a", "b", "floor"), KNOWN[rule], strict=True))
    wanted = {pair: combined(*(names[name] for name in pair), rule) for pair in PAIRS}
    scenario = scene(
        {"a": BALL, "b": BALL, "floor": FIXED}, [(p, 0.5, 0) for p in map(list, PAIRS)]
    )
    found = per_body(scenario, wanted, "friction", rule, "toy")
    for (first, second), value in wanted.items():
        assert combined(found[first], found[second], rule) == pytest.approx(value, abs=1e-12)


def test_the_first_rule_that_gives_all_pairs_is_taken():
    stacked = {"floor": FIXED, "low": BALL, "up": BALL}
    plain = [(["low", "floor"], 0.0, 0.5), (["up", "floor"], 0.0, 0.8), (["low", "up"], 0.0, 0.4)]
    same = [(["low", "floor"], 0.0, 0.5), (["up", "floor"], 0.0, 0.5), (["low", "up"], 0.0, 0.5)]
    for contacts, wanted in ((plain, "product"), (same, "min")):
        told = plan(scene(stacked, contacts))
        rule, values = told.by_first_rule("friction", ["product", "min"], "toy")
        assert rule == wanted
        assert combined(values["low"], values["up"], rule) == pytest.approx(contacts[2][2])
    with pytest.raises(Unsupported, match="multiplies"):
        plan(scene(stacked, same)).by_first_rule("friction", ["product"], "toy")


@pytest.mark.parametrize("rule", KNOWN)
def test_every_rule_says_where_there_are_none(rule):
    # a and b are smooth on the floor and rough on each other, and c is rough on the floor
    wanted = {("a", "floor"): 0.0, ("b", "floor"): 0.0, ("a", "b"): 0.9, ("floor", "c"): 0.9}
    bodies = {"a": BALL, "b": BALL, "c": BALL, "floor": FIXED}
    with pytest.raises(Unsupported, match="toy holds friction per body and"):
        per_body(scene(bodies, []), wanted, "friction", rule, "toy")


def test_bits_let_only_named_pairs_of_moving_bodies_touch():
    bodies = {"a": BALL, "b": BALL, "c": BALL, "d": BALL, "floor": FIXED}
    planned = plan(scene(bodies, [(["a", "b"], 0, 0), (["b", "c"], 0, 0)]))
    bits = planned.bits("toy")
    touching = {
        frozenset((one, other))
        for one, (category, mask) in bits.items()
        for other, (kind, may) in bits.items()
        if one != other and category & may and kind & mask
    }
    moving = {frozenset("ab"), frozenset("bc")}
    assert touching == moving | {frozenset((name, "floor")) for name in "abcd"}


def test_more_bodies_than_bits_are_refused():
    names = [f"b{i}" for i in range(7)]
    pairs = [([names[0], name], 0, 0) for name in names[1:]]
    planned = plan(scene({name: BALL for name in names}, pairs))
    assert len(planned.bits("toy", width=9)) == 7
    with pytest.raises(Unsupported, match="at most 6 moving bodies"):
        planned.bits("toy", width=8)


def test_by_default_nothing_is_given_and_only_jointed_bodies_are_kept_apart():
    joints = {"j": {"type": "hinge", "parent": "a", "child": "b"}}
    whole = scene({"a": BALL, "b": BALL, "c": BALL}, [(["a", "c"], 0.5, 0.1)], joints=joints)
    default, tuned = plan(whole, "default"), plan(whole)
    assert default.apart == (("a", "b"),)
    assert not default.are_given
    assert not default.restitution_per_body("product", "toy")
    assert set(tuned.apart) == {("a", "b"), ("b", "c")}
