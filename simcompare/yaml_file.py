"""YAML files of users: their content, the line of every place, and faults in plain words."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from simcompare.errors import InputError


def read_yaml(path: Path) -> tuple[Any, dict[str, int], dict[str, str]]:
    """Content of a YAML file, the line of every place in it, and keys that stand twice.

    Raises:
        InputError: unreadable, not UTF-8, or not YAML; names line and column.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), [f"cannot be read: {error}"]) from None
    lines: dict[str, int] = {}
    faults: dict[str, str] = {}
    try:
        content = yaml.safe_load(text)
        _collect_lines(yaml.compose(text, Loader=yaml.SafeLoader), "", lines, faults)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise InputError(str(path), [f"{place}not valid YAML: {error.problem}"]) from None
    except (yaml.YAMLError, ValueError) as error:
        raise InputError(str(path), [f"not valid YAML: {error}"]) from None
    except RecursionError:
        raise InputError(str(path), ["is nested too deeply, or an alias holds itself"]) from None
    return content, lines, faults


def _collect_lines(
    node: yaml.Node | None, path: str, lines: dict[str, int], faults: dict[str, str]
) -> None:
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            place = f"{path}.{key.value}" if path else str(key.value)
            line = key.start_mark.line + 1
            if place in lines:
                faults[place] = f"stands twice, in line {lines[place]} and in line {line}"
            lines.setdefault(place, line)
            _collect_lines(value, place, lines, faults)
    elif isinstance(node, yaml.SequenceNode):
        for i, value in enumerate(node.value):
            lines[f"{path}.{i}"] = value.start_mark.line + 1
            _collect_lines(value, f"{path}.{i}", lines, faults)


def faults_of(error: ValidationError) -> dict[str, str]:
    """Faults that pydantic found, as dotted place -> sentence with the value found."""
    faults = {}
    for item in error.errors():
        place = ".".join(_place_of(item["loc"]))
        message = _MESSAGES.get(item["type"]) or item["msg"].removeprefix("Value error, ")
        found = item.get("input")
        shown = "" if isinstance(found, dict | list) else f", found {found!r}"
        faults[place] = f"{message}{shown}"
    return faults


def _place_of(loc: tuple[int | str, ...]) -> list[str]:
    """Place in the file, without the kinds of parts that pydantic adds as if they were places."""
    parts = [str(part) for part in loc]
    if parts[:1] in (["actuators"], ["inputs"]) and len(parts) > 2:
        del parts[2]
    if "shapes" in parts[2:] and len(parts) > parts.index("shapes", 2) + 2:
        del parts[parts.index("shapes", 2) + 2]
    return parts


#: what pydantic says, in words for people who do not program
_MESSAGES = {
    "missing": "is missing",
    "extra_forbidden": "is not known here",
    "model_type": "is one value; expected a mapping with its parts, such as {value: 1.0}",
}


def describe(faults: Mapping[str, str], lines: Mapping[str, int]) -> list[str]:
    """Sentences ``line 12, bodies.ball.mass_kg: …`` in the order of the file."""
    rows = []
    for place, sentence in faults.items():
        line = _line_of(place, lines)
        where = f"line {line}, {place}" if line else place
        rows.append((line or 0, f"{where}: {sentence}" if place else sentence))
    return [text for _, text in sorted(rows, key=lambda row: row[0])]


def _line_of(place: str, lines: Mapping[str, int]) -> int | None:
    while place:
        if place in lines:
            return lines[place]
        place = place.rpartition(".")[0]
    return None
