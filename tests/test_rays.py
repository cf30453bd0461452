"""Rays that meet shapes: closed forms, and signed distances as an independent check."""

import math

import numpy as np
import pytest

from simcompare.engine.rays import Solids, cast
from simcompare.model.rotations import matrix_of
from simcompare.model.shapes import Box, Capsule, Cylinder, Plane, Sphere

#: rounding of sizes up to some metres, with a margin
EXACT_M = 1e-9
X = np.array([[1.0, 0.0, 0.0]])
START = np.zeros(3)


def met(shape, direction=(1.0, 0.0, 0.0), origin=(0.0, 0.0, 0.0)):
    along = np.array([direction], dtype=float) / np.linalg.norm(direction)
    hits = cast([shape], np.array(origin, dtype=float), along)
    return float(hits.distance_m[0]), hits.normal[0]


def turned(angle_rad, axis):
    axis = np.array(axis) / np.linalg.norm(axis)
    return (math.cos(angle_rad / 2), *(math.sin(angle_rad / 2) * axis))


# --- closed forms ---------------------------------------------------------------------------------


def test_a_sphere_is_met_by_pythagoras():
    far, radius, beside = 2.0, 0.5, 0.3
    ball = Sphere(type="sphere", radius_m=radius, position_m=(far, beside, 0))
    distance, normal = met(ball)
    depth = math.sqrt(radius**2 - beside**2)
    assert distance == pytest.approx(far - depth, abs=EXACT_M)
    np.testing.assert_allclose(normal, [-depth / radius, -beside / radius, 0], atol=EXACT_M)


def test_a_tilted_plane_is_met_where_it_crosses_the_ray():
    tilt = 0.4  # a wall at 1.5 m, turned about z
    wall = Plane(
        type="plane", position_m=(1.5, 0, 0), normal=(-2 * math.cos(tilt), 2 * math.sin(tilt), 0)
    )
    angle = 0.3
    distance, normal = met(wall, (math.cos(angle), math.sin(angle), 0))
    wanted = 1.5 * math.cos(tilt) / math.cos(tilt + angle)
    assert distance == pytest.approx(wanted, abs=EXACT_M)
    np.testing.assert_allclose(normal, [-math.cos(tilt), math.sin(tilt), 0], atol=EXACT_M)


def test_a_turned_box_is_met_at_its_edge_and_beside_it():
    cube = Box(
        type="box", size_m=(0.2, 0.2, 0.2), position_m=(1, 0, 0),
        orientation_wxyz=turned(math.pi / 4, (0, 0, 1)),
    )  # fmt: skip
    edge = 1 - 0.1 * math.sqrt(2)
    beside = 0.05
    distance, normal = met(cube, origin=(0, beside, 0))
    assert distance == pytest.approx(edge + beside, abs=EXACT_M)
    np.testing.assert_allclose(normal, [-math.sqrt(0.5), math.sqrt(0.5), 0], atol=EXACT_M)


def test_a_cylinder_is_met_on_its_side_and_on_its_end():
    tin = Cylinder(type="cylinder", radius_m=0.1, length_m=0.4, position_m=(1, 0, 0))
    distance, normal = met(tin, origin=(0, 0.06, 0.1))
    assert distance == pytest.approx(1 - 0.08, abs=EXACT_M)
    np.testing.assert_allclose(normal, [-0.8, 0.6, 0], atol=EXACT_M)
    distance, normal = met(tin, (0, 0, -1), origin=(1.05, 0, 2))
    assert distance == pytest.approx(1.8, abs=EXACT_M)
    np.testing.assert_allclose(normal, [0, 0, 1], atol=EXACT_M)


def test_a_capsule_is_met_on_its_side_and_on_its_caps():
    pill = Capsule(type="capsule", radius_m=0.1, length_m=0.4, position_m=(1, 0, 0))
    assert met(pill, origin=(0, 0, 0.1))[0] == pytest.approx(0.9, abs=EXACT_M)
    distance, normal = met(pill, origin=(0, 0, 0.26))
    assert distance == pytest.approx(1 - 0.08, abs=EXACT_M)
    np.testing.assert_allclose(normal, [-0.8, 0, 0.6], atol=EXACT_M)
    assert met(pill, (0, 0, -1), origin=(1, 0, 2))[0] == pytest.approx(1.7, abs=EXACT_M)


def test_the_nearest_of_several_is_met_and_named():
    row = [
        Sphere(type="sphere", radius_m=0.1, position_m=(3, 0, 0)),
        Box(type="box", size_m=(0.1, 1, 1), position_m=(2, 0, 0)),
        Plane(type="plane", position_m=(4, 0, 0), normal=(-1, 0, 0)),
    ]
    hits = cast(row, START, np.vstack((X, [[0.0, 1.0, 0.0]])))
    np.testing.assert_allclose(hits.distance_m, [1.95, np.inf], atol=EXACT_M)
    assert hits.index.tolist() == [1, -1]
    assert not hits.normal[1].any()


# --- what is not seen -----------------------------------------------------------------------------

SHAPES = {
    "sphere": Sphere(type="sphere", radius_m=0.3),
    "box": Box(type="box", size_m=(0.4, 0.6, 0.3)),
    "cylinder": Cylinder(type="cylinder", radius_m=0.3, length_m=0.5),
    "capsule": Capsule(type="capsule", radius_m=0.2, length_m=0.5),
    "plane": Plane(type="plane"),
}


@pytest.mark.parametrize("kind", SHAPES)
def test_what_is_behind_or_around_the_start_is_not_seen(kind):
    shape = SHAPES[kind].model_copy(update={"position_m": (-1, 0, -1)})
    assert math.isinf(met(shape)[0])
    inside = SHAPES[kind].model_copy(update={"position_m": (0, 0, 0.05)})
    for direction in np.vstack((np.eye(3), -np.eye(3))):
        assert math.isinf(met(inside, direction)[0])


@pytest.mark.parametrize("kind", ["box", "cylinder", "capsule"])
def test_rays_along_the_axes_of_a_shape_are_no_special_case(kind):
    shape = SHAPES[kind]
    for axis in np.vstack((np.eye(3), -np.eye(3))):
        almost = axis + 1e-12 * np.array([0.3, -0.5, 0.7])
        for origin in (-2 * axis, -2 * axis + 0.05 * (1 - np.abs(axis))):
            straight, slanted = (met(shape, d, origin)[0] for d in (axis, almost))
            assert straight == pytest.approx(slanted, abs=EXACT_M)
        aside = -2 * axis + (1 - np.abs(axis))
        assert math.isinf(met(shape, axis, aside)[0])


def test_without_shapes_or_rays_nothing_is_met():
    assert np.isinf(cast([], START, X).distance_m).all()
    assert cast([SHAPES["box"]], START, np.empty((0, 3))).distance_m.shape == (0,)


# --- an independent check: signed distances -------------------------------------------------------


def signed_distance(shape, places):
    """Distance of places (n, 3) from the surface, negative inside."""
    p = places - np.array(shape.position_m)
    if shape.type == "plane":
        return p @ shape.normal
    p = p @ matrix_of(shape.orientation_wxyz)
    match shape.type:
        case "sphere":
            return np.linalg.norm(p, axis=1) - shape.radius_m
        case "box":
            q = np.abs(p) - np.array(shape.size_m) / 2
            outside = np.linalg.norm(np.maximum(q, 0), axis=1)
            return outside + np.minimum(q.max(axis=1), 0)
        case "cylinder":
            q = np.column_stack(
                (np.hypot(p[:, 0], p[:, 1]) - shape.radius_m, np.abs(p[:, 2]) - shape.length_m / 2)
            )
            outside = np.linalg.norm(np.maximum(q, 0), axis=1)
            return outside + np.minimum(q.max(axis=1), 0)
    half = shape.length_m / 2
    p[:, 2] -= np.clip(p[:, 2], -half, half)
    return np.linalg.norm(p, axis=1) - shape.radius_m


def some_shapes(rng, count):
    """Shapes anywhere within a metre, turned anyhow."""
    found = []
    for i in range(count):
        kind = ("sphere", "box", "cylinder", "capsule")[i % 4]
        q = rng.normal(size=4)
        moved = {
            "position_m": tuple(rng.uniform(-1, 1, 3)),
            "orientation_wxyz": tuple(q / np.linalg.norm(q)),
        }
        found.append(SHAPES[kind].model_copy(update=moved))
    return found


@pytest.mark.parametrize("seed", range(3))
def test_rays_end_on_the_surface_and_cross_nothing_before(seed):
    rng = np.random.default_rng(seed)
    shapes = [*some_shapes(rng, 12), Plane(type="plane", position_m=(0, 0, -1.5))]
    origins = 4 * rng.normal(size=(400, 3))
    origins[:, 2] = np.abs(origins[:, 2])
    directions = rng.uniform(-1, 1, (400, 3)) - origins
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    outside = np.min([signed_distance(one, origins) for one in shapes], axis=0) > 0
    origins, directions = origins[outside], directions[outside]
    hits = Solids(shapes).cast(origins, directions)
    assert np.isfinite(hits.distance_m).mean() > 0.9
    assert len(set(hits.index.tolist())) > 8
    for number, shape in enumerate(shapes):
        own = hits.index == number
        place = origins[own] + hits.distance_m[own, None] * directions[own]
        assert np.abs(signed_distance(shape, place)).max(initial=0) < EXACT_M
        # the normal is where the distance grows fastest; central differences, rounded to 1e-9
        slope = np.column_stack(
            [
                (signed_distance(shape, place + e) - signed_distance(shape, place - e)) / 2e-6
                for e in 1e-6 * np.eye(3)
            ]
        )
        smooth = np.abs(np.linalg.norm(slope, axis=1) - 1) < 1e-6  # not on an edge
        np.testing.assert_allclose(slope[smooth], hits.normal[own][smooth], atol=1e-5)
        for part in np.linspace(0, 1, 40, endpoint=False):
            ahead = origins + part * np.minimum(hits.distance_m, 10)[:, None] * directions
            assert signed_distance(shape, ahead).min() > -EXACT_M


def test_many_rays_are_the_same_as_each_alone():
    rng = np.random.default_rng(9)
    solids = Solids(some_shapes(rng, 20))
    directions = rng.normal(size=(5000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origin = np.array([5.0, 0, 0])
    whole, index = solids.distances(origin, directions)
    for i in rng.integers(0, 5000, 50):
        alone = solids.cast(origin[None], directions[i : i + 1])
        assert alone.distance_m[0] == pytest.approx(whole[i], abs=EXACT_M)
        assert alone.index[0] == index[i]
    assert (index >= 0).any()


def test_digits_are_kept_far_away():
    ball = Sphere(type="sphere", radius_m=0.05, position_m=(1000, 0.03, 0))
    # a ball a kilometre away: distances are rounded to 1e-13 m, squares of them to 1e-10 m²
    assert met(ball)[0] == pytest.approx(1000 - 0.04, abs=EXACT_M)


def test_what_is_beside_the_view_is_left_out_and_nothing_else():
    rng = np.random.default_rng(2)
    shapes = [*some_shapes(rng, 60), Plane(type="plane", position_m=(0, 0, -0.6))]
    solids, origin = Solids(shapes), np.array([-0.5, 0.2, 3.0])
    for _ in range(20):
        middle = rng.normal(size=3)
        narrow = middle / np.linalg.norm(middle) + rng.uniform(-0.2, 0.2, (50, 3))
        narrow /= np.linalg.norm(narrow, axis=1, keepdims=True)
        together, index = solids.distances(origin, narrow)
        apart, same = solids.distances(np.tile(origin, (50, 1)), narrow)
        np.testing.assert_allclose(together, apart, rtol=0, atol=EXACT_M)
        np.testing.assert_array_equal(solids.ranges(origin, narrow), together)
        np.testing.assert_array_equal(index, same)
