"""A controller in the loop: what it reads, what it sets, and what it must not return."""

import math
import pickle

import numpy as np
import pytest

import simcompare
from simcompare.engine import engines
from simcompare.engine.features import needs
from simcompare.errors import InputError, UnknownName
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue

ENGINES = engines.names()
SPATIAL = [
    name
    for name in ENGINES
    if not needs(catalogue.load("robot").resolve()).required - engines.get(name).features
]


def speed_controller(target_m_s, gain=0.2):
    def torques(time_s, readings):
        effort = gain * (target_m_s - readings["chassis.velocity_m_s"][0])
        return {"left_drive": effort, "right_drive": effort}

    return torques


@pytest.mark.parametrize("engine", SPATIAL)
def test_a_speed_controller_reaches_its_speed_on_every_engine(engine):
    found = simcompare.control("robot", speed_controller(0.3), engine=engine)
    speed = found.signals["chassis.velocity_m_s"][:, 0]
    # proportional only: the error dies out with (m + 2J/r²)·r/2k = 0.05 s and leaves nothing
    assert speed[-1] == pytest.approx(0.3, rel=1e-3)
    assert speed.max() < 0.3 * 1.001
    # the actuators tell what the controller gave
    torque = found.signals["left_motor.torque_N_m"]
    assert torque[0] == pytest.approx(0.06)
    assert abs(torque[-1]) < 1e-4


@pytest.mark.parametrize("engine", SPATIAL)
def test_a_controller_that_repeats_the_signals_changes_nothing(engine):
    scenario = catalogue.load("robot").resolve()
    whole = engines.get(engine).simulate(scenario, Settings())
    torque = scenario.parameters["torque_N_m"]
    found = simcompare.control(
        "robot", lambda t, r: {"left_drive": torque, "right_drive": torque}, engine=engine
    )
    np.testing.assert_allclose(
        found.signals["chassis.position_m"], whole.signals["chassis.position_m"], atol=1e-9
    )


@pytest.mark.parametrize(
    ("controller", "words"),
    [
        (lambda time_s: {}, "<lambda>(time_s): cannot be called with two arguments (too many"),
        (lambda: {}, "controller <lambda>(): cannot be called"),
        (lambda time_s, readings, gain: {}, "(missing a required argument: 'gain')"),
    ],
)
def test_a_controller_with_other_parameters_is_refused(controller, words):
    with pytest.raises(InputError) as caught:
        simcompare.control("robot", controller, engine=SPATIAL[0])
    assert words in str(caught.value)
    assert "expected <lambda>(time_s, readings)" in str(caught.value)


def test_readings_have_every_signal_as_plain_numbers():
    seen = []

    def look(time_s, readings):
        seen.append((time_s, readings))
        return {}

    simcompare.control("robot", look, engine=SPATIAL[0])
    time_s, readings = seen[100]
    assert time_s == pytest.approx(0.1)
    assert isinstance(readings["left.angle_rad"], float)
    assert len(readings["chassis.orientation_wxyz"]) == 4
    # rates from the last samples, though a controller knows nothing of the future
    assert readings["left_motor.torque_N_m"] == pytest.approx(0.02)
    assert seen[0][1]["chassis.velocity_m_s"] == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_reading_that_is_asked_for_alone_is_what_all_of_them_say(engine):
    scenario = catalogue.load("robot_motor" if engine in SPATIAL else "pendulum_torque").resolve()
    simulation = engines.get(engine).open(scenario, Settings())
    for _ in range(7):  # from no sample before this one to more than are kept
        alone = simulation.read()
        every = dict(simulation.read())
        assert every == {name: alone[name] for name in reversed([*every])}
        assert len(alone) == len(every)
        simulation.step()
    simulation.close()


@pytest.mark.parametrize("engine", SPATIAL)
def test_readings_stay_those_of_their_instant(engine):
    simulation = engines.get(engine).open(catalogue.load("robot").resolve(), Settings())
    simulation.step()
    then, kept = simulation.read(), dict(simulation.read())
    simulation.step(count=10)
    assert dict(simulation.read()) != kept
    simulation.close()
    assert dict(then) == kept


@pytest.mark.parametrize("engine", SPATIAL)
def test_held_inputs_move_alike_in_one_go_and_step_by_step(engine):
    scenario = catalogue.load("robot_motor").resolve()
    simulation = engines.get(engine).open(scenario, Settings())
    given = {"left_drive": 3.0, "right_drive": 1.0}
    ends = []
    start = simulation.save()
    for counts in ([1] * 40, [20, 20], [3, 37]):
        simulation.restore(start)
        for count in counts:
            simulation.step(given, count)
        assert simulation.time_s == pytest.approx(0.04)
        ends.append(dict(simulation.read()))
    simulation.close()
    assert ends[0] == ends[1] == ends[2]


@pytest.mark.parametrize("engine", SPATIAL)
def test_efforts_that_an_engine_keeps_act_as_if_they_were_given_anew(engine):
    scenario = catalogue.load("robot_motor").resolve(step_s=0.01)
    world = scenario.world.model_copy(update={"substeps": 10})
    scenario = scenario.model_copy(update={"world": world})
    simulation = engines.get(engine).open(scenario, Settings())
    start, ends = simulation.save(), []
    for kept in {simulation.efforts_last, False}:
        simulation.efforts_last = kept
        simulation.restore(start)
        for volts in (3.0, 1.0):
            simulation.step({"left_drive": volts, "right_drive": -volts})
        ends.append(dict(simulation.read()))
    simulation.close()
    assert ends[0] == ends[-1]


@pytest.mark.parametrize("engine", SPATIAL)
def test_a_controller_that_is_asked_less_often_is_held(engine):
    times = []

    def push(time_s, readings):
        times.append(time_s)
        return {"left_drive": 0.01 * len(times)}

    found = simcompare.control("robot", push, engine=engine, every="0.3s").signals
    assert times == pytest.approx([0.0, 0.3, 0.6, 0.9])
    torque = found["left_motor.torque_N_m"]
    assert torque[[0, 299, 300, 599, 600, 1020]] == pytest.approx(
        [1e-2, 1e-2, 2e-2, 2e-2, 3e-2, 4e-2]
    )


@pytest.mark.parametrize("every", ["1.5ms", 0.0004, -1])
def test_a_controller_is_not_asked_between_two_samples(every):
    with pytest.raises(InputError, match="no whole number of recorded steps"):
        simcompare.control("robot", lambda t, r: {}, engine=SPATIAL[0], every=every)


def test_inputs_that_are_left_out_follow_their_signals():
    left_off = simcompare.control(
        "robot", lambda t, r: {"left_drive": 0.0}, engine=SPATIAL[0]
    ).signals
    assert left_off["right_motor.torque_N_m"][50] == pytest.approx(0.02)
    assert left_off["left_motor.torque_N_m"][50] == 0.0


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"left_drive": math.nan}, "left_drive = nan is not a finite number"),
        ({"left_drive": np.array([1.0, 2.0])}, r"left_drive = array\(\[1., 2.\]\) is not one numb"),
        ({"left_drive": "0.1"}, "left_drive = '0.1' is not one number"),
        ({"left_drive": True}, "left_drive = True is not one number"),
        (None, "the controller returned nothing; expected a mapping"),
        ([0.1, 0.2], "found a list; expected a mapping of input -> number"),
        (0.1, "found a float; expected a mapping"),
    ],
)
def test_a_controller_that_returns_nonsense_is_told_what_and_when(given, words):
    with pytest.raises(InputError, match=words) as caught:
        simcompare.control("robot", lambda t, r: given if t > 0.0495 else {}, engine=SPATIAL[0])
    assert "t = 0.05 s" in str(caught.value)


def test_both_faults_of_one_step_are_told():
    with pytest.raises(InputError) as caught:
        simcompare.control(
            "robot", lambda t, r: {"left_drive": math.inf, "right_drive": None}, engine=SPATIAL[0]
        )
    assert len(caught.value.faults) == 2


def test_an_input_that_does_not_exist_is_named_with_the_nearest():
    with pytest.raises(UnknownName, match="did you mean left_drive"):
        simcompare.control("robot", lambda t, r: {"left_drve": 0.0}, engine=SPATIAL[0])


@pytest.mark.parametrize("asked", ["chassis.velocity", "chassis.velocty_m_s"])
def test_a_reading_that_there_is_not_is_answered_with_the_nearest(asked):
    with pytest.raises(KeyError, match="no reading is called") as caught:
        simcompare.control("robot", lambda t, r: r[asked], engine=SPATIAL[0])
    assert isinstance(caught.value, UnknownName)
    assert f"{asked!r}; the nearest first: chassis.velocity_m_s, " in str(caught.value)
    assert "left_motor.torque_N_m" in str(caught.value)  # all others too
    assert pickle.loads(pickle.dumps(caught.value)).args == caught.value.args


def test_a_controller_may_ask_whether_there_is_a_reading():
    def look(time_s, readings):
        assert "chassis.velocity" not in readings
        assert readings.get("chassis.velocity") is None
        return {}

    simcompare.control("robot", look, engine=SPATIAL[0])


class Overheated(Exception):
    pass


def test_what_a_controller_raises_goes_on_as_it_is_with_engine_and_time():
    def breaks(time_s, readings):
        if time_s > 0.0495:
            raise Overheated("too hot")
        return {}

    with pytest.raises(Overheated, match="too hot") as caught:
        simcompare.control("robot", breaks, engine=SPATIAL[0])
    assert caught.value.args == ("too hot",)
    assert caught.value.__notes__ == [f"the controller ran on {SPATIAL[0]} at t = 0.05 s"]


def test_what_is_no_function_is_no_controller():
    with pytest.raises(InputError, match="controller=5: expected a function"):
        simcompare.control("robot", 5, engine=SPATIAL[0])


def test_a_controller_of_a_scene_without_inputs_may_only_look():
    found = simcompare.control("ball", lambda t, r: {}, engine="pymunk", set={"drop_height": 0.05})
    truth = engines.get("pymunk").simulate(
        catalogue.load("ball").resolve({"drop_height_m": 0.05}), Settings()
    )
    np.testing.assert_allclose(
        found.signals["ball.position_m"], truth.signals["ball.position_m"], atol=1e-9
    )


def test_a_controller_reads_rates_and_currents_from_the_first_sample_on():
    seen = []

    def look(time_s, readings):
        seen.append(readings)
        return {}

    simcompare.control("motor_bench", look, engine="pymunk")
    # at rest the whole voltage drives the current, and no false rate takes from it
    assert seen[0]["motor.current_A"] == pytest.approx(6.0 / 6.0)
    assert seen[1]["motor.current_A"] < seen[0]["motor.current_A"]


@pytest.mark.engines("pymunk")
def test_an_unknown_level_and_a_number_too_large_are_told():
    def push(time_s, readings):
        return {"drive": 10**400}

    with pytest.raises(UnknownName, match="no contact level is called 'asisted'; did you mean"):
        simcompare.control("robot_planar", push, engine="pymunk", contact="asisted")
    with pytest.raises(InputError, match="drive is beyond the largest number"):
        simcompare.control("robot_planar", push, engine="pymunk")
