"""The answer that a scenario declares: what it may name, and that variants inherit it."""

import pytest

from simcompare.errors import InputError
from simcompare.scenarios import catalogue, scenario_file

SCENE = """
name: slide
title: A slide
question: How far?
world: {duration_s: 1, step_s: 0.01}
bodies:
  floor: {fixed: true, shapes: [{type: plane}]}
  block:
    {mass_kg: 1, inertia_kg_m2: [1, 1, 1], position_m: [0, 0, 1],
     shapes: [{type: sphere, radius_m: 1}]}
contacts: [{pair: [block, floor], friction: 0.5}]
probes:
  way_m: {observe: block.position_m, component: 0, label: Way, unit: m}
measures:
  - {function: final, probe: way_m}
answer:
  measure: final
  within: "it slides {value}"
  outside: "it slides {value}"
  nothing: "it rests"
  causes: [{quantity: block-floor friction, says: "it rubs"}]
"""


@pytest.fixture
def read(tmp_path):
    def write(old="", new=""):
        assert old in SCENE
        (tmp_path / "slide.yaml").write_text(SCENE.replace(old, new), encoding="utf-8")
        return scenario_file.read(tmp_path / "slide.yaml")

    return write


def test_an_answer_is_read(read):
    answer = read().resolve().answer
    assert answer.measure == "final"
    assert answer.causes[0].quantity == "block-floor friction"


@pytest.mark.parametrize(
    ("old", "new", "place", "sentence"),
    [
        ("measure: final", "measure: finale", "answer.measure", "did you mean final?"),
        ("{value}\"\n  outside", "{velue}\"\n  outside", "answer.within", "did you mean value?"),
        ("{value}\"\n  outside", "{value:.1f}\"\n  outside", "answer.within", "takes no format"),
        ("{value}\"\n  outside", "{value!r}\"\n  outside", "answer.within", "takes no format"),
        ('"it rests"', '"it rests {"', "answer.nothing", "expected placeholders such as {value}"),
        ('"it rests"', '"{"', "answer.nothing", "a { or } stands alone; expected placeholders"),
        ('"it rests"', '"it goes {value}"', "answer.nothing", "takes no {value}, which is 0 here"),
        ('"it rests"', '"it goes {final}"', "answer.nothing", "takes no {final}, which is 0 here"),
        ("quantity: block-floor friction", "quantity: block-floor frict",
         "answer.causes.0.quantity", "did you mean block-floor friction"),
        ('  within: "it slides {value}"\n', "", "answer.within", "is missing"),
    ],
)  # fmt: skip
def test_what_an_answer_names_must_exist(read, old, new, place, sentence):
    with pytest.raises(InputError) as caught:
        read(old, new)
    (fault,) = caught.value.faults
    assert place in fault
    assert sentence in fault


def test_what_is_said_within_the_tolerance_is_said_outside_where_nothing_else_is(read):
    short = read('  outside: "it slides {value}"\n  nothing: "it rests"\n', "").resolve().answer
    assert short.half_sentence("outside") == "it slides {value}"
    assert short.half_sentence("nothing") is None


def test_a_scene_needs_no_answer(read):
    assert read(SCENE[SCENE.index("answer:") :], "").resolve().answer is None


def test_variants_inherit_the_answer_and_change_parts_of_it():
    base, heir = (catalogue.load(n).resolve().answer for n in ("robot", "robot_cylinder"))
    assert heir == base
    slip = catalogue.load("robot_slip").resolve().answer
    assert slip.within != base.within
    assert (slip.measure, slip.causes) == (base.measure, base.causes)
