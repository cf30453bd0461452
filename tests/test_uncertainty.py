"""The verb uncertainty: how well results of scenarios and formulas are known."""

import json
import math

import pytest

import simcompare
from simcompare.errors import InputError, UnknownName
from simcompare.model.plain import of_plain
from simcompare.propagation import results
from simcompare.propagation.closed_form import ClosedForm
from simcompare.propagation.engine_runs import NUMERICAL
from simcompare.reports.uncertainty import answer, page, tables
from simcompare.results.records.uncertainty import Uncertainty
from simcompare.scenarios import catalogue, trust

FORMULA = "2*tau/r/(m+2*J/r**2)"
VALUES = {"tau": "20 mN*m", "r": "32.5mm", "m": "0.6kg", "J": "1.584375e-5 kg*m^2"}

FALL = """\
name: fall
title: Fall
question: How high is it in the end?
parameters:
  height_m: {value: 1.0, min: 0.9, max: 20, text: "Height at release."}
  mass_kg: {value: 1.0, min: 0.1, max: 20, text: "Mass of the ball."}
world: {duration_s: 0.4, step_s: 0.001}
bodies:
  ball:
    mass_kg: "${mass_kg}"
    inertia_kg_m2: [0.1, 0.1, 0.1]
    position_m: [0, 0, "${height_m}"]
    shapes: [{type: sphere, radius_m: 0.1}]
probes:
  height_m: {observe: ball.position_m, component: 2, label: Height, unit: m}
measures:
  - {function: final, probe: height_m, names: {final: end}}
dither: {parameter: height_m, span: 0.01, count: 5, reason: "A test."}
uncertainty:
  inputs:
    height_m: {u: "2mm", reason: "A ruler, read by eye."}
    mass_kg: {u: "±1g", reason: "A kitchen scale."}
"""
FALL_REFERENCE = """\
import numpy as np

def reference(parameters, time_s):
    zero = np.zeros(len(time_s))
    height = parameters["height_m"] - 9.80665 * time_s**2 / 2
    return {"ball.position_m": np.column_stack((zero, zero, height))}
"""
#: what an engine adds to its heights depends on where the start falls
JITTER = "signals['ball.position_m'] += 1e-4 * np.sin(3e4 * scenario.parameters['height_m'])"


@pytest.fixture
def scene(write):
    trust.allow(write("mine/fall/reference.py", FALL_REFERENCE))
    return write("mine/fall/fall.yaml", FALL).parent


@pytest.fixture(scope="module")
def robot():
    return simcompare.uncertainty("robot", of="acceleration")


# --- formulas ---------------------------------------------------------------------------------


def test_a_formula_with_units():
    found = simcompare.uncertainty(of=FORMULA, set=VALUES, u={"tau": "2%", "r": "±0.1mm"})
    assert found.unit == "m/s**2"
    budget = found.known[0][1].budget
    # physics of the robot; 2 % of it, and 0.1 mm/√3 of the radius times its slope
    assert budget.estimate == pytest.approx(1.953602, abs=1e-6)
    assert budget.u == pytest.approx(math.hypot(0.02 * 1.953602, 54.4 * 1e-4 / 3**0.5), rel=1e-3)
    assert [row.name for row in budget.largest_first] == ["tau", "r"]
    assert answer.sentences(found) == [
        f"{FORMULA} = (1.954 ± 0.077) m/s² (95 %, k = 1.96); tau makes 99 % of the variance."
    ]
    assert found.known[0][1].monte_carlo.trials == 1_000_000


def test_that_first_order_fails_is_the_second_sentence():
    found = simcompare.uncertainty(of="x**2", set={"x": 0}, u={"x": 0.1})
    first, second = answer.sentences(found)
    assert first == "x**2 = 0 (95 %, k = 1.96); to first order no input changes it."
    # x² over 0.01 has a χ² distribution with one degree of freedom: 95 % below 3.84
    assert second == (
        "First order is not enough here: by Monte Carlo the value lies between 0.0000 and 0.0384"
        " (95 %, shortest interval), with the mean 0.010 ± 0.014 (u)."
    )


def test_logarithm_of_a_wide_range():
    found = simcompare.uncertainty(of="log(x)", set={"x": 0.6}, u={"x": "±0.5"}).known[0][1]
    # first order ln 0.6 and 0.289/0.6, Monte Carlo as published beside it
    assert found.budget.estimate == pytest.approx(-0.511, abs=0.0005)
    assert found.budget.u == pytest.approx(0.481, abs=0.0005)
    # a million trials repeat to u/1000
    assert found.monte_carlo.estimate == pytest.approx(-0.665, abs=0.002)
    assert found.monte_carlo.u == pytest.approx(0.606, abs=0.002)
    assert not found.validation.passed


def test_degrees_of_freedom_are_carried():
    found = simcompare.uncertainty(
        of="a + b", set={"a": 1, "b": 2}, u={"a": "0.1, dof 4", "b": 0.1}
    )
    budget = found.known[0][1].budget
    # (u²)²/(u_a⁴/4) with u² = 2·u_a²
    assert budget.degrees_of_freedom == pytest.approx(16)
    assert budget.k == pytest.approx(2.120, abs=0.0005)
    assert "k = 2.12, 16 degrees of freedom" in answer.sentences(found)[0]


def test_correlated_inputs_take_away_from_each_other():
    asked = {"of": "a - b", "set": {"a": 1, "b": 2}, "u": {"a": 0.1, "b": 0.1}}
    found = simcompare.uncertainty(**asked, correlation={"a,b": 1.0}).known[0][1]
    assert found.budget.u == pytest.approx(0, abs=1e-9)
    assert found.monte_carlo.u == pytest.approx(0, abs=1e-9)


def test_a_formula_in_the_parameters_of_a_scenario():
    text = "2*torque_N_m/wheel_radius_m/(body_mass_kg + 3*wheel_mass_kg)"
    found = simcompare.uncertainty("robot", of=text)
    assert found.unit == "m/s**2"
    assert found.known[0][1].budget.estimate == pytest.approx(1.953602, abs=1e-6)


@pytest.mark.parametrize(
    ("asked", "text"),
    [
        ({}, "uncertainty: name a scenario, or a formula with of"),
        (
            {"of": "a*b", "set": {"a": 1, "y": 2}, "u": {"a": 1}},
            "set: 2 faults\n  - no quantity of the formula is called 'y'; known: a, b"
            "\n  - b has no value; give set b=VALUE",
        ),
        (
            {"of": "a*b", "set": {"a": 1, "b": 2}},
            "u: nothing is uncertain; give an uncertainty such as u a=1%",
        ),
        (
            {"of": "a*b", "set": {"a": 1, "b": 2}, "u": {"c": 1}},
            "u: no quantity of the formula is called 'c'; known: a, b",
        ),
        (
            {"of": "a*b", "set": {"a": "0,5m", "b": 2}, "u": {"a": 1}},
            "set: a: '0,5m' has a decimal comma; write 0.5m",
        ),
        (
            {"of": "a/b", "set": {"a": 1, "b": 0}, "u": {"a": 1}},
            "of: 'a/b' gives no finite number at a = 1, b = 0",
        ),
        (
            {"of": "a+b", "set": {"a": "1m", "b": "2kg"}, "u": {"a": "1mm"}},
            "of: the units do not fit: Cannot convert from 'meter' ([length]) to 'kilogram'"
            " ([mass]); give each quantity its unit, or none to all",
        ),
        (
            {"of": "a", "engine": "mujoco", "set": {"a": 1}, "u": {"a": 1}},
            "uncertainty: engine mujoco is of a scenario, and a formula alone has none",
        ),
        (
            {"of": "a", "set": {"a": 1}, "u": {"a": 1}, "correlation": {"a": 0.5}},
            "correlation: a=0.5 is not of the form a,b=0.5",
        ),
        (
            {
                "of": "a*b",
                "set": {"a": 1, "b": 1},
                "u": {"a": 1, "b": 1},
                "correlation": {"a,b": 0.5, "b, a": 0.1},
            },
            "correlation: the correlation of b with a is given twice",
        ),
        (
            {"of": "a", "set": {"a": 1}, "u": {"a": 1}, "probability": 2.0, "seed": -1},
            "uncertainty: 2 faults\n  - probability 2 is out of range; expected more than 0"
            " and at most 0.99999"
            "\n  - seed -1 is below 0; expected a whole number from 0 on",
        ),
    ],
)
def test_what_cannot_be_is_refused(asked, text):
    with pytest.raises(InputError) as error:
        simcompare.uncertainty(**asked)
    assert str(error.value) == text


NO_NAME = "names no quantity, so nothing is uncertain; expected a formula such as 2*tau/r"


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        ("((1))", f"of: '((1))' is 1 and {NO_NAME}"),
        ("0xff", f"of: '0xff' is 255 and {NO_NAME}"),
        ("1/0", "of: '1/0' gives no finite number: a division by zero"),
        ("9**9**9", "of: '9**9**9' gives no finite number: a number in it gets too large"),
        ("sqrt(-1)", "of: 'sqrt(-1)' gives no finite number"),
    ],
)
@pytest.mark.parametrize("scenario", [None, "robot"])
def test_a_formula_without_quantities_is_refused(scenario, formula, text):
    with pytest.raises(InputError) as error:
        simcompare.uncertainty(scenario, of=formula)
    assert str(error.value) == text


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        ("a*(-1)**0.5", "gives no finite number: the root of a negative number is not real"),
        ("abs((-1)**0.5)*a", "gives no finite number: the root of a negative number is not real"),
        (
            "sqrt(a - 1)",
            "changes without limit at the estimates: it has no slope there; expected others",
        ),
    ],
)
def test_a_formula_without_a_real_value_or_slope_is_refused(formula, text):
    with pytest.raises(InputError) as error:
        simcompare.uncertainty(of=formula, set={"a": 1}, u={"a": 1})
    assert str(error.value) == f"of: {formula!r} {text}"


@pytest.mark.parametrize(
    ("asked", "text"),
    [
        ({"trials": 1}, "1 trials cannot tell an interval of 95 %; expected at least 40"),
        ({"trials": 10**10}, "10000000000 trials are too many; expected at most 10000000"),
        (
            {"trials": 10**6, "engine": "mujoco"},
            "1000000 trials are too many; expected at most 10000",
        ),
    ],
)
def test_trials_that_tell_nothing_are_refused_before_anything_runs(asked, text):
    with pytest.raises(InputError) as error:
        simcompare.uncertainty("robot", **asked)
    assert str(error.value) == f"uncertainty: {text}"
    assert error.value.exit_code == 2


# --- scenarios --------------------------------------------------------------------------------


def test_the_robot_is_known_as_well_as_its_torque(robot):
    (sentence,) = answer.sentences(robot)
    assert sentence == (
        "The acceleration is (1.954 ± 0.077) m/s² (95 %, k = 1.96);"
        " torque_N_m makes 99 % of the variance."
    )
    (_, found), *_ = robot.known
    assert found.monte_carlo.trials == 1_000_000
    assert found.validation.passed


def test_every_formula_of_a_scenario_is_its_closed_form():
    checked = []
    for name in catalogue.names():
        file = catalogue.load(name)
        for of in file.uncertainty.formulas if file.uncertainty else ():
            form = ClosedForm(file, file.resolve(), results.chosen(file.resolve(), of))
            assert form.formula is not None
            # not only at one point: where each parameter of the formula is 1 % larger
            for parameter in form.formula.names:
                more = {**form.scenario.parameters}
                more[parameter] *= 1.01
                changed = ClosedForm(file, file.moved(form.scenario, more), of)
                assert changed.formula is not None
            checked.append(name)
    assert {"robot", "motor_bench"} <= set(checked)


def test_what_a_user_says_goes_before_the_scenario():
    asked = {"torque": "exact", "wheel_radius": "±0.2mm", "wheel_mass_kg": "exact"}
    found = simcompare.uncertainty("robot", u=asked)
    rows = {row.name: row for row in found.known[0][1].budget.rows}
    assert list(rows) == ["body_mass_kg", "wheel_radius_m"]
    assert rows["wheel_radius_m"].u == pytest.approx(0.2e-3 / 3**0.5)


def test_inputs_from_a_file(write):
    path = write(
        "inputs.yaml",
        'wheel_radius: {u: ±0.05mm, value: 33mm, reason: "New wheels, calliper."}\n'
        'torque_N_m: "2%, dof 4"\ncorrelation:\n  - [wheel_radius_m, torque_N_m, 0.5]\n',
    )
    found = simcompare.uncertainty("robot", inputs=path)
    assert found.correlation == (("wheel_radius_m", "torque_N_m", 0.5),)
    assert {one.name: one.reason for one in found.inputs}["wheel_radius_m"] == (
        "New wheels, calliper."
    )
    budget = found.known[0][1].budget
    assert {row.name: row.estimate for row in budget.rows}["wheel_radius_m"] == 0.033
    # the torque's four, and a little more from what else is uncertain
    assert 4 <= budget.degrees_of_freedom < 4.2


def test_a_file_with_faults_tells_all_of_them(write):
    path = write("inputs.yaml", "radius_m: {u: 1mm, reson: x}\ncorrelation: 3\n")
    with pytest.raises(InputError) as error:
        simcompare.uncertainty("robot", inputs=path)
    assert str(error.value) == (
        f"{path}: 2 faults\n  - line 1, radius_m.reson: is not known here, found 'x'"
        "\n  - line 2, correlation: expected a list, such as [1, 2], found 3"
    )


def test_a_variant_inherits_what_it_still_has():
    said = catalogue.load("robot_motor").uncertainty
    assert "torque_N_m" not in said.inputs
    assert "wheel_radius_m" in said.inputs
    assert said.formulas == {}


def test_unknown_names_are_listed_all_at_once():
    with pytest.raises(InputError) as error:
        simcompare.uncertainty("robot", u={"torqe": "2%", "wheel_mas": "1g"})
    assert str(error.value) == (
        "robot, u: 2 faults\n"
        "  - no parameter is called 'torqe'; did you mean torque_N_m?\n"
        "  - no parameter is called 'wheel_mas'; did you mean wheel_mass_kg"
        " or wheel_radius_m or wheel_width_m?"
    )
    with pytest.raises(UnknownName, match="no result of robot is called 'accelration'"):
        simcompare.uncertainty("robot", of="accelration")


def test_where_the_closed_form_ends_within_the_uncertainty():
    found = simcompare.uncertainty("robot", set={"torque": 0.0355})
    assert answer.sentences(found)[-1] == (
        "The closed form does not hold in all of this range: where torque_N_m is 0.0369,"
        " the tyres slip: 0.0369 N·m on each wheel is more than the 0.0357 N·m that they hold."
    )


def test_a_correlation_of_what_is_not_in_the_formula_does_not_matter():
    found = simcompare.uncertainty(
        "robot", of="2*torque_N_m", correlation={"body_mass,wheel_mass": 0.5}
    )
    assert [row.name for row in found.known[0][1].budget.rows] == ["torque_N_m"]


def test_an_input_is_given_once():
    with pytest.raises(InputError, match="torque_N_m is given twice, with and without its unit"):
        simcompare.uncertainty("robot", u={"torque": "2%", "torque_N_m": "1%"})


def test_beyond_the_closed_form_an_engine_is_wanted():
    with pytest.raises(InputError, match=r"no closed form: The tyres slip: .*; name an engine"):
        simcompare.uncertainty("robot", set={"torque_N_m": 0.09})


# --- engines ----------------------------------------------------------------------------------


def test_an_engine_beside_the_closed_form(scene, add_engine):
    add_engine("toy")
    found = simcompare.uncertainty(str(scene), of="end", engine="toy", trials=200)
    (_, form), (way, engine) = found.known
    # 1 − 9.80665·0.4²/2, and the height's 2 mm; the mass does nothing
    assert form.budget.estimate == pytest.approx(1 - 9.80665 * 0.08)
    assert engine.budget.estimate == pytest.approx(form.budget.estimate)
    assert engine.budget.u == pytest.approx(0.002)
    assert [row.share for row in engine.budget.largest_first] == pytest.approx([1, 0])
    # 5 repeats, two inputs to both sides in three of them, 200 trials
    assert way.runs == 5 + 2 * 2 * 3 + 200
    # 200 trials repeat u to 5 %; three of those
    assert engine.monte_carlo.u == pytest.approx(0.002, rel=0.15)
    assert "toy differs from the closed form by less than 1 % of U" in answer.sentences(found)[1]


def test_scatter_between_repeats_is_in_the_budget(scene, add_engine):
    add_engine("shaky", JITTER)
    found = simcompare.uncertainty(str(scene), of="end", engine="shaky", u={"height": "exact"})
    budget = found.known[1][1].budget
    scatter = budget.largest_first[0]
    assert scatter.name == NUMERICAL
    assert scatter.degrees_of_freedom == 4
    # five values of a sine of 1e-4: below that over √5
    assert 1e-6 < budget.u < 1e-4 / 5**0.5 * 1.2
    # four degrees of freedom and almost nothing else
    assert budget.k == pytest.approx(2.776, abs=0.01)


def test_a_result_that_jumps_is_told(scene, add_engine):
    add_engine("jumpy", "signals['ball.position_m'] += 0.1 * (scenario.parameters['mass_kg'] > 1)")
    found = simcompare.uncertainty(str(scene), of="end", engine="jumpy", u={"mass": "±20g"})
    assert found.known[1][1].bent == ("mass_kg",)
    assert (
        "On jumpy first order says little: the result bends or jumps within the uncertainty of"
        " mass_kg. Trials tell more: --trials 200."
    ) in answer.sentences(found)


def test_an_engine_that_fails_leaves_the_others(scene, add_engine):
    add_engine("broken", "raise ValueError('no')")
    found = simcompare.uncertainty(str(scene), of="end", engine="broken")
    assert [way.status for way in found.ways] == ["ok", "failed"]
    assert found.exit_code == 3
    assert answer.not_run(found) == ["broken: ValueError: no"]


# --- what is shown ----------------------------------------------------------------------------


def test_budget_is_a_table(robot):
    table = robot.table()
    assert list(table.index) == [
        "torque_N_m", "wheel_radius_m", "wheel_mass_kg", "body_mass_kg", "combined",
    ]  # fmt: skip
    with pytest.raises(UnknownName, match="no way to the result is called 'ode'"):
        robot.table("ode")


def test_a_notebook_shows_answer_budget_and_picture(robot):
    shown = robot._repr_html_()
    assert "torque_N_m makes 99 % of the variance" in shown
    assert "data:image/png" in shown


def test_page_holds_the_command_that_makes_it_again(robot):
    block = page.block_of(robot)
    assert block.parts[-1].code == "simcompare uncertainty robot --of acceleration"
    (figure,) = block.parts[0].figures
    assert [panel.title for panel in figure.panels] == ["Share of the variance", "Distribution"]


def test_command_line_stores_and_prints(call, tmp_path):
    code, out, _ = call(
        "uncertainty", "--of", "v/i", "--set", "v=5V", "--set", "i=20mA", "--u", "v=1%",
        "--out", tmp_path / "out", "--no-report",
    )  # fmt: skip
    assert code == 0
    assert out.startswith("v/i = (250.0 ± 4.9) Ω (95 %, k = 1.96); all of it comes from v.")
    (folder,) = (tmp_path / "out").iterdir()
    stored = json.loads((folder / "uncertainty.json").read_text(encoding="utf-8"))
    assert of_plain(Uncertainty, stored).known[0][1].budget.u == pytest.approx(2.5)


def test_json_is_one_object(call, tmp_path):
    code, out, _ = call(
        "uncertainty", "robot", "--json", "--no-report", "--out", tmp_path / "out"
    )  # fmt: skip
    found = json.loads(out)
    assert code == found["exit_code"] == 0
    assert found["of"] == "acceleration"
    budget = found["ways"][0]["found"]["budget"]
    assert budget["degrees_of_freedom"] is None
    assert budget["rows"][0]["name"] == "torque_N_m"


def test_words_of_the_tables_are_explained():
    from simcompare import glossary

    assert len(glossary.legend([*tables.BUDGET_WORDS, *tables.WAYS_WORDS])) == 8


def test_what_only_compares_is_no_result_of_one_run():
    with pytest.raises(InputError) as error:
        simcompare.uncertainty("barometer", of="pressure_error", u={"climb": "1%"})
    assert str(error.value).startswith(
        "pressure_error: it has no single value in closed form; single results are: "
    )
