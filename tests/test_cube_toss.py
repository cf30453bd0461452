"""Boxes that bounce, slide and turn: exact flights, no gained energy, Coulomb; real tosses."""

import functools
import math
import os

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.errors import InputError, Unsupported
from simcompare.fitting.tosses import engines as toss_engines
from simcompare.fitting.tosses import replay, search, tosses
from simcompare.fitting.tosses.roles import parameters_of, roles_of
from simcompare.fitting.tosses.setup import Setup
from simcompare.model.fittable import Grid
from simcompare.model.rotations import multiply, quaternions_of, rotate
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue

FILE = catalogue.load("cube_toss")
ROLES = roles_of(FILE, {})
ENGINES = ("mujoco", "pybullet", "dart")
WIDTH, MASS, INERTIA, G = 0.1048, 0.37, 0.00081, 9.80665
STILL = {f"start_velocity_{axis}_m_s": 0.0 for axis in "xyz"} | {
    f"start_rate_{axis}_rad_s": 0.0 for axis in "xyz"
}
needs_data = pytest.mark.skipif(
    not os.environ.get("SIMCOMPARE_DATA"), reason="SIMCOMPARE_DATA names no folder of recordings"
)


@functools.cache
def tossed(engine, step_s=0.0005, **parameters):
    scenario = FILE.resolve(parameters, step_s=step_s)
    return scenario, engines.get(engine).simulate(scenario, Settings())


def pose(axis, angle):
    turn = quaternions_of(np.array([axis]) / np.linalg.norm(axis) * angle)[0]
    return {f"start_orientation_{c}": float(v) for c, v in zip("wxyz", turn, strict=True)}


FLAT = pose((1, 0, 0), 0.0)
#: on an edge, on a corner, and the heights of the centre when they touch
POSES = {
    "face": (FLAT, WIDTH / 2),
    "edge": (pose((1, 0, 0), math.pi / 4), WIDTH / math.sqrt(2)),
    "corner": (pose((1, -1, 0), math.acos(1 / math.sqrt(3))), WIDTH * math.sqrt(3) / 2),
}


def sliding(engine, friction, speed=0.0, rate=0.0, yaw=0.0, slope=0.0, duration_s=0.5):
    """A box that lies on a table, or on a slope, and slides or spins."""
    values = {
        **STILL, **pose((0, 0, 1), yaw), "start_z_m": WIDTH / 2, "friction": friction,
        "start_velocity_x_m_s": speed, "start_rate_z_rad_s": rate, "duration_s": duration_s,
        "restitution": 0.0,
    }  # fmt: skip
    scenario = FILE.resolve(values, step_s=0.0005)
    tilted = (G * math.sin(slope), 0.0, -G * math.cos(slope))
    world = scenario.world.model_copy(update={"gravity_m_s2": tilted})
    scenario = scenario.model_copy(update={"world": world})
    return engines.get(engine).simulate(scenario, Settings()).signals


@pytest.mark.parametrize("engine", ENGINES)
def test_flight_is_exact_until_the_first_touch(engine):
    scenario, found = tossed(engine)
    body, t = scenario.bodies["cube"], found.time_s[:, None]
    place, turn = found.signals["cube.position_m"], found.signals["cube.orientation_wxyz"]
    toss = tosses.Toss("toss", found.time_s, place, turn)
    flying = slice(0, tosses.samples_in_flight(toss, WIDTH))
    assert flying.stop > 100
    fall = np.array(scenario.world.gravity_m_s2) * t**2 / 2
    exact = np.array(body.position_m) + np.array(body.velocity_m_s) * t + fall
    np.testing.assert_allclose(place[flying], exact[flying], atol=1e-9)
    # all moments of inertia are equal, so the rate stays
    whole = multiply(quaternions_of(t * np.array(body.rate_rad_s)), turn[:1].repeat(len(t), 0))
    np.testing.assert_allclose(np.abs(np.sum(whole * turn, axis=1))[flying], 1, atol=1e-9)


@pytest.mark.parametrize("engine", ENGINES)
def test_rates_of_the_start_are_about_the_cubes_own_axes(engine):
    scenario, found = tossed(engine)
    own = np.array([[scenario.parameters[f"start_rate_{axis}_rad_s"] for axis in "xyz"]])
    held = found.signals["cube.rate_rad_s"][:1]
    turned = rotate(found.signals["cube.orientation_wxyz"][:1], own)
    np.testing.assert_allclose(held, turned, rtol=1e-6)


@pytest.mark.parametrize("restitution", [0.05, 0.5, 0.9])
@pytest.mark.parametrize("engine", ENGINES)
def test_no_flight_has_more_energy_than_the_one_before(engine, restitution):
    _, found = tossed(engine, restitution=restitution)
    v, w = found.signals["cube.velocity_m_s"], found.signals["cube.rate_rad_s"]
    place, turn = found.signals["cube.position_m"], found.signals["cube.orientation_wxyz"]
    kinetic = (MASS * np.sum(v**2, axis=1) + INERTIA * np.sum(w**2, axis=1)) / 2
    energy = kinetic + MASS * G * place[:, 2]
    # in contact a spring may hold some of it, which it gives back
    flying = tosses.lowest_m(tosses.Toss("", found.time_s, place, turn), WIDTH) > 1e-3
    held = energy[flying]
    assert (held - np.minimum.accumulate(held)).max() < 1e-4 * energy[0]
    assert energy[-1] < 0.9 * energy[0]


@pytest.mark.parametrize("engine", ENGINES)
def test_it_comes_to_rest_on_a_face(engine):
    _, found = tossed(engine)
    turn = found.signals["cube.orientation_wxyz"][-1:]
    ups = [abs(rotate(turn, axis[None])[0, 2]) for axis in np.eye(3)]
    assert max(ups) == pytest.approx(1, abs=1e-5)
    assert found.signals["cube.position_m"][-1, 2] == pytest.approx(WIDTH / 2, rel=1e-3)
    assert np.linalg.norm(found.signals["cube.velocity_m_s"][-1]) < 1e-3


@pytest.mark.parametrize("landing", POSES)
@pytest.mark.parametrize("engine", ENGINES)
def test_a_symmetric_landing_stays_symmetric_and_bounces_as_told(engine, landing):
    turn, height = POSES[landing]
    drop = {**STILL, **turn, "start_z_m": height + 0.1, "friction": 0.0, "duration_s": 0.25}
    _, found = tossed(engine, restitution=0.5, **drop)
    place = found.signals["cube.position_m"]
    assert np.abs(place[:, :2]).max() < 1e-9
    held = found.signals["cube.orientation_wxyz"]
    assert np.abs(np.abs(held @ held[0]) - 1).max() < 1e-8
    rebound = (place[:, 2] - height)[found.time_s > math.sqrt(2 * 0.1 / G) + 0.004].max()
    # 2 % is what a spring in steps of 50 µs is worth
    assert math.sqrt(rebound / 0.1) == pytest.approx(0.5, rel=0.02)


@pytest.mark.parametrize("yaw", [0.0, 0.5])
@pytest.mark.parametrize("engine", ENGINES)
def test_friction_stops_a_sliding_box_after_its_way_whichever_way_it_points(engine, yaw):
    found = sliding(engine, friction=0.3, speed=1.0, yaw=yaw)
    assert found["cube.position_m"][-1, 0] == pytest.approx(1 / (2 * 0.3 * G), rel=0.005)
    assert abs(found["cube.position_m"][-1, 1]) < 5e-4


@pytest.mark.parametrize("engine", ENGINES)
def test_friction_stops_a_spinning_box_as_coulombs_cone_says(engine):
    found = sliding(engine, friction=0.3, rate=20.0)
    turn = 2 * math.acos(min(1.0, abs(found["cube.orientation_wxyz"][-1, 0])))
    # a quarter of the weight on each corner; friction across two axes would stop it after 1.57 rad
    torque = 0.3 * MASS * G * WIDTH / math.sqrt(2)
    assert turn == pytest.approx(INERTIA * 20.0**2 / (2 * torque), rel=0.015)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_box_sticks_on_a_slope_below_the_angle_of_friction(engine):
    found = sliding(engine, friction=0.4, yaw=0.3, slope=math.radians(20))
    assert np.abs(found["cube.position_m"][-1, :2]).max() < 2e-4


def test_two_bodies_that_bounce_are_refused_by_the_engine_of_springs():
    plain = FILE.resolve({}).model_dump()
    plain["bodies"]["other"] = {**plain["bodies"]["cube"], "position_m": (0.5, 0.0, 0.3)}
    two = type(FILE.resolve({})).model_validate(plain)
    with pytest.raises(Unsupported, match="single free body bounces"):
        engines.get("mujoco").simulate(two, Settings())


# --- what is read off tosses -------------------------------------------------------------------


def made(engine="dart", samples=100, **parameters):
    """A toss that an engine made, at the samples of a camera."""
    parts = 14
    step_s = 1 / 148 / parts
    _, found = tossed(engine, step_s, duration_s=samples / 148, **parameters)
    rows = slice(0, None, parts)
    place, turn = found.signals["cube.position_m"][rows], found.signals["cube.orientation_wxyz"]
    return tosses.Toss("made", np.arange(len(place)) / 148, place, turn[rows])


def test_the_start_is_read_off_the_flight():
    toss = made()
    start = tosses.start_of(toss, WIDTH, G)
    wanted = {name: p.value for name, p in FILE.parameters.items()}
    read = parameters_of(FILE.fit, start)
    length = math.hypot(*(wanted[f"start_orientation_{axis}"] for axis in "wxyz"))
    for name, value in read.items():
        told = wanted[name] / (length if "orientation" in name else 1)
        assert value == pytest.approx(told, abs=1e-8), name


def test_a_replay_of_its_own_toss_is_not_off():
    toss = made()
    found = replay.Replay(ROLES, toss, {})(engines.get("dart")).errors
    assert found.position < 0.01
    assert found.rotation < 0.01


def test_errors_are_what_the_literature_calls_them():
    toss = made()
    aside = toss.position_m + np.array((0.03, 0.0, 0.04))
    turned = multiply(np.array([[math.cos(0.1), math.sin(0.1), 0, 0]]), toss.orientation_wxyz)
    found = tosses.errors(toss, aside, turned, WIDTH)
    assert found.position == pytest.approx(100 * 0.05 / WIDTH)
    assert found.rotation == pytest.approx(math.degrees(0.2))
    # against the corners themselves
    away = []
    for corner in tosses.corners(WIDTH):
        rows = np.tile(corner, (len(toss.time_s), 1))
        moved = aside + rotate(turned, rows) - toss.position_m - rotate(toss.orientation_wxyz, rows)
        away.append(np.sum(moved**2, axis=1))
    assert found.corners == pytest.approx(100 * np.sqrt(np.mean(away, axis=0)).mean() / WIDTH)


def test_the_fit_finds_the_parameters_that_made_the_tosses():
    truth = {"friction": 0.25, "restitution": 0.3}
    found = [
        made(**truth, start_rate_y_rad_s=rate, start_velocity_x_m_s=speed)
        for rate, speed in ((2.0, 0.8), (4.0, 1.1), (-3.0, 0.9), (1.0, 1.3))
    ]
    grids = {
        "friction": Grid(spacing=0.08, min=0.02, max=1.0),
        "restitution": Grid(spacing=0.2, min=0.02, max=0.9),
    }
    roles = roles_of(FILE, {"friction": 0.17, "restitution": 0.1})
    setup = Setup(grids, tuple(found), tuple(found[:1]), 1.0, (), ())
    (best,) = toss_engines.fit_engines(roles, setup, ["dart"], toss_engines.How(halvings=0))
    assert best.is_ok, best.outcome.reason
    assert best.search.values(best.search.best) == pytest.approx(truth)
    assert best.search.cost(best.search.best) < 0.1
    assert len(best.search.tried) < 25
    assert best.held[0].position < 0.01
    for name, own in search.estimates(best.search).items():
        low, high = own.interval95
        assert low <= truth[name] <= high
        assert high - low > grids[name].spacing
        assert own.u > 0


def test_the_split_shares_nothing_and_follows_its_seed():
    names = [tosses.Toss(str(i), *(np.zeros(1),) * 3) for i in range(30)]
    train, test = tosses.split(names, 10, 15, seed=3)
    again, _ = tosses.split(names, 10, 15, seed=3)
    assert [toss.name for toss in train] == [toss.name for toss in again]
    assert len({toss.name for toss in (*train, *test)}) == 25
    with pytest.raises(InputError, match="30 are there"):
        tosses.split(names, 20, 15, seed=3)


def test_intervals_of_a_mean_cover_it():
    rng = np.random.default_rng(5)
    inside = 0
    for seed in range(200):
        one = search.interval(rng.exponential(1.0, 60), seed)
        low, high = one.interval95
        inside += low <= 1.0 <= high
    assert 178 <= inside <= 199  # 95 % nominal, a little less for a skewed error


@pytest.mark.parametrize("scale", [0.95, 1.0, 1.03])
def test_both_witnesses_find_the_scale_of_made_tosses(scale):
    found = [
        made(samples=200, start_rate_y_rad_s=rate, start_z_m=0.2).scaled(1 / scale)
        for rate in (-4.0, -2.0, 0.5, 2.0, 4.0)
    ]
    for witness in tosses.witnesses(found, WIDTH, G):
        assert witness.scale == pytest.approx(scale, abs=1e-3), witness.name
        assert witness.u > 0


def test_too_few_tosses_tell_no_scale():
    with pytest.raises(InputError, match="expected 3"):
        tosses.witnesses([made()], WIDTH, G)


# --- the real ones -----------------------------------------------------------------------------


@functools.cache
def real():
    """The tosses as they were published; the importer itself is tested elsewhere."""
    from simcompare.hardware.recordings import registry

    (path,) = registry.locate("cube_toss")
    with np.load(path) as data:
        ends = np.cumsum(data["length"])[:-1]
        parts = zip(data["toss_id"], np.split(data["state"].astype(float), ends), strict=True)
    return [
        tosses.Toss(
            f"toss.{number}", np.arange(len(state)) / 148, state[:, :3],
            state[:, 3:7] / np.linalg.norm(state[:, 3:7], axis=1, keepdims=True),
        )
        for number, state in parts
    ]  # fmt: skip


@needs_data
def test_gravity_and_the_height_of_rest_say_that_lengths_are_two_per_cent_short():
    gravity, rest = tosses.witnesses(real(), WIDTH, 9.8017)
    assert gravity.scale == pytest.approx(0.980, abs=0.001)
    assert rest.scale == pytest.approx(0.978, abs=0.001)
    assert abs(gravity.scale - rest.scale) < 2 * math.hypot(gravity.u, rest.u)
    both = tosses.combined((gravity, rest))
    assert both.scale == pytest.approx(0.9795, abs=0.001)
    assert abs(both.scale - 1) > 5 * both.u


@needs_data
def test_rates_in_the_log_are_about_the_cubes_own_axes_and_velocities_lag_by_half_a_sample():
    from simcompare.hardware.recordings import registry

    with np.load(registry.locate("cube_toss")[0]) as data:
        state, length = data["state"].astype(float), data["length"]
    starts = np.concatenate(([0], np.cumsum(length)[:-1]))
    own, world, lag = [], [], []
    for toss, first in zip(real(), starts, strict=True):
        count = tosses.samples_in_flight(toss, WIDTH)
        if count < 10:
            continue
        read = tosses.start_of(toss, WIDTH, 9.6066)
        held = state[first : first + count]
        own.append(np.linalg.norm(held[:, 10:].mean(axis=0) - read.rate_rad_s))
        turned = rotate(toss.orientation_wxyz[:1], read.rate_rad_s[None])[0]
        world.append(np.linalg.norm(held[:, 10:].mean(axis=0) - turned))
        speed = read.velocity_m_s[2] - 9.6066 * toss.time_s[1:count]
        lag.append(np.mean(held[1:, 9] - speed))
    assert np.median(own) < 0.1
    assert np.median(world) > 3
    assert np.median(lag) == pytest.approx(9.6066 / 148 / 2, rel=0.1)


@needs_data
@pytest.mark.parametrize("engine", ENGINES)
def test_real_tosses_land_nearer_than_published(engine):
    # 40 tosses of 428, with the friction and restitution that all engines agree on
    some, _ = tosses.split(real(), 40, 0, seed=2)
    values, backend = {"friction": 0.19, "restitution": 0.07}, engines.get(engine)
    found = [replay.Replay(ROLES, toss, values)(backend).errors for toss in some]
    place = search.interval([one.position for one in found])
    turn = search.interval([one.rotation for one in found])
    assert place.interval95[1] < 23.74
    assert turn.interval95[0] < 15.34
