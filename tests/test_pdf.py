"""The PDF report: everything that the page holds, and nothing cut off."""

import pytest

from simcompare.reports import builder, pages
from simcompare.reports.render.paper import LEFT, SIZE, WIDTH, Type
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, Table
from tests.test_report_pages import block, read
from tests.test_reports import AGAINST, RUNS, make_run


def texts(drawn):
    return [text.get_text() for one in drawn for text in one.texts]


@pytest.mark.parametrize("name", ["both modes", "against", "one failed", "nothing ran"])
def test_every_word_of_the_page_is_in_the_pdf(name):
    blocks = builder.blocks_of([RUNS[name]])
    written = {word.rstrip(":") for text in texts(pages.document(blocks)) for word in text.split()}
    shown = {word.rstrip(":") for word in read(RUNS[name]).all}
    assert shown - written <= {""}


def test_every_figure_of_the_page_is_in_the_pdf():
    (one,) = builder.blocks_of([make_run(against=AGAINST)])
    drawn = pages.document([one])
    assert sum(bool(each.subfigs) for each in drawn) == len(one.figures)
    assert {figure.title for figure in one.figures} <= set(texts(drawn))


def test_pages_are_numbered_through_and_name_the_run():
    drawn = pages.document(builder.blocks_of([make_run(), make_run(truth=None)]))
    for number, one in enumerate(drawn, start=1):
        assert [t.get_text() for t in one.texts][-2:] == [
            "A toy <scene> – run", f"{number} / {len(drawn)}",
        ]  # fmt: skip


def test_nothing_is_cut_off_at_the_edges_of_a_page():
    words = ("a long sentence " * 9, "W" * 300, "0.123456 ± 0.000001")
    columns = tuple(Column(f"head {i}", text=i % 2 == 0) for i in range(14))
    rows = tuple(tuple(words[i % 3] for i in range(14)) for _ in range(3))
    notes = (" ".join(words),)
    table = Table("", columns, (Group("", rows),))
    drawn = pages.document([block(Part("", notes=notes, tables=(table,)))])
    left, right = LEFT * 72 - 1, (LEFT + WIDTH) * 72 + 1
    for one in drawn:
        one.set_dpi(720)  # else letters are as wide as whole pixels
        one.draw_without_rendering()
        boxes = [text.get_window_extent() for text in one.texts if text.get_text()]
        scale = 72 / one.dpi
        assert all(left <= scale * box.x0 and scale * box.x1 <= right for box in boxes)
        assert all(box.y0 * scale > 0 and box.y1 * scale < SIZE[1] * 72 for box in boxes)


def test_a_table_that_is_too_wide_goes_on_below_with_its_first_column():
    columns = (Column("name", text=True), *(Column(f"head{i}") for i in range(20)))
    row = ("north", *(f"{i}.000000 ± 0.000001" for i in range(20)))
    table = Table("", columns, (Group("", (row,)),))
    found = list(pages.pieces(table))
    assert len(found) > 1
    assert all(0 in piece for piece in found)
    assert sorted(i for piece in found for i in piece if i) == list(range(1, 21))
    written = texts(pages.document([block(Part("", tables=(table,)))]))
    assert set(row) | {column.head for column in columns} <= set(written)


def test_the_heads_of_a_table_stand_on_each_of_its_pages():
    rows = tuple((str(i), "x") for i in range(120))
    table = Table("", (Column("number"), Column("letter")), (Group("", rows),))
    drawn = pages.document([block(Part("", tables=(table,)))])
    assert len(drawn) > 2
    assert all("letter" in texts([one]) for one in drawn)


@pytest.mark.parametrize("count", [0, 10, 20, 30])
def test_a_heading_stands_on_the_page_of_its_figure(count):
    (figure,) = builder.blocks_of([make_run()])[0].part("energy").figures
    parts = Part("", "a", notes=("A sentence.",) * count), Part("Alone", "b", figures=(figure,))
    (page,) = [one for one in pages.document([block(*parts)]) if "Alone" in texts([one])]
    assert page.subfigs
    assert figure.title in texts([page])


def test_lines_are_as_long_as_they_are_wide():
    small = Type(10)
    assert small.width("ii") < small.width("WW")
    lines = small.wrapped("some words and " + "W" * 100, 1.0)
    assert all(small.width(line) <= 1.0 for line in lines)
    assert "".join(lines).replace(" ", "") == "somewordsand" + "W" * 100
    assert small.wrapped("", 1.0) == [""]


def test_what_few_readers_want_is_set_smaller():
    table = Table("", (Column("name", text=True),), (Group("", (("north",),)),))
    sizes = {}
    for brief in (True, False):
        drawn = pages.document([block(Part("The answer"), Part("", tables=(table,), brief=brief))])
        (text,) = [one for page in drawn for one in page.texts if one.get_text() == "north"]
        sizes[brief] = text.get_size()
    assert 6 <= sizes[False] < sizes[True]
