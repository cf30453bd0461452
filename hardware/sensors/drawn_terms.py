"""The terms of one drawn device: from the lines of a data sheet, and from what a user says."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from simcompare import units
from simcompare.hardware.sensors.device import Device
from simcompare.hardware.sensors.sheet_parts import PartData, Settings
from simcompare.hardware.sensors.sheet_rules import RULE_OF_KIND, RULES, Stated
from simcompare.hardware.sensors.sheet_terms import TERMS, Term
from simcompare.hardware.sensors.sheet_units import written
from simcompare.hardware.sensors.signals import axis_of, owner_of, part_of
from simcompare.model import sensor_errors
from simcompare.model.rotations import multiply, quaternions_of
from simcompare.model.sensor_errors import SINGLE, SensorErrors, Spread, Value
from simcompare.model.trajectory import Array
from simcompare.statistics import distributions
from simcompare.statistics.distributions import Distribution
from simcompare.statistics.streams import stream

#: of terms that a user states
OWN_SOURCE = "the scenario"


@dataclass(frozen=True)
class DrawnTerm:
    """One number of a device, and what is known of it before it is drawn.

    Attributes:
        term: name in the error model, such as "offset".
        axis: letter; of cross-axis terms "x from y"; empty where there is one axis.
        value: that this device has: a deviation, or the size of noise.
        unit: of it, SI.
        kind: of the distribution; "fixed" where every device has the same.
        u: standard uncertainty of any device, 0 where every device has the same.
        says: the value as its source states it.
        source: page or table, or who says it.
        confirmed: whether it was read in the maker's own text.
    """

    term: str
    axis: str
    value: float
    unit: str
    kind: str
    u: float
    says: str
    source: str
    confirmed: bool = True

    @property
    def title(self) -> str:
        """The term in words."""
        return _TERMS[self.term].title


#: names in data sheets -> names in the error model, where they differ
_MODEL_NAMES = {"noise": "noise_density", "rate": "rate_error"}
_TERMS = {
    **{_MODEL_NAMES.get(name, name): term for name, term in TERMS.items()},
    "resolution": Term("resolution"),
    "full_scale": Term("range"),
    "misalignment": Term("turned in its box"),
}


def of_sheet(part: PartData, settings: Settings, device: Device) -> tuple[DrawnTerm, ...]:
    """What a device has of each line of its data sheet."""
    found = []
    for term in TERMS:
        name = _MODEL_NAMES.get(term, term)
        for axis, value in _values(device, name, part.axes):
            entry = part.entry(term, settings.range.name, axis[:1])
            if entry is not None:
                known = entry.distribution
                kind, u = ("fixed", 0.0) if TERMS[term].is_noise else (known.kind, known.u)
                found.append(
                    DrawnTerm(
                        name, axis, value, _unit(name, part.unit), kind, u,
                        entry.text, entry.page, entry.confirmed,
                    )
                )  # fmt: skip
    return tuple(found)


def _unit(term: str, unit: str) -> str:
    return written("1" if _TERMS[term].relative else unit, _TERMS[term].per)


def _values(device: Device, term: str, axes: str) -> Iterator[tuple[str, float]]:
    """Axis and value of a term."""
    if term == "cross_axis":
        for i, to in enumerate(axes):
            for j, source in enumerate(axes):
                if i != j:
                    yield f"{to} from {source}", float(device.sensitivity[i, j])
        return
    if term in SINGLE:
        yield axes[:1], float(getattr(device, term))
        return
    numbers = getattr(device, term)
    if term == "sensitivity":
        numbers = np.diag(numbers) - 1
    for axis, value in zip(axes, numbers, strict=True):
        yield axis, float(value)


def with_own_terms(
    device: Device, terms: tuple[DrawnTerm, ...], errors: SensorErrors, signal: str, seed: int
) -> tuple[Device, tuple[DrawnTerm, ...]]:
    """The device with what a user says of it; that takes the place of what a sheet says."""
    owner, part = owner_of(signal), part_of(signal)
    device = _timed(device, errors)
    own, drawn = errors.terms_of(part), []
    axes = "xyz" if device.axes == 3 else axis_of(signal) or "x"
    for term, stated in own.items():
        pairs = list(_pairs(term, axes))
        values = []
        for axis, number in pairs:
            known = _known(_of_axis(stated, number))
            value = float(known.draw(stream(seed, owner, part, "own", term, axis), 1)[0])
            values.append(value)
            drawn.append(_row(term, axis, value, known, _said(_of_axis(stated, number)), part))
        device = _with_term(device, term, pairs, values)
    device, turned = _mounted(device, errors, owner, seed)
    kept = tuple(row for row in terms if row.term not in own)
    return device, (*kept, *drawn, *turned)


def _pairs(term: str, axes: str) -> Iterator[tuple[str, int]]:
    """Axis, as it is told, and the number of the stated value that holds for it."""
    if term in SINGLE:
        yield "", 0
    elif term == "cross_axis":
        yield from ((f"{to} from {by}", i) for i, to in enumerate(axes) for by in axes if by != to)
    else:
        yield from ((axis, i) for i, axis in enumerate(axes))


def _of_axis(stated: sensor_errors.Term, number: int) -> Value:
    return stated[number] if isinstance(stated, tuple) else stated


def _known(value: Value) -> Distribution:
    """What is known of a term, by the rules of data sheets."""
    if not isinstance(value, Spread):
        return distributions.fixed(value)
    if value.max is None:
        assert value.typ is not None
        return RULES[RULE_OF_KIND["typ"]].known(Stated("typ", typ=value.typ))
    low = -value.max if value.min is None else value.min
    kind = "min_max" if value.typ is None else "typ_max"
    typ = math.nan if value.typ is None else value.typ
    return RULES[RULE_OF_KIND[kind]].known(Stated(kind, typ=typ, low=low, high=value.max))


def _said(value: Value) -> str:
    if not isinstance(value, Spread):
        return f"{value:g}"
    named = (("typical", value.typ), ("from", value.min), ("to", value.max))
    if value.min is None:
        named = (("typical ±", value.typ), ("at most ±", value.max), ("", None))
    return ", ".join(f"{word} {number:g}" for word, number in named if number is not None)


def _row(
    term: str, axis: str, value: float, known: Distribution, said: str, part: str
) -> DrawnTerm:
    unit = _unit(term, units.unit_of(part))
    return DrawnTerm(term, axis, value, unit, known.kind, known.u, said, OWN_SOURCE)


def _with_term(
    device: Device, term: str, pairs: list[tuple[str, int]], values: list[float]
) -> Device:
    if term in SINGLE:
        return replace(device, **{term: values[0]})  # type: ignore[arg-type]
    if term not in ("sensitivity", "cross_axis"):
        return replace(device, **{term: np.array(values)})  # type: ignore[arg-type]
    matrix = np.array(device.sensitivity)
    if term == "sensitivity":
        np.fill_diagonal(matrix, 1 + np.array(values))
    else:
        for (axis, _), value in zip(pairs, values, strict=True):
            matrix["xyz".index(axis[0]), "xyz".index(axis[-1])] = value
    return replace(device, sensitivity=matrix)


def _timed(device: Device, errors: SensorErrors) -> Device:
    """Clock, low-pass and temperature; a device of a sheet has them by its settings."""
    if not device.rate_Hz:
        device = replace(
            device,
            rate_Hz=errors.rate_Hz or 0.0,
            bandwidth_Hz=errors.bandwidth_Hz or math.inf,
            temperature_C=errors.temperature_C,
        )
    return replace(
        device,
        poles=errors.poles or device.poles,
        latency_s=errors.latency_s,
        jitter_s=errors.jitter_s,
        mounting_wxyz=errors.mounting_wxyz,
    )


def _mounted(
    device: Device, errors: SensorErrors, owner: str, seed: int
) -> tuple[Device, tuple[DrawnTerm, ...]]:
    """The device turned in its box by angles that are drawn once, for all parts of a chip."""
    known = _known(errors.misalignment_rad)
    if device.axes != 3 or known == distributions.fixed(0.0):
        return device, ()
    angles: Array = np.array(
        [known.draw(stream(seed, owner, "misalignment", axis), 1)[0] for axis in "xyz"]
    )
    turned = multiply(np.array([device.mounting_wxyz]), quaternions_of(angles[None]))[0]
    rows = tuple(
        DrawnTerm(
            "misalignment", axis, float(angle), "rad", known.kind, known.u,
            _said(errors.misalignment_rad), OWN_SOURCE,
        )
        for axis, angle in zip("xyz", angles, strict=True)
    )  # fmt: skip
    w, x, y, z = map(float, turned)
    return replace(device, mounting_wxyz=(w, x, y, z)), rows
