"""Tables that number their bounces: intervals, instants and heights are believed as they stand."""

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.fitting.bounces import model_selection, ratios, tables
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.likelihood import COVERAGE
from simcompare.fitting.bounces.reading import drops_of
from simcompare.fitting.bounces.tables import from_intervals
from tests.bounces import TRUTH, heard, times_of, warnings_of

INTERVALS = np.diff(times_of(count=9))
COLUMN = "\n".join(f"{n},{one:.9E}" for n, one in enumerate(INTERVALS, start=1))


@pytest.fixture
def drop_in(write):
    def read(text, u_s=None):
        (drop,) = drops_of(write("table.csv", text), None, u_s, 9.80665)
        return drop

    return read


# ---- how telephones write it --------------------------------------------------------------------


@pytest.mark.parametrize(
    "head",
    ['"Bounce","Time interval (s)"', "bounce,interval_s", "n,T (s)", '"#",Δt [s]', "No.,dt (s)",
     "Bounce number,Time between bounces (s)", "number,Flight time (s)"],
)  # fmt: skip
def test_a_column_of_intervals_is_read_whatever_it_is_called(drop_in, head):
    drop = drop_in(f"{head}\n{COLUMN}\n")
    assert drop.kind == "time intervals"
    assert drop.intervals_s == pytest.approx(INTERVALS, rel=1e-9)
    assert drop.interval_numbers == (1, 2, 3, 4, 5, 6, 7, 8)
    assert not drop.u_known
    assert drop.count == 9


@pytest.mark.parametrize("name", ["Interval {} (s)", "T{} (s)", "dt_{} [s]", "time interval {}(s)"])
def test_a_row_of_numbered_intervals_is_the_same(drop_in, name):
    heads = ";".join(f'"{name.format(n)}"' for n in range(1, 9))
    cells = ";".join(f"{one:.9f}".replace(".", ",") for one in INTERVALS)
    drop = drop_in(f"{heads}\n{cells}\n")
    assert drop.intervals_s == pytest.approx(INTERVALS, abs=1e-9)
    assert drop.interval_numbers == (1, 2, 3, 4, 5, 6, 7, 8)


def test_intervals_without_numbers_are_counted(drop_in):
    drop = drop_in("Time interval (ms)\n" + "\n".join(f"{1e3 * one:.6f}" for one in INTERVALS))
    assert drop.intervals_s == pytest.approx(INTERVALS, abs=1e-9)
    assert drop.interval_numbers == (1, 2, 3, 4, 5, 6, 7, 8)


def test_an_uncertainty_is_that_of_the_table_or_of_the_user(drop_in):
    text = "bounce,interval_s,u_interval_ms\n1,0.7,0.2\n2,0.6,0.3\n"
    assert drop_in(text).u_intervals_s == pytest.approx([2e-4, 3e-4])
    assert drop_in(text, u_s=1e-3).u_intervals_s == pytest.approx([1e-3, 1e-3])


def test_a_log_with_a_number_in_front_is_no_table_of_bounces(write):
    for head in ("n,t (s),y (m)", '"Bounce 0 (s)","Height 0 (m)"', "#,temperature (K)", "time,y_m"):
        assert not tables.is_table(write("log.csv", f"{head}\n1,2,3\n"))


# ---- numbers are believed -----------------------------------------------------------------------


def test_what_is_numbered_is_neither_left_out_nor_numbered_anew(drop_in):
    """One impact far off its place would be an outlier among impacts that were heard."""
    times = times_of(count=9)
    times[0] -= 0.05
    rows = "\n".join(f"{n},{one:.6f}" for n, one in enumerate(times, start=1))
    drop = drop_in(f"bounce,impact_time_s\n{rows}\n")
    assert (drop.numbers, drop.dropped, drop.missed) == (tuple(range(1, 10)), (), ())
    assert drop.times_s == pytest.approx(times, abs=1e-6)


def test_a_missing_number_is_missing(drop_in):
    rows = COLUMN.split("\n")
    drop = drop_in("bounce,interval_s\n" + "\n".join([*rows[1:3], "4,", *rows[5:]]))
    assert drop.interval_numbers == (2, 3, 6, 7, 8)
    assert drop.notes == ("the table has no interval 4, 5",)
    found = fit(drop)
    assert found.as_dict()["restitution"] == pytest.approx(0.85, abs=1e-6)
    assert found.as_dict()["drop_height_m"] == pytest.approx(1.0, abs=1e-5)


def test_impacts_may_begin_late(drop_in):
    rows = "\n".join(f"{n},{one:.9f}" for n, one in enumerate(times_of(count=9), start=1) if n > 2)
    drop = drop_in(f"Bounce,Time (s)\n{rows}\n")
    assert drop.numbers == (3, 4, 5, 6, 7, 8, 9)
    assert fit(drop).as_dict()["drop_height_m"] == pytest.approx(1.0, abs=1e-5)


def test_a_height_of_number_0_is_the_drop(drop_in):
    drop = drop_in(
        "bounce,rebound_height_cm,u_rebound_height_cm\n0,100,0.1\n1,72.3,0.2\n3,38,0.2\n"
    )
    assert drop.height_numbers == (0, 1, 3)
    assert drop.missed == (2,)
    assert drop.u_heights_m == pytest.approx([1e-3, 2e-3, 2e-3])


# ---- what they give -----------------------------------------------------------------------------


def test_intervals_give_the_ball_and_no_release():
    found = fit(from_intervals(INTERVALS, 1e-4), "constant")
    assert found.names == ("restitution", "drop_height_m")
    assert found.values == pytest.approx([0.85, 1.0], abs=1e-5)


def test_intervals_with_errors_of_their_own_cover_the_truth_at_the_rate_that_is_stated():
    """120 draws: 95 % ± 2 %, so 89 % and more are within three standard deviations."""
    generator = np.random.default_rng(5)
    inside = np.zeros(2)
    for _ in range(120):
        drop = from_intervals(INTERVALS + generator.normal(0, 8e-5, 8))
        found = fit(drop, "constant", profiles=False)
        # six degrees of freedom tell the scatter: Student's 2.45 in place of 1.96
        inside += np.abs(found.values - [0.85, 1.0]) < 2.447 * found.u
    assert np.all(np.abs(inside / 120 - 0.95) < 0.06)


def test_intervals_out_of_instants_are_stated_too_wide_and_never_too_narrow():
    generator = np.random.default_rng(6)
    errors, stated = [], []
    for _ in range(100):
        drop = from_intervals(np.diff(times_of(count=9) + generator.normal(0, 6e-5, 9)))
        found = fit(drop, "constant", profiles=False)
        errors.append(found.values - [0.85, 1.0])
        stated.append(found.u)
    ratio = np.sqrt(np.mean(np.square(stated), axis=0) / np.mean(np.square(errors), axis=0))
    # 1.87 and 1.69 by the covariances, times 1.25: u follows Student's t of six degrees of freedom;
    # 100 draws tell each to 7 %, and three of that are allowed
    assert np.all((ratio > 1.65) & (ratio < 2.85))


def test_ratios_of_intervals_have_their_own_covariance():
    drop = from_intervals(INTERVALS, 1e-4)
    best = ratios.ratios(drop)
    assert best.numbers == (2, 3, 4, 5, 6, 7, 8)
    assert best.values == pytest.approx(0.85, abs=1e-6)
    e = 0.85  # u(e) = u·√(1 + e²)/T, and neighbours share one interval
    assert best.u == pytest.approx(1e-4 * np.sqrt(1 + e * e) / INTERVALS[:-1])
    assert best.covariance[0, 1] == pytest.approx(-e * 1e-8 / INTERVALS[0] / INTERVALS[1])


def test_a_sound_and_a_table_of_the_same_ball_are_fitted_together():
    other = {**TRUTH, "drop_height_m": 0.6}
    found = fit([heard(), from_intervals(np.diff(times_of(other)), 1e-4)], "constant")
    assert found.names == (
        "restitution", "drop_height_m[1]", "drop_height_m[2]", "release_time_s[1]",
    )  # fmt: skip
    truth = np.array([0.85, 1.0, 0.6, 0.3])
    assert np.all(np.abs(found.values - truth) < 3 * COVERAGE * found.u)


def test_the_scatter_tells_where_nothing_is_stated():
    drop = from_intervals(INTERVALS + np.random.default_rng(1).normal(0, 8e-5, 8))
    found = model_selection.compare(drop).best
    assert any("states no uncertainty" in text for text in warnings_of(found))


# ---- bad input ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ("bounce,interval_s\n1,0.7\n3,0.5\n2,0.6\n3,0.5\n",
         ["line 4: bounce 2 stands after bounce 3; number the rows upwards",
          "interval of bounce 3 stands more than once"]),
        ("bounce,interval_s\n1,0.7\n2,-0.6\n3,0\n",
         ["interval 2: -0.6 s is no time between two impacts; it must exceed 0",
          "interval 3: 0 s is no time between two impacts; it must exceed 0"]),
        ("bounce,interval_s\n0,0.7\n1,0.6\n",
         ["line 2: a bounce is numbered 1, 2, 3, … (0 is the drop, of which there is a"
          " rebound_height alone), found 0"]),
        ("bounce,interval\n1,0.7\n",
         ["line 1, column 'interval': has no unit; write interval [s]"]),
        ("Interval 1 (s),Interval 2 (s)\n0.7,0.6\n0.8,0.7\n",
         ["interval of bounce 1 stands more than once",
          "interval of bounce 2 stands more than once"]),
        ("bounce,Interval 1 (s)\n1,0.7\n",
         ["line 1: bounces are numbered in some headings and not in others; choose one way"]),
        ("bounce,interval_s,u_interval_ms\n1,0.5,1\n2,0.6,1\n",
         ["interval 2: 0.6 s is longer than the 0.5 s before it; a ball that is not struck cannot"
          " rise so high. If a bounce in between was not recorded, leave out its number"]),
        ("bounce,time_s\n1,0.7\n2,0.6\n",
         ["impact 2 at 0.6 s is not after impact 1 at 0.7 s; call a column of times between impacts"
          " interval [s]"]),
        ("# drop_height: 1 m\nbounce,rebound_height_cm\n0,100\n1,70\n",
         ["the drop height stands twice: in the head, and as the height of bounce 0; give it"
          " once"]),
    ],
)  # fmt: skip
def test_all_that_is_wrong_in_a_table_is_told_at_once(drop_in, text, faults):
    with pytest.raises(InputError) as error:
        drop_in(text)
    assert list(error.value.faults) == faults


def test_a_rise_without_a_stated_uncertainty_is_told_and_kept(drop_in):
    drop = drop_in("bounce,interval_s\n1,0.5\n2,0.501\n3,0.4\n")
    assert drop.interval_numbers == (1, 2, 3)
    assert "interval 2: 0.501 s is longer than the 0.5 s before it" in drop.notes[0]


def test_one_interval_cannot_tell_two_unknowns(drop_in):
    with pytest.raises(InputError, match="1 measured number and 0 priors cannot give 2 unknowns"):
        fit(drop_in("bounce,interval_s\n1,0.5\n"), "constant")


def test_what_else_a_table_holds_is_not_used_and_told(drop_in):
    drop = drop_in("# drop_height: 1 m\nbounce,interval_s,height_m\n1,0.7,0.6\n2,0.6,0.45\n")
    assert len(drop.heights_m) == 0
    assert "the rebound heights of the table were not used" in drop.notes[0]
    assert "--prior drop_height=1m:1mm" in drop.notes[1]


def test_an_uncertainty_of_times_is_refused_for_heights(drop_in):
    with pytest.raises(InputError, match="is of times, but the table holds heights"):
        drop_in("bounce,rebound_height_cm\n1,70\n2,50\n", u_s=1e-3)
