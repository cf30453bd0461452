"""The verb ``import``: a hardware log becomes a recording; every change is recorded."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np

from simcompare.engine.library import installed_version
from simcompare.errors import InputError
from simcompare.model import recording_store
from simcompare.model.recording import Provenance, Recording


def import_log(
    log: str | Path,
    *,
    kind: str | None = None,
    mapping: str | Path | None = None,
    strict: bool = False,
    assume_units: bool = False,
    out: str | Path | None = None,
) -> Recording:
    """Reads a log of a real device.

    Args:
        log: file or folder.
        kind: format, recognised by content where ``None``.
        mapping: YAML file that says what the log cannot.
        strict: refuse whatever is not whole, instead of repairing what is safe to repair.
        assume_units: replace a unit that contradicts physics by the one that fits, and record it.
        out: folder in which the recording is stored; it is not stored where ``None``.

    Returns:
        The recording, with everything that was noticed or changed in its provenance.

    Raises:
        InputError: every fault of the log or the mapping file, with rows and columns.
        EngineMissing: the package that reads the format is not installed.
        OutputError: the recording cannot be stored.
    """
    from simcompare.hardware import mapping as mappings

    wanted = mappings.NOTHING if mapping is None else mappings.read(Path(mapping))
    found = read(Path(log), wanted, kind=kind, strict=strict, assume_units=assume_units)
    if out is not None:
        recording_store.save(found, Path(out))
    return found


def template(log: str | Path, *, kind: str | None = None) -> str:
    """A mapping file for a log, to be filled in: a line for every column.

    Args:
        log: file or folder.
        kind: format, recognised by content where ``None``.
    """
    from simcompare.hardware.logs import importers, template
    from simcompare.hardware.mapping import NOTHING

    path = Path(log)
    name = kind or importers.recognise(path)
    return template.of_log(importers.read(path, name, NOTHING), path.name, name)


def read(
    path: Path,
    mapping: object,
    *,
    kind: str | None = None,
    strict: bool = False,
    assume_units: bool = False,
    about: dict[str, str] | None = None,
) -> Recording:
    """Reads and conditions a log with a mapping that has been read already."""
    from simcompare.hardware.conditioning.condition import condition
    from simcompare.hardware.logs import importers
    from simcompare.hardware.mapping import Mapping

    assert isinstance(mapping, Mapping)
    name = kind or mapping.format or importers.recognise(path)
    # values of a damaged log may overflow; the checks look at what comes out
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        raw = importers.read(path, name, mapping)
    size, digest = _measure(path)
    provenance = Provenance(
        path.name, digest, size, name, installed_version("simcompare") or "",
        "strict" if strict else "repair", about=about or {},
    )  # fmt: skip
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        found = condition(raw, mapping, provenance, assume_units=assume_units)
    if mapping.derive:
        from simcompare.hardware.conditioning import derived_channels

        found = derived_channels.add(found, mapping.derive, f"{path.name}, derive")
    return found


def _measure(path: Path) -> tuple[int, str]:
    """Size and SHA-256 of a file, or of all files of a folder in order of their names."""
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    digest, size = hashlib.sha256(), 0
    try:
        for file in files:
            with file.open("rb") as stream:
                while block := stream.read(1 << 20):
                    digest.update(block)
                    size += len(block)
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
    return size, digest.hexdigest()
