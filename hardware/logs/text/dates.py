"""Dates and times written as text: ISO 8601, and what spreadsheets write."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

_CLOCK = r"\d{1,2}:[0-5]\d(?::[0-5]\d(?:[.,]\d{1,9})?)?"
_ISO = re.compile(
    rf"\d{{4}}-\d{{2}}-\d{{2}}(?:[T ]{_CLOCK})?\s*(?:Z|UTC|[+-]\d{{2}}(?::?\d{{2}})?)?"
)
_OTHER = re.compile(
    rf"(\d{{1,4}})([./-])(\d{{1,2}})\2(\d{{1,4}})(?:[ T,]+{_CLOCK}(?:\s*[AaPp][Mm])?)?"
)
_TIME_OF_DAY = re.compile(rf"{_CLOCK}(?:\s*[AaPp][Mm])?")
_MINUTES = re.compile(r"(\d{1,3}):([0-5]\d)[.,](\d{1,9})")
#: a date that was not known when it was written
NEVER = re.compile(r"0000-00-00.*|00[./]00[./]0000.*")
_MONTHS = {
    name: number for number, names in enumerate(
        ("jan", "feb", "mar mär", "apr", "may mai", "jun", "jul", "aug", "sep", "oct okt", "nov",
         "dec dez"), start=1,
    ) for name in names.split()
}  # fmt: skip
_MONTH = rf"({'|'.join(_MONTHS)})[a-zé]*\.?"
#: what is written differently in a few logs, and how it is written in the most
_REWRITTEN: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], str]], ...] = (
    (re.compile(r"(\d{4}):(\d\d):(\d\d)(?=[ T])"), lambda m: f"{m[1]}-{m[2]}-{m[3]}"),
    (re.compile(r"(\d{4})(\d\d)(\d\d)[T _-](\d\d)(\d\d)(\d\d)(?!\d)"),
     lambda m: f"{m[1]}-{m[2]}-{m[3]}T{m[4]}:{m[5]}:{m[6]}"),
    (re.compile(r"(\d{4}-\d\d-\d\d)[._-](?=\d\d:)"), lambda m: f"{m[1]} "),
    (re.compile(r"(\d{4})/(\d\d)/(\d\d)/(?=\d\d:)"), lambda m: f"{m[1]}-{m[2]}-{m[3]} "),
    (re.compile(rf"(?:\w{{3}},? )?(\d{{1,2}})[ .-]+{_MONTH}[ ,-]+(\d{{4}})", re.IGNORECASE),
     lambda m: f"{m[3]}-{_MONTHS[m[2].lower()]:02d}-{int(m[1]):02d}"),
    (re.compile(rf"{_MONTH} (\d{{1,2}}),? (\d{{4}})", re.IGNORECASE),
     lambda m: f"{m[3]}-{_MONTHS[m[1].lower()]:02d}-{int(m[2]):02d}"),
    (re.compile(rf"\w{{3}} {_MONTH} +(\d{{1,2}}) ([\d:.]+) (\d{{4}})", re.IGNORECASE),
     lambda m: f"{m[4]}-{_MONTHS[m[1].lower()]:02d}-{int(m[2]):02d} {m[3]}"),
    (re.compile(r"(.*\d{1,2}:\d\d:\d\d):(\d{1,3}|\d{6})(?!\d)"),
     lambda m: f"{m[1]}.{m[2]:0>3}"),
    (re.compile(r"(.*\d)\s*([ap])\.\s?m\.", re.IGNORECASE), lambda m: f"{m[1]} {m[2]}m"),
)  # fmt: skip
#: 11:59:59:07 may count frames of a film, or hundredths
_FRAMES = re.compile(r".*\d:\d\d:\d\d:\d\d")


def _plain(text: str) -> str:
    """A date as the most logs write it."""
    text = text.strip()
    for pattern, made in _REWRITTEN:
        match = pattern.match(text)
        if match:
            text = made(match) + text[match.end() :]
    return text


#: what stands for a date that was not known
NOT_KNOWN = np.iinfo(np.int64).min


@dataclass(frozen=True)
class DateStyle:
    """How the cells of a column write dates.

    Attributes:
        kind: "iso", "date" (with ``order``), "clock" (a time of day alone) or "minutes" (of an
            hour, with seconds).
        order: such as "%d.%m.%Y", empty for the others.
        other: the order that would fit as well, empty where there is none.
        rare: whether it is made plain first.
    """

    kind: str
    order: str = ""
    other: str = ""
    rare: bool = False

    @property
    def period_ns(self) -> int:
        """After how long a clock without a date begins again; 0 for dates."""
        return {"clock": 86_400, "minutes": 3600}.get(self.kind, 0) * 10**9

    @property
    def words(self) -> str:
        """The style as a person would write it."""
        if self.kind == "iso":
            return "ISO 8601"
        if self.kind in ("clock", "minutes"):
            return "a time of day" if self.kind == "clock" else "minutes and seconds"
        words = {"%d": "day", "%m": "month", "%Y": "year", "%y": "year", "/": "/"}
        text = self.order
        for code, word in words.items():
            text = text.replace(code, word)
        return text


def looks_like_date(text: str) -> bool:
    """Whether a cell is a date, a time of day, or both."""
    text = text.strip()
    if ":" not in text and len(text) < 6:
        return False
    return any(one.fullmatch(_plain(text)) for one in (_ISO, _OTHER, _TIME_OF_DAY, _MINUTES))


def style_of(cells: Sequence[str]) -> DateStyle | None:
    """How these cells write dates, ``None`` where they do not or do it in several ways."""
    stripped = [cell.strip() for cell in cells]
    written = [cell for cell in stripped if cell and not NEVER.fullmatch(cell)]
    if not written or all(map(_FRAMES.fullmatch, written)):
        return None
    plain = [*map(_plain, written)]
    style = _style_of(plain)
    return replace(style, rare=True) if style and plain != written else style


def _style_of(cells: Sequence[str]) -> DateStyle | None:
    for pattern, kind in ((_ISO, "iso"), (_TIME_OF_DAY, "clock"), (_MINUTES, "minutes")):
        if all(map(pattern.fullmatch, cells)):
            return DateStyle(kind)
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

    A date that was not known, such as 0000-00-00, is the lowest number there is.

    Args:
        cells: a list or pandas series of text.
        style: how they are written.
    """
    import pandas as pd

    series = pd.Series([*map(_plain, cells)] if style.rare else cells, dtype="str").str.strip()
    never = series.str.fullmatch(NEVER.pattern)
    if never.any():
        full = np.full(len(series), NOT_KNOWN)
        known = nanoseconds(series[~never].tolist(), style) if not never.all() else full[:0]
        if known is None:
            return None
        full[~never.to_numpy()] = known
        return full
    series = series.str.replace(r",(\d{1,9})(?=\D*$)", r".\1", regex=True)
    try:
        if style.kind == "iso":
            series = series.str.replace(r"\s*UTC$", "Z", regex=True)
            stamps = pd.to_datetime(series, format="ISO8601", utc=True)
        elif style.kind == "clock":
            return _of_day(series)
        elif style.kind == "minutes":
            return _of_day("0:" + series)
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
    parts = series.str.extract(
        r"^(\d{1,2}):(\d{1,3})(?::([0-5]\d)(?:\.(\d{1,9}))?)?\s*([AaPp][Mm])?$"
    )
    if parts[0].isna().any():
        return None
    hours, minutes = parts[0].astype(np.int64), parts[1].astype(np.int64)
    seconds = parts[2].fillna("0").astype(np.int64)
    fraction = parts[3].fillna("0").str.ljust(9, "0").astype(np.int64)
    half = parts[4].fillna("").str.lower()
    if ((half != "") & ((hours > 12) | (hours < 1))).any():
        return None
    hours = hours.where(half == "", hours % 12 + 12 * (half == "pm"))
    total = ((hours * 60 + minutes) * 60 + seconds) * 1_000_000_000 + fraction
    return np.asarray(total, dtype=np.int64)


def iso(nanoseconds_since_1970: int) -> str:
    """An instant as ISO 8601 with microseconds, without a zone."""
    stamp = np.datetime64(int(nanoseconds_since_1970), "ns")
    return str(stamp.astype("datetime64[us]"))
