"""The robot among obstacles: its truth, arenas from seeds, what it sees, and bad arenas."""

import math

import numpy as np
import pytest

from simcompare.engine.range_sensing import middle_rays
from simcompare.errors import InputError
from simcompare.scenarios import catalogue
from simcompare.scenarios.robot_avoid import drawing, reference, seeing, task
from simcompare.scenarios.robot_motor import reference as motor

FILE = catalogue.load("robot_avoid")


def test_the_truth_is_that_of_an_empty_floor():
    empty = catalogue.load("robot_motor").resolve({"voltage_V": 3.0}).parameters
    t = np.linspace(0, 0.5, 6)
    ours, theirs = reference.reference(FILE.resolve().parameters, t), motor.reference(empty, t)
    assert ours.keys() == theirs.keys()
    for name, values in theirs.items():
        np.testing.assert_array_equal(ours[name], values)


def test_an_arena_is_the_seed_s_and_leaves_room_for_the_robot():
    for seed in range(30):
        drawn = drawing.draw(np.random.default_rng(seed))
        assert drawn == drawing.draw(np.random.default_rng(seed))
        p = FILE.resolve(drawn).parameters
        start = (-p["center_behind_m"], 0.0)
        plan = drawing.Plan(p)
        assert plan.faults(*start) == []
        assert math.dist((0, 0), plan.goal) >= 1.0
        # a free way from the start to the goal, on a grid of 2 cm, by filling
        assert reaches(plan, (0.0, 0.0))


def reaches(plan, start, cell_m=0.02):
    todo, seen = [(round(start[0] / cell_m), round(start[1] / cell_m))], set()
    while todo:
        i, j = place = todo.pop()
        x, y = i * cell_m, j * cell_m
        if place in seen or min(plan.gaps(x, y).values()) < drawing.ROBOT_RADIUS_M:
            continue
        if math.dist((x, y), plan.goal) < task.GOAL_M:
            return True
        seen.add(place)
        todo += [(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)]
    return False


def test_gaps_are_those_to_walls_boxes_and_posts():
    p = dict(FILE.resolve().parameters)
    p |= {"arena_x_m": 0.0, "arena_y_m": 0.0, "arena_turn_rad": math.pi / 2}
    p |= {"box_1_x_m": 0.5, "box_1_y_m": 0.0, "box_1_size_m": 0.2, "box_1_turn_rad": math.pi / 4}
    p |= {"post_1_x_m": 0.0, "post_1_y_m": 0.3, "post_1_radius_m": 0.1}
    gaps = drawing.Plan(p).gaps(0.0, 0.0)
    # the corner of a box that is turned by 45° looks at the origin
    assert gaps["box_1"] == pytest.approx(0.5 - 0.1 * math.sqrt(2), abs=1e-15)
    assert gaps["post_1"] == pytest.approx(0.2, abs=1e-15)
    assert gaps["the walls"] == 1.0
    assert drawing.Plan(p).gaps(0.02, 0.31)["post_1"] < 0
    assert drawing.Plan(p).gaps(0.5, 0.05)["box_1"] == pytest.approx(-0.1 + 0.05 / math.sqrt(2))


def test_zones_share_45_degrees_from_above_left():
    rays, _ = middle_rays(8)
    np.testing.assert_allclose(np.linalg.norm(rays, axis=1), 1, atol=1e-15)
    x, y, z = rays[0]
    assert math.degrees(math.atan2(y, x)) == pytest.approx(19.6875)
    assert math.degrees(math.atan2(z, x)) == pytest.approx(19.6875)
    x, y, z = rays[8 * 7 + 4]
    assert math.degrees(math.atan2(y, x)) == pytest.approx(-2.8125)
    assert math.degrees(math.atan2(z, x)) == pytest.approx(-19.6875)


def test_rays_meet_walls_boxes_posts_and_the_floor():
    p = dict(FILE.resolve().parameters)
    far = {f"{name}_y_m": 2.9 for name in (*drawing.BOXES, *drawing.POSTS)}
    given = {n: v for n, v in p.items() if n in FILE.parameters} | far
    given |= {"arena_x_m": 0.1, "arena_y_m": 0.0, "arena_turn_rad": 0.5}
    given |= {"box_1_x_m": 0.5, "box_1_y_m": 0.0, "box_1_size_m": 0.2, "box_1_turn_rad": 0.3}
    given |= {"post_1_x_m": 0.0, "post_1_y_m": 0.4, "post_1_radius_m": 0.05}
    scene, _ = seeing.standing(FILE.resolve(given))
    eye, slope = np.array((0.0, 0.0, 0.06)), math.radians(-20)
    back = (-math.cos(0.5), -math.sin(0.5), 0)
    down = (0, math.cos(slope), math.sin(slope))
    rays = np.array([(1, 0, 0), (0, 1, 0), down, (0, 0, 1), back])
    found, _ = scene.distances(eye, rays)
    assert found[0] == pytest.approx(0.5 - 0.1 / math.cos(0.3), abs=1e-12)
    assert found[1] == pytest.approx(0.35, abs=1e-12)
    assert found[2] == pytest.approx(0.06 / math.sin(-slope), abs=1e-12)
    assert found[3] == math.inf
    # the wall behind: 1 m from the arena's middle, which is 0.1 m ahead
    assert found[4] == pytest.approx(1 - 0.1 * math.cos(0.5), abs=1e-12)


#: of the middles of the zones in the middle columns
SIDE_RAD = math.radians(45 / 16)
#: the zones of the upper four rows see the wall alone
UP = slice(0, 32)


def before_a_wall(factor, seed=0, control_Hz=10.0):
    """An eye of which the arena's wall is 0.3 m away when the chassis is at (0, 0, 0.04)."""
    far = {f"{name}_y_m": 2.9 for name in (*drawing.BOXES, *drawing.POSTS)}
    walls = {"arena_x_m": 0.36 - drawing.HALF_M, "arena_y_m": 0.0, "arena_turn_rad": 0.0}
    return seeing.Eye(FILE.resolve(far | walls), factor, control_Hz, np.random.default_rng(seed))


def pose(x=0.0, turn_rad=0.0):
    return np.array((x, 0, 0.04, math.cos(turn_rad / 2), 0, 0, math.sin(turn_rad / 2)))


def test_an_ideal_sensor_reads_the_truth_now():
    eye = before_a_wall(0.0)
    eye.see(pose(-0.2))
    ranges, valid = eye.see(pose())
    np.testing.assert_allclose(ranges[UP], 0.3, atol=1e-12)
    assert valid[UP].all()
    # the lowest row sees the floor, 0.06 m below: 0.06 m / tan(19.6875°) along the axis
    np.testing.assert_allclose(ranges[-8:], 0.06 / math.tan(math.radians(19.6875)), atol=1e-12)
    ranges, valid = eye.see(np.array((0, 0, 9.0, 1, 0, 0, 0)))
    assert (ranges[UP] == 4.0).all()
    assert not valid[UP].any()


def test_a_real_sensor_reads_as_its_data_sheet_says():
    off = {
        factor: np.concatenate(
            [before_a_wall(factor, seed).see(pose())[0][UP] - 0.3 for seed in range(200)]
        )
        for factor in (1.0, 2.0)
    }
    # 2.7 standard deviations are 5 % in the dark, and up to 8 % in the most light that is drawn
    assert 0.05 < 2.7 * off[1.0].std() / 0.3 < 0.08
    # 200 devices tell the deviation of what their zones share to 5 %; light adds a little
    assert off[2.0].std() == pytest.approx(2 * off[1.0].std(), rel=0.1)


def test_light_hides_what_is_far_away():
    def seen(factor):
        looks = (before_a_wall(factor, seed).see(pose(-1.5))[1][24:32] for seed in range(40))
        return np.mean([valid.mean() for valid in looks])

    # row 3 looks at the wall 1.8 m away: in the dark only white targets are found there
    assert seen(0.0) == 1
    assert seen(4.0) < seen(0.2) < 0.9


@pytest.mark.parametrize("control_Hz", [10.0, 15.0])
def test_a_frame_of_a_real_sensor_is_half_a_period_old(control_Hz):
    eye = before_a_wall(1e-6, control_Hz=control_Hz)
    for k in range(4):
        ranges, _ = eye.see(pose(0.3 * k / control_Hz))
    # at 0.3 m/s; it counts millimetres
    expected = 0.3 - 0.3 * (3 / control_Hz - 1 / 30)
    np.testing.assert_allclose(ranges[UP], expected, atol=0.6e-3)


def test_what_was_seen_is_remembered_where_it_is_for_three_seconds():
    far = {f"{name}_y_m": 2.9 for name in (*drawing.BOXES, *drawing.POSTS)}
    post = {"post_1_x_m": 0.5, "post_1_y_m": 0.0, "post_1_radius_m": 0.05}
    arena = {"arena_x_m": 0.3, "arena_y_m": 0.0, "arena_turn_rad": 0.0}
    scenario = FILE.resolve(far | post | arena)
    eye = seeing.Eye(scenario, 0.0, 10.0, np.random.default_rng(0))
    assert not eye.memory.around(0, 0, 0).any()
    eye.see(pose())
    # rays 2.8125° beside the middle, from 0.06 m ahead, meet the post so far from the origin
    aside, along = 0.44 * math.sin(SIDE_RAD), 0.44 * math.cos(SIDE_RAD)
    far_m = along - math.sqrt(0.05**2 - aside**2)
    x, y = 0.06 + far_m * math.cos(SIDE_RAD), far_m * math.sin(SIDE_RAD)
    away_m = math.hypot(x, y)
    assert eye.memory.around(0, 0, 0)[0] == pytest.approx(1 - away_m / 0.6, abs=1e-12)
    # the floor is no obstacle, and nothing else is as near
    assert (eye.memory.around(0, 0, 0) > 0).sum() == 1
    # turned to the left by 90° it is on the right: the 18th of 24 directions
    eye.see(pose(turn_rad=math.pi / 2))
    around = eye.memory.around(0, 0, math.pi / 2)
    assert around.argmax() == 18
    assert around[18] == pytest.approx(1 - away_m / 0.6, abs=1e-12)
    # driven past it, it is behind
    around = eye.memory.around(0.7, 0, 0)
    assert around.argmax() == 12
    assert around[12] == pytest.approx(1 - math.hypot(0.7 - x, y) / 0.6, abs=1e-12)
    for _ in range(30):
        eye.see(pose(turn_rad=math.pi / 2))
    assert not eye.memory.around(0, 0, 0).any()


def test_what_stands_on_the_start_or_on_the_goal_is_told_at_once():
    given = {"box_1_x_m": 0.0, "box_1_y_m": 0.05, "post_2_x_m": 1.0, "post_2_y_m": 0.0}
    given |= {"goal_x_m": 1.0, "goal_y_m": 0.0}
    with pytest.raises(InputError) as caught:
        task.Episode(FILE.resolve(given), 0.0, 10.0, np.random.default_rng(0))
    assert len(caught.value.faults) == 2
    assert "start at (-0.02, 0) m: box_1 is" in str(caught.value)
    assert "goal at (1, 0) m: post_2 is -0.07 m away; expected more than 0 m" in str(caught.value)
