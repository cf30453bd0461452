"""Source text of what was watched while a scene was built: statements with good names."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from simcompare.engine.scripting.merge import Varying
from simcompare.engine.scripting.rolling import Statement, rolled
from simcompare.engine.scripting.text import number, unused
from simcompare.engine.scripting.trace import (
    Assign,
    Attribute,
    Call,
    Event,
    Expression,
    Result,
    Root,
)


@dataclass(frozen=True)
class Helper:
    """A small function of the script that stands for a call and those on what it returned.

    Attributes:
        call: last part of the call's name.
        setters: calls on its result (or on the result of ``nested``) -> keyword of the argument
            that each becomes; empty where it is told by its place.
        name: of the function.
        lines: its source; none where the engine has it.
        receiver: whether the object that is called, and the call's own arguments, come first.
        swallowed: calls on the result that the function makes too.
        nested: one of them, on whose result setters count as well.
        order: of the setters whose arguments are told by their places, if not as they are called.
        least: uses from which on it is worth its lines.
    """

    call: str
    setters: Mapping[str, str]
    name: str
    lines: tuple[str, ...] = ()
    receiver: bool = False
    swallowed: frozenset[str] = frozenset()
    nested: str = ""
    order: tuple[str, ...] = ()
    least: int = 2


@dataclass
class Style:
    """How an engine's statements are written.

    Attributes:
        helpers: functions that stand for several calls.
        hidden: functions whose results are not written as arguments.
        tidy: last touch on the arguments of a call, by its name.
        names: last part of a call's name, or a keyword -> names of its arguments in loops.
    """

    helpers: tuple[Helper, ...] = ()
    hidden: frozenset[str] = frozenset()
    tidy: Callable[[str, list[Any], dict[str, Any]], None] = lambda *_: None
    names: Mapping[str, Sequence[str]] = field(default_factory=dict)


@dataclass
class Writer:
    """Writes a trace as statements.

    Args:
        events: what happened.
        style: how it is written.
        names: names that are wanted: place of the call, and of the member, -> name.
        taken: names that the script uses for something else.
        wanted: expressions that the rest of the script uses.
    """

    events: Sequence[Event]
    style: Style
    names: Mapping[tuple[int, int | None], str]
    taken: set[str]
    wanted: Sequence[Expression] = ()
    used_helpers: list[Helper] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._place = {id(event): i for i, event in enumerate(self.events)}
        self._folded: dict[int, tuple[Helper, list[Any], dict[str, Any]]] = {}
        self._inside: set[int] = set()
        self._fold()
        self._uses: Counter[tuple[int, int | None]] = Counter()
        self._needed: set[int] = set()
        for expression in self.wanted:
            self._need(expression, 2)
        for event in reversed(self.events):
            if not (event.idle or id(event) in self._inside or self._is_pure(event)):
                self._need_all(event)
        self._assigned: dict[tuple[int, int | None], str] = {}

    def _is_pure(self, event: Event) -> bool:
        return isinstance(event, Call) and event.pure

    def _fold(self) -> None:
        """Finds calls that helpers stand for, with what is called on their results."""
        for helper in self.style.helpers:
            made = [e for e in self.events if isinstance(e, Call) and self._is_made_by(e, helper)]
            for event in made if len(made) >= helper.least else ():
                self._fold_one(helper, event)

    def _is_made_by(self, event: Call, helper: Helper) -> bool:
        return last_name(event.target) == helper.call

    def _fold_one(self, helper: Helper, event: Call) -> None:
        placed: list[Any] = []
        if helper.receiver:
            assert isinstance(event.target, Attribute)
            placed += [event.target.owner, *event.args]
        named: dict[str, Any] = {}
        setters: list[tuple[str, Any]] = []
        owners = [event]
        for later in self.events:
            if not isinstance(later, Call) or not isinstance(later.target, Attribute):
                continue
            owner, name = later.target.owner, later.target.name
            if not isinstance(owner, Result) or owner.call not in owners:
                continue
            if name in helper.swallowed:
                self._inside.add(id(later))
            if name == helper.nested:
                owners.append(later)
            keyword = helper.setters.get(name)
            if keyword is None:
                continue
            self._inside.add(id(later))
            if not keyword:
                setters.append((name, later.args[0]))
            elif not later.idle:
                named[keyword] = later.args[0]
        setters.sort(key=lambda one: [*helper.order, one[0]].index(one[0]))
        placed += [value for _, value in setters]
        self._folded[id(event)] = helper, placed, named

    def _need_all(self, event: Event) -> None:
        if id(event) in self._needed:
            return
        self._needed.add(id(event))
        if isinstance(event, Assign):
            self._need(event.owner, 1)
            self._need(event.value, 1)
        elif id(event) in self._folded:
            _, placed, named = self._folded[id(event)]
            self._need((placed, *named.values()), 1)
        else:
            self._need(event.target, 1)
            self._need((event.args, tuple(event.kwargs.values())), 1)

    def _need(self, value: Any, times: int) -> None:  # noqa: ANN401
        if isinstance(value, Attribute):
            self._need(value.owner, times)
        elif isinstance(value, Result) and not self._is_hidden(value):
            self._uses[id(value.call), value.index] += times
            self._need_all(value.call)
        elif isinstance(value, tuple | list):
            for member in value:
                self._need(member, times)

    def lines(self) -> list[str]:
        """All statements, wrapped, and repeated ones in loops."""
        found = []
        for event in self.events:
            if id(event) not in self._needed:
                continue
            if isinstance(event, Assign):
                head = f"{self.text(event.owner)}.{event.attribute} = "
                found.append(Statement(head, self.text(event.value)))
                continue
            uses = {index: n for (i, index), n in self._uses.items() if i == id(event) and n}
            if event.pure and uses == {None: 1} and self._name_for(event, None) is None:
                continue  # written where it is used
            found.append(self._statement(event, uses))
        return rolled(found, self.style.names, set(self._assigned.values()))

    def _statement(self, event: Call, uses: Mapping[int | None, int]) -> Statement:
        call, args = self._call(event)
        head = ""
        if None in uses:
            head = f"{self._assign(event, None)} = "
        elif uses:
            last = max(index for index in uses if index is not None)
            members = [self._assign(event, i) if i in uses else "_" for i in range(last + 1)]
            # the first alone of what several are returned
            head = f"{members[0]}, *_ = " if last == 0 else f"{', '.join(members)} = "
        return Statement(head, call, tuple(args))

    def _name_for(self, event: Call, index: int | None) -> str | None:
        return self.names.get((self._place[id(event)], index))

    def _assign(self, event: Call, index: int | None) -> str:
        wanted = self._name_for(event, index) or _generic(event)
        name = unused(wanted, self.taken)
        self.taken.add(name)
        self._assigned[id(event), index] = name
        return name

    def _call(self, event: Call) -> tuple[str, list[str]]:
        """What is called, and its arguments."""
        if id(event) in self._folded:
            helper, placed, named = self._folded[id(event)]
            if helper not in self.used_helpers:
                self.used_helpers.append(helper)
            return helper.name, [
                *(self.text(value) for value in placed),
                *(f"{key}={self.text(value)}" for key, value in named.items()),
            ]
        args = [value for value in event.args if not self._is_hidden(value)]
        kwargs = dict(event.kwargs)
        self.style.tidy(last_name(event.target), args, kwargs)
        texts = [self.text(value) for value in args]
        return self.text(event.target), [
            *texts, *(f"{key}={self.text(value)}" for key, value in kwargs.items())
        ]  # fmt: skip

    def _is_hidden(self, value: Any) -> bool:  # noqa: ANN401
        return isinstance(value, Result) and last_name(value.call.target) in self.style.hidden

    def text(self, value: Any) -> str:  # noqa: ANN401
        """Source of a value."""
        match value:
            case Root():
                return value.name
            case Attribute():
                return f"{self.text(value.owner)}.{value.name}"
            case Result():
                return self._assigned.get((id(value.call), value.index)) or self._inline(value)
            case Varying():
                return f"{number(value.first)} + phase * {number(value.last - value.first)}"
            case np.ndarray():
                return self._array(value)
            case tuple() | list():
                return self._sequence(value)
            case float():
                return number(value)
            case _:
                return f'"{value}"' if isinstance(value, str) else repr(value)

    def _sequence(self, value: tuple[Any, ...] | list[Any]) -> str:
        texts = [self.text(member) for member in value]
        if len(texts) > 2 and len(set(texts)) == 1 and isinstance(value, list):
            return f"[{texts[0]}] * {len(texts)}"
        members = ", ".join(texts)
        if isinstance(value, list):
            return f"[{members}]"
        return f"({members},)" if len(value) == 1 else f"({members})"

    def _inline(self, value: Result) -> str:
        head, args = self._call(value.call)
        return f"{head}({', '.join(args)})"

    def _array(self, value: Any) -> str:  # noqa: ANN401
        if value.ndim == 1:
            return self.text(value.tolist())
        if np.array_equal(value, np.eye(len(value))):
            return f"np.eye({len(value)})"
        if np.array_equal(value, value[0, 0] * np.eye(len(value))):
            return f"{number(value[0, 0])} * np.eye({len(value)})"
        if np.array_equal(value, np.diag(np.diag(value))):
            return f"np.diag({self.text(np.diag(value).tolist())})"
        return f"np.array({self.text(value.tolist())})"


def last_name(expression: Expression) -> str:
    """The last part of a dotted name."""
    return expression.name if isinstance(expression, Attribute | Root) else ""


def _generic(event: Call) -> str:
    """A name for what a call returns: ``getConstraintSolver`` -> ``constraint_solver``."""
    name = last_name(event.target).removeprefix("get").removeprefix("create")
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower() or "found"
