"""Tables of measured bounces: what is good is read, what is not is told with its line."""

from __future__ import annotations

import math
import re

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from simcompare.errors import InputError, UnknownName
from simcompare.hardware.recordings import bounce_table, published
from simcompare.scenarios import catalogue

KNOWN = {"impact_time": "s", "impact_speed": "m/s", "restitution": "1", "rebound_height": "m"}
GOOD = """\
# title: A ball
# citation: A. Author, Journal 1 (2020) 2
# preset: table_tennis
# drop_height: 31.5 cm
# any other remark
bounce,rebound_height_cm,u_rebound_height_cm,restitution,restitution_low,restitution_high
1,24.4,0.2,0.88,0.87,0.89
2,18.9,0.3,,,
"""


@pytest.fixture
def table(write):
    def load(text):
        return bounce_table.read(write("table.csv", text), KNOWN)

    return load


@pytest.fixture
def faults(table):
    def of(text):
        with pytest.raises(InputError) as error:
            table(text)
        assert "table.csv" in str(error.value)
        return error.value.faults

    return of


def numbers(found):
    return [(q.name, q.bounce, q.value, q.u, q.low, q.high) for q in found.quantities]


def test_a_good_table_is_read_in_si_with_its_head(table):
    found = table(GOOD)
    assert found.head["citation"] == "A. Author, Journal 1 (2020) 2"
    assert found.preset == "table_tennis"
    assert found.parameters == {"drop_height": "31.5 cm"}
    first, second, third = found.quantities
    assert (first.name, first.bounce, first.low) == ("rebound_height", 1, None)
    assert (first.value, first.u) == (pytest.approx(0.244), pytest.approx(0.002))
    assert (second.name, second.low, second.high) == ("restitution", 0.87, 0.89)
    assert second.u == pytest.approx(0.01 / math.sqrt(3)), "limits mean a rectangle"
    assert (third.name, third.bounce, third.value) == ("rebound_height", 2, pytest.approx(0.189))


@pytest.mark.parametrize("separator", [",", ";", "\t", " ; ", ", "])
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_separators_line_ends_and_byte_order_mark(table, separator, newline, mark):
    head, _, body = GOOD.partition("bounce,")
    text = mark + head + "bounce,".replace(",", separator) + body.replace(",", separator)
    assert numbers(table(text.replace("\n", newline))) == numbers(table(GOOD))


@pytest.mark.parametrize(
    "heading",
    [
        "rebound_height_cm",
        "rebound_height [cm]",
        "rebound height [cm]",
        "rebound height (cm)",
        "rebound-height[cm]",
        '"rebound height [cm]"',
    ],
)
def test_a_unit_stands_in_the_name_or_in_brackets(table, heading):
    assert table(f"bounce,{heading}\n1,24.4\n").quantities[0].value == pytest.approx(0.244)


def test_the_units_of_names_are_those_of_the_project(table):
    """``impact_speed_m_s`` is how simcompare itself writes a speed."""
    for heading in ("impact_speed [m/s]", "impact_speed_m/s", "impact_speed_m_s"):
        assert table(f"bounce,{heading}\n1,2.4\n").quantities[0].value == 2.4


def test_uncertainties_and_limits_have_their_own_units(table):
    found = table(
        "bounce,rebound_height_cm,u_rebound_height_mm,impact_time [ms],impact_time low [ms],"
        "impact_time high [s]\n1,24.4,2,250,249,0.251\n"
    )
    height, instant = found.quantities
    assert height.u == pytest.approx(0.002)
    assert (instant.low, instant.high) == (pytest.approx(0.249), pytest.approx(0.251))


def test_rows_without_a_number_of_the_bounce_are_counted(table):
    found = table("rebound_height_cm\n24\n18\n14\n")
    assert [q.bounce for q in found.quantities] == [1, 2, 3]


def test_rows_are_counted_and_not_the_numbers_in_them(table):
    found = table("restitution,rebound_height_cm\n0.8,64\n0.8,41\n")
    assert [(q.name, q.bounce) for q in found.quantities] == [
        ("restitution", 1),
        ("rebound_height", 1),
        ("restitution", 2),
        ("rebound_height", 2),
    ]
    found = table("restitution,rebound_height_cm\n,64\n,\n,26\n")
    assert [q.bounce for q in found.quantities] == [1, 3], "a bounce that was missed is a bounce"


@pytest.mark.parametrize(
    ("text", "line", "expected"),
    [
        ("bounce,rebound_height_kg\n1,2\n", 1, "the unit 'kg' does not fit"),
        ("bounce,rebound_height_furlnog\n1,2\n", 1, "is not a unit"),
        ("# x\nbounce,rebound_hight_cm\n1,2\n", 2, "did you mean rebound_height"),
        ("bounce,rebound_height\n1,2\n", 1, "has no unit"),
        ("bounce,restitution\n1,high\n", 2, "'high' is not a number"),
        ("bounce;restitution\n1;0,8,8\n", 2, "is not a number"),
        ("bounce,restitution\n1,0.8\n1,0.7\n", None, "stands more than once"),
        ("bounce,restitution\n1,0.8\n2,0,88\n", 3, "3 cells but the header has 2"),
        ("bounce,restitution\n\n1\n", 3, "1 cells but"),
        ("bounce,restitution,u_restitution\n1,0.8,-0.1\n", 2, "must be above 0"),
        ("bounce,restitution,u_restitution\n1,0.8,0\n", 2, "must be above 0"),
        ("bounce,restitution,u_restitution\n1,0.8,1e-300\n", 2, "nothing is measured that finely"),
        ("bounce,restitution\n1,nan\n", 2, "not finite"),
        ("bounce,restitution\n1,1e999\n", 2, "not finite"),
        ("bounce,restitution\n0,0.8\n", 2, "numbered 1, 2, 3"),
        ("bounce,restitution\n1.5,0.8\n", 2, "found 1.5"),
        ("bounce,restitution,restitution_low,restitution_high\n1,.9,.7,.8\n", 2, "not within 0.7"),
        ("bounce,restitution,restitution_low,restitution_high\n1,.7,.8,.6\n", 2, "not within"),
        ("bounce\n1\n", 1, "no measured quantity"),
        ("bounce,u_restitution\n1,0.1\n", 1, "no measured quantity"),
    ],
)
def test_a_fault_is_told_with_its_line(faults, text, line, expected):
    (fault,) = faults(text)
    assert line is None or re.match(rf"line {line}\b", fault), fault
    assert expected in fault


def test_all_faults_come_together(faults):
    found = faults("bounce,restitution\n1,x\n2,0.8,9\n3,nan\n0,0.8\n")
    assert [fault.split(":")[0] for fault in found] == ["line 2", "line 3", "line 4", "line 5"]
    assert len(faults("bounce,hight_m,restitution_kg\n1,1,1\n")) == 2


@pytest.mark.parametrize(
    "text",
    ["", "\n \n", "# title: x\n", "bounce,restitution\n", "bounce,restitution\n1,\n"],
)
def test_a_table_without_values_says_so(faults, text):
    assert "no measured values" in faults(text)[0]


def test_text_that_is_not_utf8_is_told(faults):
    assert "CSV UTF-8" in faults("bounce,höhe (m)\n1,1\n".encode("latin-1"))[0]


@pytest.mark.parametrize(
    "text",
    [
        "bounce,restitution,restitution_low\n1,0.8,0.7\n",
        "bounce,rebound_height_cm,u_restitution\n1,64,0.1\n",
    ],
    ids=["one limit", "u of nothing"],
)
def test_a_number_that_would_not_be_used_is_told(faults, text):
    faults(text)


def test_a_column_that_stands_twice_is_told(faults):
    """Else the last one wins, and is counted twice."""
    (fault,) = faults("bounce,rebound_height_cm,rebound_height_mm\n1,64,650\n")
    assert "rebound_height" in fault


@pytest.mark.parametrize(
    "heading",
    ["restitution [1/0]", "restitution [)]", "restitution [__import__('os')]", "9" * 140_000],
    ids=["division", "bracket", "call", "long"],
)
def test_a_heading_that_is_nonsense_is_told_with_its_line(faults, heading):
    (fault,) = faults(f"bounce,{heading}\n1,0.8\n")
    assert fault.startswith("line 1")


def test_a_missing_unit_is_asked_for_with_one_that_fits(faults):
    (fault,) = faults("bounce,impact_speed\n1,2\n")
    assert "m/s" in fault
    assert "_cm" not in fault, "a speed is not given in centimetres"


def test_the_head_is_no_place_for_surprises(table):
    """A remark with a colon is a remark, unless it names what the head can hold."""
    assert table("# drop height: 3 cm\n" + GOOD).parameters == {"drop_height": "31.5 cm"}
    assert table("# https://example.invalid\n" + GOOD).parameters == {"drop_height": "31.5 cm"}


LETTERS = st.sampled_from([*",;\t\n\r#[]()\"' ._-+*/%=:0123456789eE", "nan", "inf", "_cm", "m",
                           "_low", "u_", "bounce", "restitution", "\ufeff", "\0", "é", "²",
                           "\u2028"])  # fmt: skip
EDITS = st.lists(
    st.tuples(st.integers(0, len(GOOD) - 1), st.integers(0, 6), st.lists(LETTERS, max_size=3)),
    min_size=1,
    max_size=6,
)


@settings(
    max_examples=400,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(EDITS)
def test_any_damage_is_read_or_told_and_never_a_crash(tmp_path, edits):
    text = GOOD
    for place, gone, new in edits:
        text = text[:place] + "".join(new) + text[place + gone :]
    path = tmp_path / "fuzz.csv"
    path.write_bytes(text.encode())
    try:
        found = bounce_table.read(path, KNOWN)
    except InputError:
        return
    assert found.quantities
    for quantity in found.quantities:
        assert quantity.name in KNOWN
        assert quantity.bounce >= 1
        assert math.isfinite(quantity.value)
        assert quantity.u is None or 0 < quantity.u < math.inf


@settings(
    max_examples=100,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(st.binary(max_size=200))
def test_any_bytes_are_told(tmp_path, raw):
    path = tmp_path / "fuzz.csv"
    path.write_bytes(raw)
    with pytest.raises(InputError):
        bounce_table.read(path, KNOWN)


@pytest.mark.parametrize("name", sorted(published.tables()))
def test_every_published_fact_is_read_and_says_where_it_is_from(name):
    found = bounce_table.read(bounce_table.find(name), KNOWN)
    assert found.quantities
    assert len(found.head["citation"]) > 20
    assert found.head["seen"]
    assert found.head["title"]
    assert all(q.u is not None or q.low is not None for q in found.quantities)
    ball = catalogue.load("ball")
    values = ball.read_settings(dict(found.parameters))
    assert "drop_height_m" in values
    ball.resolve(values, preset=found.preset)


def test_a_table_is_found_by_file_before_name_and_else_the_nearest_is_named(write, monkeypatch):
    name = "itf_tennis_rebound"
    assert bounce_table.find(name).suffix == ".csv"
    own = write(name, GOOD)
    monkeypatch.chdir(own.parent)
    assert bounce_table.find(name).resolve() == own
    with pytest.raises(UnknownName, match="did you mean itf_tennis_rebound"):
        bounce_table.find("itf_tenis_rebound")
    with pytest.raises(UnknownName):
        bounce_table.find("x" * 5000)


def test_limits_alone_are_a_measurement(table):
    (found,) = table("bounce,rebound_height_low_cm,rebound_height_high_cm\n1,24,26\n").quantities
    assert (found.value, found.low, found.high) == pytest.approx((0.25, 0.24, 0.26))


@pytest.mark.parametrize("separator", [";", "\t"])
def test_a_decimal_comma_is_read_where_it_can_be_nothing_else(table, separator):
    text = separator.join(("bounce", "rebound_height_cm", "u_rebound_height_cm"))
    found = table(text + "\n" + separator.join(("1", "61,5", "0,5")) + "\n").quantities
    assert (found[0].value, found[0].u) == pytest.approx((0.615, 0.005))
