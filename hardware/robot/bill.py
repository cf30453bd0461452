"""Bill of materials, wiring and pins of a robot as tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

from simcompare.hardware.robot.built import placed
from simcompare.hardware.robot.description import Bought, Robot
from simcompare.hardware.robot.wiring import controller, leads
from simcompare.model.cells import cell

#: heads of the tables, by which our own are known again
BILL = ("part", "count", "mass_each_kg", "text", "maker", "part_number", "price_each", "currency",
        "price_source", "source", "confirmed")  # fmt: skip
WIRING = ("part", "pin", "to_part", "to_pin", "for")
PINS = ("pin", "kind", "for", "leads_to")

Row = Sequence[str | float]


def bill(robot: Robot) -> str:
    """What has to be bought or printed, as CSV; empty where nobody saw a price or a number."""
    masses = {one.place: one.mass_kg for one in placed(robot)}
    return _csv(
        BILL, [_bought(name, count, one, masses[place]) for name, count, one, place in parts(robot)]
    )


def parts(robot: Robot) -> Iterable[tuple[str, int, Bought, str]]:
    """Name, number, part and place in the file of all that the robot is made of."""
    yield "chassis", 1, robot.chassis, "chassis"
    yield "wheel", 2, robot.wheels, "wheels"
    yield "caster", 1, robot.caster, "caster"
    for name, part in robot.all_parts.items():
        place = name if part is robot.motor else f"parts.{name}"
        yield name, 2 if part.mirrored else 1, part, place


def wiring(robot: Robot) -> str:
    """Every wire, as CSV."""
    return _csv(
        WIRING, [(one.name, one.pin, one.to_part, one.to_pin, one.use) for one in leads(robot)]
    )


def pins(robot: Robot) -> str:
    """Every pin of the controller and what it is used for, as CSV; free ones have no more."""
    board = controller(robot)
    if board is None:
        return _csv(PINS, [])
    name, part = board
    uses: dict[str, list[tuple[str, str]]] = {pin: [] for pin in part.pins}
    for one in leads(robot):
        if one.to_part == name:
            uses[one.to_pin].append((one.use, f"{one.name}.{one.pin}"))
    return _csv(
        PINS,
        [
            (pin, kind, _once(use for use, _ in uses[pin]), " ".join(to for _, to in uses[pin]))
            for pin, kind in part.pins.items()
        ],
    )


def _bought(name: str, count: int, one: Bought, mass_kg: float) -> Row:
    price = "" if one.price is None else one.price
    return (
        name, count, round(mass_kg, 6), one.text, one.maker, one.part_number, price, one.currency,
        one.price_source, one.source, "yes" if one.confirmed else "no",
    )  # fmt: skip


def _once(words: Iterable[str]) -> str:
    return " ".join(dict.fromkeys(words))


def _csv(head: Sequence[str], rows: Iterable[Row]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows([cell(value) for value in row] for row in rows)
    return text.getvalue()
