"""Dates and times written as text: ISO 8601, and what spreadsheets write."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

_CLOCK = r"\d{1,2}:\d{2}(?::\d{2}(?:[.,]\d{1,9})?)?"
_ISO = re.compile(rf"\d{{4}}-\d{{2}}-\d{{2}}(?:[T ]{_CLOCK})?\s*(?:Z|UTC|[+-]\d{{2}}:?\d{{2}})?")
_OTHER = re.compile(
    rf"(\d{{1,4}})([./-])(\d{{1,2}})\2(\d{{1,4}})(?:[ T,]+{_CLOCK}(?:\s*[AaPp][Mm])?)?"
)
_TIME_OF_DAY = re.compile(rf"{_CLOCK}(?:\s*[AaPp][Mm])?")


@dataclass(frozen=True)
class DateStyle:
    """How the cells of a column write dates.

    Attributes:
        kind: "iso", "date" (with ``order``) or "clock" (a time of day alone).
        order: such as "%d.%m.%Y", empty for the others.
        other: the order that would fit as well, empty where there is none.
    """

    kind: str
    order: str = ""
    other: str = ""

    @property
    def words(self) -> str:
        """The style as a person would write it."""
        if self.kind == "iso":
            return "ISO 8601"
        if self.kind == "clock":
            return "a time of day"
        words = {"%d": "day", "%m": "month", "%Y": "year", "%y": "year", "/": "/"}
        text = self.order
        for code, word in words.items():
            text = text.replace(code, word)
        return text


def looks_like_date(text: str) -> bool:
    """Whether a cell is a date, a time of day, or both."""
    text = text.strip()
    return bool(_ISO.fullmatch(text) or _OTHER.fullmatch(text) or (_TIME_OF_DAY.fullmatch(text)))


def style_of(cells: Sequence[str]) -> DateStyle | None:
    """How these cells write dates, ``None`` where they do not or do it in several ways."""
    cells = [cell.strip() for cell in cells if cell.strip()]
    if not cells:
        return None
    if all(_ISO.fullmatch(cell) for cell in cells):
        return DateStyle("iso")
    if all(_TIME_OF_DAY.fullmatch(cell) for cell in cells):
        return DateStyle("clock")
    parts = [_OTHER.fullmatch(cell) for cell in cells]
    if not all(parts):
        return None
    numbers = [[int(p[1]), int(p[3]), int(p[4])] for p in parts if p]
    mark, long = parts[0][2], [len(parts[0][i]) for i in (1, 3, 4)]  # type: ignore[index]
    if long[0] == 4:
        return DateStyle("date", f"%Y{mark}%m{mark}%d")
    year = "%Y" if long[2] == 4 else "%y"
    day_first = f"%d{mark}%m{mark}{year}"
    month_first = f"%m{mark}%d{mark}{year}"
    if mark == "." or any(n[0] > 12 for n in numbers):
        return DateStyle("date", day_first)
    if any(n[1] > 12 for n in numbers):
        return DateStyle("date", month_first)
    return DateStyle("date", day_first, month_first)


def nanoseconds(cells: Any, style: DateStyle) -> NDArray[np.int64] | None:  # noqa: ANN401
    """Nanoseconds since 1970 (or midnight) of many cells; ``None`` where one is no such date.

    Args:
        cells: a list or pandas series of text.
        style: how they are written.
    """
    import pandas as pd

    series = pd.Series(cells, dtype="str").str.strip()
    series = series.str.replace(r",(\d{1,9})(?=\D*$)", r".\1", regex=True)
    try:
        if style.kind == "iso":
            series = series.str.replace(r"\s*UTC$", "Z", regex=True)
            stamps = pd.to_datetime(series, format="ISO8601", utc=True)
        elif style.kind == "clock":
            return _of_day(series)
        else:
            stamps = _dated(series, style)
        if stamps.isna().any():
            return None
        naive = stamps.dt.tz_localize(None) if stamps.dt.tz is not None else stamps
        return np.asarray(naive.astype("datetime64[ns]").astype(np.int64), dtype=np.int64)
    except (ValueError, OverflowError, TypeError):
        return None


def _dated(series: Any, style: DateStyle) -> Any:  # noqa: ANN401
    import pandas as pd

    parts = series.str.extract(r"^(\S+?)[T, ]+(\S.*)$")
    dates = parts[0].where(parts[0].notna(), series)
    days = pd.to_datetime(dates, format=style.order)
    clocks = parts[1].where(parts[1].notna(), "00:00:00")
    since = _of_day(clocks)
    if since is None:
        raise ValueError("no time of day")
    return days + pd.to_timedelta(since, unit="ns")


def _of_day(series: Any) -> NDArray[np.int64] | None:  # noqa: ANN401
    """Nanoseconds since midnight of ``h:mm[:ss[.fff]] [AM|PM]``."""
    parts = series.str.extract(r"^(\d{1,2}):(\d{2})(?::(\d{2})(?:\.(\d{1,9}))?)?\s*([AaPp][Mm])?$")
    if parts[0].isna().any():
        return None
    hours, minutes = parts[0].astype(np.int64), parts[1].astype(np.int64)
    seconds = parts[2].fillna("0").astype(np.int64)
    fraction = parts[3].fillna("0").str.ljust(9, "0").astype(np.int64)
    half = parts[4].fillna("").str.lower()
    if ((half != "") & ((hours > 12) | (hours < 1))).any() or (hours > 24).any():
        return None
    hours = hours.where(half == "", hours % 12 + 12 * (half == "pm"))
    total = ((hours * 60 + minutes) * 60 + seconds) * 1_000_000_000 + fraction
    return np.asarray(total, dtype=np.int64)


def iso(nanoseconds_since_1970: int) -> str:
    """An instant as ISO 8601 with microseconds, without a zone."""
    stamp = np.datetime64(int(nanoseconds_since_1970), "ns")
    return str(stamp.astype("datetime64[us]"))
