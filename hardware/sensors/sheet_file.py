"""What stands in the YAML file of a data sheet; all faults of a file are told at once."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationError

from simcompare.errors import InputError
from simcompare.model.frozen import Frozen
from simcompare.model.yaml_file import describe, faults_of, read_yaml


def _text(value: object) -> object:
    return str(value) if isinstance(value, int | float | date) else value


Text = Annotated[str, Field(min_length=1)]
#: a number with its unit; a bare number is read, so that the missing unit can be told
Value = Annotated[str, BeforeValidator(_text)]
#: YAML reads what looks like a date as one
Date = Annotated[str, BeforeValidator(_text)]
#: a page, or the name of a table
Page = int | Text


class SourceFile(Frozen):
    """Which document the values were read in."""

    document: Text
    revision: Text
    date: Date = ""
    read: str = ""


class RangeFile(Frozen):
    """One full scale: where readings are cut off, and the size of one count."""

    full_scale: Value
    count: Value | None = None
    page: Page
    confirmed: bool


class EntryFile(Frozen):
    """One line of a data sheet.

    Attributes:
        term: which term of the error model it states.
        says: what the sheet calls it.
        axes: letters of the axes; all where left out.
        ranges: names of the ranges for which it holds; all where left out.
        nominal: what an ideal device has, where the values are no deviations.
        over_C: temperatures between which it changes by so much.
        within: span of readings over which a sensitivity is off by so much.
        about: reading at which a sensitivity is not off.
        bandwidth: at which an rms was stated; of one reading where left out.
        rule: by which it becomes a distribution, where not by its kind.
        used: whether it is a part of the error model; otherwise only a cross-check.
        page: page or table of the document.
        confirmed: whether it was read in the maker's own text.
        source: another source than that of the sheet.
    """

    term: str
    says: Text
    axes: str | None = Field(None, pattern=r"^[xyz]{1,3}$")
    ranges: tuple[str, ...] = ()
    nominal: Value | None = None
    typ: Value | None = None
    min: Value | None = None
    max: Value | None = None
    rms: Value | None = None
    density: Value | None = None
    over_C: tuple[float, float] | None = None
    within: Value | None = None
    about: Value | None = None
    bandwidth: Value | None = None
    rule: str | None = None
    used: bool = True
    page: Page
    confirmed: bool
    source: str = ""
    note: str = ""

    @property
    def kind(self) -> str:
        """Kind of its value; empty where its values do not go together."""
        stated = {
            name
            for name in ("typ", "min", "max", "rms", "density")
            if getattr(self, name) is not None
        }
        return _KINDS.get(frozenset(stated), "")


_KINDS = {
    frozenset({"typ"}): "typ",
    frozenset({"max"}): "max",
    frozenset({"min", "max"}): "min_max",
    frozenset({"typ", "max"}): "typ_max",
    frozenset({"typ", "min", "max"}): "typ_max",
    frozenset({"rms"}): "rms",
    frozenset({"density"}): "density",
}


class UsualFile(Frozen):
    """Settings that hold where none are given."""

    range: str
    rate: Value
    bandwidth: Value | None = None


class PartFile(Frozen):
    """One sensor of a chip.

    Attributes:
        measures: the quantity.
        axes: how many.
        reading: a reading at which its uncertainty is told where none is given.
        ranges: name -> full scale; at least one.
        rates: output data rates; with ``rates_between`` the lowest and the highest.
        bandwidths: -3 dB bandwidths that can be chosen.
        bandwidth_per_rate: or the bandwidth as a part of the rate.
        poles: of the low-pass, 1 to 4 (assumed: sheets rarely say).
        page: page or table of rates and bandwidths.
        confirmed: whether these were read in the maker's own text.
        usual: settings that hold where none are given.
        entries: lines of the sheet.
    """

    measures: Literal[
        "specific force", "angular rate", "pressure", "distance", "current", "voltage", "angle"
    ]
    axes: Literal[1, 3]
    reading: Value
    ranges: Mapping[str, RangeFile] = Field(min_length=1)
    rates: tuple[Value, ...] = Field(min_length=1)
    rates_between: bool = False
    bandwidths: tuple[Value, ...] = ()
    bandwidth_per_rate: float | None = Field(None, gt=0)
    poles: int = Field(1, ge=1, le=4)
    page: Page
    confirmed: bool
    usual: UsualFile
    entries: tuple[EntryFile, ...] = Field(min_length=1)


class ZoneFile(Frozen):
    """One number of a range sensor of many zones, in the SI unit that its name ends with.

    Attributes:
        term: what it is, a field of ``ZoneNumbers``.
        value: its value.
        says: what the source calls it.
        page: page or table of the document.
        confirmed: whether it was read in the maker's own text.
        source: another source than that of the sheet.
    """

    term: Text
    value: float
    says: Text
    page: Page
    confirmed: bool
    source: str = ""


class ZonesFile(Frozen):
    """What a range sensor of many zones has in all modes, and with 4 or 8 zones in a row."""

    both: tuple[ZoneFile, ...]
    four: tuple[ZoneFile, ...]
    eight: tuple[ZoneFile, ...]


class SheetFile(Frozen):
    """A data sheet: one chip with its parts."""

    name: Text
    title: Text
    maker: Text
    source: SourceFile
    note: str = ""
    parts: Mapping[Text, PartFile] = Field(min_length=1)
    zones: ZonesFile | None = None


def read(path: Path) -> tuple[SheetFile, Mapping[str, int]]:
    """Content of a file, and the line of each place in it.

    Raises:
        InputError: it cannot be read, or is no data sheet; all faults with line and place.
    """
    tree, lines, faults = read_yaml(path)
    content = _checked(tree, path, lines, faults)
    return content, lines


def _checked(
    tree: Any,  # noqa: ANN401  (anything can stand in a YAML file)
    path: Path,
    lines: Mapping[str, int],
    faults: Mapping[str, str],
) -> SheetFile:
    try:
        content = SheetFile.model_validate(tree)
    except ValidationError as error:
        found = {**faults, **faults_of(error, SheetFile)}
        raise InputError(str(path), describe(found, lines)) from None
    if faults:
        raise InputError(str(path), describe(faults, lines))
    return content
