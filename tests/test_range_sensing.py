"""The range sensor of many zones: where it looks, what it reads, and through whose rays."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from simcompare.engine import engines
from simcompare.engine.range_sensing import zone_rays
from simcompare.engine.sensing import complete
from simcompare.errors import InputError
from simcompare.model.scenes import scene
from simcompare.model.sensor import Sensor
from simcompare.model.settings import ASSISTED, TUNED, Settings
from simcompare.model.trajectory import Trajectory
from simcompare.results import store
from tests.present import INSTALLED, need

SENSOR = {"type": "time_of_flight", "body": "robot", "zones": 8, "position_m": [0.05, 0, 0]}
ROBOT = {"fixed": True, "shapes": [{"type": "box", "size_m": [0.1, 0.1, 0.1]}]}


def wall(distance_m, turn_rad=0.0):
    normal = [-math.cos(turn_rad), -math.sin(turn_rad), 0]
    return {"fixed": True, "shapes": [{"type": "plane", "normal": normal}],
            "position_m": [distance_m, 0, 0]}  # fmt: skip


def seen(bodies, **sensor):
    """What the sensor reads at one instant, by our rays."""
    made = scene(
        "view", {"robot": ROBOT, **bodies}, 0.01, 0.001, sensors={"tof": {**SENSOR, **sensor}}
    )
    signals = {
        f"{name}.{part}": np.array([getattr(body, part)])
        for name, body in made.moving_bodies().items()
        for part in ("position_m", "orientation_wxyz", "velocity_m_s", "rate_rad_s")
    }
    complete(made, np.zeros(1), signals, {})
    return signals["tof.range_m"][0]


# --- where it looks -------------------------------------------------------------------------------


def test_zones_go_along_rows_from_the_left_and_rows_from_the_top():
    rays = zone_rays(8)[:, 0]
    angles = np.degrees(np.arctan(rays[:, 1:])).reshape(8, 8, 2)
    np.testing.assert_allclose(angles[0, :, 0], 19.6875 - 5.625 * np.arange(8))
    np.testing.assert_allclose(angles[:, 0, 1], 19.6875 - 5.625 * np.arange(8))
    assert (angles[0, :, 1] == angles[0, 0, 1]).all()


def test_an_equal_division_of_a_plane_looks_a_little_further_out():
    outer = math.degrees(math.atan(zone_rays(8, "rectilinear")[0, 0, 1]))
    assert outer == pytest.approx(math.degrees(math.atan(0.875 * math.tan(math.radians(22.5)))))
    assert 19.9 < outer < 19.95


@pytest.mark.parametrize("geometry", ["equal_angle", "rectilinear"])
def test_rays_of_a_zone_fill_it_without_gaps(geometry):
    fine, coarse = zone_rays(4, geometry, 4), zone_rays(16, geometry)
    rows = fine.reshape(4, 4, 4, 4, 3).transpose(0, 2, 1, 3, 4).reshape(256, 3)
    np.testing.assert_allclose(rows, coarse[:, 0])


def test_what_is_up_and_left_is_seen_in_the_first_rows_and_columns():
    ball = {"fixed": True, "shapes": [{"type": "sphere", "radius_m": 0.05}],
            "position_m": [1.05, 0.25, 0.12]}  # fmt: skip
    image = seen({"ball": ball}).reshape(8, 8)
    found = np.argwhere(image < 4)
    azimuth = 3.5 - math.degrees(math.atan(0.25)) / 5.625
    elevation = 3.5 - math.degrees(math.atan(0.12)) / 5.625
    np.testing.assert_allclose(found.mean(axis=0), [elevation, azimuth], atol=0.5)
    assert 0.94 < image.min() < 1.0


def test_a_wall_across_is_equally_far_in_all_zones():
    np.testing.assert_allclose(seen({"wall": wall(1.05)}), 1.0, atol=1e-12)
    np.testing.assert_allclose(seen({"wall": wall(1.05)}, zones=4), np.ones(16), atol=1e-12)


def test_a_turned_wall_is_met_where_each_zone_crosses_it():
    turn = 0.35
    azimuth = np.radians(19.6875 - 5.625 * np.arange(8))
    wanted = math.cos(turn) / (math.cos(turn) + np.tan(azimuth) * math.sin(turn))
    image = seen({"wall": wall(1.05, turn)}).reshape(8, 8)
    np.testing.assert_allclose(image, np.tile(wanted, (8, 1)), atol=1e-12)


def test_a_sensor_that_is_turned_looks_the_other_way():
    back = {"orientation_wxyz": [0, 0, 0, 1], "position_m": [-0.05, 0, 0]}
    np.testing.assert_allclose(seen({"wall": wall(1.05)}, **back), 4.0)


def test_it_reads_its_reach_where_nothing_is_nearer():
    np.testing.assert_allclose(seen({}), 4.0)
    np.testing.assert_allclose(seen({"wall": wall(1.05)}, reach_m=0.7), 0.7)


def test_it_does_not_see_the_body_that_carries_it():
    np.testing.assert_allclose(seen({"wall": wall(1)}, position_m=[0, 0, 0]), 1.0, atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"zones": None}, "zones, 4 or 8"),
        ({"zones": 6}, "4 or 8"),
        ({"type": "barometer"}, "zones, 4 or 8"),
        ({"type": "barometer", "zones": None, "reach_m": 2.0}, "of a time_of_flight"),
        ({"geometry": "fisheye"}, "equal_angle"),
        ({"reach_m": -1.0}, "greater than 0"),
        ({"body": None}, "needs a body"),
        ({"errors": {"sheet": "vl53l5cx"}}, "takes no errors; ask for a real one"),
    ],
)
def test_what_no_such_sensor_has_is_refused(wrong, said):
    with pytest.raises(ValidationError, match=said):
        Sensor.model_validate({**SENSOR, **wrong})


# --- through whose rays ---------------------------------------------------------------------------


def moving():
    """A robot that glides towards a wall and past a ball; all of it in the x-z plane."""
    robot = {
        "mass_kg": 1.0, "inertia_kg_m2": [0.01] * 3, "velocity_m_s": [1.0, 0, 0],
        "shapes": [{"type": "box", "size_m": [0.1, 0.1, 0.1]}],
    }  # fmt: skip
    ball = {"fixed": True, "shapes": [{"type": "sphere", "radius_m": 0.1}],
            "position_m": [0.8, 0, 0.2]}  # fmt: skip
    parts = {"sensors": {"tof": SENSOR}, "gravity_m_s2": (0.0, 0.0, 0.0)}
    return scene("glide", {"robot": robot, "ball": ball, "wall": wall(1.5)}, 0.05, 0.001, **parts)


@pytest.mark.parametrize("engine", INSTALLED)
def test_every_engine_says_through_whose_rays_it_sees(engine):
    made, backend = moving(), engines.get(engine)
    own = backend.simulate(made, Settings(TUNED))
    assert "rays" not in own.helps
    casts_none = engine in ("pymunk", "box2d")
    assert ("tof.range_m" in own.lacks) == casts_none
    assert ("tof.range_m" in own.signals) != casts_none
    helped = backend.simulate(made, Settings(ASSISTED))
    assert ("rays" in helped.helps) == (casts_none or engine == "pybullet")
    assert "tof.range_m" in helped.signals
    # ours, from the same motion
    again = dict(helped.signals)
    del again["tof.range_m"]
    complete(made, helped.time_s, again, {})
    off_m = {"rapier": 2e-5}.get(engine, 1e-9)
    np.testing.assert_allclose(again["tof.range_m"], helped.signals["tof.range_m"], atol=off_m)
    image = helped.signals["tof.range_m"][0].reshape(8, 8)
    assert image[0, 3] < 0.8 < image[7, 3]  # the ball is above the middle


def test_a_help_that_is_left_out_leaves_the_engines_own_rays():
    need("pybullet")
    made, backend = moving(), engines.get("pybullet")
    ours, theirs = (
        backend.simulate(made, Settings(ASSISTED, helps=helps)).signals["tof.range_m"]
        for helps in (None, frozenset())
    )
    apart = np.abs(ours - theirs)
    assert apart.max() > 1e-6
    assert (apart > 0.01).mean() < 0.01  # where a ray only grazes the ball, one may miss it


def test_a_controller_reads_what_the_engine_sees_then():
    need("mujoco")
    made, times = moving(), []
    simulation = engines.get("mujoco").open(made, Settings(TUNED))
    try:
        for _ in range(3):
            times.append((simulation.time_s, simulation.read()))
            simulation.step(count=10)
        for time_s, readings in times:
            assert readings["tof.range_m"][60] == pytest.approx(1.45 - time_s, abs=1e-9)
            assert len(dict(readings)["tof.range_m"]) == 64
            assert readings["robot.position_m"][0] == pytest.approx(time_s, abs=1e-9)
    finally:
        simulation.close()


def test_all_zones_are_stored_and_read_back():
    run = Trajectory("mine", np.arange(3.0), {"tof.range_m": np.arange(3 * 64.0).reshape(3, 64)})
    columns = run.to_columns()
    assert list(columns)[:3] == ["time_s", "tof.range_m.0", "tof.range_m.1"]
    again = store._from_columns("mine", "", columns)
    np.testing.assert_array_equal(again.signals["tof.range_m"], run.signals["tof.range_m"])


@pytest.mark.engines("mujoco")
def test_a_script_that_casts_no_rays_is_refused():
    from simcompare.exporters.scripts import write

    with pytest.raises(InputError, match=r"sensor eye of time_of_flight.*casts no rays"):
        write.script("time_of_flight", engine="mujoco", contact=TUNED)
