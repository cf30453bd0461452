"""One device for one signal: drawn from a data sheet, from own terms, or from both.

Every systematic term is drawn once for the device, from a stream of the device's own name. So the
same seed gives the same device for every engine, and adding a sensor changes no other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors import data_sheet
from simcompare.hardware.sensors.data_sheet import DataSheet, Part
from simcompare.hardware.sensors.device import Device, perfect
from simcompare.hardware.sensors.drawn_terms import DrawnTerm, of_sheet, with_own_terms
from simcompare.hardware.sensors.sheet_parts import Settings
from simcompare.hardware.sensors.signals import axis_of, owner_of, part_of, unit_of
from simcompare.model.sensor_errors import SensorErrors


@dataclass(frozen=True, eq=False)
class DrawnSensor:
    """The device that reads one signal.

    Attributes:
        signal: such as "imu.rate_rad_s".
        unit: of the signal, SI.
        axes: letters of its axes.
        device: its numbers.
        terms: what was drawn, and what every device of its kind has.
        sheet: name of the data sheet, empty where there is none.
        chip: what the sheet calls it.
        part: of the chip.
        source: document of the sheet.
    """

    signal: str
    unit: str
    axes: str
    device: Device
    terms: tuple[DrawnTerm, ...]
    sheet: str = ""
    chip: str = ""
    part: str = ""
    source: str = ""


def drawn(errors: SensorErrors, signals: Mapping[str, int], seed: int) -> tuple[DrawnSensor, ...]:
    """The devices of one sensor, one for each of its signals of which errors are said.

    Args:
        errors: what is said of it.
        signals: names such as "imu.rate_rad_s" -> number of components.
        seed: of all streams.

    Raises:
        UnknownName: no such sheet or range.
        InputError: the sheet has nothing that measures so, or not with these settings.
    """
    sheet = None if errors.sheet is None else data_sheet.load(errors.sheet)
    parts = {} if sheet is None else parts_of(sheet, errors, signals)
    named = [signal for signal in signals if errors.names_unit_of(part_of(signal))]
    chosen = {*parts, *named} or {*signals}
    return tuple(
        _one(errors, signal, width, seed, sheet, parts.get(signal))
        for signal, width in signals.items()
        if signal in chosen
    )


def parts_of(
    sheet: DataSheet, errors: SensorErrors, signals: Mapping[str, int]
) -> dict[str, tuple[Part, Settings]]:
    """Signal -> the part of a chip that measures it, and the settings for that.

    Raises:
        UnknownName: no part has such a range.
        InputError: no part measures any of the signals, or none has such a rate or bandwidth.
    """
    found = {
        signal: part
        for signal, width in signals.items()
        if (part := sheet.part_for(unit_of(signal))) and len(part.axes) >= width
    }
    if not found:
        raise InputError(f"sheet {sheet.name}", [_no_part(sheet, signals)])
    asked = {name: getattr(errors, name) for name in ("range", "rate_Hz", "bandwidth_Hz")}
    asked = {name: value for name, value in asked.items() if value is not None}
    return {
        signal: (part, _settings(part, list(found.values()), asked, errors.temperature_C))
        for signal, part in found.items()
    }


def _settings(
    part: Part, parts: list[Part], asked: Mapping[str, object], temperature_C: float
) -> Settings:
    """Settings of a part; what only another part of the chip has is not asked of this one."""
    own = {}
    for name, value in asked.items():
        others = [one for one in parts if one is not part and _has(one, name, value)]
        if _has(part, name, value) or not others:
            own[name] = value
    return part.settings(**own, temperature_C=temperature_C)  # type: ignore[arg-type]


def _has(part: Part, name: str, value: object) -> bool:
    try:
        part.settings(**{name: value})  # type: ignore[arg-type]
    except (InputError, UnknownName):
        return False
    return True


def _no_part(sheet: DataSheet, signals: Mapping[str, int]) -> str:
    measured = ", ".join(
        f"{part.measures} ({units.symbol(part.unit)}, {len(part.axes)}"
        f" {'axes' if len(part.axes) > 1 else 'axis'})"
        for part in sheet.parts.values()
    )
    named = ", ".join(signals)
    hint = ""
    wide = [name for name, width in signals.items() if width > 1]
    units_of_one = {part.unit for part in sheet.parts.values() if len(part.axes) == 1}
    fitting = [name for name in wide if unit_of(name) in units_of_one]
    if fitting:
        hint = f"; name one component, such as {fitting[0]}.x"
    return f"it measures {measured}, not {named}{hint}"


def _one(
    errors: SensorErrors, signal: str, width: int, seed: int,
    sheet: DataSheet | None, chosen: tuple[Part, Settings] | None,
) -> DrawnSensor:  # fmt: skip
    owner = owner_of(signal)
    if sheet is None or chosen is None:
        device, about = perfect(owner, width), {}
        terms: tuple[DrawnTerm, ...] = ()
    else:
        part, at = chosen
        device = part.drawn(
            seed, owner, range=at.range.name, rate_Hz=at.rate_Hz,
            bandwidth_Hz=at.bandwidth_Hz if np.isfinite(at.bandwidth_Hz) else None,
            temperature_C=at.temperature_C,
        )  # fmt: skip
        terms = of_sheet(part, at, device)
        if width < device.axes:
            device, terms = _alone(device, terms, axis_of(signal) or "x")
        about = {
            "sheet": sheet.name, "chip": sheet.title, "part": part.name, "source": sheet.document
        }  # fmt: skip
    device, terms = with_own_terms(device, terms, errors, signal, seed)
    axes = "xyz" if width > 1 else axis_of(signal)
    return DrawnSensor(signal, unit_of(signal), axes, device, terms, **about)


def _alone(
    device: Device, terms: tuple[DrawnTerm, ...], axis: str
) -> tuple[Device, tuple[DrawnTerm, ...]]:
    """One axis of a device; what the others would add to it is not known and left out."""
    i = "xyz".index(axis)
    one = {
        name: value[i : i + 1]
        for name, value in vars(device).items()
        if isinstance(value, np.ndarray) and value.ndim == 1
    }
    one["sensitivity"] = device.sensitivity[i : i + 1, i : i + 1]
    return replace(device, **one), tuple(row for row in terms if row.axis == axis)  # type: ignore[arg-type]
