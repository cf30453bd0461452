"""Sentences on what a sensor reads, and numbers of its devices as a reader wants them."""

from __future__ import annotations

import math

from simcompare import notation, units
from simcompare.hardware.sensors.drawn_terms import DrawnTerm
from simcompare.model.sensor_errors import SIZES
from simcompare.reports.render import numbers
from simcompare.results.records.sensing import Sensing, SensorRecord, SourceDeviation

#: what is said of a device, wherever it is shown
ONE_DEVICE = (
    "Each device was drawn once and is the same for every source. Engines and scores are ideal:"
    " nothing that a sensor reads goes into a score."
)


def lines(sensing: Sensing) -> list[str]:
    """What every sensor reads, a line or two for each signal, and how it was drawn."""
    said = [line for sensor in sensing.sensors for line in sensor_lines(sensor)]
    notes = [note for sensor in sensing.sensors for one in sensor.deviations for note in one.notes]
    said += [notation.sentence(note) for note in dict.fromkeys(notes)]
    return [*said, f"{ONE_DEVICE} Another draw: --seed {sensing.seed + 1}."] if said else []


def sensor_lines(sensor: SensorRecord) -> list[str]:
    """How far the reading of one signal is off."""
    leading = lead(sensor)
    if leading is None:
        return [f"{sensor.signal}: no source gives this signal, so there is nothing to read."]
    return [f"{sensor.signal}, read by {_device_words(sensor)}: {_off_words(sensor, leading)}."]


def lead(sensor: SensorRecord) -> SourceDeviation | None:
    """The source whose reading stands for all: the truth, else the most helped engine."""
    known = sensor.deviations
    return next((one for one in known if not one.contact), known[-1] if known else None)


def _device_words(sensor: SensorRecord) -> str:
    """Which device it is."""
    if sensor.chip:
        return f"one {sensor.chip} ({sensor.part.replace('_', ' ')})"
    return "one device with the terms that were given"


def _off_words(sensor: SensorRecord, one: SourceDeviation) -> str:
    """Mean deviation, scatter and saturation."""
    unit = unit_words(sensor.unit)
    means = ", ".join(f"{axis.axis} {signed(axis.mean)}".strip() for axis in one.axes)
    scatter = max(axis.scatter for axis in one.axes)
    cut = sum(axis.saturated for axis in one.axes)
    text = f"off by {means}{unit} in the mean, scatter"
    text += f" {'up to ' if len(one.axes) > 1 else ''}{numbers.plain(scatter, 2)}{unit}"
    whole = one.samples * len(one.axes)
    return f"{text}; {cut} of {whole} values saturated" if cut else text


def signed(value: float) -> str:
    """A deviation with three digits and its sign."""
    text = numbers.plain(value, 3)
    return text if text.startswith(("−", "-")) or value == 0 else f"+{text}"


def unit_words(unit: str) -> str:
    """A unit behind a number."""
    return "" if unit == "1" else f" {units.symbol(unit)}"


def value_words(term: DrawnTerm) -> tuple[str, str, str]:
    """Value, what any device has, and their unit; parts are told in per cent."""
    factor, unit = _scale(term)
    value = factor * term.value
    told = numbers.plain(value, 3) if term.term in SIZES else signed(value)
    return told, _known(term.kind, factor * term.u), unit


def _known(kind: str, u: float) -> str:
    """A distribution in words."""
    if kind == "fixed" or u == 0:
        return "the same"
    return f"{kind.replace('_', ' ')}, u = {numbers.plain(u, 2)}"


def _scale(term: DrawnTerm) -> tuple[float, str]:
    if term.unit == "":
        return 100.0, "%"
    return (100.0, "%/K") if term.unit == "1/K" else (1.0, term.unit)


def settings(sensor: SensorRecord) -> dict[str, str]:
    """How the device samples, by name."""
    unit = unit_words(sensor.unit)
    facts = {
        "Data sheet": sensor.document and f"{sensor.chip}, {sensor.document}",
        "Samples": f"{sensor.rate_Hz:g} a second" if sensor.rate_Hz else "those of the simulation",
        "Bandwidth": f"{sensor.bandwidth_Hz:g} Hz, {_poles(sensor.poles)}"
        if math.isfinite(sensor.bandwidth_Hz)
        else "",
        "Range": f"±{numbers.plain(sensor.full_scale, 4)}{unit}"
        if math.isfinite(sensor.full_scale)
        else "",
        "One count": f"{numbers.plain(sensor.resolution, 3)}{unit}" if sensor.resolution else "",
        "Temperature": f"{sensor.temperature_C:g} °C",
        "Latency": notation.amount(sensor.latency_s, "s") if sensor.latency_s else "",
        "Jitter": notation.amount(sensor.jitter_s, "s") if sensor.jitter_s else "",
    }
    return {name: text for name, text in facts.items() if text}


def _poles(count: int) -> str:
    return "one pole" if count == 1 else f"{count} poles"
