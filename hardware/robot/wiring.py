"""Wires of the robot: which pin of a part leads to which pin of another, and which cannot be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from simcompare.hardware.robot.description import Part, Robot
from simcompare.hardware.robot.pins import Role, Wire

#: what a pin of the controller must be able to do for a wire
_ABLE: Mapping[str, tuple[Role, ...]] = {
    "out": ("io",),
    "in": ("io", "input"),
    "sda": ("io",),
    "scl": ("io",),
    "power": ("power",),
    "ground": ("ground",),
}


@dataclass(frozen=True)
class Lead:
    """One wire: from a pin of a part to a pin of another, and what for.

    Attributes:
        part: its name in the file. name: its own, left_… or right_… of a pair.
    """

    part: str
    name: str
    pin: str
    to_part: str
    to_pin: str
    use: str


def leads(robot: Robot) -> Iterator[Lead]:
    """All wires, in the order of the file; mirrored parts are named ``left_…`` and ``right_…``."""
    for name, part in robot.all_parts.items():
        if not part.mirrored:
            yield from _of(name, name, part.wires)
            continue
        yield from _of(name, f"left_{name}", part.wires)
        yield from _of(name, f"right_{name}", {**part.wires, **part.right_wires})


def _of(name: str, called: str, wires: Mapping[str, Wire]) -> Iterator[Lead]:
    for pin, (target, use) in wires.items():
        to_part, _, to_pin = target.partition(".")
        yield Lead(name, called, pin, to_part, to_pin, use)


def controller(robot: Robot) -> tuple[str, Part] | None:
    """The part that lists its pins, with its name."""
    found = [(name, part) for name, part in robot.all_parts.items() if part.pins]
    return found[0] if found else None


def wiring_faults(robot: Robot) -> dict[str, str]:
    """Wires that lead nowhere or to a pin that cannot do it, as place -> sentence."""
    faults: dict[str, str] = {}
    taken: dict[str, Lead] = {}
    boards = [name for name, part in robot.all_parts.items() if part.pins]
    for name in boards[1:]:
        faults[f"{_place(name)}.pins"] = (
            f"{boards[0]} lists its pins, too; there is one controller, so delete one of the lists"
        )
    board = controller(robot)
    for lead in leads(robot):
        place = f"{_place(lead.part)}.wires.{lead.pin}"
        target = f"{lead.to_part}.{lead.to_pin}"
        if lead.to_part not in robot.all_parts:
            faults[place] = f"leads to {lead.to_part}, which is no part; {_known(robot.all_parts)}"
            continue
        if (lead.to_part, lead.to_pin) == (lead.part, lead.pin):
            faults[place] = f"{target} leads to itself; name the pin at its other end"
        if board is None or lead.to_part != board[0]:
            continue
        role = board[1].pins.get(lead.to_pin)
        able = _ABLE.get(lead.use, ())
        if role is None:
            faults[place] = f"{target} does not exist; {_known(board[1].pins)}"
        elif role not in able:
            can = ", ".join(pin for pin, what in board[1].pins.items() if what in able)
            faults[place] = f"{target} is a pin of kind {role!r}; for {lead.use!r} take: {can}"
        elif lead.use in ("out", "in") and target in taken:
            other = taken[target]
            faults[place] = f"{target} is taken by {other.name}.{other.pin}; take a free pin"
        taken.setdefault(target, lead)
    return {**faults, **_bus_faults(robot)}


def _bus_faults(robot: Robot) -> dict[str, str]:
    """Two parts that answer to one address."""
    faults: dict[str, str] = {}
    owners: dict[int, str] = {}
    for name, part in robot.all_parts.items():
        if part.i2c is None:
            continue
        if not 8 <= part.i2c <= 0x77:
            faults[f"{_place(name)}.i2c"] = (
                f"expected an address of 0x08 to 0x77, found {part.i2c:#x}"
            )
        elif part.mirrored:
            faults[f"{_place(name)}.i2c"] = (
                f"two parts would answer to {part.i2c:#x}: it is mirrored; list both, each with"
                " an address of its own"
            )
        elif part.i2c in owners:
            faults[f"{_place(name)}.i2c"] = (
                f"{part.i2c:#x} is the address of {owners[part.i2c]} too; change one of them"
            )
        owners.setdefault(part.i2c, name)
    return faults


def _known(names: Mapping[str, object]) -> str:
    return f"known: {', '.join(names)}"


def _place(part: str) -> str:
    return part if part == "motor" else f"parts.{part}"
