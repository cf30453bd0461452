"""The variables of a MATLAB file as plain trees: arrays, texts, dicts (structs), lists (cells)."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import mat_check, mat_v4

_MAX_DEPTH = 16
_MAX_CELLS = 100_000
_OBJECT = (
    "is an object of MATLAB, such as a timetable, which only MATLAB reads; write it there as a"
    " table of text: writetimetable({name}, '{name}.csv'), or writetable for a table"
)
_HDF5 = b"\x89HDF\r\n\x1a\n"


@dataclass(frozen=True)
class Refused:
    """Something that is left out.

    Attributes:
        why: the reason.
    """

    why: str


def load(path: Path) -> dict[str, object]:
    """All variables of a file.

    Raises:
        InputError: it cannot be read.
    """
    with path.open("rb") as file:
        file.seek(512)
        is_hdf5 = file.read(8) == _HDF5
    return _load_hdf5(path) if is_hdf5 else _load_5(path)


def _load_5(path: Path) -> dict[str, object]:
    import scipy.io

    try:
        _check(path)  # scipy itself ends the program on some damaged files
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            variables = scipy.io.loadmat(path, struct_as_record=True, chars_as_strings=True)
    except mat_check.Damaged as damage:
        raise InputError(str(path), [f"{damage}; save it again with save -v7"]) from None
    # scipy raises many kinds for damaged files
    except Exception as error:  # noqa: BLE001
        text = f"is damaged ({type(error).__name__}: {error}"[:300]
        raise InputError(str(path), [f"{text}); save it again with save -v7"]) from None
    told = (_variable(*each) for each in variables.items() if not each[0].startswith("__"))
    return dict(told)


def _variable(name: str, value: Any) -> tuple[str, object]:  # noqa: ANN401  (whatever a file holds)
    """A variable with its name; of an object, scipy gives the name within."""
    if type(value).__name__ == "MatlabOpaque" and "s0" in (value.dtype.names or ()):
        name = bytes(value["s0"][0]).decode("latin-1")
    return name, _plain(value, name=name)


def _check(path: Path) -> None:
    with path.open("rb") as file:
        start = file.read(128)
    if not mat_v4.begins(start):
        mat_check.check(path)
    elif fault := mat_v4.fault(path):
        raise mat_check.Damaged(fault)


def _plain(value: Any, depth: int = 0, name: str = "NAME") -> Any:  # noqa: ANN401  (whatever a file may hold)
    """What scipy returns, without its own types."""
    if depth > _MAX_DEPTH:
        return Refused("is nested too deeply")
    if hasattr(value, "tocsc"):
        return Refused("is a sparse matrix; save it as full(…)")
    if isinstance(value, str):
        return Refused(value)  # scipy's word for what it cannot read
    if type(value).__name__ == "MatlabOpaque":
        return Refused(_OBJECT.format(name=name))
    if not isinstance(value, np.ndarray) or type(value).__name__ == "MatlabFunction":
        return Refused(f"is a {type(value).__name__}, which holds no numbers")
    if value.dtype.names:
        return _struct(value, depth)
    if value.dtype.kind in "US":
        return " / ".join(str(line) for line in value.reshape(-1))
    if value.dtype == object:
        cells = value.reshape(-1, order="F")
        if len(cells) > _MAX_CELLS:
            return Refused(f"has {len(cells)} cells")
        return [_plain(cell, depth + 1) for cell in cells]
    return value


def _struct(value: np.ndarray, depth: int) -> Any:  # noqa: ANN401
    items = value.reshape(-1, order="F")
    names = value.dtype.names or ()
    trees = [{name: _plain(item[name], depth + 1) for name in names} for item in items[:_MAX_CELLS]]
    if len(trees) == 1:
        return trees[0]
    return {str(i): tree for i, tree in enumerate(trees)}


def _load_hdf5(path: Path) -> dict[str, object]:
    import h5py

    try:
        with h5py.File(path, "r") as file:
            return {
                name: _of_hdf5(file, file[name], 0)
                for name in file
                if not name.startswith("#")
                and not isinstance(file.get(name, getlink=True), h5py.ExternalLink)
            }
    except (OSError, KeyError, RuntimeError, ValueError) as error:
        text = str(error)[:300]
        raise InputError(
            str(path), [f"is a damaged MATLAB 7.3 file ({text}); copy or save it again"]
        ) from None


def _of_hdf5(file: Any, item: Any, depth: int) -> Any:  # noqa: ANN401  (h5py has no types)
    """One variable of a version 7.3 file; its dimensions are in reverse order there."""
    import h5py

    if depth > _MAX_DEPTH:
        return Refused("is nested too deeply")
    kind = item.attrs.get("MATLAB_class", b"")
    kind = kind.decode("ascii", "replace") if isinstance(kind, bytes) else str(kind)
    if isinstance(item, h5py.Group):
        if "MATLAB_sparse" in item.attrs:
            return Refused("is a sparse matrix; save it as full(…)")
        return {name: _of_hdf5(file, item[name], depth + 1) for name in item}
    if not isinstance(item, h5py.Dataset) or item.external or item.is_virtual:
        return Refused("is no data set of this file")
    if item.attrs.get("MATLAB_empty", 0):
        return np.empty((0, 0))
    if item.dtype == h5py.ref_dtype:
        return _references(file, item, kind, depth)
    if item.dtype.names == ("real", "imag"):
        return Refused("holds complex numbers; save their real and imaginary parts")
    if item.dtype.kind not in "biuf":
        return Refused(f"holds {item.dtype}, no numbers")
    values = np.asarray(item[()])
    if kind == "char":
        return "".join(map(chr, values.reshape(-1).tolist()))
    return values.T


def _references(file: Any, item: Any, kind: str, depth: int) -> Any:  # noqa: ANN401
    if item.size > _MAX_CELLS:
        return Refused(f"has {item.size} cells")
    cells = [
        _of_hdf5(file, file[reference], depth + 1) if reference else Refused("is empty")
        for reference in np.asarray(item[()]).reshape(-1)
    ]
    return cells if kind == "cell" else dict(zip(map(str, range(len(cells))), cells, strict=True))
