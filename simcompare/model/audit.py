"""What a backend set, it reads back: the record of every physical value given to an engine."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from simcompare.errors import ReadBackMismatch


@dataclass(frozen=True)
class AuditRow:
    """One physical value as the scenario has it and as the engine holds it.

    Attributes:
        quantity: name in the scenario ("ball.mass_kg").
        scenario_value: value in the scenario, ``None`` where the scenario has no such quantity.
        engine_parameter: what the engine calls it.
        set_value: value that was given to the engine, ``None`` where its own default was left.
        read_value: value read from the engine afterwards; ``None`` where the engine offers no way
            to read it (then the note says what was done instead).
        unit: unit of the engine's value.
        note: why it was set so.
    """

    quantity: str
    scenario_value: float | None
    engine_parameter: str
    set_value: float | None
    read_value: float | None
    unit: str
    note: str = ""


class Audit:
    """Collects rows while a scene is built and fails if the engine holds other values.

    Args:
        engine: name of the engine, for the message.
        relative: largest relative difference that counts as equal (rounding of the engine).
    """

    def __init__(self, engine: str, relative: float = 1e-12) -> None:
        self._engine, self._relative = engine, relative
        self.rows: list[AuditRow] = []

    def add(
        self,
        quantity: str,
        scenario_value: float | None,
        engine_parameter: str,
        values: tuple[float | None, float | None],
        unit: str,
        note: str = "",
    ) -> None:
        """Adds a row; ``values`` are the value set and the value read back."""
        wanted, put, held = map(_plain, (scenario_value, *values))
        self.rows.append(AuditRow(quantity, wanted, engine_parameter, put, held, unit, note))

    def add_all(
        self,
        quantity: str,
        parameter: str,
        put: Sequence[float],
        held: Sequence[float],
        units: Sequence[str],
        note: str = "",
    ) -> None:
        """Adds a row for every number that was set of one parameter; it may hold more of them."""
        for i, (wanted, value, unit) in enumerate(zip(put, held, units, strict=False)):
            self.add(quantity, None, f"{parameter}[{i}]", (wanted, value), unit, note)

    def add_without_getter(
        self,
        quantity: str,
        given: Mapping[str, tuple[float, float | None]],
        *,
        is_given: bool,
        stated: float | None = None,
    ) -> None:
        """Adds parameters that the engine does not tell.

        Args:
            quantity: what they are about.
            given: parameter -> the value that was set, and the engine's default where it is known.
            is_given: whether they were set; else what the engine itself has was left on.
            stated: the scenario's value, if it has one.
        """
        for parameter, (value, default) in given.items():
            note = "it has no getter"
            if not is_given:
                own = f", {default:g}," if default else ""
                note += f"; the engine's own{own} was left on"
            self.add(quantity, stated, parameter, (value if is_given else None, None), "", note)

    def finish(self) -> tuple[AuditRow, ...]:
        """All rows.

        Raises:
            ReadBackMismatch: the engine holds another value than was set; all of them are named.
        """
        wrong = [row for row in self.rows if not self._agrees(row)]
        if wrong:
            raise ReadBackMismatch(
                self._engine,
                [
                    f"{row.quantity}: set {row.engine_parameter} = {row.set_value!r}"
                    f" but it is {row.read_value!r} {row.unit}"
                    for row in wrong
                ],
            )
        return tuple(map(_with_finite_numbers, self.rows))

    def _agrees(self, row: AuditRow) -> bool:
        if row.set_value is None or row.read_value is None or row.set_value == row.read_value:
            return True
        if not (math.isfinite(row.set_value) and math.isfinite(row.read_value)):
            return False
        size = max(abs(row.set_value), abs(row.read_value))
        return abs(row.set_value - row.read_value) <= self._relative * size


def _plain(value: float | None) -> float | None:
    return None if value is None else float(value)


def _with_finite_numbers(row: AuditRow) -> AuditRow:
    """A row as a record can hold it: what has no limit is told in its note."""
    if row.read_value is None or math.isfinite(row.read_value):
        return row
    note = f"{row.note}: {row.read_value}" if row.note else str(row.read_value)
    return replace(row, set_value=None, read_value=None, note=note)
