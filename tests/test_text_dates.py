"""Times as people and programs write them: every way gives the same seconds."""

from __future__ import annotations

import datetime

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import importing
from simcompare.hardware.mapping import NOTHING

START = datetime.datetime(2024, 5, 17, 11, 59, 59, 800_000)
COUNT = 60


@pytest.fixture
def read(tmp_path):
    def of(stamps, name="time"):
        lines = [f"{name},x (m)", *(f"{stamp},{i}" for i, stamp in enumerate(stamps))]
        (tmp_path / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        return importing.read(tmp_path / "log.csv", NOTHING)

    return of


def moments(start=START, count=COUNT):
    return [start + datetime.timedelta(milliseconds=10 * i) for i in range(count)]


def rules(recording):
    return {repair.rule for repair in recording.provenance.repairs}


@pytest.mark.parametrize(
    "written",
    [
        "%Y-%m-%dT%H:%M:%S.{ms}Z", "%Y-%m-%dT%H:%M:%S.{ms}+02:00", "%Y-%m-%d %H:%M:%S.{ms}+02",
        "%Y-%m-%d %H:%M:%S.{ms}", "%Y-%m-%d %H:%M:%S:{ms}", "%Y-%m-%d_%H:%M:%S.{ms}",
        "%Y-%m-%d.%H:%M:%S.{ms}", "%Y:%m:%d %H:%M:%S.{ms}", "%Y/%m/%d %H:%M:%S.{ms}",
        "%Y%m%dT%H%M%S.{ms}", "%Y%m%d_%H%M%S.{ms}", "%d.%m.%Y %H:%M:%S.{ms}",
        "%d-%b-%Y %H:%M:%S.{ms}", "%d %B %Y %H:%M:%S.{ms}", "%b %d %Y %H:%M:%S.{ms}",
        "%a %b %d %H:%M:%S.{ms} %Y", "%m/%d/%Y %I:%M:%S.{ms} %p", "%m/%d/%Y %I:%M:%S.{ms} p.m.",
        "%H:%M:%S.{ms}", "%H:%M:%S:{ms}", "%I:%M:%S.{ms} %p", "%M:%S.{ms}",
    ],
)  # fmt: skip
def test_every_way_of_writing_gives_the_same_seconds(read, written):
    late = START.replace(hour=12, minute=30) if "p.m." in written else START
    stamps = [m.strftime(written).format(ms=f"{m.microsecond // 1000:03d}") for m in moments(late)]
    (stream,) = read(stamps).streams.values()
    # a nanosecond is what dates are counted in
    assert stream.time_s == pytest.approx(0.01 * np.arange(COUNT), abs=1e-9)
    start = stream.clock.start
    assert start == "" or start.startswith("2024-05-17T")


def test_milliseconds_behind_a_colon_need_no_zeros(read):
    stamps = [f"{m:%H:%M:%S}:{m.microsecond // 1000}" for m in moments()]
    (stream,) = read(stamps).streams.values()
    assert stream.time_s == pytest.approx(0.01 * np.arange(COUNT), abs=1e-9)


def test_two_digits_behind_a_colon_may_be_frames_of_a_film(read):
    stamps = [f"{m:%H:%M:%S}:{m.microsecond // 10_000:02d}" for m in moments()]
    with pytest.raises(InputError):
        read(stamps)


def test_minutes_go_on_after_the_hour(read):
    made = read([f"{m:%M:%S}.{m.microsecond // 1000:03d}" for m in moments()])
    assert {"time_of_day", "midnight"} <= rules(made)


def test_dates_that_were_not_known_are_no_time(read):
    with pytest.raises(InputError, match="no column is a time"):
        read(["0000-00-00 00:00:00"] * COUNT)


@pytest.mark.parametrize(("name", "since"), [("date", 25_569), ("time", 25_569), ("time", 719_529)])
def test_day_numbers_of_spreadsheets_and_matlab(read, name, since):
    days = since + START.replace(tzinfo=datetime.UTC).timestamp() / 86_400
    (stream,) = read(
        [f"{days + 0.01 * i / 86_400:.12f}" for i in range(COUNT)], name
    ).streams.values()
    # a float holds such numbers to 1.2e-10 days, 1e-5 s
    assert stream.time_s == pytest.approx(0.01 * np.arange(COUNT), abs=1.1e-5)
    assert stream.clock.start.startswith("2024-05-17T11:59:59.")


def test_large_numbers_that_are_no_days_stay_seconds(read):
    (stream,) = read([f"{45_429 + 0.01 * i:.2f}" for i in range(COUNT)]).streams.values()
    assert stream.time_s[-1] == pytest.approx(0.59)


@pytest.mark.parametrize("skip", [0, 2, 3])
def test_a_time_in_parts_is_put_together(tmp_path, skip):
    names = "year,month,day,hour,minute,second,x (m)"
    form = "%Y,%m,%d,%H,%M,%S."
    lines = [",".join(names.split(",")[skip:])]
    for i, m in enumerate(moments(START.replace(hour=23))):
        cells = (m.strftime(form) + f"{m.microsecond // 1000:03d}").split(",")[skip:]
        lines.append(",".join([*cells, str(i)]))
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (stream,) = importing.read(tmp_path / "log.csv", NOTHING).streams.values()
    # seconds since 1970 in a float
    assert stream.time_s == pytest.approx(0.01 * np.arange(COUNT), abs=1e-6)
    assert "x_m" in stream.channels


def test_an_update_is_no_date(read):
    with pytest.raises(InputError, match="update time"):
        read([30_000 + 10 * i for i in range(50)], name="update time")


def test_a_board_that_restarts_after_86_4_s_is_no_midnight(read):
    stamps = [*range(864), *range(400)]
    log = read([f"{stamp / 10:.1f}" for stamp in stamps], name="t (s)")
    assert len(log.streams) == 2
