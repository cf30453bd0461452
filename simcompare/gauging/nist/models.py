"""The models of NIST's nonlinear regression problems, as their files write them.

Each takes the parameters (…, p) and the predictors (k, n) and gives the responses (…, n), so that
many parameters are tried at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from simcompare.model.trajectory import Array

Model = Callable[[Array, Array], Array]


def _parts(b: Array) -> list[Array]:
    """The parameters, each (…, 1)."""
    return [b[..., k, None] for k in range(b.shape[-1])]


def _misra1a(b: Array, x: Array) -> Array:
    b1, b2 = _parts(b)
    return np.asarray(-b1 * np.expm1(-b2 * x[0]))


def _misra1b(b: Array, x: Array) -> Array:
    b1, b2 = _parts(b)
    return np.asarray(b1 * (1 - (1 + b2 * x[0] / 2) ** -2.0))


def _misra1c(b: Array, x: Array) -> Array:
    b1, b2 = _parts(b)
    return np.asarray(b1 * (1 - (1 + 2 * b2 * x[0]) ** -0.5))


def _misra1d(b: Array, x: Array) -> Array:
    b1, b2 = _parts(b)
    return np.asarray(b1 * b2 * x[0] / (1 + b2 * x[0]))


def _chwirut(b: Array, x: Array) -> Array:
    b1, b2, b3 = _parts(b)
    return np.asarray(np.exp(-b1 * x[0]) / (b2 + b3 * x[0]))


def _lanczos(b: Array, x: Array) -> Array:
    b1, b2, b3, b4, b5, b6 = _parts(b)
    terms = ((b1, b2), (b3, b4), (b5, b6))
    return np.asarray(sum(size * np.exp(-rate * x[0]) for size, rate in terms))


def _gauss(b: Array, x: Array) -> Array:
    b1, b2, b3, b4, b5, b6, b7, b8 = _parts(b)
    peaks = ((b3, b4, b5), (b6, b7, b8))
    bells = sum(size * np.exp(-(((x[0] - at) / wide) ** 2)) for size, at, wide in peaks)
    return np.asarray(b1 * np.exp(-b2 * x[0]) + bells)


def _danwood(b: Array, x: Array) -> Array:
    b1, b2 = _parts(b)
    return np.asarray(b1 * x[0] ** b2)


def _kirby(b: Array, x: Array) -> Array:
    b1, b2, b3, b4, b5 = _parts(b)
    return np.asarray((b1 + x[0] * (b2 + x[0] * b3)) / (1 + x[0] * (b4 + x[0] * b5)))


def _cubics(b: Array, x: Array) -> Array:
    b1, b2, b3, b4, b5, b6, b7 = _parts(b)
    above = b1 + x[0] * (b2 + x[0] * (b3 + x[0] * b4))
    return np.asarray(above / (1 + x[0] * (b5 + x[0] * (b6 + x[0] * b7))))


def _nelson(b: Array, x: Array) -> Array:
    """Of the logarithm of the response."""
    b1, b2, b3 = _parts(b)
    return np.asarray(b1 - b2 * x[0] * np.exp(-b3 * x[1]))


def _mgh09(b: Array, x: Array) -> Array:
    b1, b2, b3, b4 = _parts(b)
    return np.asarray(b1 * (x[0] ** 2 + x[0] * b2) / (x[0] ** 2 + x[0] * b3 + b4))


def _mgh10(b: Array, x: Array) -> Array:
    b1, b2, b3 = _parts(b)
    return np.asarray(b1 * np.exp(b2 / (x[0] + b3)))


def _mgh17(b: Array, x: Array) -> Array:
    b1, b2, b3, b4, b5 = _parts(b)
    return np.asarray(b1 + b2 * np.exp(-x[0] * b4) + b3 * np.exp(-x[0] * b5))


def _enso(b: Array, x: Array) -> Array:
    b1, b2, b3, b4, b5, b6, b7, b8, b9 = _parts(b)
    year, second, third = (2 * np.pi * x[0] / period for period in (12.0, b4, b7))
    return np.asarray(
        b1 + b2 * np.cos(year) + b3 * np.sin(year) + b5 * np.cos(second) + b6 * np.sin(second)
        + b8 * np.cos(third) + b9 * np.sin(third)
    )  # fmt: skip


def _roszman(b: Array, x: Array) -> Array:
    b1, b2, b3, b4 = _parts(b)
    return np.asarray(b1 - b2 * x[0] - np.arctan(b3 / (x[0] - b4)) / np.pi)


def _rat42(b: Array, x: Array) -> Array:
    b1, b2, b3 = _parts(b)
    return np.asarray(b1 / (1 + np.exp(b2 - b3 * x[0])))


def _rat43(b: Array, x: Array) -> Array:
    b1, b2, b3, b4 = _parts(b)
    return np.asarray(b1 / (1 + np.exp(b2 - b3 * x[0])) ** (1 / b4))


def _bennett(b: Array, x: Array) -> Array:
    b1, b2, b3 = _parts(b)
    return np.asarray(b1 * (b2 + x[0]) ** (-1 / b3))


def _eckerle(b: Array, x: Array) -> Array:
    b1, b2, b3 = _parts(b)
    return np.asarray(b1 / b2 * np.exp(-0.5 * ((x[0] - b3) / b2) ** 2))


#: name of the file -> model, in NIST's order from easy to hard
MODELS: Mapping[str, Model] = {
    "Misra1a": _misra1a, "Chwirut2": _chwirut, "Chwirut1": _chwirut, "Lanczos3": _lanczos,
    "Gauss1": _gauss, "Gauss2": _gauss, "DanWood": _danwood, "Misra1b": _misra1b,
    "Kirby2": _kirby, "Hahn1": _cubics, "Nelson": _nelson, "MGH17": _mgh17,
    "Lanczos1": _lanczos, "Lanczos2": _lanczos, "Gauss3": _gauss, "Misra1c": _misra1c,
    "Misra1d": _misra1d, "Roszman1": _roszman, "ENSO": _enso, "MGH09": _mgh09,
    "Thurber": _cubics, "BoxBOD": _misra1a, "Rat42": _rat42, "MGH10": _mgh10,
    "Eckerle4": _eckerle, "Rat43": _rat43, "Bennett5": _bennett,
}  # fmt: skip
