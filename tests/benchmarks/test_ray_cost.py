"""Rays of a range sensor beside 20 obstacles: MuJoCo's own call, our way to it, and our casting.

``64 rays`` are the middles of 8×8 zones, ``1600 rays`` what a real sensor is worked out from. Our
way to MuJoCo's call brings the bodies up to date and tells where nothing is met.
"""

import statistics
import time

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.engine.kinematics import placed_shapes
from simcompare.engine.range_sensing import zone_rays
from simcompare.engine.rays import Solids
from simcompare.model.scenes import scene
from simcompare.model.settings import TUNED, Settings

ORIGIN, REACH_M, ROUNDS, CALLS = (0.0, 0.0, 0.1), 4.0, 25, 50


def obstacles():
    """A robot on a floor, and 20 boxes and cylinders before it."""
    rng = np.random.default_rng(0)
    robot = {
        "mass_kg": 0.5, "inertia_kg_m2": [0.001] * 3, "position_m": [0, 0, 0.1],
        "shapes": [{"type": "box", "size_m": [0.1, 0.1, 0.05]}],
    }  # fmt: skip
    bodies = {"robot": robot, "floor": {"fixed": True, "shapes": [{"type": "plane"}]}}
    for i in range(20):
        (x, y), turn = rng.uniform((0.3, -1), (2, 1)), rng.uniform(0, 0.75)
        box = {"type": "box", "size_m": [0.1, 0.12, 0.2]}
        shape = box if i % 2 else {"type": "cylinder", "radius_m": 0.05, "length_m": 0.2}
        bodies[f"obstacle{i}"] = {
            "fixed": True, "shapes": [shape], "position_m": [x, y, 0.1],
            "orientation_wxyz": [float(np.cos(turn)), 0, 0, float(np.sin(turn))],
        }  # fmt: skip
    return scene("obstacles", bodies, 0.1, 0.001)


@pytest.mark.parametrize("whose", ["adapter", "ours"])
@pytest.mark.parametrize("in_a_row", [1, 5])
@pytest.mark.engines("mujoco")
def test_cost_of_rays(benchmark, in_a_row, whose):
    import mujoco

    made, rays = obstacles(), zone_rays(8, "equal_angle", in_a_row).reshape(-1, 3)
    along = np.ascontiguousarray(rays / np.linalg.norm(rays, axis=1)[:, None])
    count, flat, start = len(along), along.ravel(), np.array(ORIGIN)
    simulation = engines.get("mujoco").open(made, Settings(TUNED))
    model, data = simulation._model, simulation.data
    own, geoms, distances = model.body("robot").id, np.empty(count, np.int32), np.empty(count)
    fixed = [body for name, body in made.bodies.items() if name != "robot"]
    solids = Solids([one for body in fixed for one in placed_shapes(body, body.shapes)])

    def bare():
        mujoco.mj_multiRay(
            model, data, start, flat, None, True, own, geoms, distances, None, count, REACH_M
        )

    def measured():
        if whose == "ours":
            return solids.ranges(start, along)
        return simulation.cast_rays(ORIGIN, along, "robot", REACH_M)

    def timed(call):
        started = time.process_time()
        for _ in range(CALLS):
            call()
        return (time.process_time() - started) / CALLS

    benchmark.group = f"{count} rays, {whose}"
    benchmark.pedantic(measured, rounds=ROUNDS)
    pairs = [(timed(bare), timed(measured)) for _ in range(ROUNDS)]
    ratios = sorted(ours / theirs for theirs, ours in pairs)
    benchmark.extra_info["ratio"] = statistics.median(ratios)
    benchmark.extra_info["low"], benchmark.extra_info["high"] = ratios[2], ratios[-3]
    benchmark.extra_info["bare_ms"] = 1e3 * statistics.median(theirs for theirs, _ in pairs)
    near = (distances >= 0) & (distances < REACH_M)
    np.testing.assert_allclose(np.asarray(measured())[near], distances[near], atol=1e-9)
    simulation.close()
