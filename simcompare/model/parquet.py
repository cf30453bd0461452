"""Tables of numbers as Parquet files, by DuckDB: what is NaN here is NULL there."""

from __future__ import annotations

import glob
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError

#: a connection to DuckDB, which has few types
Connection: TypeAlias = Any
Columns = Mapping[str, NDArray[Any]]


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


def copy(connection: Connection, query: str, path: Path, options: str = "") -> None:
    """Writes what a query gives.

    Raises:
        OSError: DuckDB could not write; its message is kept.
    """
    import duckdb

    # the only path in a text of SQL: before version 2 DuckDB takes no parameter there
    place = str(path).replace("'", "''")
    try:
        connection.execute(
            f"copy ({query}) to '{place}' (format parquet, compression zstd{options})"
        )
    except duckdb.Error as error:
        # DuckDB appends the same again as JSON
        message = str(error).splitlines()[0].partition(": {")[0]
        raise OSError(f"writing {path.name}: {message}") from None


def read(path: Path, again: str) -> dict[str, NDArray[Any]]:
    """All columns of a file, by name.

    Args:
        path: the file.
        again: what makes it anew, such as "run it again".

    Raises:
        InputError: it cannot be read.
    """
    import duckdb

    try:
        path.open("rb").close()  # what hinders that is told in the words of the system
        with connect() as connection:
            rows = connection.execute("from read_parquet(?)", [glob.escape(str(path))])
            columns = rows.fetchnumpy()
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
    except duckdb.Error:
        fault = f"cannot be read: it is cut off or damaged; {again}"
        raise InputError(str(path), [fault]) from None
    return {
        name: np.ma.filled(values, np.nan) if values.dtype == np.float64 else np.ma.filled(values)
        for name, values in columns.items()
    }
