"""Tables in a terminal: nothing is left out at any width."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simcompare.cli.console import Rows
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.render.text_tables import lines

#: letters on a line, from the narrowest terminal to a wide one
WIDTHS = st.integers(60, 200)


@st.composite
def tables(draw):
    """A table of unique words of up to 20 letters, so that each can be looked for."""
    counts = [draw(st.integers(1, n)) for n in (9, 3, 3)]
    columns, groups, rows = counts

    def cell(*place):
        sizes = draw(st.lists(st.integers(1, 20), min_size=0, max_size=5))
        heads = ["w" + "_".join(map(str, (*place, k))) for k in range(len(sizes))]
        return " ".join(head.ljust(size, "x") for head, size in zip(heads, sizes, strict=True))

    return Table(
        "",
        tuple(
            Column(
                cell("h", i),
                text=draw(st.booleans()),
                spare=draw(st.booleans()),
                nowrap=draw(st.booleans()),
                over=draw(st.sampled_from(["", "over"])),
            )
            for i in range(columns)
        ),
        tuple(
            Group(
                draw(st.sampled_from(["", f"title{g}"])),
                tuple(tuple(cell(g, r, c) for c in range(columns)) for r in range(rows)),
                draw(st.sampled_from(["", f"note{g}"])),
            )
            for g in range(groups)
        ),
    )


@settings(max_examples=200)
@given(tables(), WIDTHS)
def test_every_word_of_every_cell_is_shown_and_no_line_is_too_long(table, width):
    shown = list(lines(table, width))
    assert max(map(len, shown)) <= width
    words = " ".join(shown).split()
    cells = [cell for group in table.groups for row in group.rows for cell in row]
    for text in (*cells, *(column.head for column in table.columns)):
        assert set(text.split()) <= set(words)


@pytest.mark.parametrize("width", [60, 80])
def test_columns_without_room_stand_below_beside_the_same_first_column(width):
    rows = Rows("engine", *(f"quantity{i}" for i in range(12)))
    rows.add_row("mujoco", *(f"{i}.123456" for i in range(12)))
    shown = list(lines(rows.table, width))
    heads = [line for line in shown if line.startswith("engine")]
    assert len(heads) == sum(line.startswith("mujoco") for line in shown) > 1
    assert shown.count("") == len(heads) - 1


def test_what_is_wide_enough_is_one_table():
    rows = Rows("engine", "value")
    rows.add_row("mujoco", "0.5")
    rows.add_row("ode", "–")
    rows.add_row("dart")
    assert list(lines(rows.table, 80)) == [
        "engine  value",
        "─────────────",
        "mujoco    0.5",
        "ode         –",
        "dart",
    ]


def test_a_cell_of_several_lines_keeps_them():
    rows = Rows("engine", "number")
    rows.add_row("ode\n0.16", "bounce\n0.8")
    assert list(lines(rows.table, 80))[2:] == ["ode     bounce", "0.16    0.8"]


def test_a_value_and_its_uncertainty_stay_on_one_line():
    rows = Rows("engine", *(f"quantity{i}" for i in range(4)))
    rows.add_row("mujoco", *["(1.50 ± 0.43)·10⁻⁴"] * 4)
    shown = "\n".join(lines(rows.table, 60))
    assert shown.count("(1.50 ± 0.43)·10⁻⁴") == 4


def test_sentences_are_wrapped_before_columns_are_parted():
    table = Table("", (Column("name", text=True), Column("what it is", text=True)),
                  (Group("", (("restitution", "how much of its speed " * 6),)),))  # fmt: skip
    shown = list(lines(table, 60))
    assert sum(line.startswith("name") for line in shown) == 1
    assert max(map(len, shown)) <= 60


def test_a_word_that_is_wider_than_the_terminal_is_broken():
    rows = Rows("file")
    rows.add_row("x" * 150)
    shown = list(lines(rows.table, 60))
    assert max(map(len, shown)) <= 60
    assert "".join(shown[2:]) == "x" * 150
