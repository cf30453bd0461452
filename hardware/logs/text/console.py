"""Lines of serial consoles: stamps that the console puts before each, and values with labels.

    09:41:07.020 -> 0.1,9.8                  [09:41:07.020] 0.1,9.8
    Thrust: 0.03lbs, Torque: 0.12            ax=0.1 ay=0.2
    [1530815 ms] ypr: -7.4 -1.2 3.8          0.01s, 1.2m, 3 m/s

A line becomes one of a table with tabs, and stays at its place, so that faults name the right line.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence

from simcompare.hardware.logs.text import clocks
from simcompare.hardware.logs.text import source as _source

#: name of the column that the stamps of a console make
STAMP = "time of day"
#: lines that are looked at, and the share of them that must be of one kind
_LOOKED_AT, _SHARE = 400, 0.6
#: what a board writes while it starts
BOOT = re.compile(r"(?:ets |rst:0x|configsip:|clk_drv:|mode:\w+, clock|load:0x|entry 0x|=~=~)")
_CLOCK = r"(?:\d{4}-\d\d-\d\d[ T])?\d{1,2}:\d\d:\d\d(?:[.,:]\d{1,6})?"
_STAMPED = re.compile(rf"\s*(?:\[({_CLOCK})\]\s*(?:->|>)?|({_CLOCK})\s*->)\s?(.*)")
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|NaN|NAN|inf|INF|ovf)"
#: a word, or a few of them, before its value; with its unit behind it
_LABELLED = re.compile(
    rf"\s*(?P<label>[^\W\d][\w .()/²°%\[\]#-]{{0,40}}?)\s*(?:[:=]|:=)\s*"
    rf"(?P<value>{_NUMBER})\s?(?P<unit>[^\W\d_][\w/²°^*·-]{{0,9}}|°[\w/]{{0,8}}|%)?"
    r"(?=\s*[,;|\t]|\s+|$)\s*[,;|\t]?"
)
#: a word that tells whose values follow, such as "IMU:"
_WHOSE = re.compile(r"\s*[^\W\d][\w ]{0,20}:\s+(?=[^\W\d])")


#: a stamp in brackets with its unit, and whose values follow
_COUNTED = re.compile(r"\s*\[\s*(\d+(?:\.\d+)?)\s?(ns|us|µs|ms|s)\s*\]\s*(?:[^\W\d]\w*:)?\s*(.*)")
_UNITED = re.compile(rf"\s*(?P<value>{_NUMBER})\s?(?P<unit>[^\W\d_][\w/²°^*·-]{{0,9}}|°\w?|%)?\s*")


def unrolled(source: _source.Source) -> _source.Source:
    """The same text as a table, where a console wrote it; else as it is."""
    lines = [line for line in source.head[:_LOOKED_AT] if line.strip()]
    for told in (_counted(lines), _united(lines)):
        if told:
            return source.rewritten(*told)
    stamped = _mostly([_STAMPED.fullmatch(line) is not None for line in lines])
    rests = [_rest(line) for line in lines] if stamped else lines
    names = _labels(rests)
    if names:
        labels = [*([(STAMP, "")] if stamped else []), *names]
        return source.rewritten(_of_labels([n for n, _ in names], stamped=stamped), labels)
    return source.rewritten(_of_stamps(_separator(rests))) if stamped else source


def _counted(lines: Sequence[str]) -> tuple[Callable[[str], str], list[tuple[str, str]]] | None:
    """How lines with a stamp ``[1530815 ms]`` become rows, and names and units of their cells."""
    found = [match for match in map(_COUNTED.fullmatch, lines) if match]
    units = {match[2] for match in found}
    if len(units) != 1 or not _mostly([_COUNTED.fullmatch(line) is not None for line in lines]):
        return None
    separator = _separator([match[3] for match in found])

    def cells(text: str) -> list[str]:
        return text.split() if separator == " " else text.split(separator)

    def rewrite(line: str) -> str:
        match = _COUNTED.fullmatch(line)
        return "\t".join([match[1], *cells(match[3])]) if match else line

    width = Counter(len(cells(match[3])) for match in found).most_common(1)[0][0]
    return rewrite, [("time", units.pop()), *((f"value {k + 1}", "") for k in range(width))]


def _united(lines: Sequence[str]) -> tuple[Callable[[str], str], list[tuple[str, str]]] | None:
    """The same for rows whose cells carry units, ``0.01s, 1.2m``; one of them has to be a time."""
    separator = max(",;\t|", key=lambda one: sum(one in line for line in lines))

    def cells(line: str) -> list[re.Match[str]]:
        found = [_UNITED.fullmatch(cell) for cell in line.rstrip(separator).split(separator)]
        return [match for match in found if match] if all(found) and len(found) > 1 else []

    kinds = Counter(tuple(m["unit"] or "" for m in cells(line)) for line in lines)
    units, count = kinds.most_common(1)[0] if kinds else ((), 0)
    if count < _SHARE * len(lines) or count < 2 or not any(map(clocks.spelled, units)):
        return None
    head = [name.strip() for name in lines[0].split(separator)]
    named = len(head) == len(units) and not cells(lines[0])
    names = head if named else [f"column_{k + 1}" for k in range(len(units))]

    def rewrite(line: str) -> str:
        found = cells(line)
        right = tuple(m["unit"] or "" for m in found) == units
        return "\t".join(m["value"] for m in found) if right else line

    return rewrite, list(zip(names, units, strict=True))


def _mostly(fits: Sequence[bool]) -> bool:
    return len(fits) > 1 and sum(fits) >= _SHARE * len(fits)


def _rest(line: str) -> str:
    match = _STAMPED.fullmatch(line)
    return match[3] if match else line


def _separator(rests: Sequence[str]) -> str:
    """What separates the values behind the stamps."""
    for separator in "\t;|,":
        if _mostly([separator in rest for rest in rests]):
            return separator
    return " "


def _of_stamps(separator: str) -> Callable[[str], str]:
    """Stamp and values as cells; a header gets the name of the stamps."""

    def rewrite(line: str) -> str:
        match = _STAMPED.fullmatch(line)
        if match is None:
            return line
        stamp = _stamp(match[1] or match[2])
        cells = match[3].split() if separator == " " else match[3].split(separator)
        if not match[3].strip() or (separator != " " and len(cells) == 1 and not _is_value(cells)):
            return match[3]
        return "\t".join([stamp if _has_value(cells) else STAMP, *(cell.strip() for cell in cells)])

    return rewrite


def _stamp(text: str) -> str:
    """09:41:07:020 and 09:41:07,020 as 09:41:07.020."""
    return re.sub(r"(:\d\d:\d\d)[:,](\d+)$", r"\1.\2", text)


def _is_value(cells: Sequence[str]) -> bool:
    return bool(re.fullmatch(_NUMBER, cells[0].strip()))


def _has_value(cells: Sequence[str]) -> bool:
    return any(re.fullmatch(_NUMBER, cell.strip()) for cell in cells)


def _pairs(line: str) -> list[tuple[str, str, str]]:
    """Label, value and unit of each cell; none where the line holds anything else."""
    whose = _WHOSE.match(line)
    pairs, at = [], whose.end() if whose and not _LABELLED.match(line) else 0
    while at < len(line.rstrip()):
        match = _LABELLED.match(line, at)
        if match is None:
            return []
        pairs.append((match["label"].strip(), match["value"], match["unit"] or ""))
        at = match.end()
    return pairs


def _labels(lines: Sequence[str]) -> list[tuple[str, str]]:
    """The labels that most lines have, with the units that stand behind their values."""
    found = [pairs for pairs in map(_pairs, lines) if pairs]
    kinds = Counter(tuple(label for label, _, _ in pairs) for pairs in found)
    if not kinds:
        return []
    labels, count = kinds.most_common(1)[0]
    if count < 2 or count < _SHARE * len(lines) or len({*labels}) < len(labels):
        return []
    first = next(pairs for pairs in found if tuple(label for label, _, _ in pairs) == labels)
    return [(label, unit) for label, _, unit in first]


def _of_labels(labels: Sequence[str], *, stamped: bool) -> Callable[[str], str]:
    def rewrite(line: str) -> str:
        match = _STAMPED.fullmatch(line) if stamped else None
        pairs = _pairs(match[3] if match else line)
        if [label for label, _, _ in pairs] != [*labels] or (stamped and not match):
            return line
        stamp = [_stamp(match[1] or match[2])] if match else []
        return "\t".join([*stamp, *(value for _, value, _ in pairs)])

    return rewrite
