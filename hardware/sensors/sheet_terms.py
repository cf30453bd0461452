"""The terms of an error model that data sheets state, each with the unit it must have."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Term:
    """One term of the error model of ``hardware/sensors/device.py``.

    Attributes:
        title: in tables.
        relative: a part of the reading or of the full scale, without unit.
        per: what its unit is divided by.
        is_noise: drawn for every reading; the others are drawn once for a device.
        kinds: kinds of values that can be stated of it.
        rule: that holds where a sheet states none; empty where the kind of the value chooses it.
    """

    title: str
    relative: bool = False
    per: str = ""
    is_noise: bool = False
    kinds: tuple[str, ...] = ("typ", "max", "min_max", "typ_max")
    rule: str = ""


_NOISE = ("density", "rms")
#: what a quantity is called -> its SI unit
QUANTITIES = {
    "specific force": "m/s**2",
    "angular rate": "rad/s",
    "pressure": "Pa",
    "distance": "m",
    "current": "A",
    "voltage": "V",
    "angle": "rad",
}
#: name in a sheet's file -> term
TERMS = {
    "sensitivity": Term("sensitivity", relative=True),
    "cross_axis": Term("cross-axis sensitivity", relative=True),
    "offset": Term("offset"),
    "nonlinearity": Term("non-linearity", relative=True),
    "sensitivity_per_K": Term("sensitivity with temperature", relative=True, per="K"),
    "offset_per_K": Term("offset with temperature", per="K"),
    "noise": Term("noise", per="√Hz", is_noise=True, kinds=_NOISE),
    "noise_per_reading": Term("noise that grows", relative=True, is_noise=True, kinds=("rms",)),
    "bias_instability": Term("bias instability", is_noise=True, kinds=("typ",), rule="alike"),
    "random_walk": Term("random walk", per="√s", is_noise=True, kinds=("typ",), rule="alike"),
    "rate": Term("output data rate", relative=True),
}
