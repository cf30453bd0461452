"""Records read back from JSON into their types."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from pydantic import ValidationError

from simcompare.errors import InputError
from simcompare.model import plain
from simcompare.results.records.first_format import FIRST_FORMAT, of_today
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.run import FORMAT, Record, RunRecord
from simcompare.results.records.validation import ValidationRecord

_KINDS: Mapping[str, type[Record]] = {
    kind.kind: kind for kind in (RunRecord, FitRecord, ValidationRecord)
}


def read(path: Path) -> Record:
    """The record of a run, a fit or a validation.

    Raises:
        InputError: it cannot be read; says where it is damaged.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"), parse_constant=_refuse)
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
    except (ValueError, RecursionError) as error:
        raise InputError(str(path), [f"cannot be read: {_damage(error)}; run it again"]) from None
    try:
        return of_plain(data)
    except InputError as error:
        raise InputError(str(path), error.faults) from None


def of_plain(data: object) -> Record:
    """The record that JSON holds, also that of an older format.

    Raises:
        InputError: it is none; says what is wrong, place by place.
    """
    if not isinstance(data, dict):
        raise InputError("record", [f"holds a {type(data).__name__}, not an object"])
    _check_age(data.get("format"))
    _expect("format", data.get("format"), (FIRST_FORMAT, FORMAT))
    if data["format"] == FIRST_FORMAT:
        data = of_today(data, FORMAT)
    _expect("kind", data.get("kind"), tuple(_KINDS))
    try:
        return plain.of_plain(_KINDS[data["kind"]], data)
    except ValidationError as error:
        raise InputError("record", plain.faults(error)) from None


def _damage(error: ValueError | RecursionError) -> str:
    """What is wrong with a text that should be JSON."""
    if isinstance(error, json.JSONDecodeError):
        return f"it is cut off or damaged in line {error.lineno}"
    if isinstance(error, _NoNumber):
        return str(error)
    return "it is damaged"


class _NoNumber(ValueError):
    """A word that Python takes for a number and JSON does not."""


def _refuse(constant: str) -> float:
    """NaN and Infinity are no numbers of JSON, and none that was written."""
    raise _NoNumber(f"{constant} is no number")


def _check_age(number: object) -> None:
    """Refuses a format that only a newer simcompare knows."""
    if type(number) is int and number > FORMAT:
        fault = f"cannot be read: a newer simcompare wrote it (format {number}, known to {FORMAT})"
        raise InputError("record", [f"{fault}; update simcompare"])


def _expect(name: str, value: object, known: tuple[object, ...]) -> None:
    if value not in known or isinstance(value, bool):
        expected = " or ".join(map(str, known))
        raise InputError("record", [f"{name} {value!r} is not known; expected {expected}"])
