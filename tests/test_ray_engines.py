"""Rays through each engine's own ray casting, held against ours."""

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.engine.features import Feature
from simcompare.engine.ray_scene import RayScene
from simcompare.model.scenes import scene
from simcompare.model.settings import DEFAULT, TUNED, Settings
from simcompare.model.trajectory import BODY_SIGNALS
from tests.present import INSTALLED

CASTING = [name for name in INSTALLED if Feature.RAYS in engines.get(name).features]
REACH_M = 3.0
#: on flat and on round shapes; single precision rounds places of some metres to 1e-6 m, and roots
#: of them, where round shapes are met aslant, to some 1e-5 m (measured: 3e-5); Bullet meets all but
#: planes by an iteration that stops up to 10 mm beside them (measured: 8 mm)
OFF_M = {"rapier": (5e-6, 1e-4), "pybullet": (1e-2, 1e-2)}
EXACT = (1e-9, 1e-9)


def body(shape, **more):
    return {"mass_kg": 1.0, "inertia_kg_m2": [0.01] * 3, "shapes": [shape], **more}


def fixed(shape, **more):
    return {"fixed": True, "shapes": [shape], **more}


TURNED = [0.9, 0.1, -0.3, (1 - 0.81 - 0.01 - 0.09) ** 0.5]
FLAT = {
    "floor": fixed({"type": "plane"}),
    "wall": fixed(
        {"type": "box", "size_m": [0.1, 1.5, 0.8], "position_m": [0, 0.1, 0]},
        position_m=[2.2, 0, 0.5], orientation_wxyz=TURNED,
    ),
    "crate": body(
        {"type": "box", "size_m": [0.3, 0.2, 0.2]}, position_m=[1.0, -0.4, 0.6],
        velocity_m_s=[0.5, 1.0, 0.5], rate_rad_s=[1.0, 2.0, 3.0],
    ),
}  # fmt: skip
ROUND = {
    "ball": body({"type": "sphere", "radius_m": 0.2}, position_m=[1.2, 0.6, 0.7]),
    "tin": body(
        {"type": "cylinder", "radius_m": 0.15, "length_m": 0.3}, position_m=[1.0, -0.4, 0.6],
        rate_rad_s=[1.0, 2.0, 0.0],
    ),
    "pill": fixed(
        {"type": "capsule", "radius_m": 0.1, "length_m": 0.4}, position_m=[1.3, 0, 0.3],
        orientation_wxyz=TURNED,
    ),
}  # fmt: skip


def some_scene(bodies):
    """The carrier flies with its flag on a hinge; both would hide everything else."""
    carrier = body(
        {"type": "sphere", "radius_m": 0.15}, position_m=[0, 0, 0.9], velocity_m_s=[0.4, 0, 0.3],
        rate_rad_s=[0, 0, 0.5],
    )  # fmt: skip
    flag = body({"type": "box", "size_m": [0.05, 0.3, 0.05]}, position_m=[0.5, 0, 1.0])
    hinge = {
        "type": "hinge", "parent": "carrier", "child": "flag", "axis": [0, 0, 1], "rate": 3.0,
        "anchor_m": [0.2, 0, 0],
    }  # fmt: skip
    return scene(
        "rays", {"carrier": carrier, "flag": flag, **bodies}, 0.1, 0.001, joints={"pole": hinge}
    )


def rays(count=1500):
    rng = np.random.default_rng(4)
    along = np.column_stack((np.ones(count), rng.uniform(-0.8, 0.8, (count, 2))))
    return along / np.linalg.norm(along, axis=1, keepdims=True)


#: [rad], upwards, downwards and to both sides
ASIDE = 0.01 * np.array([[0, 0, 1], [0, 0, -1], [0, 1, 0], [0, -1, 0]])


def both(simulation, without, aside=(0, 0, 0)):
    """Distances by the engine and by us, rays beginning in the carrier."""
    state, along = simulation.state, rays() + aside
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    signals = {
        f"{name}.{part}": np.array([getattr(motion, part)])
        for name, motion in state.bodies.items()
        for part in BODY_SIGNALS
    }
    origin = np.array(state.bodies["carrier"].position_m)
    seen = RayScene(simulation.scenario, without)
    ours = seen.distances(origin[None], along[None], signals)[0]
    theirs = simulation.cast_rays(tuple(origin.tolist()), along, without, REACH_M)
    assert len(theirs) == len(along)
    hits = seen.cast(origin[None], along[None], signals)
    np.testing.assert_array_equal(hits.distance_m[0], ours)
    return np.array(theirs), np.where(ours <= REACH_M, ours, np.inf), hits


@pytest.mark.parametrize("engine", CASTING)
@pytest.mark.parametrize(("kind", "bodies"), [(0, FLAT), (1, ROUND)], ids=["flat", "round"])
def test_an_engine_meets_what_we_meet(engine, kind, bodies):
    off_m = OFF_M.get(engine, EXACT)[kind]
    simulation = engines.get(engine).open(some_scene(bodies), Settings(TUNED))
    try:
        for _ in range(3):
            theirs, ours, hits = both(simulation, "carrier")
            # a ray along a rim is a hit for one and none for the other
            beside = np.all(
                [both(simulation, "carrier", aside)[2].index == hits.index for aside in ASIDE], 0
            )[0]
            met = np.isfinite(ours)
            steep = -np.einsum("ij,ij->i", hits.normal[0], rays()) > 0.15
            sure = met & steep & beside
            assert 100 < sure.sum() < len(ours)
            np.testing.assert_allclose(theirs[sure], ours[sure], rtol=0, atol=off_m)
            clear = beside & ~met
            assert clear.sum() > 100
            assert np.isinf(theirs[clear]).all()
            assert len(set(hits.index[0].tolist())) == len(bodies) + 2  # the flag, and nothing
            for _ in range(20):
                simulation.step()
    finally:
        simulation.close()


@pytest.mark.parametrize("engine", CASTING)
def test_a_body_that_was_put_elsewhere_is_seen_there(engine):
    simulation = engines.get(engine).open(some_scene(FLAT), Settings(DEFAULT))
    try:
        start = simulation.state
        for _ in range(30):
            simulation.step()
        simulation.set_state(start)
        theirs, ours, _ = both(simulation, "carrier")
        near = np.isfinite(ours) & np.isfinite(theirs)
        assert near.sum() > 100
        off_m = OFF_M.get(engine, EXACT)[0]
        np.testing.assert_allclose(theirs[near], ours[near], rtol=0, atol=off_m)
    finally:
        simulation.close()


@pytest.mark.parametrize("engine", CASTING)
def test_looking_changes_nothing(engine):
    ends = []
    for looks in (False, True):
        simulation = engines.get(engine).open(some_scene(FLAT), Settings(TUNED))
        try:
            for _ in range(50):
                simulation.step()
                if looks:
                    simulation.cast_rays((0.0, 0.0, 0.9), rays(20), "carrier", REACH_M)
            ends.append(simulation.state)
        finally:
            simulation.close()
    assert ends[0] == ends[1]


@pytest.mark.parametrize("engine", CASTING)
def test_nothing_within_reach_is_infinitely_far(engine):
    simulation = engines.get(engine).open(some_scene(FLAT), Settings(TUNED))
    try:
        found = simulation.cast_rays((0.0, 0.0, 5.0), np.array([[0.0, 0, 1], [0, 0, -1]]), "", 4.5)
        assert np.isinf(found[0])
        assert np.isinf(found[1]) or found[1] < 4.5
        assert np.isinf(simulation.cast_rays((9.0, 0.0, 1.0), np.array([[0.0, 0, -1]]), "", 0.9))
        down = simulation.cast_rays((9.0, 0.0, 1.0), np.array([[0.0, 0, -1]]), "", 1.1)
        assert down[0] == pytest.approx(1.0, abs=1e-6)
    finally:
        simulation.close()
