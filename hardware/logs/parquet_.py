"""Parquet tables, read with DuckDB in blocks."""

from __future__ import annotations

import glob
from io import BufferedReader
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import arrays
from simcompare.hardware.logs.binary.arrays import Block
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, Spool
from simcompare.model import parquet
from simcompare.model.recording import INFO, WARNING, Repair

#: a connection to DuckDB, which has few types
_Base: TypeAlias = Any

TITLE = "a Parquet table"

_MAGIC = b"PAR1"
_NUMBERS = ("TINYINT", "SMALLINT", "INTEGER", "BIGINT", "HUGEINT", "UTINYINT", "USMALLINT",
            "UINTEGER", "UBIGINT", "UHUGEINT", "FLOAT", "DOUBLE", "DECIMAL")  # fmt: skip
_WIDE = ("BIGINT", "HUGEINT", "UBIGINT", "UHUGEINT", "DECIMAL")
_MAX_LIST = 64
#: rows that are fetched together, in units of DuckDB's vectors of 2048
_VECTORS = 64
_MEMORY = "512MB"


def recognises(head: Head) -> int:
    """By the signature."""
    return 100 if head.start.startswith(_MAGIC) else 0


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all columns of numbers.

    Raises:
        InputError: the file is damaged, or holds no numbers.
    """
    import duckdb

    with path.open("rb") as file:
        _check_end(file, path)
        name = parquet.literal(file, path)
        base = parquet.connect()
        try:
            base.execute(f"SET memory_limit='{_MEMORY}'")
            base.execute("SET threads=1")
            return _read(base, path, _quoted(glob.escape(name), "'"))
        except duckdb.Error as error:
            text = str(error).splitlines()[0][:300].replace(name, path.name)
            fault = f"is a damaged Parquet file: {text}; copy it again"
            raise InputError(str(path), [fault]) from None
        finally:
            base.close()


def _check_end(file: BufferedReader, path: Path) -> None:
    size = file.seek(0, 2)
    file.seek(-min(4, size), 2)
    end = file.read()
    if end != _MAGIC:
        raise InputError(
            str(path),
            [f"byte {size - 4}: ends with {end!r}, not with 'PAR1'; the file is truncated and its"
             " description, which stands at the end, is lost: copy it again"],
        )  # fmt: skip


def _read(base: _Base, path: Path, file: str) -> RawLog:
    """Reads a file that has been opened.

    Args:
        base: the data base.
        path: the file, for messages.
        file: what is read, as SQL takes it.
    """
    log = RawLog([])
    block = Block("log")
    base.execute(f"CREATE VIEW log AS SELECT * FROM read_parquet({file}, hive_partitioning=false)")
    types = base.execute("DESCRIBE log").fetchall()
    wanted: list[tuple[str, str, str]] = []  # name, expression, unit
    for name, kind, *_ in types:
        wanted += _expressions(base, str(name), str(kind), block, log)
    if not wanted:
        reasons = [f"column {name}: {why}" for name, why in log.ignored.items()]
        raise InputError(str(path), reasons or ["holds no columns"])
    spool = Spool(len(wanted))
    query = ", ".join(
        f"CAST({expression} AS DOUBLE) AS c{i}" for i, (_, expression, _) in enumerate(wanted)
    )
    cursor = base.execute(f"SELECT {query} FROM log")
    while len(frame := cursor.fetch_df_chunk(_VECTORS)):
        spool.append(frame.to_numpy(dtype=np.float64, na_value=np.nan))
    if not len(spool):
        raise InputError(str(path), ["holds no rows"])
    for (name, _, unit), values in zip(wanted, spool.columns(), strict=True):
        block.columns.append(RawColumn(name, values, unit))
    _about(base, file, log)
    log.streams.append(arrays.stream_of(block, {}, row_word="row"))
    log.repairs += block.repairs
    return log


def _quoted(name: str, mark: str = '"') -> str:
    """A name or text as SQL takes it, whatever it holds."""
    return mark + name.replace(mark, mark * 2) + mark


def _expressions(
    base: _Base, name: str, kind: str, block: Block, log: RawLog
) -> list[tuple[str, str, str]]:
    """What is selected for one column of the table."""
    plain, unit = arrays.split_unit(name)
    column = _quoted(name)
    if kind == "BOOLEAN":
        return [(plain, f"CAST({column} AS INTEGER)", unit or "1")]
    if kind.startswith(("TIMESTAMP", "DATE")):
        return _instants(base, plain, column, block)
    if kind.endswith("]"):
        return _list(base, name, kind, log)
    if kind.startswith("STRUCT"):
        log.ignored[name] = "is a struct; store its fields as columns"
        return []
    if kind.partition("(")[0] not in _NUMBERS:
        log.ignored[name] = f"holds {kind}, no numbers"
        return []
    if kind.partition("(")[0] in _WIDE:
        return _wide(base, plain, column, unit, block)
    return [(plain, column, unit)]


def _wide(
    base: _Base, plain: str, column: str, unit: str, block: Block
) -> list[tuple[str, str, str]]:
    """Numbers that may be larger than float64 can hold exactly."""
    low, high, first = base.execute(
        f"SELECT min({column}), max({column}), first({column}) FROM log"
    ).fetchone()
    if low is None or max(-low, high) <= 1 << 53:
        return [(plain, column, unit)]
    if arrays.time_of([plain])[0] is None or first is None:
        text = f"{plain} has values beyond 2^53, which were rounded"
        block.repairs.append(Repair("rounded", WARNING, text, block.name, plain))
        return [(plain, column, unit)]
    if 10**17 < first < 46 * 10**17:
        block.start = arrays.iso_ns(int(first))
    text = f"{plain} is counted from its first value {first}, so that float64 keeps every count"
    block.repairs.append(Repair("time_origin", INFO, text, block.name, plain))
    return [(plain, f"(CAST({column} AS HUGEINT) - {int(first)})", unit)]


def _instants(base: _Base, plain: str, column: str, block: Block) -> list[tuple[str, str, str]]:
    """Instants in seconds from the first one on."""
    nanoseconds = f"epoch_ns(CAST({column} AS TIMESTAMP_NS))"
    first = base.execute(
        f"SELECT first({nanoseconds}) FROM log WHERE {column} IS NOT NULL"
    ).fetchone()
    start = int(first[0]) if first and first[0] is not None else 0
    block.start = block.start or arrays.iso_ns(start)
    text = f"{plain} is given in seconds from its first value, {arrays.iso_ns(start)}"
    block.repairs.append(Repair("time_origin", INFO, text, block.name, plain))
    return [(plain, f"(({nanoseconds} - {start}) / 1e9)", "s")]


def _list(base: _Base, name: str, kind: str, log: RawLog) -> list[tuple[str, str, str]]:
    """Lists of numbers that are equally long become one column for each element."""
    plain, unit = arrays.split_unit(name)
    column = _quoted(name)
    inner = kind[: kind.rindex("[")].partition("(")[0]
    if inner not in _NUMBERS:
        log.ignored[name] = f"holds {kind}, no numbers"
        return []
    low, high = base.execute(f"SELECT min(len({column})), max(len({column})) FROM log").fetchone()
    if low is None or low != high or not 0 < high <= _MAX_LIST:
        log.ignored[name] = f"holds lists of {low} to {high} numbers; expected equally long ones"
        return []
    names = arrays.component_names(plain, int(high), letters=True)
    return [(full, f"{column}[{i + 1}]", unit) for i, full in enumerate(names)]


def _about(base: _Base, file: str, log: RawLog) -> None:
    rows = base.execute(f"SELECT key, value FROM parquet_kv_metadata({file})").fetchall()
    for key, value in rows:
        name = arrays.shorten(key)
        if not name.startswith(("ARROW:", "pandas")):
            log.about[name] = arrays.shorten(value)
