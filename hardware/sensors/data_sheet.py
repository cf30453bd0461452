"""Data sheets as data: what is known of any device of a chip, and devices drawn from it.

::

    part = data_sheet.load("mpu6050").part("accelerometer")
    part.terms["offset_xy"].distribution        # normal, u = 0.49 m/s²
    part.terms["offset_xy"].rule_in_words
    device = part.drawn(seed=1, device_name="imu", range="2 g", rate_Hz=100)

A sheet is a YAML file, of the folder ``sheets`` or the user's own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypedDict, Unpack

from simcompare.errors import NoSuchFile, UnknownName, unknown_or_missing
from simcompare.hardware.sensors import drawing, sheet_reading, sheets
from simcompare.hardware.sensors.device import Device
from simcompare.hardware.sensors.drawing import Devices
from simcompare.hardware.sensors.sheet_entries import Entry
from simcompare.hardware.sensors.sheet_parts import PartData, Settings


class Asked(TypedDict, total=False):
    """Settings that can be asked for.

    Attributes:
        range: name of the full scale, such as "2 g".
        rate_Hz: output data rate.
        bandwidth_Hz: -3 dB bandwidth.
        temperature_C: of the device.
    """

    range: str | None
    rate_Hz: float | None
    bandwidth_Hz: float | None
    temperature_C: float


@dataclass(frozen=True)
class Part(PartData):
    """One sensor of a chip: what its data sheet says, and devices drawn from that."""

    def with_sigma(self, typ_is_sigma: float) -> Part:
        """The same where another part of a typical value is one standard deviation."""
        terms = {name: one.with_sigma(typ_is_sigma) for name, one in self.terms.items()}
        return replace(self, terms=terms)

    def typical(self, device_name: str = "", **asked: Unpack[Asked]) -> Device:
        """A device without systematic errors: noise, resolution and range as in the sheet."""
        return drawing.typical(self, self.settings(**asked), device_name)

    def drawn(self, seed: int, device_name: str = "", **asked: Unpack[Asked]) -> Device:
        """One device: each systematic term drawn once, from a stream of its own name.

        The device's name is a part of the stream: two sensors of a robot have other errors, and
        adding one changes no other.

        Args:
            seed: of all streams of a run.
            device_name: whose errors they are, for example "imu".
            asked: settings.

        Raises:
            UnknownName: no such range.
            InputError: a rate or a bandwidth that the chip does not have.
        """
        return drawing.many(self, self.settings(**asked), seed, 1, device_name).device(0)

    def drawn_many(
        self, seed: int, count: int, device_name: str = "", **asked: Unpack[Asked]
    ) -> Devices:
        """Many devices at once as arrays; the first is the one that ``drawn`` gives."""
        return drawing.many(self, self.settings(**asked), seed, count, device_name)

    def settings(self, **asked: Unpack[Asked]) -> Settings:
        """Settings that the chip has; the usual ones where none are asked for.

        Raises:
            UnknownName: no such range.
            InputError: a rate or a bandwidth that the chip does not have.
        """
        return sheet_reading.settings(self, **asked)


@dataclass(frozen=True)
class DataSheet:
    """A chip.

    Attributes:
        name: of its file.
        title: name of the chip.
        about: what it is, in a few words.
        maker: who makes it.
        document: number and revision of the maker's data sheet.
        read: how its values were read.
        note: what else must be known.
        parts: name -> part.
    """

    name: str
    title: str
    about: str
    maker: str
    document: str
    read: str
    note: str
    parts: Mapping[str, Part]

    def part(self, name: str | None = None) -> Part:
        """The part of that name; the first where ``None``.

        Raises:
            UnknownName: there is none of that name.
        """
        chosen = next(iter(self.parts)) if name is None else name
        if chosen not in self.parts:
            raise UnknownName(f"part of {self.title}", chosen, self.parts)
        return self.parts[chosen]

    def part_for(self, unit: str) -> Part | None:
        """The part that measures in an SI unit, such as ``m/s**2``."""
        return next((part for part in self.parts.values() if part.unit == unit), None)


def names() -> list[str]:
    """Names of the sheets that ship with simcompare."""
    return sheets.names()


def load(name_or_path: str | Path) -> DataSheet:
    """A data sheet by its name, or the user's own by its path.

    Args:
        name_or_path: "mpu6050", or a YAML file.

    Raises:
        UnknownName: no sheet is called so.
        NoSuchFile: there is no such file.
        InputError: the file is no data sheet, or one of a sensor that cannot be.
    """
    known = sheets.files()
    path = known.get(str(name_or_path).lower(), Path(name_or_path))
    if path.is_dir():
        raise NoSuchFile(path, "a data sheet in YAML")
    if not path.is_file():
        raise unknown_or_missing("data sheet", str(name_or_path), known)
    content, lines = sheet_reading.read(path)
    parts = sheet_reading.parts(content, lines, path)
    made = {name: Part(**vars(part)) for name, part in parts.items()}
    source = content.source
    return DataSheet(
        path.stem, content.name, content.title, content.maker,
        sheet_reading.document(source), source.read, content.note, made,
    )  # fmt: skip


__all__ = ["DataSheet", "Device", "Devices", "Entry", "Part", "load", "names"]
