"""The arm's motion against Newton's laws with constraints, energy, and a pose of 30 degrees."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from simcompare import measures
from simcompare.engine.simulation import sample_times
from simcompare.measures import joint_angle_estimate as estimate
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.joint_angle import reference as arms

G = 9.80665
CHANGES = [
    {},
    {"upper_angle_rad": -1.2, "elbow_angle_rad": 2.0, "fore_mass_kg": 0.6},
    {"upper_length_m": 0.5, "release_s": 0.02, "swing_s": 1.0},
]
LINKS = ("upper", "fore")


def scene(**changes):
    return catalogue.load("joint_angle").resolve(changes)


def truth_of(scenario):
    times = sample_times(scenario)
    return Trajectory("reference", times, arms.reference(scenario.parameters, times))


class Constrained:
    """Both links as free bodies (x, z, angle about +y), held together by forces at the hinges.

    Reads places, masses and torques from the scene; knows no Lagrangian.
    """

    def __init__(self, scenario):
        self.scenario = scenario
        bodies = [scenario.bodies[name] for name in LINKS]
        self.mass = np.array([b.mass_kg for b in bodies])
        self.inertia = np.array([b.inertia_kg_m2[1] for b in bodies])
        place = np.array([[b.position_m[0], b.position_m[2]] for b in bodies])
        angle = np.array([2 * math.atan2(b.orientation_wxyz[2], b.orientation_wxyz[0])
                          for b in bodies])  # fmt: skip
        self.start = np.array([*place[0], angle[0], *place[1], angle[1]])
        hinges = [scenario.joints["shoulder"].anchor_m, scenario.joints["elbow"].anchor_m]
        elbow = place[0] + turned(angle[0], (hinges[1][0], hinges[1][2]))
        world = [np.array([hinges[0][0], hinges[0][2]]), elbow]
        # where each hinge is in the frames of the links that it joins: (link, place)
        self.ends = [
            [(0, turned(-angle[0], world[0] - place[0]))],
            [(0, turned(-angle[0], elbow - place[0])), (1, turned(-angle[1], elbow - place[1]))],
        ]

    def accelerations(self, t, q, v):
        """Accelerations (6,) from Newton's laws and four equations of the hinges."""
        matrix, right = np.zeros((10, 10)), np.zeros(10)
        hold = float(self.scenario.inputs["hold"].at(np.array([t]))[0])
        shoulder, elbow = (
            self.scenario.actuators[name].gear * hold for name in ("shoulder_motor", "elbow_motor")
        )
        for i in range(2):
            matrix[3 * i, 3 * i] = matrix[3 * i + 1, 3 * i + 1] = self.mass[i]
            matrix[3 * i + 2, 3 * i + 2] = self.inertia[i]
            right[3 * i + 1] = self.mass[i] * self.scenario.world.gravity_m_s2[2]
        right[2], right[5] = shoulder - elbow, elbow
        for h, ends in enumerate(self.ends):
            for sign, (link, place) in zip((1, -1), ends, strict=False):
                x, z = turned(q[3 * link + 2], place)
                # the place moves by (z, -x) for one rad about +y, and is drawn to the middle
                rows = np.zeros((2, 6))
                rows[:, 3 * link : 3 * link + 3] = [[1, 0, z], [0, 1, -x]]
                at = slice(6 + 2 * h, 8 + 2 * h)
                matrix[at, :6] += sign * rows
                matrix[:6, at] -= sign * rows.T
                right[at] += sign * v[3 * link + 2] ** 2 * np.array([x, z])
        return np.linalg.solve(matrix, right)[:6]

    def run(self, time_s):
        corners = (0.0, self.scenario.inputs["hold"].start_s, self.scenario.inputs["hold"].end_s,
                   time_s[-1] + 1e-9)  # fmt: skip
        state, found = np.concatenate((self.start, np.zeros(6))), np.zeros((12, len(time_s)))
        for start, end in pairwise(corners):
            inside = (time_s >= start) & (time_s <= end)
            solved = solve_ivp(
                lambda t, y: np.concatenate((y[6:], self.accelerations(t, y[:6], y[6:]))),
                (start, end), state, "DOP853", dense_output=True,
                rtol=1e-12, atol=1e-13, max_step=0.01,
            )  # fmt: skip
            found[:, inside] = solved.sol(time_s[inside])
            state = solved.y[:, -1]
        return found


def turned(angle, vector):
    """A vector (x, z) turned about +y."""
    x, z = vector
    return np.array([x * math.cos(angle) + z * math.sin(angle),
                     z * math.cos(angle) - x * math.sin(angle)])  # fmt: skip


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_agrees_with_newtons_laws_and_constraints(changes):
    scenario = scene(**changes)
    truth = truth_of(scenario)
    independent = Constrained(scenario)
    states = independent.run(truth.time_s)
    angles = np.array([states[2], states[5]])
    shoulder = angles[0] - angles[0, 0]
    elbow = angles[1] - angles[0] - (angles[1, 0] - angles[0, 0])
    np.testing.assert_allclose(truth.signals["shoulder.angle_rad"], shoulder, atol=1e-9)
    np.testing.assert_allclose(truth.signals["elbow.angle_rad"], elbow, atol=1e-9)
    np.testing.assert_allclose(truth.signals["shoulder.rate_rad_s"], states[8], atol=1e-8)
    # what the sensors read, from the accelerations of the middles of the links
    for k in range(0, len(truth.time_s), 97):
        q, v = states[:6, k], states[6:, k]
        a = independent.accelerations(truth.time_s[k], q, v)
        for i, link in enumerate(LINKS):
            for place in ("axis", "outer"):
                sensor = scenario.sensors[f"{link}_{place}"]
                x, z = turned(q[3 * i + 2], (sensor.position_m[0], sensor.position_m[2]))
                rate, change = v[3 * i + 2], a[3 * i + 2]
                moved = a[3 * i : 3 * i + 2] + change * np.array([z, -x])
                felt = moved - rate**2 * np.array([x, z]) + np.array([0, G])
                expected = turned(-q[3 * i + 2], felt)
                got = truth.signals[f"{link}_{place}.specific_force_m_s2"][k]
                np.testing.assert_allclose(got[[0, 2]], expected, atol=1e-7)
                assert got[1] == 0


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_stays_where_it_is_held_and_keeps_its_energy_once_free(changes):
    scenario = scene(**changes)
    parameters = scenario.parameters
    arm = arms.arm_of(parameters)
    t = sample_times(scenario)
    angles, rates = arms.motion(arm, t)
    held = t <= parameters["hold_s"]
    assert np.ptp(angles[:, held], axis=1).max() == 0
    assert np.abs(arm.accelerations(t[held], angles[:, held], rates[:, held])).max() < 1e-12
    first, second, c = arm.inertia
    kinetic = (first * rates[0] ** 2 + second * rates[1] ** 2) / 2
    kinetic += c * rates[0] * rates[1] * np.cos(angles[0] - angles[1])
    energy = kinetic - arm.weight[0] * np.cos(angles[0]) - arm.weight[1] * np.cos(angles[1])
    free = t > parameters["hold_s"] + parameters["release_s"]
    assert np.ptp(energy[free]) < 1e-10 * sum(arm.weight)


def test_one_link_alone_swings_with_the_period_of_a_rod():
    # a forearm of next to no mass: small swings of a rod have T = 2π·√(2L/3g)
    scenario = scene(fore_mass_kg=0.001, upper_angle_rad=0.01, elbow_angle_rad=0.0, swing_s=2.0,
                     fore_length_m=0.02)  # fmt: skip
    t = sample_times(scenario)
    angle = arms.motion(arms.arm_of(scenario.parameters), t)[0][0]
    zeros = t[1:][np.diff(np.sign(angle)) != 0]
    period = 2 * math.pi * math.sqrt(2 * 0.3 / (3 * G))
    assert np.diff(zeros).mean() * 2 == pytest.approx(period, rel=0.01)


def test_a_pose_of_thirty_degrees_has_the_sign_of_its_hinge():
    # hanging frame and one turned by +30° about +y: its x axis points down by 30°, reads -g/2
    upright = (np.array([0.0]), np.array([G]))
    bent = (np.array([-G / 2]), np.array([G * math.sqrt(3) / 2]))
    assert estimate.angle_between(upright, bent)[0] == pytest.approx(math.radians(30))
    assert estimate.angle_between(bent, upright)[0] == pytest.approx(math.radians(-30))
    # the scene itself is held so: with its own quaternions and sensors, at rest
    truth = truth_of(scene())
    a, b = (truth.signals[f"{link}_axis.specific_force_m_s2"][0] for link in LINKS)
    told = estimate.angle_between((a[:1], a[2:]), (b[:1], b[2:]))
    assert told[0] == pytest.approx(math.radians(30))


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_any_pose_at_rest_is_told_whatever_the_first_link_does(first, between):
    felt = [(np.array([-G * math.sin(a)]), np.array([G * math.cos(a)]))
            for a in (first, first + between)]  # fmt: skip
    told = estimate.angle_between(*felt)[0]
    assert math.remainder(told - between, 2 * math.pi) == pytest.approx(0, abs=1e-9)


def test_noise_of_both_sensors_adds_up():
    # u = √2·s/g: 0.02 g make 28 mrad
    random = np.random.default_rng(5)
    noisy = [(random.normal(0, 0.02, 200_000), random.normal(1, 0.02, 200_000)) for _ in range(2)]
    told = estimate.angle_between(*noisy)
    assert told.std() == pytest.approx(math.sqrt(2) * 0.02, rel=0.01)


def test_the_measure_shows_where_the_method_holds():
    scenario = scene()
    outer, axis, _ = (measures.take(m, scenario, truth_of(scenario)) for m in scenario.measures)
    assert outer.values["static_error"] < 1e-9
    assert outer.values["moving_error"] > 0.1
    assert outer.values["corrected_error"] < 1e-3
    assert axis.values["moving_error"] < 1e-9
    assert 0 < outer.values["valid_fraction"] < 0.5
    # a reading of g in size need not be g in direction
    assert outer.values["gated_error"] > 0.1
