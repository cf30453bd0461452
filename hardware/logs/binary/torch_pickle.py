"""Tensors in files of ``torch.save``, read without PyTorch and without executing a pickle.

A pickle is a program. Here its steps are only looked at: those that put numbers, texts, lists and
the description of a tensor together are followed; any other one is refused with its byte.
"""

from __future__ import annotations

import io
import pickletools
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import zip_guard

#: how every file of the older format begins: the pickle of a magic number
MAGIC = b"\x80\x02\x8a\x0al\xfc\x9cF\xf9 j\xa8P\x19."
_STORAGES = {
    "DoubleStorage": "<f8", "FloatStorage": "<f4", "HalfStorage": "<f2", "LongStorage": "<i8",
    "IntStorage": "<i4", "ShortStorage": "<i2", "CharStorage": "<i1", "ByteStorage": "<u1",
    "BoolStorage": "<u1",
}  # fmt: skip
_MAX_STEPS = 1_000_000
_MAX_DIMENSIONS = 8


@dataclass(frozen=True)
class _Callable:
    """Something a pickle may name; it is never called."""

    name: str


@dataclass(frozen=True)
class _Storage:
    dtype: str
    key: str
    count: int


@dataclass
class _Tensor:
    storage: _Storage
    offset: int
    shape: tuple[int, ...]
    strides: tuple[int, ...]


class _Mark:
    """Beginning of a list of arguments on the stack."""


class _Refused(Exception):
    """A step that is not followed."""


_ALLOWED = {
    "torch._utils _rebuild_tensor_v2",
    "torch._utils _rebuild_parameter",
    "collections OrderedDict",
    *(f"torch {name}" for name in _STORAGES),
}


def read(path: Path) -> dict[str, np.ndarray]:
    """All tensors of a file, by where they stand in it ("" where there is only one).

    Raises:
        InputError: a step that is not followed, or a damaged file.
    """
    try:
        with path.open("rb") as file:
            tree, storages = _zipped(path) if file.read(2) == b"PK" else _legacy(path)
        tensors = _collected(tree, storages)
    except (_Refused, ValueError, IndexError, KeyError, *zip_guard.ERRORS) as error:
        text = str(error) if isinstance(error, _Refused) else f"is damaged: {error!r}"
        raise InputError(
            str(path),
            [f"{text[:400]}; only tensors of numbers are read (save them with numpy.savez)"],
        ) from None
    if not tensors:
        raise InputError(str(path), ["holds no tensor"])
    return tensors


def _legacy(path: Path) -> tuple[object, dict[str, bytes]]:
    """Five pickles, then the numbers of each storage behind their count."""
    size = path.stat().st_size
    with path.open("rb") as file:
        for _ in range(3):  # a magic number, the version, what the machine was
            _follow(file)
        tree = _follow(file)
        keys = _follow(file)
        wanted = _storages(tree)
        data = {}
        for key in keys if isinstance(keys, list) else []:
            at = file.tell()
            count = int.from_bytes(file.read(8), "little")
            storage = wanted.get(key)
            if storage is None or storage.count != count:
                raise _Refused(f"byte {at}: the storage {key!r:.40} is described by no tensor")
            length = count * np.dtype(storage.dtype).itemsize
            if length > size - at - 8:
                missing = length - (size - at - 8)
                raise _Refused(f"byte {at}: {missing} bytes of the numbers are missing")
            data[key] = file.read(length)
    return tree, data


def _zipped(path: Path) -> tuple[object, dict[str, bytes]]:
    """One pickle ``data.pkl`` and a member for each storage."""
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        main = next((name for name in names if name.endswith("data.pkl")), None)
        if main is None:
            raise _Refused("has no data.pkl")
        size = path.stat().st_size
        tree = _follow(io.BytesIO(zip_guard.member(archive, main, size)))
        wanted = _storages(tree)
        root = main.removesuffix("data.pkl")
        return tree, {key: zip_guard.member(archive, f"{root}data/{key}", size) for key in wanted}


def _storages(tree: object) -> dict[str, _Storage]:
    """The storage of every tensor, by its key."""
    return {leaf.storage.key: leaf.storage for _, leaf in _tensors(tree)}


def _collected(tree: object, storages: dict[str, bytes]) -> dict[str, np.ndarray]:
    return {name: _array(leaf, storages) for name, leaf in _tensors(tree)}


def _tensors(tree: object) -> Iterator[tuple[str, _Tensor]]:
    """Every tensor and where it stands; lists that hold each other may repeat without end."""
    for steps, (name, leaf) in enumerate(_walk(tree, "", 0)):
        if steps > _MAX_STEPS:
            raise _Refused("repeats its parts more than a million times")
        if isinstance(leaf, _Tensor):
            yield name, leaf


def _walk(tree: object, name: str, depth: int) -> Iterator[tuple[str, object]]:
    yield name, tree
    if depth == _MAX_DIMENSIONS or not isinstance(tree, dict | list | tuple):
        return
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, item in items:
        yield from _walk(item, f"{name}.{key}".strip("."), depth + 1)


def _array(tensor: _Tensor, storages: dict[str, bytes]) -> np.ndarray:
    """A copy of a tensor; its shape must lie within its storage."""
    data = np.frombuffer(storages[tensor.storage.key], tensor.storage.dtype)
    ends = [(n - 1) * step for n, step in zip(tensor.shape, tensor.strides, strict=True)]
    numbers = (*tensor.shape, *tensor.strides, tensor.offset)
    if len(tensor.shape) > _MAX_DIMENSIONS or any(n < 0 for n in numbers):
        raise _Refused(f"a tensor has the shape {tensor.shape} and the strides {tensor.strides}")
    empty = 0 in tensor.shape
    size = 1
    for n in tensor.shape:
        size *= n
    if not empty and (tensor.offset + sum(ends) >= len(data) or size > len(data)):
        raise _Refused(f"a tensor of the shape {tensor.shape} does not fit {len(data)} numbers")
    strides = [step * data.itemsize for step in tensor.strides]
    view = np.lib.stride_tricks.as_strided(data[tensor.offset :], tensor.shape, strides)
    return np.array(view)


@dataclass
class _Machine:
    """The stack on which a pickle puts its parts; none of them is ever called."""

    stack: list[Any] = field(default_factory=list)
    memo: dict[int, Any] = field(default_factory=dict)

    def since_mark(self) -> list[Any]:
        """Everything above the last mark; the mark goes too."""
        for i in range(len(self.stack) - 1, -1, -1):
            if isinstance(self.stack[i], _Mark):
                items = self.stack[i + 1 :]
                del self.stack[i:]
                return items
        raise _Refused("a list has no beginning")

    def pop(self, count: int) -> list[Any]:
        """The last items."""
        if len(self.stack) < count:
            raise _Refused("the stack of the pickle is empty")
        items = self.stack[len(self.stack) - count :]
        del self.stack[len(self.stack) - count :]
        return items


def _follow(file: BinaryIO) -> object:
    """What one pickle describes."""
    start = file.tell()
    machine = _Machine()
    try:
        for steps, (opcode, argument, position) in enumerate(pickletools.genops(file)):
            if steps > _MAX_STEPS:
                raise _Refused("has more than a million steps")
            if opcode.name == "STOP":
                return machine.pop(1)[0]
            step = _STEPS.get(opcode.name)
            if step is None:
                raise _Refused(
                    f"byte {position}: the pickle wants {opcode.name}, which is not followed"
                )
            try:
                step(machine, argument)
            except _Refused as reason:
                raise _Refused(f"byte {position}, {opcode.name}: {reason}") from None
    except (ValueError, UnicodeDecodeError, OverflowError) as error:
        raise _Refused(f"the pickle from byte {start} on is damaged: {error}") from None
    raise _Refused(f"the pickle from byte {start} on has no end")


def _global(machine: _Machine, name: str) -> None:
    if name not in _ALLOWED:
        raise _Refused(f"it names {name.replace(' ', '.')!r:.120}")
    machine.stack.append(_Callable(name))


def _reduce(machine: _Machine, _: object) -> None:
    """What a call would make, for the few that make data."""
    called, arguments = machine.pop(2)
    name = called.name if isinstance(called, _Callable) else ""
    if name == "collections OrderedDict" and arguments == ():
        machine.stack.append({})
    elif name == "torch._utils _rebuild_tensor_v2" and _describes(arguments):
        machine.stack.append(_Tensor(*arguments[:4]))
    elif (
        name == "torch._utils _rebuild_parameter"
        and arguments
        and isinstance(arguments[0], _Tensor)
    ):
        machine.stack.append(arguments[0])
    else:
        raise _Refused(f"it calls {name.replace(' ', '.') or 'something unknown'!r}")


def _describes(arguments: object) -> bool:
    """Whether arguments are storage, offset, shape, strides of a tensor."""
    return (
        isinstance(arguments, tuple)
        and len(arguments) >= 4
        and isinstance(arguments[0], _Storage)
        and isinstance(arguments[1], int)
        and all(
            isinstance(numbers, tuple) and all(isinstance(n, int) for n in numbers)
            for numbers in arguments[2:4]
        )
        and len(arguments[2]) == len(arguments[3])
    )


def _persistent(machine: _Machine, _: object) -> None:
    """A storage: ('storage', type, key, place, count, …)."""
    description = machine.pop(1)[0]
    usual = (
        isinstance(description, tuple)
        and len(description) >= 5
        and description[0] == "storage"
        and isinstance(description[1], _Callable)
        and description[1].name.removeprefix("torch ") in _STORAGES
        and isinstance(description[2], str)
        and isinstance(description[4], int)
        and (len(description) == 5 or description[5] is None)
    )
    if not usual:
        raise _Refused("it wants a storage of an unknown kind")
    machine.stack.append(
        _Storage(
            _STORAGES[description[1].name.removeprefix("torch ")], description[2], description[4]
        )
    )


def _tuple(count: int) -> Callable[[_Machine, Any], None]:
    def step(machine: _Machine, _: object) -> None:
        machine.stack.append(tuple(machine.pop(count)))

    return step


def _push(machine: _Machine, value: object) -> None:
    machine.stack.append(value)


def _new(make: Callable[[], Any]) -> Callable[[_Machine, Any], None]:
    def step(machine: _Machine, _: object) -> None:
        machine.stack.append(make())

    return step


def _put(machine: _Machine, argument: int | None) -> None:
    machine.memo[len(machine.memo) if argument is None else argument] = machine.stack[-1]


def _get(machine: _Machine, argument: object) -> None:
    if argument not in machine.memo:
        raise _Refused("it repeats what was never there")
    machine.stack.append(machine.memo[argument])


def _append(machine: _Machine, items: list[Any]) -> None:
    if not machine.stack or not isinstance(machine.stack[-1], list):
        raise _Refused("it appends to what is no list")
    machine.stack[-1].extend(items)


def _set(machine: _Machine, items: list[Any]) -> None:
    if not machine.stack or not isinstance(machine.stack[-1], dict) or len(items) % 2:
        raise _Refused("it sets an item of what is no dict")
    for key, value in zip(items[::2], items[1::2], strict=True):
        if not isinstance(key, (str, int)):
            raise _Refused("it uses a key that is no text")
        machine.stack[-1][key] = value


def _named(machine: _Machine, _: object) -> None:
    module, name = machine.pop(2)
    _global(machine, f"{module} {name}")


_STEPS: dict[str, Callable[[_Machine, Any], None]] = {
    "PROTO": lambda machine, _: None,
    "FRAME": lambda machine, _: None,
    **dict.fromkeys(
        ("LONG1", "BININT", "BININT1", "BININT2", "INT", "LONG", "BINUNICODE", "SHORT_BINUNICODE",
         "UNICODE", "BINFLOAT", "FLOAT"), _push,
    ),
    "NONE": _new(lambda: None), "NEWTRUE": _new(lambda: True), "NEWFALSE": _new(lambda: False),
    "EMPTY_TUPLE": _new(tuple), "EMPTY_LIST": _new(list), "EMPTY_DICT": _new(dict),
    "MARK": _new(_Mark),
    "TUPLE": lambda machine, _: machine.stack.append(tuple(machine.since_mark())),
    "TUPLE1": _tuple(1), "TUPLE2": _tuple(2), "TUPLE3": _tuple(3),
    "BINPUT": _put, "LONG_BINPUT": _put, "PUT": _put, "MEMOIZE": _put,
    "BINGET": _get, "LONG_BINGET": _get, "GET": _get,
    "APPEND": lambda machine, _: _append(machine, machine.pop(1)),
    "APPENDS": lambda machine, _: _append(machine, machine.since_mark()),
    "SETITEM": lambda machine, _: _set(machine, machine.pop(2)),
    "SETITEMS": lambda machine, _: _set(machine, machine.since_mark()),
    "GLOBAL": _global, "STACK_GLOBAL": _named, "REDUCE": _reduce, "BINPERSID": _persistent,
}  # fmt: skip
