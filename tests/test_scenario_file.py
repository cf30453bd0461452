"""Scenario files: every fault at once, each with its line, its place and what was found."""

from __future__ import annotations

import json
import re

import pytest
import yaml

from simcompare.errors import InputError, UnknownName
from simcompare.scenarios import catalogue, schema
from simcompare.scenarios.scenario_file import SCHEMA_PATH, read

TOY = """\
name: toy
title: Toy
question: Does it move?
parameters:
  height_m: {value: 1.0, min: 0, max: 2, text: "A height."}
  restitution: {value: 0.5, min: 0, max: 1, text: "A ratio."}
presets:
  high: {text: "A high one.", set: {height_m: 2}}
world: {duration_s: 1, step_s: 0.01}
bodies:
  ball:
    mass_kg: 1
    inertia_kg_m2: [1, 1, 1]
    position_m: [0, 0, "${height_m}"]
"""


@pytest.fixture
def toy(write):
    """Reads the toy file after a change of its text."""

    def load(old: str = "", new: str = "", text: str = TOY):
        assert old in text
        return read(write("toy.yaml", text.replace(old, new, 1)))

    return load


@pytest.fixture
def fault(toy):
    """The message for a changed toy file."""

    def message(old: str = "", new: str = "", text: str = TOY) -> str:
        with pytest.raises(InputError) as error:
            toy(old, new, text)
        assert "toy.yaml" in str(error.value)
        return str(error.value)

    return message


def test_a_file_gives_a_scenario_with_its_numbers(toy):
    scenario = toy().resolve({"height_m": 1.5})
    assert scenario.bodies["ball"].position_m == (0.0, 0.0, 1.5)
    assert scenario.parameters == {"height_m": 1.5, "restitution": 0.5}


def test_values_win_over_the_preset_and_the_preset_over_the_file(toy):
    file = toy()
    assert file.resolve(preset="high").parameters["height_m"] == 2.0
    assert file.resolve({"height_m": 0.5}, preset="high").parameters["height_m"] == 0.5


def test_the_step_can_be_changed_and_expressions_see_it(toy):
    file = toy("mass_kg: 1", 'mass_kg: "${100 * step_s}"')
    assert file.resolve().bodies["ball"].mass_kg == pytest.approx(1.0)
    changed = file.resolve(step_s=0.002)
    assert changed.world.step_s == 0.002
    assert changed.bodies["ball"].mass_kg == pytest.approx(0.2)


@pytest.mark.parametrize("number", ["1e-3", "1.0e-3", "0.001", "'0.001'"])
def test_numbers_in_scientific_notation_are_numbers(toy, number):
    """PyYAML reads 1e-3 as text."""
    assert toy("step_s: 0.01", f"step_s: {number}").resolve().world.step_s == 0.001
    assert toy("value: 1.0", f"value: {number}").parameters["height_m"].value == 0.001


def test_malformed_yaml_names_line_and_column(fault):
    message = fault("title: Toy", "title: [Toy")
    assert re.search(r"line \d+, column \d+: not valid YAML", message)
    assert "line 2, column 1" in fault(text="a:\n\t- b\n")


@pytest.mark.parametrize("text", ["", "just text", "- 1\n- 2\n", "3", "# only a comment\n"])
def test_a_file_that_is_no_mapping_is_one_clear_error(fault, text):
    assert "not a mapping" in fault(text=text)


@pytest.mark.parametrize(
    "text",
    ["a: &a [*a]\n", "a: " + "[" * 3000 + "]" * 3000, "a: !!python/object/apply:os.system [id]\n"],
    ids=["cycle", "deep", "python tag"],
)
def test_a_hostile_file_is_one_clear_error(fault, text):
    fault(text=text)


def test_a_file_in_another_encoding_is_one_clear_error(write):
    with pytest.raises(InputError, match="cannot be read"):
        read(write("toy.yaml", TOY.replace("height.", "Höhe.").encode("latin-1")))
    with pytest.raises(InputError, match="is a folder; expected a YAML file"):
        read(write("toy.yaml", TOY).parent)


def test_a_byte_order_mark_is_accepted(write):
    assert read(write("toy.yaml", b"\xef\xbb\xbf" + TOY.encode())).name == "toy"


def test_a_key_that_stands_twice_is_a_fault_and_not_dropped(fault):
    message = fault("bodies:", "world: {duration_s: 5}\nbodies:")
    assert "world" in message
    assert "line 10" in message


def test_all_faults_are_reported_in_the_order_of_the_file(fault):
    text = TOY.replace("name: toy", "name: Toy")
    text = text.replace("step_s: 0.01", "step_s: fast")
    text = text.replace("mass_kg: 1", 'mass_kg: "${heigth_m}"')
    text = text.replace("[1, 1, 1]", "[1, -1, 1]") + "    colour: red\n"
    rows = fault(text=text).splitlines()
    assert rows[0].endswith("5 faults")
    places = [re.match(r"  - line (\d+), ([\w.]+): (.*)", row) for row in rows[1:]]
    assert all(places)
    found = [(int(m[1]), m[2]) for m in places if m]
    assert found == [
        (1, "name"),
        (9, "world.step_s"),
        (12, "bodies.ball.mass_kg"),
        (13, "bodies.ball.inertia_kg_m2.1"),
        (15, "bodies.ball.colour"),
    ]
    assert "'Toy'" in rows[1]
    assert "'fast'" in rows[2]
    assert "${heigth_m}" in rows[3]
    assert "-1" in rows[4]


def test_dangling_names_and_faulty_expressions_have_their_lines_too(fault):
    text = TOY + "contacts:\n  - {pair: [ball, flor]}\n"
    message = fault(text=text)
    assert "line 16, contacts.0.pair" in message
    assert "'flor'" in message


def test_a_faulty_parameter_names_its_line_and_value(fault):
    message = fault("{value: 1.0, min: 0, max: 2", "{value: 3.0, min: 0, max: 2")
    assert "line 5, parameters.height_m" in message
    assert "3" in message
    assert "0 … 2" in message
    assert "line 5, parameters.height_m.max" in fault("max: 2, ", "")


def test_faults_of_the_parameters_and_of_the_scene_come_together(fault):
    message = fault(text=TOY.replace("value: 1.0", "value: 7").replace("mass_kg: 1", "mass_kg: -1"))
    assert "parameters.height_m" in message
    assert "bodies.ball.mass_kg" in message


def test_a_preset_out_of_bounds_names_preset_value_bounds_and_line(fault):
    message = fault("set: {height_m: 2}", "set: {height_m: 5}")
    assert "high" in message
    assert "height_m = 5 m is outside 0 m to 2 m" in message
    assert "line 8" in message


def test_every_faulty_preset_is_reported(fault):
    more = '  low: {text: "A low one.", set: {height_m: -1}}\n'
    message = fault(text=TOY.replace("{height_m: 2}}\n", "{heigth_m: 2}}\n" + more))
    assert "did you mean height_m" in message
    assert "height_m = -1" in message


@pytest.mark.parametrize("name", ["step_s", "pi", "sqrt", "a b", "1st"])
def test_a_parameter_that_no_expression_could_name_is_refused(fault, name):
    """``step_s`` would be overridden in silence by the step of the run."""
    assert name in fault("restitution: {", f"{name!r}: {{")


def test_a_parameter_out_of_bounds_names_value_bounds_and_unit(toy):
    with pytest.raises(InputError, match="height_m = 3 m is outside 0 m to 2 m"):
        toy().resolve({"height_m": 3.0})
    with pytest.raises(InputError, match="outside"):
        toy().resolve({"height_m": float("nan")})


def test_an_unknown_preset_or_parameter_names_the_nearest(toy):
    with pytest.raises(UnknownName, match="did you mean high"):
        toy().resolve(preset="hihg")
    with pytest.raises(InputError, match="did you mean height_m"):
        toy().resolve({"hight_m": 1.0})


def test_settings_are_read_with_units_and_all_faults_come_together(toy):
    file = toy()
    assert file.read_settings({"height": "30cm", "restitution": "80%"}) == {
        "height_m": pytest.approx(0.3),
        "restitution": pytest.approx(0.8),
    }
    with pytest.raises(InputError) as error:
        file.read_settings({"hight": "1", "height": "3s", "restitution": "x"})
    assert len(error.value.faults) == 3
    assert "did you mean height_m" in error.value.faults[0]


def test_a_step_longer_than_the_scenario_is_refused(fault):
    message = fault("step_s: 0.01", "step_s: 3")
    assert "step_s" in message


def test_the_committed_schema_is_the_one_of_the_model():
    assert json.loads(SCHEMA_PATH.read_text(encoding="utf-8")) == schema.build(), (
        "python -m simcompare.scenarios.schema writes it anew"
    )


@pytest.mark.parametrize("name", catalogue.names())
def test_every_scenario_fits_the_schema(name):
    tree = yaml.safe_load(catalogue.find(name).read_text(encoding="utf-8"))
    built = schema.build()
    assert set(tree) <= set(built["else"]["properties"])
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft202012Validator(built).validate(tree)


def test_the_schema_lets_every_number_be_an_expression_but_no_text():
    built = schema.build()
    mass = json.dumps(built["$defs"]["Body"]["properties"]["mass_kg"])
    assert "\\\\$" in mass
    assert "\\\\$" not in json.dumps(built["else"]["properties"]["title"])
    assert "\\\\$" not in json.dumps(built["$defs"]["Parameter"])


def test_the_schema_asks_a_whole_scenario_for_all_its_parts_and_a_variant_for_its_own_words():
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft202012Validator(schema.build())
    words = {"name": "toy", "title": "Toy", "question": "Does it move?"}
    assert list(validator.iter_errors(words))
    assert not list(
        validator.iter_errors({**words, "extends": "../x/x.yaml", "probes": {"p": None}})
    )
    assert list(validator.iter_errors({"extends": "../x/x.yaml"}))


VARIANT = """\
extends: toy.yaml
name: toy_high
title: High toy
question: Does it fall longer?
parameters:
  height_m: {value: 2.0}
world: {duration_s: 3}
bodies:
  ball: {mass_kg: 5}
  second: {fixed: true}
"""


def test_a_variant_is_merged_onto_what_it_extends(write):
    write("toy.yaml", TOY)
    file = read(write("toy_high.yaml", VARIANT))
    scenario = file.resolve()
    assert file.name == scenario.name == "toy_high"
    assert (scenario.world.duration_s, scenario.world.step_s) == (3, 0.01)
    assert scenario.bodies["ball"].mass_kg == 5
    assert scenario.bodies["ball"].position_m == (0, 0, 2)
    assert list(scenario.bodies) == ["ball", "second"]
    # the bounds are those of the base
    assert file.parameters["height_m"].max == 2
    assert [path.name for path in file.extends] == ["toy.yaml"]


def test_null_takes_away_and_a_list_is_replaced(write):
    write("toy.yaml", TOY)
    text = VARIANT.replace("  ball: {mass_kg: 5}", "  ball: {inertia_kg_m2: [2, 2, 3]}") + (
        "presets: null\n"
    )
    file = read(write("toy_high.yaml", text))
    assert file.presets == {}
    assert file.resolve().bodies["ball"].inertia_kg_m2 == (2, 2, 3)


def test_a_variant_of_nothing_or_of_itself_is_told(write):
    with pytest.raises(InputError, match=r"line 1, extends: there is no file .*toy.yaml"):
        read(write("alone/toy_high.yaml", VARIANT))
    with pytest.raises(InputError, match="extends itself"):
        read(write("self/toy.yaml", VARIANT))
    write("ring/toy.yaml", "extends: toy_high.yaml\n")
    with pytest.raises(InputError, match="extends itself"):
        read(write("ring/toy_high.yaml", VARIANT))


def test_a_fault_of_a_variant_is_told_with_its_own_line(write):
    write("toy.yaml", TOY)
    with pytest.raises(InputError, match=r"line 9, bodies\.ball\.mass_kg: expected a number gr"):
        read(write("toy_high.yaml", VARIANT.replace("mass_kg: 5", "mass_kg: -5")))


ESTIMATE = """
estimate:
  speed_filter:
    signals: {marks: height}
    truth: {speed: speed_of_ball}
    options: {diameter_m: 0.1, gates: 3}
    sensors: {imu: {sheet: mpu6050}}
  speed_flter:
    signals: {marks: height}
"""


def test_every_fault_of_an_estimate_is_told(fault):
    message = fault(text=TOY + ESTIMATE)
    for part in (
        "estimate.speed_filter.signals.marks: ",
        "estimate.speed_filter.truth.speed: no probe or signal is called 'speed_of_ball'",
        "estimate.speed_filter.options.gates: no option of the estimator is called 'gates'",
        "estimate.speed_filter.sensors.imu: no sensor is called 'imu'",
        "estimate.speed_flter: no estimator is called 'speed_flter'; did you mean speed_filter or",
    ):
        assert part in message


@pytest.mark.parametrize("name", ["x" * 5000, '"a\\0b"', "{a: 1}"])
def test_what_can_be_no_name_of_a_file_is_told(write, name):
    with pytest.raises(InputError, match=r"line 1, extends: there is no file .*; expected a path"):
        catalogue.load(str(write("mine.yaml", f"extends: {name}\n")))
