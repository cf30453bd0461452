"""The file of the robot: what follows from it, what cannot be, and a run of another robot."""

from __future__ import annotations

import math

import numpy as np
import pytest
import yaml

import simcompare
from simcompare.errors import InputError
from simcompare.exporters.scripts.write import script
from simcompare.exporters.twins import twin
from simcompare.hardware.robot import built, possible, robot_file, solids
from simcompare.hardware.robot.description import Robot
from simcompare.hardware.robot.solids import Solid
from simcompare.scenarios import catalogue, robot_values
from tests.present import need

#: what the scenarios write fewer digits of, and how far that may be off: nobody places a battery
#: better than to a tenth of a millimetre, or weighs a robot better than to a tenth of a gram
ROUNDED = {
    "body_mass_kg": 5e-5, "center_height_m": 5e-5, "center_behind_m": 5e-5,
    "body_yaw_inertia_kg_m2": 5e-7, "roll_inertia_share": 5e-4, "pitch_inertia_share": 5e-4,
}  # fmt: skip


def content():
    return yaml.safe_load(robot_file.OWN.read_text(encoding="utf-8"))


@pytest.fixture
def changed(tmp_path):
    """Writes our robot with other values: ``changed({"wheels.radius_m": 0.03}) -> path``."""

    def to(values, without=()):
        tree = content()
        for place, value in values.items():
            *above, last = place.split(".")
            part = tree
            for key in above:
                part = part[key]
            part[last] = value
        for place in without:
            section, _, key = place.rpartition(".")
            del tree[section][key]
        path = tmp_path / "my.yaml"
        path.write_text(yaml.safe_dump(tree, sort_keys=False), encoding="utf-8")
        return path

    return to


def faults_of(path):
    with pytest.raises(InputError) as error:
        robot_file.read(path)
    assert str(path) in str(error.value)
    return error.value.faults


# --- what follows from it ---------------------------------------------------------------------


@pytest.mark.parametrize("scenario", ["robot", "robot_motor"])
def test_scenarios_hold_what_follows_from_the_file(scenario):
    known = built.parameters(robot_file.read())
    file = catalogue.load(scenario)
    held = {name: one.value for name, one in file.parameters.items() if name in known}
    assert len(held) >= 12
    for name, value in held.items():
        assert value == pytest.approx(known[name], rel=1e-12, abs=ROUNDED.get(name, 0)), name


def test_nothing_turns_our_robot_about_two_axes_at_once():
    """So that the engines, which get no products of inertia, miss nothing of it."""
    robot = robot_file.read()
    assert built.products_kg_m2(robot) == pytest.approx((0, 0, 0), abs=1e-8)


def test_the_motor_is_near_to_its_sheet():
    drive = robot_file.read().motor.drive
    k, resistance = drive.torque_constant_N_m_A, drive.resistance_Ohm
    stall = k * 6 / resistance - drive.rotor_friction_N_m
    slope = k**2 / resistance + drive.rotor_damping_N_m_s_rad
    turns = stall / slope / drive.gear_ratio * 60 / (2 * math.pi)
    # as the file says; SunFounder's 200 a minute are good to 10 %, and 0.8 kg·cm has one digit
    assert turns == pytest.approx(200, rel=0.1)
    assert drive.efficiency * drive.gear_ratio * stall == pytest.approx(0.8 * 0.0980665, rel=0.1)


def test_mass_and_inertia_are_those_of_points_spread_over_the_solids():
    """A hundred thousand points a solid, drawn evenly: good to half a percent."""
    rng = np.random.default_rng(1)
    made = built.chassis_solids(robot_file.read())
    plate_and_more = [one for one in made if not one.is_hole]
    points, weights = [], []
    for one in plate_and_more:
        drawn = rng.uniform(one.low_m, one.high_m, (100_000, 3))
        points.append(drawn)
        weights.append(np.full(len(drawn), one.volume_m3 / len(drawn)))
    at, volume = np.concatenate(points), np.concatenate(weights)
    for hole in (one for one in made if one.is_hole):
        inside = np.hypot(*(at[:, :2] - hole.position_m[:2]).T) < hole.radius_m
        inside &= np.abs(at[:, 2] - hole.position_m[2]) < hole.size_m[2] / 2
        volume = np.where(inside, 0.0, volume)
    assert solids.volume_m3(made) == pytest.approx(volume.sum(), rel=5e-4)
    mass = solids.mass_of(made, 1.0)
    share = volume / volume.sum()
    center = share @ at
    assert mass.center_m == pytest.approx(center, abs=2e-4)
    off = at - center
    squares = (share[:, None] * off).T @ off
    inertia = np.trace(squares) * np.eye(3) - squares
    assert mass.inertia_kg_m2 == pytest.approx(inertia, rel=5e-3, abs=5e-3 * inertia[0, 0])


@pytest.mark.parametrize("axis", "xyz")
def test_a_cylinder_has_the_moments_of_every_textbook(axis):
    index = "xyz".index(axis)
    size = [0.2, 0.2, 0.2]
    size[index] = 0.5
    mass = solids.mass_of([Solid(axis, tuple(size), (0.0, 0.0, 0.0))], 3.0)
    expected = [3.0 * (3 * 0.1**2 + 0.5**2) / 12] * 3
    expected[index] = 3.0 * 0.1**2 / 2
    assert np.diag(mass.inertia_kg_m2) == pytest.approx(expected, rel=1e-14)


def test_a_longer_chassis_is_one_number(changed):
    ours = built.parameters(robot_file.read())
    longer = built.parameters(robot_file.read(changed({"chassis.length_m": 0.22})))
    assert longer["body_mass_kg"] > ours["body_mass_kg"] + 0.03
    assert longer["center_behind_m"] > ours["center_behind_m"]
    assert longer["body_yaw_inertia_kg_m2"] > ours["body_yaw_inertia_kg_m2"]
    assert longer["wheel_radius_m"] == ours["wheel_radius_m"]


# --- what cannot be ---------------------------------------------------------------------------


def test_all_faults_are_told_at_once_with_place_value_and_cure(changed):
    path = changed(
        {"wheels.width_m": 0.2, "parts.battery.mass_kg": -0.14, "motor.drive.efficiency": 1.5},
        without=["motor.source"],
    )
    faults = "\n".join(faults_of(path))
    assert "wheels.width_m: 0.2 m is wider than the chassis (0.094 m)" in faults
    assert "parts.battery.mass_kg: expected a number greater than 0, found -0.14" in faults
    assert "motor.drive.efficiency: expected at most 1, found 1.5" in faults
    assert "motor.source: is missing; say where" in faults
    assert all(fault.startswith("line ") for fault in faults.splitlines())


def test_what_cannot_be_read_hides_nothing_else(changed):
    """Of names that are not known, texts and missing keys, and of values and sizes, all is told."""
    horn = {"text": "Horn", "size_m": [0.01, 0.01, 0.01], "position_m": [0, 0, 0.05]}
    path = changed(
        {
            "wheels.raduis_m": 0.03, "wheels.width_m": 0.2, "parts.battery.mass_kg": -0.14,
            "caster.behind_m": 0.3, "parts.imu.i2c": "x", "parts.imu.size_m": [0.016, "wide", 3],
            "parts.horn": horn,
        },
        without=["motor.source"],
    )  # fmt: skip
    places = [fault.split(": ")[0].partition(", ")[2] for fault in faults_of(path)]
    assert sorted(places) == sorted(
        [
            "wheels.raduis_m", "wheels.width_m", "parts.battery.mass_kg", "caster.behind_m",
            "parts.imu.i2c", "parts.imu.size_m.1", "parts.horn.mass_kg", "parts.horn.source",
            "motor.source",
        ]
    )  # fmt: skip


def test_a_part_in_the_way_is_told_beside_a_wrong_wire(changed):
    path = changed({"parts.imu.position_m": [0, 0, 0.02], "parts.imu.i2c": 3})
    first, second = faults_of(path)
    assert "overlap" in first
    assert "0x08 to 0x77" in second


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"chassis.density_kg_m3": 8.96}, "found 8.96; 1 g/cm³ is 1000 kg/m³"),
        ({"wheels.radius_m": 0.012}, "lower it, or raise wheels.radius_m"),
        ({"wheels.radius_m": "3,25"}, "found '3,25'; write a point: 3.25"),
        ({"wheels.radius_m": "3.25 cm"}, "write the number alone"),
        ({"wheels.mass_kg": True}, "wheels.mass_kg: expected a number, found 'true'"),
        ({"wheels.track_m": 0.1}, "does not fit between the wheels, which leave 0.08 m"),
        ({"caster.radius_m": 0.013}, "less than the ball's diameter 0.026 m"),
        ({"caster.height_m": 0.05}, "the plate is only 0.0435 m above the floor"),
        ({"caster.screws_m": 0.05}, "raise chassis.post_m"),
        ({"caster.behind_m": 0.12}, "raise chassis.length_m"),
        ({"parts.board.position_m": [-0.0473, 0, 0.0275]}, "board and breadboard overlap by"),
        ({"parts.battery.position_m": [0.018, 0.004, -0.00365]}, "move battery to y ="),
        ({"parts.battery.position_m": [0.2, 0, -0.00365]}, "between the caster (-0.08 m)"),
        ({"parts.imu.i2c": 0x29}, "0x29 is the address of imu too"),
        ({"parts.imu.i2c": 3}, "0x08 to 0x77"),
        ({"parts.driver.wires": {"AIN1": ["board.IO34", "out"]}}, "kind 'input'; for 'out' take"),
        ({"parts.driver.wires": {"AIN1": ["board.IO99", "out"]}}, "board.IO99 does not exist"),
        ({"parts.driver.wires": {"AIN1": ["bord.IO25", "out"]}}, "which is no part"),
        ({"parts.imu.wires": {"VCC": ["imu.VCC", "power"]}}, "imu.VCC leads to itself"),
        ({"parts.driver.wires": {"STBY": ["board.IO34", "in"]}}, "taken by left_encoder.DO"),
        ({"parts.driver.price": 3}, "needs price_source and currency"),
        ({"parts.imu.mass": 3}, "is not known here; known, the nearest first: mass_kg"),
        ({"parts.imu.mass_kg": "2 g"}, "expected a number, found '2 g'"),
        ({"chassis": 3}, "expected a mapping"),
        ({"motor.mirrored": False}, "motor.mirrored: expected true"),
        ({"parts.motor": content()["parts"]["imu"]}, "give this part another name"),
        ({"chassis.length_m": 179}, "expected at most 1 m, found 179; a millimetre is 0.001"),
        ({"parts.imu.mass_kg": 21}, "expected at most 20 kg, found 21; a gram is 0.001"),
        ({"parts.imu.position_m": [0, 0, 29.5]}, "position_m.2: expected at most 1 m"),
        ({"chassis.density_kg_m3": 1.24e6}, "density_kg_m3: expected at most 22590 kg/m³"),
        # what is drawn would weigh less than what is summed up
        ({"caster.behind_m": 0.05, "motor.size_m": [0.07, 0.02, 0.022]}, "of the post; make them"),
        ({"caster.screws_m": 0.003}, "so they are one"),
        ({"chassis.post_m": [0.016, 0.1]}, "wider than the plate (0.094 m)"),
        ({"parts.battery.position_m": [0.0158, 0, -0.03]}, "battery is 12 mm below the floor"),
        ({"parts.imu.mirrored": True, "parts.imu.position_m": [0, 0.02, 0.045]}, "mirrored; list"),
        ({"parts.imu.frame": "range_link"}, "range_link is the frame of imu; choose"),
        ({"parts.imu.frame": "base_link"}, "base_link is the frame of the driver"),
        ({"parts.encoder.frame": "disc"}, "list both as parts"),
        ({"parts.driver.pins": {"IO1": "io"}}, "parts.driver.pins: board lists its pins, too"),
        (
            {
                "parts.left_wheel": {
                    **content()["parts"]["imu"],
                    "i2c": 9,
                    "frame": "b",
                    "position_m": [0, 0, 0.06],
                }
            },
            "parts.left_wheel: another part is called left_wheel, too",
        ),
        (
            {"parts.imu.wires": {"=cmd|calc": ["board.GND", "ground"]}},
            "is not written as it must",
        ),
        ({"name": "Röbot"}, "a package of ROS 2 cannot be called so"),
    ],
)
def test_what_cannot_be_is_told_with_its_cure(changed, values, words):
    faults = faults_of(changed(values))
    assert any(words in fault for fault in faults), faults


def test_a_cure_cures(changed):
    """What the message names as the place of the battery balances the robot."""
    off = {"parts.imu.position_m": [0, 0.02, 0.0425], "parts.imu.mass_kg": 0.02}
    (fault,) = faults_of(changed(off))
    y = float(fault.partition("y = ")[2].partition(" m")[0])
    place = content()["parts"]["battery"]["position_m"]
    place[1] = y
    size = [0.058, 0.020, 0.029]
    moved = {**off, "parts.battery.position_m": place, "parts.battery.size_m": size}
    assert isinstance(robot_file.read(changed(moved)), Robot)


# --- another robot runs -----------------------------------------------------------------------


def test_a_chassis_may_be_of_foam():
    """Where its balance is another matter: boards of it have 12 kg/m³ and more."""
    made = robot_file.read()
    chassis = made.chassis.model_copy(update={"density_kg_m3": 12.0})
    faults = possible.faults(made.model_copy(update={"chassis": chassis}))
    assert "chassis.density_kg_m3" not in faults


def test_a_run_takes_another_robot(changed):
    need("mujoco")
    path = changed({"wheels.radius_m": 0.03})
    run = simcompare.run(
        "robot", engine="mujoco", contact="assisted", robot=path, set={"torque": "10mN*m"}
    )
    values = built.parameters(robot_file.read(path))
    mass, radius = values["body_mass_kg"] + 0.06, 0.03
    expected = (2 * 0.01 / radius) / (mass + 0.03)  # 2·J/r² is the mass of one wheel
    (row,) = [row for row in run.record.scores if row.measure == "acceleration"]
    assert row.truth == pytest.approx(expected, rel=1e-9)
    assert "--robot" in run.record.command
    assert run.passed


def test_a_scenario_without_a_robot_is_refused(changed):
    with pytest.raises(InputError, match="the scenario ball has no parameter of a robot"):
        simcompare.run("ball", engine="pymunk", robot=changed({}))


def test_values_that_the_scenario_does_not_take_are_told(changed):
    path = changed({"wheels.radius_m": 0.06, "parts.cables.mass_kg": 15})
    with pytest.raises(InputError, match=r"wheel_radius_m = 0.06 m is outside"):
        simcompare.run("robot", engine="mujoco", robot=path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is no file of a robot; begin one with: simcompare robot --template"),
        ("- 1\n", "is no file of a robot"),
        ("name: [", "not valid YAML"),
        ("name: robot\nname: robot\n", "stands twice"),
        ("name: robot\n", "chassis: is missing"),
    ],
)
def test_what_is_no_robot_is_told(tmp_path, text, words):
    path = tmp_path / "my.yaml"
    path.write_text(text, encoding="utf-8")
    faults = faults_of(path)
    assert any(words in fault for fault in faults), faults


def test_a_place_that_is_not_there_is_told(tmp_path):
    with pytest.raises(InputError, match=r"none\.yaml"):
        robot_file.read(tmp_path / "none.yaml")


def test_a_run_shows_the_robot_that_it_ran_and_says_what_is_left_out(changed):
    """What is drawn are the parts of the file; a body that is tilted is told in one sentence."""
    need("mujoco")
    path = changed({"chassis.length_m": 0.2})
    made = robot_file.read(path)
    run = simcompare.run("robot", engine="mujoco", contact="tuned", robot=path)
    chassis = run.record.scene["chassis"]
    plate = chassis.shapes[0]
    assert plate.size_m == pytest.approx((0.2, 0.094, 0.0085))
    assert len(chassis.shapes) == len(built.drawn(made))
    (caution,) = run.record.cautions
    assert f"I_xz = {built.products_kg_m2(made)[1]:.3g} kg·m²" in caution
    own = simcompare.run("robot", engine="mujoco", contact="tuned", robot=robot_file.OWN)
    assert own.record.cautions == ()  # nothing turns our own


def test_a_scenario_of_another_machine_says_what_it_takes(changed):
    """Its casters and its looks stay its own."""
    file = catalogue.load("odometry")
    taken = robot_values.taken(file, changed({}))
    assert taken.file is file
    assert set(taken.values) < set(built.parameters(robot_file.read()))
    (told,) = taken.left_out
    assert told.startswith("odometry takes only body_mass_kg, ")
    assert told.endswith(" from the robot's file; all else is its own")


def test_every_verb_says_what_is_left_out_of_a_robot(changed, call):
    need("mujoco")
    path = changed({"wheels.radius_m": 0.030})
    (told,) = robot_values.about_tilt(robot_file.read(path))
    for one in (
        simcompare.estimate("robot_motor", engine="mujoco", robot=path, draws=1),
        simcompare.control("robot", lambda time_s, seen: {}, engine="mujoco", robot=path),
        simcompare.uncertainty("robot", of="acceleration", robot=path),
        simcompare.uncertainty(
            "robot", of="torque_N_m/wheel_radius_m", u={"torque": "1%"}, robot=path
        ),
    ):
        assert repr(one).count(f"Caution: {told}.") == 1
    words = ("--format", "script", "--engine", "mujoco", "--robot", path, "-o", "robot.py")
    code, _, said = call("export", "robot", *words)
    assert (code, " ".join(said.split())) == (0, f"left out: {told}")
    with pytest.warns(UserWarning, match="product of inertia I_xz") as warned:
        simcompare.gym("robot_avoid", engine="mujoco", robot=path).close()
    assert [one.filename for one in warned] == [__file__]


def test_every_verb_that_runs_a_scenario_takes_a_robot(changed):
    """Wheels that are smaller make it faster: a = 2·τ/r/(M + m), of body and one wheel more."""
    need("mujoco")
    path = changed({"wheels.radius_m": 0.030})
    mass = built.parameters(robot_file.read(path))["body_mass_kg"] + 3 * 0.030
    expected = 2 * 0.02 / 0.030 / mass
    moved = simcompare.control("robot", lambda time_s, seen: {}, engine="mujoco", robot=path)
    time_s, x = moved.time_s, moved.signals["chassis.position_m"][:, 0]
    at = [np.searchsorted(time_s, t) for t in (0.2, 0.6, 1.0)]
    found = (x[at[2]] - 2 * x[at[1]] + x[at[0]]) / 0.4**2
    assert found == pytest.approx(expected, rel=3e-3)  # the scenario's own tolerance
    (way,) = simcompare.uncertainty("robot", of="acceleration", robot=path).ways
    assert way.found.budget.estimate == pytest.approx(expected, rel=1e-9)
    for text in (
        twin("robot", format="mjcf", robot=path).text,
        script("robot", engine="mujoco", robot=path).text,
    ):
        assert "0.03" in text
        assert "0.0325" not in text
    with pytest.warns(UserWarning, match="I_xz"):
        environment = simcompare.gym("robot_avoid", engine="mujoco", robot=path)
    with environment:
        assert environment.reset(seed=1)[1]["parameters"]["wheel_radius_m"] == 0.030
