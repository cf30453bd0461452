"""What a backend set, it reads back: the record of every physical value given to an engine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from simcompare.errors import ReadBackMismatch
from simcompare.shapes import Shape, sizes_m


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
        wanted, put, held = (
            None if value is None else float(value) for value in (scenario_value, *values)
        )
        row = AuditRow(quantity, wanted, engine_parameter, put, held, unit, note)
        self.rows.append(row)

    def add_sizes(self, body: str, shape: Shape, parameter: str, held_m: Sequence[float]) -> None:
        """Adds a row for every length of a shape; ``held_m`` in the order of ``sizes_m``."""
        for (name, wanted), got in zip(sizes_m(shape).items(), held_m, strict=True):
            self.add(f"{body}.{name}", wanted, parameter, (wanted, got), "m")

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
        return tuple(self.rows)

    def _agrees(self, row: AuditRow) -> bool:
        if row.set_value is None or row.read_value is None or row.set_value == row.read_value:
            return True
        if not (math.isfinite(row.set_value) and math.isfinite(row.read_value)):
            return False
        size = max(abs(row.set_value), abs(row.read_value))
        return abs(row.set_value - row.read_value) <= self._relative * size
