"""Plans of validations keep the file and the lines that they stand in."""

import pytest

import simcompare
from simcompare.errors import InputError
from simcompare.inference import plan as plans
from simcompare.inference import sources


def test_a_fault_of_a_plan_is_told_with_its_file_and_line(write):
    rows = "".join(f"{i / 100:.2f},{i % 7}\n" for i in range(50))
    log = write("run1.csv", f"t (s),angle (deg)\n{rows}")
    mapping = write(
        "map.yaml",
        "validate:\n  - scenario: pendulum\n    parameters:\n"
        "      length_m: {value: long, u: 0.01, source: ruler}\n"
        "    compare: {angle_rad: {channel: angle}}\n",
    )
    source = sources.find(str(log), mapping=mapping)
    with pytest.raises(InputError) as error:
        plans.choose(source.plans, "pendulum")
    assert error.value.where == str(mapping)
    assert error.value.faults == (
        "line 4, validate.0.parameters.length_m.value: expected a number, found 'long'",
    )
    with pytest.raises(InputError, match=r"map\.yaml: is not prepared for the scenario ball"):
        plans.choose(source.plans, "ball")


ENTRY = """\
validate:
  scenario: pendulum
  compare: {angle_rad: {channel: angle}}
"""


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("angle_rad:", "angel_rad:", "line 3, validate.compare.angel_rad: no probe of pendulum"),
        ("  compare", "  start:\n    wrong: {channel: angle}\n  compare",
         "line 4, validate.start.wrong: no parameter of pendulum"),
        ("  compare", "  inputs:\n    wrong: {channel: angle}\n  compare",
         "line 4, validate.inputs.wrong: no input of pendulum"),
        ("  compare", "  calibrate:\n    parameters: [wrong]\n  compare",
         "line 4, validate.calibrate.parameters.wrong: no parameter of pendulum"),
        ("  scenario: pendulum\n", "", "line 1, validate.scenario: is missing"),
        (ENTRY, "validate: 5\n", "line 1, validate: is one value; expected a mapping"),
        (ENTRY, "validate: {}\n", "line 1, validate.scenario: is missing"),
        (ENTRY, "validate: [5]\n", "line 1, validate.0: is one value; expected a mapping"),
    ],
)  # fmt: skip
def test_a_fault_of_a_mapping_is_told_with_the_mapping(write, old, new, fault):
    rows = "".join(f"{i / 100:.2f},{i % 7}\n" for i in range(50))
    log = write("run1.csv", f"t (s),angle (deg)\n{rows}")
    mapping = write("map.yaml", ENTRY.replace(old, new))
    with pytest.raises(InputError) as error:
        simcompare.validate("pendulum", recording=log, mapping=mapping, engine="mujoco")
    assert error.value.where == str(mapping)
    assert error.value.faults[0].startswith(fault)
