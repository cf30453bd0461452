"""The double pendulum's motion against Newton's laws with constraints, energy, and its horizon."""

import math

import numpy as np
import pytest
from scipy.integrate import simpson, solve_ivp

from simcompare.engine.simulation import sample_times
from simcompare.scenarios import catalogue
from simcompare.scenarios.pendulum import reference as single
from simcompare.scenarios.pendulum_double import reference as double

FREE = {"upper_damping_N_m_s_rad": 0.0, "lower_damping_N_m_s_rad": 0.0}
CHANGES = [
    {},
    FREE,
    {"upper_rate_rad_s": 8.0, "lower_rate_rad_s": -12.0},
    {"upper_angle_rad": 3.0, "lower_angle_rad": -0.5, "lower_damping_N_m_s_rad": 0.002},
    {"upper_angle_rad": 0.3, "lower_angle_rad": 0.2, "upper_length_m": 0.4},
]


def scene(**changes):
    return catalogue.load("pendulum_double").resolve(changes)


class Constrained:
    """Both links as free bodies (x, z, angle), held together by forces at the hinges.

    Reads places, masses and dampers from the scene; knows no Lagrangian. Angles are about -y.
    """

    def __init__(self, scenario):
        self.bodies = [scenario.bodies[name] for name in ("upper", "lower")]
        self.dampers = [scenario.joints[name].damping for name in ("shoulder", "elbow")]
        self.gravity = scenario.world.gravity_m_s2[2]
        place = np.array([[b.position_m[0], b.position_m[2]] for b in self.bodies])
        angle = [-2 * math.atan2(b.orientation_wxyz[2], b.orientation_wxyz[0]) for b in self.bodies]
        anchor = scenario.joints["elbow"].anchor_m
        elbow = place[0] + turned(angle[0], (anchor[0], anchor[2]))
        self.ends = [
            [(0, turned(-angle[0], -place[0]))],
            [(0, turned(-angle[0], elbow - place[0])), (1, turned(-angle[1], elbow - place[1]))],
        ]
        rates = [scenario.joints["shoulder"].rate]
        rates.append(rates[0] + scenario.joints["elbow"].rate)
        first = rates[0] * across(place[0])
        second = rates[0] * across(elbow) + rates[1] * across(place[1] - elbow)
        self.start = np.array(
            [*place[0], angle[0], *place[1], angle[1],
             *first, rates[0], *second, rates[1]]
        )  # fmt: skip

    def change(self, _t, y):
        q, v = y[:6], y[6:]
        matrix, right = np.zeros((10, 10)), np.zeros(10)
        for i, body in enumerate(self.bodies):
            matrix[3 * i, 3 * i] = matrix[3 * i + 1, 3 * i + 1] = body.mass_kg
            matrix[3 * i + 2, 3 * i + 2] = body.inertia_kg_m2[1]
            right[3 * i + 1] = body.mass_kg * self.gravity
        apart = self.dampers[1] * (v[5] - v[2])
        right[2], right[5] = apart - self.dampers[0] * v[2], -apart
        for h, ends in enumerate(self.ends):
            at = slice(6 + 2 * h, 8 + 2 * h)
            for sign, (link, place) in zip((1, -1), ends, strict=False):
                arm = turned(q[3 * link + 2], place)
                rows = np.zeros((2, 6))
                rows[:, 3 * link : 3 * link + 2] = np.eye(2)
                rows[:, 3 * link + 2] = across(arm)
                matrix[at, :6] += sign * rows
                matrix[:6, at] -= sign * rows.T
                right[at] += sign * v[3 * link + 2] ** 2 * arm
        return np.concatenate((v, np.linalg.solve(matrix, right)[:6]))

    def run(self, time_s):
        solved = solve_ivp(
            self.change, (0, time_s[-1] + 1e-9), self.start, "DOP853", dense_output=True,
            rtol=1e-13, atol=1e-13, max_step=0.005,
        )  # fmt: skip
        return solved.sol(time_s)


def turned(angle, vector):
    """A vector (x, z) turned by an angle about -y, from -z towards +x."""
    x, z = vector
    return np.array([x * math.cos(angle) - z * math.sin(angle),
                     z * math.cos(angle) + x * math.sin(angle)])  # fmt: skip


def across(vector):
    """Velocity of a place for one rad/s about -y."""
    return np.array([-vector[1], vector[0]])


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_agrees_with_newtons_laws_and_constraints(changes):
    scenario = scene(duration_s=1.5, **changes)
    t = sample_times(scenario)[::10]
    states = Constrained(scenario).run(t)
    angles, rates = double.motion(scenario.parameters, t)
    np.testing.assert_allclose(angles, states[[2, 5]], atol=1e-9)
    np.testing.assert_allclose(rates, states[[8, 11]], atol=1e-8)
    found = double.reference(scenario.parameters, t)
    start = states[[2, 5], 0]
    np.testing.assert_allclose(found["shoulder.angle_rad"], states[2] - start[0], atol=1e-9)
    bent = states[5] - states[2] - (start[1] - start[0])
    np.testing.assert_allclose(found["elbow.angle_rad"], bent, atol=1e-9)
    np.testing.assert_allclose(found["elbow.rate_rad_s"], states[11] - states[8], atol=1e-8)


def energy_of(p, angles, rates):
    """Kinetic and potential energy (n,) from angles and rates (2, n); 0 at rest at the hinge."""
    links = double.links_of(p)
    first, second, c = links.inertia
    kinetic = (first * rates[0] ** 2 + second * rates[1] ** 2) / 2
    kinetic = kinetic + c * rates[0] * rates[1] * np.cos(angles[0] - angles[1])
    return kinetic - np.array(links.weight) @ np.cos(angles)


@pytest.mark.parametrize("start", [(1.6, 1.6, 0, 0), (3.0, 2.5, 0, 0), (0.5, 1, 8, -12)])
def test_without_friction_the_energy_stays(start):
    names = ("upper_angle_rad", "lower_angle_rad", "upper_rate_rad_s", "lower_rate_rad_s")
    p = scene(**dict(zip(names, start, strict=True)), **FREE).parameters
    angles, rates = double.motion(p, np.linspace(0, 5, 2001))
    energy = energy_of(p, angles, rates)
    assert np.ptp(energy) < 1e-13 * sum(double.links_of(p).weight)


def test_what_is_missing_of_the_energy_went_into_the_hinges():
    p = scene(upper_damping_N_m_s_rad=0.001, lower_damping_N_m_s_rad=0.0005).parameters
    t = np.linspace(0, 3, 30001)
    angles, rates = double.motion(p, t)
    energy = energy_of(p, angles, rates)
    power = 0.001 * rates[0] ** 2 + 0.0005 * (rates[1] - rates[0]) ** 2
    assert energy[0] - energy[-1] == pytest.approx(simpson(power, x=t), rel=1e-9)


def test_the_upper_link_alone_is_a_single_pendulum():
    # a lower link of next to no mass hangs on it: the upper one does not feel it
    p = scene(lower_mass_kg=0.001, lower_inertia_kg_m2=1e-7, upper_mass_kg=100, **FREE).parameters
    about = p["upper_inertia_kg_m2"] / (p["upper_mass_kg"] * p["upper_center_m"])
    length = p["upper_center_m"] + about
    own = dict(
        catalogue.load("pendulum")
        .resolve({"length_m": length, "damping_N_m_s_rad": 0, "friction_N_m": 0})
        .parameters
    )
    t = np.linspace(0, 2, 201)
    np.testing.assert_allclose(double.motion(p, t)[0][0], single.motion(own, t)[0], atol=1e-3)


def test_small_swings_have_the_normal_frequencies_of_two_links():
    p = scene(upper_angle_rad=1e-4, lower_angle_rad=-2e-4, **FREE).parameters
    links = double.links_of(p)
    first, second, c = links.inertia
    squares, shapes = np.linalg.eig(
        np.linalg.solve(np.array([[first, c], [c, second]]), np.diag(links.weight))
    )
    t = np.linspace(0, 3, 301)
    parts = np.linalg.solve(shapes, [1e-4, -2e-4])
    expected = shapes @ (parts[:, None] * np.cos(np.sqrt(squares)[:, None] * t))
    np.testing.assert_allclose(double.motion(p, t)[0], expected, atol=2e-10)


@pytest.mark.parametrize(("preset", "growth"), [(None, 10), ("wild", 1000), ("small", 10)])
def test_its_presets_end_well_before_the_horizon(preset, growth):
    # the horizon is where an error of the start has grown to what is tolerated
    file = catalogue.load("pendulum_double")
    scenario = file.resolve(preset=preset)
    p, t = dict(scenario.parameters), sample_times(scenario)
    moved = {**p, "upper_angle_rad": p["upper_angle_rad"] + 1e-8}
    apart = np.abs(double.motion(moved, t)[0] - double.motion(p, t)[0]).max() / 1e-8
    assert 0.5 < apart < growth


def test_it_is_chaotic_where_it_goes_over_the_top():
    p = scene(upper_angle_rad=3.0, lower_angle_rad=2.5, **FREE).parameters
    t = np.linspace(0, 5, 501)
    moved = {**p, "upper_angle_rad": 3.0 + 1e-10}
    apart = np.abs(double.motion(moved, t)[0] - double.motion(p, t)[0]).max(axis=0)
    assert apart[-50:].max() > 1e4 * 1e-10
