"""Exact motion of a base that a force shakes, and of a mass on a spring and a damper in it.

With base mass M, seismic mass m, base position y and deflection x of the spring, Newton's law for
both gives two equations that do not mix: for the centre of mass X = y + m·x/(M + m)

    Ẍ = F/(M + m)

and for the deflection

    ẍ + 2ζω_n·s·ẋ + ω_n²·s·x = -F/M,    s = 1 + m/M,

which is the textbook equation ẍ + 2ζω_n·ẋ + ω_n²·x = -ÿ with the reaction on the base put in.
Each is solved by Duhamel's integral over its impulse response, x(t) = ∫g(t - u)·f(u)du, which is
taken by an eight-point Gauss rule over pieces so short that the rule is exact to rounding.

Source of H(jω) = ω_n²/(ω_n² - ω² + 2jζω_nω): any text on vibration, for example Meirovitch,
Fundamentals of Vibrations (2001), 3.9. The tests check the motion against an independent
integration (DOP853) to 1e-9, and the steady states against H.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.model.signals import SineSteps
from simcompare.model.trajectory import Array
from simcompare.scenarios.instants import grid

#: frequencies of the dwells over the natural one, as the scenario has them
RATIOS = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0)
#: largest phase of the force, or of the spring, in one piece [rad]; the rule then errs by 1e-16
LARGEST_PHASE = 1.0
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)

Force = Callable[[Array], Array]


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion under one frequency after another.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].

    Returns:
        Position and velocity of the joints ``slide`` (the base) and ``spring`` (n,).
    """
    natural_Hz = parameters["natural_frequency_Hz"]
    dwell_s = parameters["dwell_periods"] / natural_Hz
    shaking = SineSteps(
        signal="sine_steps",
        amplitude=force_amplitude(parameters),
        frequencies_Hz=tuple(ratio * natural_Hz for ratio in RATIOS),
        dwell_s=dwell_s,
    )
    changes = dwell_s * np.arange(1.0, len(RATIOS) + 1)
    return motion(parameters, time_s, shaking.at, changes, max(RATIOS) * natural_Hz)


def force_amplitude(parameters: Mapping[str, float]) -> float:
    """Force that gives both masses together the wanted acceleration [N]."""
    total = parameters["base_mass_kg"] + parameters["seismic_mass_kg"]
    return parameters["acceleration_m_s2"] * total


def response(parameters: Mapping[str, float], frequency_Hz: Array) -> Array:
    """H(jω) = ω_n²/(ω_n² - ω² + 2jζω_nω), reading over acceleration of the base, complex (n,)."""
    ratio = frequency_Hz / parameters["natural_frequency_Hz"]
    return np.asarray(1 / (1 - ratio**2 + 2j * parameters["damping_ratio"] * ratio))


def motion(
    parameters: Mapping[str, float],
    time_s: Array,
    force: Force,
    changes_s: Array,
    highest_Hz: float,
) -> dict[str, Array]:
    """Motion under any force, from rest.

    Args:
        parameters: those of the scenario, SI.
        time_s: times (n,), increasing from 0 on [s].
        force: force on the base [N] at times (k,), smooth between ``changes_s``.
        changes_s: times at which it jumps [s].
        highest_Hz: highest frequency in it.
    """
    base, seismic = parameters["base_mass_kg"], parameters["seismic_mass_kg"]
    omega = 2 * math.pi * parameters["natural_frequency_Hz"]
    stiffer = 1 + seismic / base
    spring = Oscillator(omega * math.sqrt(stiffer), parameters["damping_ratio"] * omega * stiffer)
    fastest = max(2 * math.pi * highest_Hz, spring.rate_rad_s, spring.decay_1_s)
    times, kept = grid(time_s, changes_s, LARGEST_PHASE / fastest, 0.0)
    x, v = (part[kept] for part in spring.driven(times, lambda t: -force(t) / base))
    center, speed = (
        part[kept] for part in FREE.driven(times, lambda t: force(t) / (base + seismic))
    )
    share = seismic / (base + seismic)
    return {
        "slide.position_m": center - share * x,
        "slide.velocity_m_s": speed - share * v,
        "spring.position_m": x,
        "spring.velocity_m_s": v,
    }


@dataclass(frozen=True)
class Oscillator:
    """ẍ + 2δ·ẋ + ω²·x = f(t), whatever the damping.

    Attributes:
        rate_rad_s: ω, 0 for a free mass.
        decay_1_s: δ.
    """

    rate_rad_s: float
    decay_1_s: float

    def propagator(self, time_s: Array) -> tuple[Array, Array]:
        """exp(-δt)·cosh(βt) and exp(-δt)·sinh(βt)/β with β² = δ² - ω², in the shape of t."""
        beta = np.emath.sqrt(self.decay_1_s**2 - self.rate_rad_s**2)
        fade = np.exp(-self.decay_1_s * time_s)
        # sinh(z)/z = sin(jz)/(jz), which is 1 at 0: critical damping needs no case of its own
        odd = np.sinc(1j * beta * time_s / np.pi) * time_s
        return np.real(fade * np.cosh(beta * time_s)), np.real(fade * odd)

    def driven(self, time_s: Array, force: Force) -> tuple[Array, Array]:
        """Position and velocity at times (n,), at rest at the first, under f(t)."""
        lengths = np.diff(time_s)
        nodes = time_s[:-1, None] + lengths[:, None] * (1 + _NODES) / 2
        pushed = force(nodes.ravel()).reshape(nodes.shape) * _WEIGHTS * lengths[:, None] / 2
        even, odd = self.propagator(time_s[1:, None] - nodes)
        gained = np.sum(pushed * odd, axis=1)
        sped = np.sum(pushed * (even - self.decay_1_s * odd), axis=1)
        even, odd = self.propagator(lengths)
        steps = np.stack(
            (
                even + self.decay_1_s * odd,
                odd,
                gained,
                -(self.rate_rad_s**2) * odd,
                even - self.decay_1_s * odd,
                sped,
            ),
            axis=1,
        )
        states = [(0.0, 0.0)]
        x = v = 0.0
        for xx, xv, xf, vx, vv, vf in steps.tolist():
            x, v = xx * x + xv * v + xf, vx * x + vv * v + vf
            states.append((x, v))
        positions, velocities = np.array(states).T
        return positions, velocities


FREE = Oscillator(0.0, 0.0)
