"""Calls that repeat with other numbers become a loop over a small table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from simcompare.engine.scripting.text import called, filled, unused

#: most calls that one loop repeats
_MAX_LENGTH = 5
#: lines that a loop must save
_WORTH = 2


@dataclass(frozen=True)
class Statement:
    """One statement of a script.

    Attributes:
        head: what its value is given to, with the sign of equality; empty for a plain call.
        call: what is called, or the value.
        args: source of the arguments; none where nothing is called.
    """

    head: str
    call: str
    args: tuple[str, ...] | None = None

    @property
    def text(self) -> str:
        """Its source."""
        return self.head + (self.call if self.args is None else called(self.call, self.args))

    @property
    def kind(self) -> tuple[str, ...] | None:
        """What must be alike in all rounds of a loop; ``None`` where it cannot be in one."""
        if self.head or self.args is None:
            return None
        return (self.call, *(arg.partition("=")[0] if _named(arg) else "" for arg in self.args))


def rolled(
    statements: Sequence[Statement], names: Mapping[str, Sequence[str]], taken: set[str]
) -> list[str]:
    """Source of statements, repeated ones in loops.

    Args:
        statements: all of them, in order.
        names: last part of a call's name -> names of its arguments; of those that have keywords
            the keyword.
        taken: names that a loop must not use.
    """
    lines: list[str] = []
    at = 0
    while at < len(statements):
        found = [
            (saved, loop, count)
            for length in range(1, _MAX_LENGTH + 1)
            for saved, loop, count in _tried(statements, at, length, names, taken)
        ]
        saved, loop, count = max(found, key=lambda one: one[0], default=(0, [], 0))
        if saved >= _WORTH:
            lines += loop
            at += count
        else:
            lines.append(statements[at].text)
            at += 1
    return lines


def _tried(
    statements: Sequence[Statement],
    at: int,
    length: int,
    names: Mapping[str, Sequence[str]],
    taken: set[str],
) -> list[tuple[int, list[str], int]]:
    """The loop over blocks of a length, if there is one: lines saved, its lines, statements."""
    first = [one.kind for one in statements[at : at + length]]
    if None in first or len(first) < length:
        return []
    rounds = [statements[at : at + length]]
    while [one.kind for one in _next(statements, at, len(rounds), length)] == first:
        rounds.append(_next(statements, at, len(rounds), length))
    if len(rounds) == 1 or all(part == rounds[0] for part in rounds):
        return []
    loop = _loop(rounds, names, taken)
    saved = _count([one.text for part in rounds for one in part]) - _count(loop)
    if saved == 1 and len(rounds) > length + 1:
        saved = _WORTH  # a small one
    return [(saved, loop, length * len(rounds))] if loop else []


def _count(lines: Sequence[str]) -> int:
    """Lines that these take in the end."""
    return sum(len(filled(line.lstrip(), indent="    ")) for line in lines)


def _next(statements: Sequence[Statement], at: int, done: int, length: int) -> Sequence[Statement]:
    return statements[at + done * length : at + (done + 1) * length]


def _loop(
    rounds: Sequence[Sequence[Statement]], names: Mapping[str, Sequence[str]], taken: set[str]
) -> list[str]:
    """The loop; nothing where one name would stand for two things."""
    columns: dict[str, tuple[str, ...]] = {}
    body = []
    for i, statement in enumerate(rounds[0]):
        args = []
        placed = names.get(statement.call.rpartition(".")[2], ())
        for j, arg in enumerate(statement.args or ()):
            texts = tuple((part[i].args or ())[j] for part in rounds)
            if len(set(texts)) == 1:
                args.append(arg)
                continue
            keyword = arg.partition("=")[0] if _named(arg) else ""
            values = tuple(one.removeprefix(f"{keyword}=") if keyword else one for one in texts)
            wanted = names.get(keyword, [keyword])[0] if keyword else ""
            wanted = wanted or (placed[j] if j < len(placed) else "item")
            name = unused(wanted, taken)
            if columns.setdefault(name, values) != values:
                return []
            args.append(f"{keyword}={name}" if keyword else name)
        body.append(f"    {called(statement.call, args)}")
    return [loop_head(columns), *body]


def loop_head(columns: Mapping[str, tuple[str, ...]]) -> str:
    """The head of a loop over a table: variable of each column -> its values."""
    variables = ", ".join(columns)
    rows = [", ".join(row) for row in zip(*columns.values(), strict=True)]
    if len(columns) > 1:
        return f"for {variables} in ({', '.join(f'({row})' for row in rows)}):"
    if all(row.lstrip("-").isdecimal() for row in rows):
        numbers = [int(row) for row in rows]
        first = numbers[0]
        if numbers == list(range(first, first + len(numbers))):
            start = f"{first}, " if first else ""
            return f"for {variables} in range({start}{first + len(numbers)}):"
    return f"for {variables} in ({', '.join(rows)}):"


def _named(arg: str) -> bool:
    return arg.partition("=")[0].isidentifier() and "=" in arg
