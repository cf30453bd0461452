"""YAML files of users: their content, the line of every place, and faults in plain words."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

import yaml
from pydantic import BaseModel, ValidationError

from simcompare.errors import InputError
from simcompare.model import user_file
from simcompare.model.plain import Plain

#: size of a file, its parts, and those that aliases may stand for beside them: far more than a
#: scenario or a mapping needs, and read in seconds
_MAX_MB, _MAX_PARTS, _MAX_ALIASED = 1.0, 50_000, 100_000

#: what YAML 1.2 takes for a truth value or a number (its core schema, chapter 10.3.2); version 1.1,
#: which PyYAML reads, also takes 1:30 for 90, 010 for 8, no for false, and 1e3 for a text
_CORE = {
    "bool": ("true|True|TRUE|false|False|FALSE", "tTfF"),
    "int": ("[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+", "-+0123456789"),
    "float": (
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
        "-+.0123456789",
    ),
}


class _Loader(yaml.SafeLoader):
    """Reads truth values and numbers as YAML 1.2 does."""

    def construct_yaml_int(self, node: yaml.ScalarNode) -> int:
        """A whole number; 010 is ten."""
        return int(node.value, {"0x": 16, "0o": 8}.get(node.value[:2], 10))


_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in known if tag.rpartition(":")[2] not in _CORE]
    for first, known in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
for _kind, (_pattern, _first) in _CORE.items():
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_kind}", re.compile(f"(?:{_pattern})$"), list(_first)
    )
_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_yaml_int)


def read_yaml(path: Path) -> tuple[Any, dict[str, int], dict[str, str]]:
    """Content of a YAML file, the line of every place in it, and keys that stand twice.

    Raises:
        InputError: unreadable, not UTF-8, or not YAML; names line and column.
    """
    raw = user_file.content(path, _MAX_MB, "a YAML file")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(str(path), ["cannot be read: it is no text in UTF-8"]) from None
    lines: dict[str, int] = {}
    faults: dict[str, str] = {}
    try:
        content = _content(path, text, lines, faults)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        # a template has one where the user must write
        open_ = mark is not None and re.search(r"[{,:]\s*\?", _line(text, mark.line))
        cure = "; replace the ? by what it stands for" if open_ else ""
        raise InputError(str(path), [f"{place}not valid YAML: {error.problem}{cure}"]) from None
    except (yaml.YAMLError, ValueError) as error:
        raise InputError(str(path), [f"not valid YAML: {error}"]) from None
    except RecursionError:
        raise InputError(str(path), ["is nested too deeply, or an alias holds itself"]) from None
    return content, lines, faults


def _line(text: str, number: int) -> str:
    """A line of a text, counted from 0; empty beyond its end."""
    return next(iter(text.splitlines()[number : number + 1]), "")


def _content(path: Path, text: str, lines: dict[str, int], faults: dict[str, str]) -> Any:  # noqa: ANN401
    """What a YAML text holds; the lines of its places and its faults are added."""
    loader = _Loader(text)
    try:
        node = loader.get_single_node()
        if node is None:
            return None
        sizes: dict[int, int] = {}
        # a few aliases of aliases stand for more parts than any computer can hold
        if _size(node, sizes) > len(sizes) + _MAX_ALIASED:
            raise InputError(
                str(path),
                [f"its aliases (*name) stand for more than {_MAX_ALIASED} parts; use fewer"],
            )
        if len(sizes) > _MAX_PARTS:
            raise InputError(
                str(path),
                [f"has {len(sizes)} parts, and at most {_MAX_PARTS} are read; put measured values"
                 " into a table of their own"],
            )  # fmt: skip
        _collect_lines(node, "", lines, faults)
        return loader.construct_document(node)
    finally:
        loader.dispose()


def _size(node: yaml.Node, sizes: dict[int, int]) -> int:
    """Number of parts below a node, those behind aliases counted each time they are used."""
    if id(node) in sizes:
        if not sizes[id(node)]:
            raise RecursionError  # it is a part of itself
        return sizes[id(node)]
    sizes[id(node)] = 0
    parts: list[yaml.Node] = []
    if isinstance(node, yaml.MappingNode):
        parts = [part for pair in node.value for part in pair]
    elif isinstance(node, yaml.SequenceNode):
        parts = node.value
    total = 1 + sum(_size(part, sizes) for part in parts)
    sizes[id(node)] = total
    return total


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


def faults_of(error: ValidationError, model: type[BaseModel] | None = None) -> dict[str, str]:
    """Faults that pydantic found, as dotted place -> sentence with the value found.

    Args:
        error: what pydantic raised.
        model: what was read; keys that it does not have are told with those that it has.
    """
    faults = {}
    for item in error.errors():
        place = ".".join(_place_of(item["loc"]))
        message = _message(item["type"], item.get("ctx") or {}) or item["msg"]
        message = message.removeprefix("Value error, ")
        value = item.get("input")
        if model is not None and item["type"] == "extra_forbidden":
            faults[place] = _unknown_key(model, item["loc"])
            continue
        faults[place] = f"{message}{_found(value)}{_cure(item['type'], value)}"
    return faults


def _found(value: object) -> str:
    """What stands in the file, as it is written there."""
    if isinstance(value, dict | list):
        return ""
    if isinstance(value, bool):
        return f", found {str(value).lower()}"
    return ", found nothing" if value is None else f", found {value!r:.200}"


def _cure(kind: str, value: object) -> str:
    """What to write in place of a text that nearly is a number."""
    if kind not in ("float_parsing", "int_parsing") or not isinstance(value, str):
        return ""
    if re.fullmatch(r"[-+]?\d+,\d+", value):
        return f"; write a point: {value.replace(',', '.')}"
    if re.fullmatch(r"[-+]?[\d.]+ ?[^\W\d_].{,9}", value):
        return "; write the number alone"
    return ""


def _unknown_key(model: type[BaseModel], loc: tuple[int | str, ...]) -> str:
    """That a key is not known, and those that are, the nearest first."""
    known = [field.alias or name for name, field in _model_at(model, loc[:-1]).model_fields.items()]
    key = str(loc[-1])
    known.sort(key=lambda name: -difflib.SequenceMatcher(None, key, name).ratio())
    return f"is not known here; known, the nearest first: {', '.join(known)}"


def _model_at(kind: Any, loc: tuple[int | str, ...]) -> type[BaseModel]:  # noqa: ANN401
    """The model at a place below another: of a field, or of an entry of a mapping or list."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        if not loc:
            return kind
        names = {field.alias or name: field for name, field in kind.model_fields.items()}
        return _model_at(names[str(loc[0])].annotation, loc[1:])
    inner = [one for one in get_args(kind) if one not in (type(None), ..., str)]
    if get_origin(kind) in (UnionType, Union, Annotated):
        return _model_at(inner[0], loc)
    return _model_at(inner[-1], loc[1:])  # the key of a mapping comes first


def _place_of(loc: tuple[int | str, ...]) -> list[str]:
    """Place in the file, without the kinds of parts that pydantic adds as if they were places."""
    parts = [str(part) for part in loc if part != "[key]"]
    if parts[:1] in (["actuators"], ["inputs"]) and len(parts) > 2:
        del parts[2]
    if "shapes" in parts[2:] and len(parts) > parts.index("shapes", 2) + 2:
        del parts[parts.index("shapes", 2) + 2]
    return parts


#: what pydantic says, in words for people who do not program
_MESSAGES = {
    "missing": "is missing",
    "extra_forbidden": "is not known here",
    "model_type": "is one value; expected a mapping with its parts, such as {{value: 1.0}}",
    "mapping_type": "is one value; expected a mapping, such as {{name: value}}",
    "dict_type": "is one value; expected a mapping, such as {{name: value}}",
    "tuple_type": "expected a list, such as [1, 2]",
    "list_type": "expected a list, such as [1, 2]",
    "float_type": "expected a number",
    "float_parsing": "expected a number",
    "int_type": "expected a whole number",
    "int_parsing": "expected a whole number",
    "int_from_float": "expected a whole number",
    "finite_number": "expected a finite number",
    "bool_type": "expected true or false",
    "bool_parsing": "expected true or false",
    "string_type": "expected a text",
    "string_too_short": "expected a text of at least {min_length} characters",
    "string_too_long": "expected a text of at most {max_length} characters",
    "string_pattern_mismatch": "is not written as it must be (pattern {pattern})",
    "greater_than": "expected a number greater than {gt:g}",
    "greater_than_equal": "expected a number of at least {ge:g}",
    "less_than": "expected a number less than {lt:g}",
    "less_than_equal": "expected a number of at most {le:g}",
    "literal_error": "expected {expected}",
    "too_short": "expected at least {min_length}, found {actual_length}",
    "too_long": "expected at most {max_length}, found {actual_length}",
}


def _message(kind: str, about: Plain) -> str:
    """Plain words for a kind of fault, empty where there are none."""
    return _MESSAGES.get(kind, "").format(**about)


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
