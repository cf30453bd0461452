"""Tables of numbers as Parquet files, by DuckDB: what is NaN here is NULL there."""

from __future__ import annotations

import glob
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from io import BufferedIOBase
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.model import whole

#: a connection to DuckDB, which has few types
Connection: TypeAlias = Any
Columns = Mapping[str, NDArray[Any]]
_CHANGED = "it is cut off, damaged or changed"
#: where the system names opened files by number
_OPENED = Path("/dev/fd")


@dataclass(frozen=True)
class Table:
    """What the description of stored results says of a table beside it; older ones say less.

    Attributes:
        sha256: digest of the file, empty where it is not known.
        rows: how many there are, ``None`` where it is not known.
    """

    sha256: str = ""
    rows: int | None = None


def connect() -> Connection:
    """A data base in memory."""
    import duckdb

    return duckdb.connect()


def register(connection: Connection, table: str, columns: Columns) -> list[str]:
    """Makes columns a table of a connection; returns how each is selected under its name.

    They are numbered in the table, ``c0`` first: names of channels may hold anything.
    """
    numbered = {f"c{i}": values for i, values in enumerate(columns.values())}
    connection.register(table, numbered)
    return [
        (f"nullif({table}.c{i}, 'nan'::double)" if values.dtype == np.float64 else f"{table}.c{i}")
        + ' as "{}"'.format(name.replace('"', '""'))
        for i, (name, values) in enumerate(columns.items())
    ]


def write(connection: Connection, query: str, path: Path, options: str = "") -> Table:
    """Writes what a query gives into a new file.

    Raises:
        OSError: it could not be written; the message of DuckDB is kept.
    """
    import duckdb

    with path.open("x+b") as file:
        try:
            # the only path in a text of SQL: before version 2 DuckDB takes no parameter there
            place = literal(file, path).replace("'", "''")
            (rows,) = connection.execute(
                f"copy ({query}) to '{place}'"
                f" (format parquet, use_tmp_file false, compression zstd{options})"
            ).fetchone()
        except duckdb.Error as error:
            # DuckDB appends the same again as JSON
            message = str(error).splitlines()[0].partition(": {")[0]
            raise OSError(f"writing {path.name}: {message}") from None
        return Table(_digest(file), int(rows))


def read(path: Path, written: Table, again: str) -> dict[str, NDArray[Any]]:
    """All columns of a file, by name.

    Args:
        path: the file.
        written: what was written.
        again: what makes it anew, such as "run it again".

    Raises:
        InputError: it cannot be read, or is not what was written.
    """
    import duckdb

    try:
        with whole.opened(path) as file, connect() as connection:
            if written.sha256 and _digest(file) != written.sha256:
                raise InputError(str(path), [f"is not what was written: {_CHANGED}; {again}"])
            columns = connection.execute(
                "from read_parquet(?, hive_partitioning=false)",
                [glob.escape(literal(file, path))],
            ).fetchnumpy()
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
    except (duckdb.Error, ValueError, MemoryError):
        fault = f"cannot be read: it is cut off or damaged; {again}"
        raise InputError(str(path), [fault]) from None
    found = len(next(iter(columns.values()), ()))
    if written.rows is not None and found != written.rows:
        raise InputError(str(path), [f"holds {found} rows; expected {written.rows}; {again}"])
    return {
        name: np.ma.filled(values, np.nan) if values.dtype == np.float64 else np.ma.filled(values)
        for name, values in columns.items()
    }


def literal(file: BufferedIOBase, path: Path) -> str:
    """A name of an opened file that holds nothing of its path, where the system has one.

    To DuckDB a path is a pattern, an address, and perhaps a list of keys and values.
    """
    return str(_OPENED / str(file.fileno())) if _OPENED.is_dir() else str(path)


def _digest(file: BufferedIOBase) -> str:
    return hashlib.file_digest(file, "sha256").hexdigest()
