"""Frequency response from one sweep: the ratio of two spectra, without any leakage that counts."""

from __future__ import annotations

import math

import numpy as np

from simcompare.measures import Measured, Request, _transfer
from simcompare.model.trajectory import Array, Trajectory

SERIES = _transfer.SERIES
AXES = _transfer.AXES
UNITS = _transfer.UNITS
ROLES = ("base",)
OPTIONS = ("first_Hz", "last_Hz", "count", "taper_s", "gain", "judged_up_to_Hz")

against = _transfer.against


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Amplitude and phase of gain·(probe) over the acceleration of the base, over a sweep.

    A linear system that starts at rest obeys X(ω) = H(ω)·A(ω) exactly, however fast the sweep, if
    the record holds all of the motion. It ends, however, while the sweep goes on. So the last
    ``taper_s`` of both signals fade out smoothly. That changes the ratio only at the frequencies
    that are swept there; the sweep must therefore have passed ``last_Hz`` before, and the system
    have forgotten it.

    The spectrum of the base's acceleration comes from its position y: with the fade w(t) that ends
    with zero slope, and a start at rest, two integrations by parts give
    ∫w·ÿ·exp(-jωt)dt = ∫(y - y₀)·(w″ - 2jω·w′ - ω²·w)·exp(-jωt)dt.

    Series over ``count`` frequencies, evenly spaced on a logarithmic axis: ``frequency``,
    ``amplitude``, ``phase`` (negative: the reading lags). Values: ``cutoff_frequency`` (amplitude
    1/√2) and ``judged_frequencies`` (how many are held against the truth).

    Args:
        trajectory: the source, evenly sampled, at rest at its start.
        request: its probe sees what the reading is made of, its role ``base`` the position of the
            base [m]; ``gain`` is the reading [m/s²] for one unit of the probe, ``judged_up_to_Hz``
            the highest frequency at which errors count.
    """
    options = request.options
    time_s, probe, base = (
        trajectory.time_s,
        request.observed(trajectory),
        request.observed(trajectory, "base"),
    )
    if _transfer.still(base):
        return _transfer.as_measured(np.empty(0), np.empty(0, complex), options["judged_up_to_Hz"])
    frequency = np.geomspace(options["first_Hz"], options["last_Hz"], round(options["count"]))
    fade, slope, curvature = _fade(time_s, options["taper_s"])
    omega = 2 * math.pi * frequency[:, None]
    waves = np.exp(-1j * omega * time_s)
    read = options["gain"] * (waves @ (fade * (probe - probe[0])))
    moved = base - base[0]
    shaken = waves @ (curvature * moved) - omega[:, 0] * (
        2j * (waves @ (slope * moved)) + omega[:, 0] * (waves @ (fade * moved))
    )
    return _transfer.as_measured(frequency, read / shaken, options["judged_up_to_Hz"])


def _fade(time_s: Array, taper_s: float) -> tuple[Array, Array, Array]:
    """A weight that is 1 and falls to 0 in the last ``taper_s``, and its first two derivatives.

    It falls as 1 - u⁴·(35 - 84u + 70u² - 20u³), whose first three derivatives are 0 at both ends.
    """
    u = np.clip((time_s - (time_s[-1] - taper_s)) / taper_s, 0, 1)
    fade = 1 - u**4 * (35 - 84 * u + 70 * u**2 - 20 * u**3)
    slope = -140 * u**3 * (1 - u) ** 3 / taper_s
    curvature = -420 * u**2 * (1 - u) ** 2 * (1 - 2 * u) / taper_s**2
    return fade, slope, curvature
