"""Sentences on what a sensor reads, and numbers of its devices as a reader wants them."""

from __future__ import annotations

import math

from simcompare import notation, units
from simcompare.hardware.sensors.drawn_terms import DrawnTerm
from simcompare.hardware.sensors.multizone import NOTHING, TRUSTED
from simcompare.model.sensor_errors import SIZES
from simcompare.reports.render import numbers
from simcompare.results.records.sensing import Sensing, SensorRecord, SourceDeviation

#: what is said of a device, wherever it is shown
ONE_DEVICE = (
    "Each device was drawn once and is the same for every source. Engines and scores are ideal:"
    " nothing that a sensor reads goes into a score."
)


#: below a table of numbers with their sources
NOT_CONFIRMED = " A value marked * was not read in the maker's own text."


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
    told = _zones_words if sensor.zones is not None else _off_words
    return [f"{sensor.signal}, read by {_device_words(sensor)}: {told(sensor, leading)}."]


def lead(sensor: SensorRecord) -> SourceDeviation | None:
    """The source whose reading stands for all: the truth, else the most helped engine."""
    known = sensor.deviations
    return next((one for one in known if not one.contact), known[-1] if known else None)


def _device_words(sensor: SensorRecord) -> str:
    """Which device it is."""
    if sensor.zones is not None:
        count = sensor.zones.in_a_row
        return f"one {sensor.chip} ({count}×{count} zones, {sensor.rate_Hz:g} frames a second)"
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


def _zones_words(sensor: SensorRecord, one: SourceDeviation) -> str:
    """How far what can be trusted is off, and how much cannot."""
    whole = sum(one.statuses.values())
    nothing, doubtful = counts_of(one)
    told = {"see nothing": nothing, "are not to be trusted": doubtful}
    missing = [f"{count} {what}" for what, count in told.items() if count]
    rest = f"; of {whole} readings {' and '.join(missing)}" if missing else ""
    if not one.axes:
        return f"no reading can be trusted{rest}"
    axis, unit = one.axes[0], unit_words(sensor.unit)
    assert axis.median is not None
    assert axis.half_68 is not None
    off = f"off by {signed(axis.median)}{unit} in the median"
    return f"{off}, 68 % within ±{numbers.plain(axis.half_68, 2)}{unit} of that{rest}"


def counts_of(one: SourceDeviation) -> tuple[int, int]:
    """Readings of zones in which nothing was found, and those that are found and not trusted."""
    nothing = one.statuses.get(str(NOTHING), 0)
    trusted = sum(one.statuses.get(str(code), 0) for code in TRUSTED)
    return nothing, sum(one.statuses.values()) - nothing - trusted


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
        "Range": f"{'to ' if sensor.zones else '±'}{numbers.plain(sensor.full_scale, 4)}{unit}"
        if math.isfinite(sensor.full_scale)
        else "",
        "One count": f"{numbers.plain(sensor.resolution, 3)}{unit}" if sensor.resolution else "",
        **_light(sensor),
        "Temperature": f"{sensor.temperature_C:g} °C",
        "Latency": notation.amount(sensor.latency_s, "s") if sensor.latency_s else "",
        "Jitter": notation.amount(sensor.jitter_s, "s") if sensor.jitter_s else "",
    }
    return {name: text for name, text in facts.items() if text}


def _light(sensor: SensorRecord) -> dict[str, str]:
    """What a range sensor of many zones looks at."""
    zones = sensor.zones
    if zones is None:
        return {}
    dark = ", ".join(f"{name} {100 * part:g} %" for name, part in zones.reflectance.items())
    return {
        "Light": f"{zones.ambient_klux:g} klux" if zones.ambient_klux else "dark",
        "Reflectance": f"{dark}; all else as the white target" if dark else "as the white target",
        "Cover glass": f"{zones.crosstalk:g}/m²" if zones.crosstalk else "",
        "Of several targets": f"the {zones.order} is told",
    }


def _poles(count: int) -> str:
    return "one pole" if count == 1 else f"{count} poles"
