"""Records read back from JSON into their types."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from simcompare.errors import InputError
from simcompare.model import record_file
from simcompare.results.records.first_format import FIRST_FORMAT, of_today
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.run import FORMAT, Record, RunRecord
from simcompare.results.records.validation import ValidationRecord

_KINDS: Mapping[str, type[Record]] = {
    kind.kind: kind for kind in (RunRecord, FitRecord, ValidationRecord)
}
#: formats that did not tell the digests of their tables
_WITHOUT_DIGESTS = (FIRST_FORMAT, 2)


def read(path: Path, tables: Sequence[str] = ()) -> Record:
    """The record of a run, a fit or a validation.

    Args:
        path: the file.
        tables: names of files beside it, whose digests it tells since format 3.

    Raises:
        InputError: it cannot be read; says where it is damaged.
    """
    data = record_file.read(path, "run it again")
    found = of_plain(data, path)
    told = {name for name, table in found.tables.items() if table.sha256}
    lacking = [name for name in tables if name not in told and path.with_name(name).exists()]
    if lacking and isinstance(data, dict) and data["format"] not in _WITHOUT_DIGESTS:
        faults = [f"tables: tells no digest of {name}; run it again" for name in lacking]
        raise InputError(str(path), faults)
    return found


def of_plain(data: object, path: Path = Path("record")) -> Record:
    """The record that JSON holds, also that of an older format.

    Args:
        data: what JSON holds.
        path: of the file, for messages.

    Raises:
        InputError: it is none; says what is wrong, place by place.
    """
    if not isinstance(data, dict):
        raise InputError(str(path), [f"holds a {type(data).__name__}, not an object"])
    _check_age(data.get("format"), path)
    _expect("format", data.get("format"), (*_WITHOUT_DIGESTS, FORMAT), path)
    is_old = data["format"] == FIRST_FORMAT
    if is_old:
        data = of_today(data, FORMAT)
    _expect("kind", data.get("kind"), tuple(_KINDS), path)
    found = record_file.record(_KINDS[data["kind"]], data, path, more=is_old)
    if found.command is not None and found.command[:1] != ("simcompare",):
        # it is printed for pasting
        raise InputError(str(path), ["command: is none of simcompare"])
    return found


def _check_age(number: object, path: Path) -> None:
    """Refuses a format that only a newer simcompare knows."""
    if type(number) is int and number > FORMAT:
        fault = f"cannot be read: a newer simcompare wrote it (format {number}, known to {FORMAT})"
        raise InputError(str(path), [f"{fault}; update simcompare"])


def _expect(name: str, value: object, known: tuple[object, ...], path: Path) -> None:
    if value not in known or isinstance(value, bool):
        expected = " or ".join(map(str, known))
        raise InputError(str(path), [f"{name} {value!r} is not known; expected {expected}"])
