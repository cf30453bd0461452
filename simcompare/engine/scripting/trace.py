"""Watches how a scene is built in an engine: the calls and assignments that change something.

A :class:`Recorder` stands in for the engine's module. What is called through it is called for real,
and noted as an expression, so that the same calls can be written as source afterwards. Nothing here
knows an engine: what its getters and plain values are called is told by a :class:`Dialect`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Dialect:
    """What has to be known of an engine to read its calls.

    Attributes:
        name: what its module is called in the source.
        values: types of its own that are plain values to everybody, such as vectors.
        pure: names of functions that change nothing, besides those that begin with ``get``.
        idle: whether an assignment or a call leaves everything as it was; called before it with
            the object, the name and the arguments.
        dropped: keyword arguments that are not written.
    """

    name: str
    values: tuple[type, ...] = ()
    pure: frozenset[str] = frozenset()
    idle: Callable[[Any, str, tuple[Any, ...]], bool] = lambda *_: False
    dropped: frozenset[str] = frozenset()


@dataclass(eq=False)
class Call:
    """One call.

    Attributes:
        target: the expression that is called.
        args: arguments, expressions in place of the engine's objects.
        kwargs: likewise.
        pure: whether it is of interest only for what it returns.
        idle: whether it changed nothing.
    """

    target: Expression
    args: tuple[Any, ...]
    kwargs: Mapping[str, Any]
    pure: bool
    idle: bool = False


@dataclass(eq=False)
class Assign:
    """An attribute that is set; ``idle`` where it had that value before."""

    owner: Expression
    attribute: str
    value: Any
    idle: bool


@dataclass(eq=False)
class Root:
    """The engine's module."""

    name: str


@dataclass(eq=False)
class Attribute:
    """A part of something."""

    owner: Expression
    name: str


@dataclass(eq=False)
class Result:
    """What a call returned, or one member of it."""

    call: Call
    index: int | None = None


Expression = Root | Attribute | Result
Event = Call | Assign


class Named(int):
    """An integer that remembers where it came from: a constant, or the number of a body."""

    expression: Expression


class Watched:
    """An object of the engine, or one of its functions; everything goes on to the real one."""

    def __init__(self, recorder: Recorder, real: Any, expression: Expression) -> None:  # noqa: ANN401
        object.__setattr__(self, "_watch", (recorder, real, expression))

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        recorder, real, expression = self._watch
        return recorder.wrap(getattr(real, name), Attribute(expression, name))

    def __setattr__(self, name: str, value: Any) -> None:  # noqa: ANN401
        recorder, real, expression = self._watch
        recorder.assign(real, expression, name, value)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:  # noqa: ANN401, D102
        recorder, real, expression = self._watch
        return recorder.call(real, expression, args, kwargs)

    def __eq__(self, other: object) -> bool:
        return bool(self._watch[1] == real_of(other))

    def __hash__(self) -> int:
        return hash(self._watch[1])

    def __len__(self) -> int:
        return len(self._watch[1])

    def __iter__(self) -> Any:  # noqa: ANN401
        recorder, real, expression = self._watch
        return iter([recorder.wrap(member, expression) for member in real])


@dataclass
class Recorder:
    """Notes all calls, in order.

    Attributes:
        dialect: what is known of the engine.
        events: what happened.
    """

    dialect: Dialect
    events: list[Event] = field(default_factory=list)
    _known: dict[int, Watched] = field(default_factory=dict)

    def engine(self, module: ModuleType) -> Any:  # noqa: ANN401
        """What stands in for the engine's module."""
        return Watched(self, module, Root(self.dialect.name))

    def wrap(self, value: Any, expression: Expression) -> Any:  # noqa: ANN401
        """A value as the caller may have it: plain, or watched."""
        if isinstance(value, Watched | bool) or value is None:
            return value
        if isinstance(value, int):
            named = Named(value)
            named.expression = expression
            return named
        if self._is_plain(value):
            return value
        if type(value) in (tuple, list, set):
            if isinstance(expression, Result) and type(value) is tuple:
                members = [self.wrap(v, Result(expression.call, i)) for i, v in enumerate(value)]
                return tuple(members)
            return type(value)(self.wrap(member, expression) for member in value)
        if callable(value) and not isinstance(value, type):
            return Watched(self, value, expression)
        if id(value) not in self._known:
            # named as what it is, for those who ask for the kind of a thing
            kind = type(type(value).__name__, (Watched,), {})
            self._known[id(value)] = kind(self, value, expression)
        return self._known[id(value)]

    def _is_plain(self, value: Any) -> bool:  # noqa: ANN401
        known = (float, str, bytes, np.ndarray, np.generic, *self.dialect.values)
        if isinstance(value, known):
            return True
        if type(value) in (tuple, list, set):
            return all(isinstance(v, bool) or v is None or self._is_number(v) for v in value)
        return isinstance(value, dict)

    def _is_number(self, value: Any) -> bool:  # noqa: ANN401
        return isinstance(value, int) or self._is_plain(value)

    def call(
        self,
        real: Any,  # noqa: ANN401
        target: Expression,
        args: tuple[Any, ...],
        kwargs: Mapping[str, Any],
    ) -> Any:  # noqa: ANN401
        """Calls and notes it."""
        name = target.name if isinstance(target, Attribute) else ""
        pure = isinstance(real, type) or name.startswith("get") or name in self.dialect.pure
        plain = tuple(real_of(value) for value in args)
        owner = getattr(real, "__self__", None)  # of a function: its module
        idle = not pure and self.dialect.idle(owner, name, plain)
        noted = {k: noted_of(v) for k, v in kwargs.items() if k not in self.dialect.dropped}
        event = Call(target, tuple(noted_of(value) for value in args), noted, pure, idle)
        self.events.append(event)
        found = real(*plain, **{key: real_of(value) for key, value in kwargs.items()})
        if isinstance(real, type) and not isinstance(found, self.dialect.values):
            return (
                Watched(self, found, Result(event))
                if self._is_plain(found)
                else self.wrap(found, Result(event))
            )
        return self.wrap(found, Result(event))

    def assign(self, real: Any, owner: Expression, name: str, value: Any) -> None:  # noqa: ANN401
        """Sets an attribute and notes it."""
        idle = self.dialect.idle(real, name, (real_of(value),))
        self.events.append(Assign(owner, name, noted_of(value), idle))
        setattr(real, name, real_of(value))


def real_of(value: Any) -> Any:  # noqa: ANN401
    """What the engine is to be given for a value that may be watched."""
    if isinstance(value, Watched):
        return value._watch[1]
    if type(value) in (tuple, list):
        return type(value)(real_of(member) for member in value)
    return value


def noted_of(value: Any) -> Any:  # noqa: ANN401
    """A value with expressions in place of what is watched, which nobody changes any more."""
    if isinstance(value, Watched):
        return value._watch[2]
    if isinstance(value, Named):
        return value.expression
    if type(value) in (tuple, list):
        return type(value)(noted_of(member) for member in value)
    return value.copy() if isinstance(value, np.ndarray) else value


def expression_of(value: Any) -> Expression:  # noqa: ANN401
    """The expression of something that was watched."""
    found = noted_of(value)
    assert isinstance(found, Root | Attribute | Result), "it was not watched"
    return found
