"""Rows of damaged and of very large text tables: marks, lines that are no rows, pieces."""

from __future__ import annotations

import io

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import mapping
from simcompare.hardware.logs import importers
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text import state as _state


@pytest.fixture
def read(tmp_path):
    def of(text):
        path = tmp_path / "log.csv"
        path.write_bytes(text.encode())
        return importers.read(path, "csv", mapping.NOTHING)

    return of


def faults(read, text):
    with pytest.raises(InputError) as error:
        read(text)
    return " | ".join(error.value.faults)


def rows(count, mark=","):
    return "".join(f"{i};{1 + i / 1000:.4f}\n".replace(".", mark) for i in range(count))


def test_one_odd_number_does_not_make_decimal_commas_marks_of_thousands(read):
    text = "t;x\n" + rows(50) + "50;1,791,7925\n" + rows(3)
    assert "line 52, column 'x': '1,791,7925' is not a number with a decimal comma" in faults(
        read, text
    )


def test_commas_for_decimals_and_for_thousands_in_one_log_are_refused(read):
    text = "t;x\n" + rows(20) + "20;1,234,567\n"
    assert "commas stand for decimals in some numbers and for thousands in others" in faults(
        read, text
    )


def test_marks_of_thousands_are_not_taken_out_where_they_are_none(read):
    text = "t;x\n" + "".join(f"{i};1,234.5\n" for i in range(1200))
    assert read(text).streams[0].columns[1].values[7] == 1234.5
    for odd in ("1,5003", "12345,678", "0,123"):
        assert f"line 1202, column 'x': '{odd}'" in faults(read, f"{text}1200;{odd}\n")


def test_a_line_of_a_megabyte_is_no_row(read):
    text = "t,x\n" + "".join(f"{i},1\n" for i in range(1500)) + "0," * (1 << 20) + "\n"
    assert "line 1502: has 2097152 bytes, which is no row of a table" in faults(read, text)


@pytest.mark.parametrize("end", ["100,", ""])
def test_a_text_is_given_in_blocks_of_whole_lines(monkeypatch, end):
    monkeypatch.setattr(_source, "BLOCK_BYTES", 30)
    text = "".join(f"{i},1\n" for i in range(100)) + end
    source = _source.opened("log", lambda: io.BytesIO(text.encode()))
    for first in (1, 2, 8, 95, 100):
        blocks = list(_source.blocks(source, first))
        assert len(blocks) == 1 or max(len(block.lines) for block in blocks) < 15
        assert [block.ended for block in blocks] == [True] * (len(blocks) - 1) + [not end]
        lines = [pair for block in blocks for pair in enumerate(block.lines, start=block.line)]
        assert lines == list(enumerate(text.splitlines(), start=1))[first - 1 :]


def test_lines_that_are_no_rows_leave_the_others_their_numbers(read):
    text = "\n".join(["t,x", "0,1", "", "", "1,2", "# restart", "2,3", "3,4", ""]) + "\n\n\n"
    found = read(text)
    assert found.streams[0].rows.tolist() == [2, 5, 7, 8]
    told = {repair.rule: repair for repair in found.repairs}
    assert (told["blank_line"].rows, told["blank_line"].count) == (((3, 4), (9, 11)), 5)
    assert told["comment_line"].rows == ((6, 6),)


def test_rows_are_numbered_as_if_each_skipped_line_were_named():
    chance = np.random.default_rng(2)
    for _ in range(50):
        first, count = 5, 60
        gone = np.flatnonzero(chance.random(80) < 0.4) + first
        state = _state.State()
        for line in gone.tolist():
            state.skip("blank_line" if line % 3 else "comment_line", line)
        kept = np.setdiff1d(np.arange(first, first + 300), gone)[:count]
        rows_ = state.rows(first, count)
        assert (
            kept.tolist() == (np.arange(first, first + count) if rows_ is None else rows_).tolist()
        )


def test_a_million_empty_lines_are_one_stretch():
    lines = _state.Lines()
    for line in range(3, 1_000_003):
        lines.add(line)
    assert (len(lines), lines.runs().tolist()) == (1_000_000, [[3, 1_000_002]])
