"""The mapping file: what a log cannot say of itself, in a few lines of YAML.

    time: {column: t, unit: ms}
    channels:
      angle: {column: "encoder", unit: deg, sign: -1, offset: 180, u: 0.05, frame: joint}
      torque: {column: tau, unit: N*m}

Values become sign·scale·raw + offset in ``unit``, and then SI. Columns that are not named keep what
the log says of them.
"""

from __future__ import annotations

from collections.abc import Mapping as MappingOf
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    PositiveFloat,
    ValidationError,
    field_validator,
    model_validator,
)

from simcompare.errors import InputError
from simcompare.hardware.conditioning.drive import Drive
from simcompare.model.estimate_plan import RecordedPlan
from simcompare.model.frozen import Frozen
from simcompare.model.yaml_file import describe, faults_of, read_yaml

#: kinds of joints: what turns, and what slides
REVOLUTE, PRISMATIC = "revolute", "prismatic"
#: what stands in a template where the user must write
UNKNOWN = "?"


#: a unit; the number 1 is that of plain numbers
_Unit = Annotated[str, BeforeValidator(lambda unit: "1" if unit == 1 else unit)]


class _Column(Frozen):
    """A column and its unit, which a template leaves open where the log does not say."""

    @model_validator(mode="after")
    def _filled_in(self) -> Self:
        empty = [name for name in ("column", "unit") if getattr(self, name, None) == UNKNOWN]
        if empty:
            raise ValueError(
                f"{' and '.join(empty)} is still ?; replace the ? (the unit of a plain number is 1)"
                " or delete the line"
            )
        return self


class TimeMap(_Column):
    """Which column is the time, or the rate where there is none.

    Attributes:
        column: name of the column; several where streams call it differently.
        unit: its unit.
        rate_Hz: samples in a second, for logs without times.
    """

    column: str | Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    unit: _Unit | None = None
    rate_Hz: PositiveFloat | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> TimeMap:
        if (self.column is None) == (self.rate_Hz is None):
            raise ValueError("give either column (with its unit) or rate_Hz")
        return self

    @property
    def columns(self) -> tuple[str, ...]:
        """Every name that the column may have; none where the rate is given."""
        return (self.column,) if isinstance(self.column, str) else self.column or ()


class ChannelMap(_Column):
    """How one column becomes a channel.

    Attributes:
        column: name in the log, without its unit; "stream/column" for one stream only; several
            where the same quantity has different names in different streams.
        unit: unit of the raw values, or of scale·raw where a scale is given.
        scale: factor from raw to ``unit`` (such as LSB to volt).
        offset: added after scale and sign [unit].
        sign: -1 where the log counts the other way.
        u: standard uncertainty [unit].
        frame: frame of a component.
        kind: "specific_force" or "gravity_removed", for accelerations.
        sensor: what measured it.
        limits: smallest and largest raw value that the sensor can give.
        wraps: number of raw counts after which a counter begins again.
        sentinels: raw values that mean "nothing was measured".
    """

    column: str | Annotated[tuple[str, ...], Field(min_length=1)]
    unit: _Unit
    scale: float = 1.0
    offset: float = 0.0
    sign: Literal[-1, 1] = 1
    u: PositiveFloat | None = None
    frame: str = ""
    kind: Literal["", "specific_force", "gravity_removed"] = ""
    sensor: str = ""
    limits: tuple[float, float] | None = None
    wraps: PositiveFloat | None = None
    sentinels: tuple[float, ...] = ()

    @property
    def columns(self) -> tuple[str, ...]:
        """Every name that the column may have."""
        return (self.column,) if isinstance(self.column, str) else self.column


class Mapping(Frozen):
    """A whole mapping file.

    Attributes:
        format: importer that reads the log, where its content is not enough.
        time: clock of all streams.
        channels: name of the channel (its unit's suffix is added) -> column.
        streams: the streams that are wanted; all where empty.
        about: what is known of the device, for the record.
        up: axis of the accelerometer that points up while the device is at rest ("+z").
        wheel_diameter_m: of the wheel whose speed and turning rate are both in the log [m].
        joints: whether joints, whose unit that decides, turn ("revolute") or slide ("prismatic");
            one word for all of them, or name -> kind.
        derive: channels that follow from others: name of a new stream -> function and its needs.
        drive: the wheels of a robot and where it was, to be held against each other.
        validate: how a scenario is held against the recording.
        estimate: how estimators are used on the recording.
    """

    format: str | None = None
    time: TimeMap | None = None
    channels: MappingOf[Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")], ChannelMap] = Field(
        default_factory=dict
    )
    streams: tuple[str, ...] = ()
    about: MappingOf[str, str] = Field(default_factory=dict)
    up: Literal["+x", "-x", "+y", "-y", "+z", "-z"] | None = None
    wheel_diameter_m: PositiveFloat | None = None
    joints: str | MappingOf[str, str] | None = None
    derive: MappingOf[str, Any] = Field(default_factory=dict)
    drive: Drive | None = None
    validate_: Any = Field(None, alias="validate")
    estimate: tuple[RecordedPlan, ...] = ()

    @field_validator("joints", mode="before")
    @classmethod
    def _kinds_of_joints(cls, given: object) -> object:
        kinds = [*given.values()] if isinstance(given, dict) else [given]
        wrong = [kind for kind in kinds if kind not in (REVOLUTE, PRISMATIC)]
        if wrong and given is not None:
            raise ValueError(
                f"expected {REVOLUTE} or {PRISMATIC} for all joints, or name: {REVOLUTE} for each;"
                f" found {', '.join(map(str, wrong))}"
            )
        return {str(k): v for k, v in given.items()} if isinstance(given, dict) else given

    def of_column(self, stream: str, column: str) -> list[tuple[str, ChannelMap]]:
        """Channels that are made of a column of a stream, with their names."""
        return [
            (name, channel)
            for name, channel in self.channels.items()
            if {*channel.columns} & {column, f"{stream}/{column}"}
        ]


#: a mapping that says nothing
NOTHING = Mapping.model_validate({})


def read(path: Path) -> Mapping:
    """Reads a mapping file.

    Raises:
        InputError: unreadable, not YAML, or with faults; all of them are named with their lines.
    """
    tree, lines, faults = read_yaml(path)
    if not isinstance(tree, dict):
        raise InputError(str(path), ["is not a mapping; expected keys such as time, channels"])
    return of_tree(tree, str(path), lines, faults)


def of_tree(
    tree: MappingOf[str, Any],
    where: str,
    lines: MappingOf[str, int] | None = None,
    faults: MappingOf[str, str] | None = None,
) -> Mapping:
    """The mapping in a parsed file.

    Raises:
        InputError: all faults at once.
    """
    all_faults: dict[str, str] = dict(faults or {})
    try:
        mapping = Mapping.model_validate(tree)
    except ValidationError as error:
        raise InputError(
            where, describe({**all_faults, **faults_of(error, Mapping)}, lines or {})
        ) from None
    if all_faults:
        raise InputError(where, describe(all_faults, lines or {}))
    return mapping
