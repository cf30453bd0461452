"""CSV of oscilloscopes: Rigol, Tektronix, Siglent, Keysight, PicoScope, Rohde & Schwarz.

They differ in where time and units stand. A layout is a function that looks at the first lines and
says how to read the rest, or ``None``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import sniff
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text import table as _table
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.logs.text.state import Table
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawLog, RawStream
from simcompare.model.recording import INFO, REPAIR, Clock, Repair, ranges

TITLE = "an oscilloscope's CSV"

#: units as oscilloscopes spell them
_UNITS = {
    "volt": "V", "volts": "V", "ampere": "A", "amperes": "A", "amp": "A", "amps": "A", "aa": "A",
    "watt": "W", "watts": "W", "second": "s", "seconds": "s", "sec": "s", "vv": "V", "u": "1",
    "binary": "1", "value": "",
}  # fmt: skip
_KEYS = re.compile(
    r"(model( number)?|firmware( version)?|record length|sample interval|trigger point|source"
    r"|vertical (units?|scale|offset|position)|horizontal (units?|scale|offset|delay|position)"
    r"|pt fmt|yzero|probe( atten(uation)?)?|memory length|serial number|software version|label"
    r"|waveform type|point format|zero index|gating|threshold used|sampling period|note)"
)
#: columns on the left that hold no samples; what they say goes into the record
_SETTINGS = ("setting", "value of the setting", "unit of the setting")


@dataclass(frozen=True)
class Plan:
    """How one file is to be read.

    Attributes:
        maker: whose layout it is.
        layout: of the rows.
        start_s: time of the first sample, where no column holds it [s].
        increment_s: time between samples, where no column holds it [s].
        about: what the file says of the instrument and its settings.
        counter: name of a column that counts the samples.
    """

    maker: str
    layout: Layout
    start_s: float = 0.0
    increment_s: float | None = None
    about: dict[str, str] = field(default_factory=dict)
    counter: str | None = None


def recognises(head: Head) -> int:
    """High where the first lines are laid out as by an oscilloscope."""
    if head.members:
        return 0
    lines = _source.head_lines(head.start)
    if not lines:
        return 0
    try:
        return 90 if _plan(str(head.path), lines) is not None else 0
    except InputError:
        return 85  # its reader says what is wrong


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads one acquisition.

    Raises:
        InputError: of none of the known layouts, or with rows that are no numbers.
    """
    source = _source.source_of(path)
    plan = _plan(str(path), source.head)
    if plan is None:
        raise InputError(
            str(path), [f"line 1: no layout of an oscilloscope; known: {', '.join(_LAYOUTS)}"]
        )
    table = _table.read(source, plan.layout)
    repairs = [*source.repairs, *table.repairs, *_clipped(table)]
    probes = _probes(plan.about)
    if probes:
        text = f"the probe factor ({probes}) is in the values already, as the instrument applies it"
        repairs.append(Repair("probe_factor", INFO, text))
    time = table.columns[0].name if plan.increment_s is None else None
    clock = f"column {time}" if time else "the oscilloscope's increment"
    stream = RawStream(
        "log", table.columns, time, plan.start_s, plan.increment_s, plan.counter, Clock(clock),
        first_row=table.first_row, rows=table.rows,
        truncated=table.truncated or _short(plan, table),
    )  # fmt: skip
    about = {"instrument": plan.maker, **plan.about}
    ignored = {k: why for k, why in table.ignored.items() if k not in _SETTINGS}
    return RawLog([stream], repairs=repairs, ignored=ignored, about=about)


def unit(text: str) -> str:
    """A unit as an oscilloscope spells it, in the usual way."""
    plain = text.strip(" ()[]\"'")
    return _UNITS.get(plain.lower(), plain)


def _plan(label: str, lines: Sequence[str]) -> Plan | None:
    # a table that holds metres and seconds is no oscilloscope's; the layouts are narrow
    for make in _LAYOUTS.values():
        plan = make(label, lines)
        if plan is not None:
            return plan
    return None


def _padded(cells: Sequence[str], width: int) -> list[str]:
    return [*cells, *[""] * width][: max(width, len(cells))]


def _rigol(label: str, lines: Sequence[str]) -> Plan | None:
    """``X,CH1,Start,Increment`` and below it ``Sequence,Volt,-0.1,1e-6``; X may be missing."""
    head = [cell.strip() for cell in _cell.split(lines[0], ",")] if lines else []
    while head and not head[-1]:
        head.pop()
    if len(head) < 3 or head[-2:] != ["Start", "Increment"]:
        return None
    if not all(re.fullmatch(r"X|CH\d|MATH\d?|D\d+(-D\d+)?|REF\d*", name) for name in head[:-2]):
        return None
    below = [cell.strip() for cell in _cell.split(lines[1], ",")] if len(lines) > 1 else []
    at = head.index("Increment")
    start, step = (_cell.number(c) for c in (_padded(below, at + 1))[at - 1 : at + 1])
    if start is None or step is None or not step > 0:
        shown = ", ".join(below[at - 1 : at + 1])
        raise InputError(
            label, [f"line 2: {shown!r} is no start and increment; expected two numbers, such as"
                    " -0.1,1e-6, the second above 0"],
        )  # fmt: skip
    names = [
        (name, "1" if name == "X" else unit(below[i])) for i, name in enumerate(head[: at - 1])
    ]
    counter = "X" if head[0] == "X" else None
    return Plan("Rigol", sniff.below_header(label, lines, 2, names), start, step, counter=counter)


def _increments(label: str, lines: Sequence[str]) -> Plan | None:
    """``CH1V,CH2V,t0 =-0.05, tInc = 1e-05`` above rows without a time."""
    cells = [cell.strip() for cell in _cell.split(lines[0], ",")] if lines else []
    said = {m[1]: m[2] for m in (re.fullmatch(r"(t0|tInc)\s*=\s*(\S+)", c) for c in cells) if m}
    start, step = (_cell.number(said.get(key, "")) for key in ("t0", "tInc"))
    heads = [c for c in cells if c and "=" not in c]
    if start is None or step is None or not step > 0 or not heads or heads[0].startswith("Time"):
        return None
    parts = [re.fullmatch(r"(\w+\d)\s?\(?([VAW])\)?", head) for head in heads]
    names = [(p[1], p[2]) if p else (head, "") for p, head in zip(parts, heads, strict=True)]
    return Plan("Rigol", sniff.below_header(label, lines, 1, names), start, step)


def _settings_beside(label: str, lines: Sequence[str]) -> Plan | None:
    """Tektronix: settings in the left columns, time and value in the fourth and fifth."""
    first = _cell.split(lines[0], ",") if lines else []
    if len(first) < 5 or first[0].strip().lower() != "record length":
        return None
    if any(_cell.number(cell) is None or not cell.strip() for cell in first[3:5]):
        return None
    about: dict[str, str] = {}
    for line in lines[:40]:
        cells = [cell.strip() for cell in _cell.split(line, ",")]
        if cells and cells[0]:
            about[cells[0]] = " ".join(cell for cell in cells[1:3] if cell)
    low = {key.lower(): value for key, value in about.items()}
    name = low.get("source", "") or "CH1"
    names = [
        *((name, "") for name in _SETTINGS),
        ("time", unit(low.get("horizontal units", "s")).lower()),
        (name, unit(low.get("vertical units", "V").split(" ")[0])),
    ]  # fmt: skip
    names += [(f"column_{i + 1}", "") for i in range(5, len(first))]
    kinds = ("text", "text", "text", "number", "number", *["empty"] * (len(first) - 5))
    return Plan("Tektronix", Layout(",", 1, kinds, tuple(names)), about=about)


def _keyed(label: str, lines: Sequence[str]) -> Plan | None:
    """Tektronix, Siglent: lines ``key,value``, then ``TIME,CH1`` or ``Second,Volt``."""
    keys = 0
    for i, line in enumerate(lines[:60]):
        cells = [cell.strip() for cell in _cell.split(line.lstrip("#"), ",")]
        key = cells[0].lower() if cells else ""
        if keys >= 3 and key == "waveform data":  # of GW Instek, without names
            return _after_keys(label, lines, i, ["time", _source_named(lines[:i])])
        named = re.fullmatch(r"time|second|time ?\(s\)", key) and ":" not in "".join(cells)
        if keys >= 3 and named and len(cells) > 1:
            return _after_keys(label, lines, i, [cell for cell in cells if cell])
        keys += bool(_KEYS.fullmatch(key))
        if i > 2 and not keys:
            return None
    return None


def _source_named(lines: Sequence[str]) -> str:
    """The channel that lines ``Source,CH1`` name."""
    said = (_padded(_cell.split(line, ","), 2) for line in lines)
    return next((cells[1].strip() for cells in said if cells[0].lower() == "source"), "") or "CH1"


def _after_keys(label: str, lines: Sequence[str], header: int, cells: Sequence[str]) -> Plan:
    about = {}
    for line in lines[:header]:
        key, *values = (cell.strip() for cell in _padded(_cell.split(line.lstrip("#"), ","), 2))
        if key and any(values):
            about[key] = ", ".join(value for value in values if value)
    low = {key.lower(): [v.strip() for v in value.split(",")] for key, value in about.items()}
    width = len(cells) - 1
    named = [cells[1:], low.get("source", []), low.get("label", [])]
    siglent = cells[0].lower() == "second"
    labels = named[1] if siglent and len(named[1]) == width else named[0]
    units = [entry.rpartition(":")[2] for entry in low.get("vertical units", [])]
    names = [("time", "s")]
    for k in range(width):
        name, in_name = _cell.heading(labels[k])
        below = cells[k + 1] if siglent else ""
        unit_found = in_name or (unit(units[k]) if k < len(units) else "") or unit(below)
        names.append((name, unit_found))
    layout = sniff.below_header(label, lines, header + 1, names)
    return Plan("Siglent" if siglent else "Tektronix", layout, about=about)


def _keysight(label: str, lines: Sequence[str]) -> Plan | None:
    """``x-axis,1,2`` and below it ``second,Volt,Volt``."""
    if len(lines) < 2 or not lines[0].lower().startswith("x-axis"):
        return None
    head, below = (_cell.split(line, ",") for line in lines[:2])
    names = [("time", unit(below[0]) if below else "")]
    for i, text in enumerate(head[1:], start=1):
        name = text.strip()
        if name:
            unit_below = unit(below[i]) if i < len(below) else ""
            names.append((f"channel {name}" if name.isdigit() else name, unit_below))
    return Plan("Keysight", sniff.below_header(label, lines, 2, names))


def _pico(label: str, lines: Sequence[str]) -> Plan | None:
    """``Time,Channel A`` and below it ``(ms),(mV)``."""
    if len(lines) < 2 or "(" not in lines[1]:
        return None
    separator = max(",;\t", key=lines[1].count)
    head, below = ([c.strip() for c in _cell.split(line, separator)] for line in lines[:2])
    while head and not head[-1]:
        head.pop()
    below = below[: len(head)]
    if len(head) < 2 or len(below) != len(head):
        return None
    if not all(re.fullmatch(r"\(.*\)", cell) for cell in below):
        return None
    names = [(name, unit(u)) for name, u in zip(head, below, strict=True)]
    electric = any(re.fullmatch(r"[munµμk]?[VAW]", u) for _, u in names[1:])
    if not re.fullmatch(r"[munpfµμ]?s", names[0][1]) or not electric:
        return None
    return Plan("PicoScope", sniff.below_header(label, lines, 2, names, separator))


def _schwarz(label: str, lines: Sequence[str]) -> Plan | None:
    """``in s,C1 in V,C2 in V``."""
    cells = [cell.strip() for cell in _cell.split(lines[0], ",")] if lines else []
    parts = [re.fullmatch(r"(.*?)\s?\bin (\S+)", cell) for cell in cells if cell]
    if len(parts) < 2 or not all(parts) or parts[0] is None or parts[0][1]:
        return None
    names = [(part[1] or "time", part[2]) for part in parts if part]
    return Plan("Rohde & Schwarz", sniff.below_header(label, lines, 1, names))


_LAYOUTS: dict[str, Callable[[str, Sequence[str]], Plan | None]] = {
    "Rigol": _rigol,
    "Rigol with increments": _increments,
    "Tektronix": _settings_beside,
    "Tektronix or Siglent": _keyed,
    "Keysight": _keysight,
    "PicoScope": _pico,
    "Rohde & Schwarz": _schwarz,
}


def _clipped(table: Table) -> list[Repair]:
    """Samples beyond the range are written as infinite; they become missing, the range is noted."""
    repairs = []
    for column in table.columns:
        high, low = np.isposinf(column.values), np.isneginf(column.values)
        beyond = np.flatnonzero(high | low)
        if not len(beyond):
            continue
        finite = column.values[np.isfinite(column.values)]
        ends = (float(finite.min()), float(finite.max())) if len(finite) else (-np.inf, np.inf)
        limits = (ends[0] if low.any() else -np.inf, ends[1] if high.any() else np.inf)
        column.limits = limits
        column.values[beyond] = np.nan
        rows = table.rows[beyond] if table.rows is not None else beyond + table.first_row
        text = (
            f"{len(beyond)} sample(s) are written as ∞ (beyond the input's range) and were taken as"
            f" missing; the other values go from {ends[0]:g} to {ends[1]:g}"
        )
        repairs.append(
            Repair("clipped", REPAIR, text, "log", column.name, ranges(rows), len(beyond),
                   {"missing": 0.0}, {"missing": float(len(beyond))})
        )  # fmt: skip
    return repairs


def _probes(about: dict[str, str]) -> str:
    return next((v for k, v in about.items() if k.lower().startswith("probe") and v), "")


def _short(plan: Plan, table: Table) -> str:
    """Whether fewer samples follow than the file promises."""
    text = next((v for k, v in plan.about.items() if k.lower() == "record length"), "")
    match = re.search(r"[\d.]+(?:[eE][+-]?\d+)?", text.rpartition(":")[2])
    promised = _cell.number(match[0]) if match else None
    if promised is None or not promised > len(table):
        return ""
    return f"holds {len(table)} of the {promised:g} samples that its record length says"
