"""Real robots and a real motor, held against their simulations; skipped where the data are not."""

import pytest

from simcompare.hardware.recordings import registry
from simcompare.verbs.fit import fit
from simcompare.verbs.validate import validate


def needs(name):
    if registry.place(name) is None:
        pytest.skip(f"{name} is not on this machine")


def rows(found):
    return {row.measure: row for row in found.record.validation.values}


def rms(found, probe):
    (row,) = [row for row in found.record.validation.waveforms if row.probe == probe]
    return row.rmse


def test_a_motor_named_for_150_rpm_is_slower_but_within_what_its_name_leaves_open():
    needs("motor_step_esp32")
    found = rows(validate("motor_step", recording="motor_step_esp32", engine="mujoco"))["last_rate"]
    # the mean of the last tenth: independent, from the log 11.55 rad/s
    assert found.measured == pytest.approx(11.55, abs=0.02)
    assert found.simulated == pytest.approx(14.9, abs=0.1)
    assert abs(found.e_n) < 1


def test_the_two_speeds_that_are_no_motion_are_missing_and_told():
    needs("motor_step_esp32")
    done = validate("motor_step", recording="motor_step_esp32", engine="mujoco")
    rules = [repair.rule for repair in done.record.validation.provenance.repairs]
    assert rules.count("sentinel") == 2
    assert "missing_values" in rules


def test_idle_speed_and_time_constant_are_told_where_all_else_is_given():
    needs("motor_step_esp32")
    found = fit(
        "motor_step", recordings="motor_step_esp32", engine="mujoco",
        unknowns="torque_constant,inertia", fixed={"friction": 0, "damping": 0},
    )  # fmt: skip
    parameters = found.record.fit.closed_form.parameters
    k, inertia = parameters["torque_constant_N_m_A"], parameters["inertia_kg_m2"]
    # independent least squares on the log: 11.35 rad/s and 0.0565 s
    assert 9 / k.value == pytest.approx(11.35, abs=0.03)
    assert inertia.value * 5.5 / k.value**2 == pytest.approx(0.0565, abs=0.001)
    # the voltage was not measured: 0.3 V of 9 V
    assert k.u / k.value == pytest.approx(0.3 / 9, rel=0.15)


def test_the_labyrinth_as_documented_is_nowhere_near():
    needs("robot_labyrinth")
    found = validate("odometry", recording="robot_labyrinth", engine="mujoco")
    assert rms(found, "x") > 1
    assert abs(rows(found)["end_x"].e_n) > 5
    assert any("contradicts" in text for text in found.record.validation.sentences)


def test_the_labyrinth_as_its_data_suggest_is_followed_to_a_few_percent_of_the_way():
    needs("robot_labyrinth_exchanged")
    found = validate("odometry", recording="robot_labyrinth_exchanged", engine="mujoco")
    assert rms(found, "x") < 0.2
    assert rms(found, "y") < 0.1
    assert abs(rows(found)["path_length"].e_n) < 1
