"""The ``errors`` of a sensor in a scenario's file: a data sheet, own terms, or both.

::

    imu:
      type: imu
      body: chassis
      errors:
        sheet: mpu6050                        # of a chip, or
        rate_Hz: 100
        offset_m_s2: {typ: 0.5, max: 1.0}     # drawn once for the device
        noise_m_s2_per_rtHz: 0.004            # the same for every device
        offset_rad_s: 0.02                    # exactly this

A number is exactly that. ``{typ: s}`` is normal with the standard deviation s, ``{max: a}`` and
``{min: a, max: b}`` are rectangular between the limits, ``{typ: s, max: a}`` is normal and cut off
at the limits. Three of them in a list are one for each axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated

from pydantic import (
    ConfigDict,
    Field,
    PositiveFloat,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from simcompare import units
from simcompare.errors import UnknownName
from simcompare.model.frozen import Frozen
from simcompare.model.shapes import Nonnegative, Quaternion

#: engines simulate ideal readings; errors are added to what was simulated
ERRORS = "what a real device would add to the ideal readings"


class Spread(Frozen):
    """What is known of a term, as a data sheet says it: a deviation from an ideal device."""

    typ: Annotated[float, Field(gt=0)] | None = None
    min: float | None = None
    max: float | None = None

    @property
    def fault(self) -> str:
        """What is wrong with it; empty where nothing is."""
        if self.max is None:
            return "" if self.typ is not None and self.min is None else f"expected {_SPREADS}"
        low = -self.max if self.min is None else self.min
        if not low < self.max:
            return f"max {self.max:g} is not above {low:g}; expected the larger one"
        if self.typ is not None and self.typ > max(abs(low), abs(self.max)):
            return f"max {self.max:g} is below the typical {self.typ:g}; expected more"
        return ""


_SPREADS = "a number, or {typ: s}, {max: a}, {min: a, max: b}, {typ: s, max: a}"


def _plainly(value: object, read: ValidatorFunctionWrapHandler) -> object:
    """A term; what is wrong with it is one sentence, and not one for each form that it can have."""
    try:
        if any(isinstance(one, bool) for one in (value if isinstance(value, list) else [value])):
            raise ValueError(f"expected {_SPREADS}, or a list of three of these")
        return read(value)
    except ValidationError as error:
        inside = [one for one in error.errors() if "Spread" in one["loc"] and len(one["loc"]) > 1]
        if isinstance(value, dict) and inside:
            first = inside[0]
            raise ValueError(f"{first['loc'][-1]}: {first['msg'].lower()}") from None
        raise ValueError(f"expected {_SPREADS}, or a list of three of these") from None


_Known = float | Spread
#: one value for all axes, or three
Value = Annotated[_Known, WrapValidator(_plainly)]
Term = Annotated[_Known | tuple[_Known, _Known, _Known], WrapValidator(_plainly)]
#: terms without unit, parts of the reading, the full scale or the rate
_RELATIVE = (
    "sensitivity", "cross_axis", "nonlinearity", "sensitivity_per_K", "noise_per_reading",
    "rate_error",
)  # fmt: skip
#: terms in the unit of the signal -> what their name begins with, and what the unit is divided by
_IN_UNITS = {
    "offset": ("offset", ""),
    "offset_per_K": ("offset", "_per_K"),
    "noise_density": ("noise", "_per_rtHz"),
    "bias_instability": ("bias_instability", ""),
    "random_walk": ("random_walk", "_per_rts"),
    "resolution": ("resolution", ""),
    "full_scale": ("full_scale", ""),
}
#: terms that every device has alike, and that are sizes
SIZES = (
    "noise_density", "noise_per_reading", "bias_instability", "random_walk", "resolution",
    "full_scale",
)  # fmt: skip
#: terms of the whole device, with one value for all axes
SINGLE = ("resolution", "full_scale", "rate_error")


#: temperatures that make sense for electronics
COLDEST_C, HOTTEST_C = -100.0, 250.0
#: no sensor is older than this
MAX_LATENCY_S = 10.0
#: of any term: beyond it numbers lose their digits
MAX_SIZE = 1e12
#: of a clock, as a part of its rate
MAX_RATE_ERROR = 0.5
#: of one count: below it a number has as many digits
MIN_RESOLUTION = 1e-15
#: standard deviation of the instant of a sample, as a part of the time between two: beyond it
#: samples would change places
MAX_JITTER = 0.5
#: bandwidth as a part of the rate, below which a low-pass of several poles, or one, has no digits
_LEAST_SEVERAL, _LEAST_ONE = 1e-4, 1e-8


class SensorErrors(Frozen):
    """What keeps a sensor from being ideal; terms carry the unit of the signal in their names.

    Attributes:
        sheet: name or file of a data sheet.
        range: of the sheet, such as "2 g"; the usual one where left out.
        rate_Hz: samples in a second; those of the sheet, or of the simulation, where left out.
        bandwidth_Hz: -3 dB of the low-pass.
        poles: of the low-pass; 1 where left out.
        temperature_C: of the device.
        latency_s: by which a sample is older than its time stamp.
        jitter_s: standard deviation of the instant of a sample.
        mounting_wxyz: how the sensor is turned in its box.
        misalignment_rad: small turn in its box about each axis, drawn for each device.
    """

    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False)
    __pydantic_extra__: dict[str, Term]

    sheet: str | None = None
    range: str | None = None
    rate_Hz: PositiveFloat | None = None
    bandwidth_Hz: PositiveFloat | None = None
    poles: Annotated[int, Field(ge=1, le=4)] | None = None
    temperature_C: Annotated[float, Field(ge=COLDEST_C, le=HOTTEST_C)] = 25.0
    latency_s: Annotated[float, Field(ge=0, le=MAX_LATENCY_S)] = 0.0
    jitter_s: Nonnegative = 0.0
    mounting_wxyz: Quaternion = (1.0, 0.0, 0.0, 0.0)
    misalignment_rad: Value = 0.0

    @model_validator(mode="before")
    @classmethod
    def _a_mapping(cls, given: object) -> object:
        if isinstance(given, str | int | float | list):
            raise ValueError("expected terms, such as {sheet: mpu6050} or {offset_m_s2: 0.2}")
        return given

    def terms_of(self, part: str) -> dict[str, Term]:
        """The terms that are said of one signal of the sensor, by the names of the error model."""
        known = keys_of(part)
        return {known[key]: value for key, value in self.__pydantic_extra__.items() if key in known}

    def names_unit_of(self, part: str) -> bool:
        """Whether a term is said in the unit of this signal, and so of this one."""
        return any(term in _IN_UNITS for term in self.terms_of(part))


def keys_of(part: str) -> dict[str, str]:
    """What terms of a signal such as ``rate_rad_s`` are called in a file -> term."""
    suffix = units.suffix_of(part)
    of_unit = {f"{begin}{suffix}{per}": term for term, (begin, per) in _IN_UNITS.items()}
    return {**{name: name for name in _RELATIVE}, **of_unit}


def faults_of(
    errors: SensorErrors, signals: Mapping[str, int], rate_Hz: float
) -> Iterator[tuple[str, str]]:
    """Place and sentence of what cannot be.

    Args:
        errors: what is said of a sensor.
        signals: what it records -> number of components.
        rate_Hz: of the simulation's samples.
    """
    given = errors.__pydantic_extra__
    if not errors.model_dump(exclude_unset=True, exclude_none=True):
        yield "", f"says nothing; give a sheet, or terms such as {_example(signals)}"
    if errors.range is not None and errors.sheet is None:
        yield "range", "is one of a data sheet; give a sheet, or full_scale"
    yield from _of_time(errors, rate_Hz)
    if fault := _fault_of_one("misalignment", errors.misalignment_rad):
        yield "misalignment_rad", fault
    known = [key for part in signals for key in keys_of(part)]
    for key in given:
        if key not in known:
            yield key, str(UnknownName("term of these errors", key, [*known, *_SETTINGS]))
    for part, width in signals.items():
        yield from _of_terms(errors, part, width)
    yield from _without_scale(errors, signals)


_SETTINGS = tuple(SensorErrors.model_fields)


def _example(signals: Mapping[str, int]) -> str:
    return ", ".join(f"offset{units.suffix_of(part)}" for part in signals)


def _of_time(errors: SensorErrors, rate_Hz: float) -> Iterator[tuple[str, str]]:
    length = math.hypot(*errors.mounting_wxyz)
    if abs(length - 1) > 1e-6:
        yield "mounting_wxyz", f"has length {length:.6g}; a rotation has length 1"
    rate, whose = (errors.rate_Hz, "rate_Hz") if errors.rate_Hz else (rate_Hz, "the simulation's")
    if errors.sheet is None or errors.rate_Hz:
        fault = fault_of_jitter(errors.jitter_s, rate)
        if fault:
            yield "jitter_s", fault
    if errors.sheet is not None or errors.bandwidth_Hz is None:
        return  # the sheet knows its own rate
    fault = fault_of_low_pass(errors.bandwidth_Hz, errors.poles or 1, max(rate, rate_Hz))
    if fault:
        yield "bandwidth_Hz", fault
    if errors.bandwidth_Hz > rate / 2 * (1 + 1e-9):
        yield (
            "bandwidth_Hz",
            f"{errors.bandwidth_Hz:g} Hz is above Nyquist's {rate / 2:g} Hz, half of {whose}"
            f"{'' if errors.rate_Hz else f' rate {rate:g} Hz'}; give less, or a higher rate_Hz",
        )


def fault_of_low_pass(bandwidth_Hz: float, poles: int, rate_Hz: float) -> str:
    """Whether a bandwidth is too low to be calculated at that rate; empty where it is not."""
    least = rate_Hz * (_LEAST_SEVERAL if poles > 1 else _LEAST_ONE)
    if not 0 < bandwidth_Hz < least:
        return ""
    return (
        f"{bandwidth_Hz:g} Hz is too low to be calculated at {rate_Hz:.4g} samples a second;"
        f" expected at least {least:.4g} Hz"
    )


def fault_of_jitter(jitter_s: float, rate_Hz: float) -> str:
    """What is wrong with a jitter at that rate; empty where nothing is."""
    if jitter_s * rate_Hz <= MAX_JITTER:
        return ""
    most = MAX_JITTER / rate_Hz
    return (
        f"{jitter_s:g} s would let samples change places; "
        f"expected at most {most:g} s, half of the time between two"
    )


def _of_terms(errors: SensorErrors, part: str, width: int) -> Iterator[tuple[str, str]]:
    names = {term: key for key, term in keys_of(part).items()}
    for term, value in errors.terms_of(part).items():
        fault = _fault(term, value, width)
        if fault:
            yield names[term], fault


def _without_scale(errors: SensorErrors, signals: Mapping[str, int]) -> Iterator[tuple[str, str]]:
    """A non-linearity is a part of a full scale, which must be known."""
    if errors.sheet is not None or "nonlinearity" not in errors.__pydantic_extra__:
        return
    said = [part for part in signals if errors.names_unit_of(part)] or list(signals)
    scales = [
        f"full_scale{units.suffix_of(part)}"
        for part in said
        if "full_scale" not in errors.terms_of(part)
    ]
    if scales:
        yield "nonlinearity", f"is a part of full scale; give {' and '.join(scales)} too"


def _fault(term: str, value: Term, width: int) -> str:
    values = value if isinstance(value, tuple) else (value,)
    if len(values) > 1 and (term in SINGLE or width == 1):
        return "is one number for all axes; expected no list"
    if term == "cross_axis" and width == 1:
        return "there is only one axis; leave it out"
    return next(filter(None, (_fault_of_one(term, one) for one in values)), "")


def _fault_of_one(term: str, one: float | Spread) -> str:
    if isinstance(one, Spread):
        if term in SIZES:
            return "every device has it alike; expected a number"
        if one.fault:
            return one.fault
        sizes = [abs(size) for size in (one.typ, one.min, one.max) if size is not None]
    elif term in SIZES and one < 0:
        return f"is {one:g}; expected 0 or more"
    else:
        sizes = [abs(one)]
    most = MAX_RATE_ERROR if term == "rate_error" else MAX_SIZE
    if term == "full_scale" and not sizes[0]:
        return "is 0; expected more: readings are cut off there"
    if max(sizes) > most:
        return f"is {max(sizes):g}; expected a size of at most {most:g}"
    if term == "resolution" and 0 < sizes[0] < MIN_RESOLUTION:
        return f"is {sizes[0]:g}; expected 0, or at least {MIN_RESOLUTION:g}"
    return ""
