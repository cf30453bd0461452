"""Goes through one ROS message by the definition of its type, and works out its layout."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from simcompare.hardware.logs.bags.layout import MAX_COLUMNS, Layout, Misfit, Number, TooMuch
from simcompare.hardware.logs.bags.types import (
    ARRAY,
    BASE,
    COVARIANCES,
    IN_CHILD_FRAME,
    JOINT_STATE,
    LENGTHS,
    NAME,
    OUT_OF_RANGE,
    VARIANCES,
    Types,
    unit_of,
)

_MAX_DEPTH = 12
_TIME, _DURATION = "builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"
_DTYPES = {
    "bool": "u1", "byte": "u1", "char": "u1", "octet": "u1", "int8": "i1", "uint8": "u1",
    "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8",
    "float32": "f4", "float64": "f8",
}  # fmt: skip
_POINT_DTYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}


def layout_of(types: Types, kind: str, data: bytes, encoding: str) -> Layout:
    """Works out where the numbers of a message stand.

    Raises:
        Misfit: the message is not of this type.
        TooMuch: it holds more than can become columns.
    """
    walk = _Walk(types, data, encoding)
    walk.struct(kind, "", "", False, 0)
    walk.end()
    if kind == "sensor_msgs/msg/PointCloud2":
        _cloud(walk)
    elif kind == JOINT_STATE:
        _joints(walk)
    walk.layout.seal(data)
    return walk.layout


@dataclass(frozen=True)
class _Field:
    """A field of a message while it is gone through.

    Attributes:
        owner: type that it is a field of.
        name: its name there.
        path: its full name in the message.
        unit: of all that is in it.
        child: whether it is given in ``child_frame_id``.
        depth: types around it.
    """

    owner: str
    name: str
    path: str
    unit: str
    child: bool
    depth: int

    @property
    def beside(self) -> str:
        """How the names of its neighbours begin."""
        return self.path.removesuffix(self.name)

    @property
    def infinite(self) -> bool:
        """Whether ±infinity means "out of range" in it."""
        return (self.owner, self.name) in OUT_OF_RANGE


class _Walk:
    """Goes through one message, field by field."""

    def __init__(self, types: Types, data: bytes, encoding: str) -> None:
        self.types, self.data, self.layout = types, data, Layout()
        self.aligned = encoding == "cdr"
        self.at = self.base = 0
        if self.aligned:
            if data[:2] not in (b"\0\0", b"\0\1"):
                raise Misfit(f"begins with {data[:2].hex()}, which is no plain CDR")
            self.layout.order = "<" if data[1] else ">"
            self.at = self.base = 4
            self.layout.guards.append((0, 2))
        #: path -> (byte, dtype, length) of every array that is long or of a length that may change
        self.arrays: dict[str, tuple[int, str, int]] = {}
        self.names: dict[str, list[str]] = {}

    def end(self) -> None:
        """Checks that the whole message was understood."""
        rest = len(self.data) - self.at
        if rest < 0 or rest > (3 if self.aligned else 0):
            raise Misfit(f"has {len(self.data)} bytes; its definition has {self.at}")

    def struct(self, kind: str, path: str, unit: str, child: bool, depth: int) -> None:
        """All fields of a type."""
        if kind in (_TIME, _DURATION):
            self._time(kind, path)
            return
        if kind not in self.types or depth > _MAX_DEPTH:
            raise Misfit(f"is of the type {kind}, which is not defined or too deep")
        for name, description in self.types[kind]:
            if name == "structure_needs_at_least_one_member":
                self._take(1, 1)
                continue
            full = f"{path}.{name}" if path else name
            inside = child or (kind, name) in IN_CHILD_FRAME
            part = _Field(kind, name, full, unit_of(kind, name, unit), inside, depth)
            self._field(part, *description)

    def _field(self, field: _Field, form: int, what: Any) -> None:  # noqa: ANN401  (as rosbags describes it)
        if form == NAME:
            self.struct(what, field.path, field.unit, field.child, field.depth + 1)
        elif form == BASE:
            self._single(field, what[0])
        else:
            (inner, element), count = what
            fixed = form == ARRAY
            if not fixed:
                count = self._count()
            if inner == NAME:
                self._structs(field, element, count)
            elif element[0] in ("string", "wstring"):
                self.names[field.path] = [self._text() for _ in range(self._limited(count))]
            else:
                self._array(field, element[0], count, fixed)

    def _single(self, field: _Field, base: str) -> None:
        if base == "string":
            self.layout.texts[field.path] = self._text()
            return
        dtype = self._dtype(base, field.path)
        at = self._take(np.dtype(dtype).itemsize, np.dtype(dtype).itemsize)
        of = VARIANCES.get((field.owner, field.name), "")
        unit = "1" if base == "bool" and not field.unit else field.unit
        of = field.beside + of if of else ""
        self.layout.numbers.append(
            Number(field.path, at, dtype, unit, field.child, field.infinite, of)
        )

    def _array(self, field: _Field, base: str, count: int, fixed: bool) -> None:
        path = field.path
        dtype = self._dtype(base, path)
        size = np.dtype(dtype).itemsize
        at = self._take(size * count, size) if count or fixed else self.at
        if (field.owner, field.name) in COVARIANCES:
            self._covariance(field, at, dtype)
            return
        self.arrays[path] = (at, dtype, count)
        if count > MAX_COLUMNS:
            self.layout.skipped[path] = f"has {count} elements; at most {MAX_COLUMNS} are read"
            return
        self.layout.numbers += [
            Number(f"{path}.{i}", at + i * size, dtype, field.unit, field.child, field.infinite)
            for i in range(count)
        ]

    def _covariance(self, field: _Field, at: int, dtype: str) -> None:
        """Only the diagonal becomes columns, as the variance of what it belongs to."""
        path, parts = field.path, COVARIANCES[field.owner, field.name]
        side, size = 3 * len(parts), np.dtype(dtype).itemsize
        for i in range(side):
            of = f"{field.beside}{parts[i // 3]}"
            # a quaternion has four components, so its three variances stay together
            target = of if of.endswith("orientation") else f"{of}.{'xyz'[i % 3]}"
            self.layout.numbers.append(
                Number(f"{path}.{i}", at + i * (side + 1) * size, dtype, of=target)
            )
        cells = at + np.arange(side * side * size).reshape(-1, size)
        self.layout.off_diagonal[path] = cells[np.arange(side * side) % (side + 1) != 0].ravel()

    def _structs(self, field: _Field, kind: str, count: int) -> None:
        """Elements are gone through to find their end; only those of fixed types become columns."""
        before = len(self.layout.numbers)
        for i in range(self._limited(count)):
            self.struct(kind, f"{field.path}.{i}", field.unit, field.child, field.depth + 1)
        if field.path != "fields" and count:
            del self.layout.numbers[before:]
            self.layout.skipped[field.path] = f"is a list of {kind}"

    def _time(self, kind: str, path: str) -> None:
        at = self._take(8, 4)
        if path == "header.stamp":
            self.layout.stamp = at
            return
        seconds = f"{self.layout.order}{'i4' if self.aligned or kind == _DURATION else 'u4'}"
        split = "time" if kind == _TIME else "duration"
        self.layout.numbers.append(Number(path, at, seconds, "s", split=split))

    def _limited(self, count: int) -> int:
        if count > 4 * MAX_COLUMNS:
            raise TooMuch(f"has a list of {count} elements")
        return count

    def _count(self) -> int:
        at = self._take(4, 4)
        self.layout.guards.append((at, at + 4))
        return int.from_bytes(
            self.data[at : at + 4], "little" if self.layout.order == "<" else "big"
        )

    def _text(self) -> str:
        size = self._count()
        at = self._take(size, 1)
        self.layout.guards.append((at, at + size))
        return self.data[at : at + size].rstrip(b"\0").decode("utf-8", "replace")

    def _dtype(self, base: str, path: str) -> str:
        if base not in _DTYPES:
            raise Misfit(f"has the field {path} of the type {base}, which cannot be read")
        return f"{self.layout.order}{_DTYPES[base]}"

    def _take(self, size: int, alignment: int) -> int:
        """Byte of the next piece of that size."""
        if self.aligned:
            self.at += -(self.at - self.base) % alignment
        at = self.at
        self.at += size
        if self.at > len(self.data):
            raise Misfit(f"has {len(self.data)} bytes; its definition needs {self.at} or more")
        return at


def _cloud(walk: _Walk) -> None:
    """Columns ``z[row,column]`` of a small cloud; everything but the points must stay the same."""
    layout = walk.layout
    values = {n.name: n for n in layout.numbers}
    order = ">" if int(_value(walk, values["is_bigendian"])) else "<"
    height, width = (int(_value(walk, values[name])) for name in ("height", "width"))
    step, row_step = (int(_value(walk, values[name])) for name in ("point_step", "row_step"))
    start, _, size = walk.arrays["data"]
    if height * width > MAX_COLUMNS:
        raise TooMuch(f"is a cloud of {height}×{width} points; at most {MAX_COLUMNS} are read")
    kept = [number for number in layout.numbers if number.name.startswith("header.")]
    for number in layout.numbers:
        if not number.name.startswith(("data.", "header.")):
            layout.guards.append((number.at, number.at + np.dtype(number.dtype).itemsize))
    fields = [path.removesuffix(".name") for path in layout.texts if path.endswith(".name")]
    points = []
    for path in fields:
        name = layout.texts[f"{path}.name"]
        kind = int(_value(walk, values[f"{path}.datatype"]))
        if kind not in _POINT_DTYPES:
            raise Misfit(f"has the field {name} of the unknown datatype {kind}")
        dtype = order + _POINT_DTYPES[kind]
        offset = int(_value(walk, values[f"{path}.offset"]))
        unit = "m" if name in LENGTHS else "1" if name == "intensity" else ""
        for row in range(height):
            for column in range(width):
                at = row * row_step + column * step + offset
                if at + np.dtype(dtype).itemsize > size:
                    raise Misfit(f"has {size} bytes of points; {name}[{row},{column}] is beyond")
                points.append(Number(f"{name}[{row},{column}]", start + at, dtype, unit))
    layout.numbers = kept + points
    layout.skipped.pop("data", None)
    layout.texts = {path: text for path, text in layout.texts.items() if path.startswith("header")}


def _value(walk: _Walk, number: Number) -> float:
    return float(np.frombuffer(walk.data, number.dtype, 1, number.at)[0])


def _joints(walk: _Walk) -> None:
    """Columns ``joint.position`` and so on, by the names in the message, whatever their order."""
    layout = walk.layout
    names = walk.names.get("name", [])
    if len(set(names)) < len(names):
        raise Misfit("names a joint twice")
    kept = [n for n in layout.numbers if n.name.partition(".")[0] not in walk.arrays]
    for field_name in ("position", "velocity", "effort"):
        at, dtype, count = walk.arrays.get(field_name, (0, "<f8", 0))
        if count not in (0, len(names)):
            raise Misfit(f"has {len(names)} names and {count} values of {field_name}")
        size = np.dtype(dtype).itemsize
        kept += [
            Number(f"{name}.{field_name}", at + i * size, dtype)
            for i, name in enumerate(names[:count])
        ]
    layout.numbers = kept
    layout.skipped.clear()
