"""Seconds that closed forms and fits of them cost; fits call them thousands of times."""

import numpy as np
import pytest

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.fit import fit
from simcompare.model.signals import Chirp
from simcompare.scenarios import catalogue
from simcompare.scenarios.pendulum import reference as pendulum
from simcompare.scenarios.pendulum_torque.reference import Pendulum, motion
from tests.bounces import IN_AIR, heard


@pytest.mark.parametrize("model", ["constant", "constant+drag"])
def test_fit_of_a_closed_form(benchmark, model):
    benchmark(fit, heard(IN_AIR), model)


@pytest.mark.parametrize("name", ["constant", "power+drag", "hunt_crossley+drag"])
def test_impacts_of_a_closed_form(benchmark, name):
    values = {"restitution": 0.85, "drag_k": 0.0134, "exponent": 0.02}
    benchmark(bounce_models.bounces, bounce_models.MODELS[name], values, 7)


def test_swing_of_ten_seconds(benchmark):
    parameters = catalogue.load("pendulum").resolve().parameters
    benchmark(pendulum.motion, parameters, np.linspace(0, 10, 10001))


def test_swing_under_a_chirp(benchmark):
    times = np.arange(2001) / 200
    signal = Chirp(signal="chirp", amplitude=1.3, start_Hz=0.1, end_Hz=4, duration_s=9.0)
    benchmark(motion, Pendulum(0.15, 3.0, 0.02, 0.13), (0.3, 0.0), times, signal)
