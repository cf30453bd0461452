"""A table of results, one experiment a row, is held against engines and the closed form."""

import json

import numpy as np
import pytest
from scipy.special import ellipk

import simcompare
from simcompare.errors import InputError
from simcompare.scenarios import catalogue
from simcompare.validation.tabled import tables
from simcompare.validation.tabled.experiments import Experiment, Reading
from simcompare.validation.tabled.judged import judged
from simcompare.validation.tabled.simulated import ClosedForm, EngineValues, Setting
from simcompare.validation.tabled.vocabulary import of_scenario

LENGTHS_M = np.array([0.15, 0.25, 0.4, 0.6, 0.9, 1.2])
#: periods that a class measured over these lengths, to a hundredth of a second
PERIODS = """Length (m),Period (s)
0.15,0.78
0.25,1.01
0.40,1.27
0.60,1.56
0.90,1.90
1.20,2.20
"""


#: amplitude that is assumed where no column is one
AMPLITUDE_RAD = np.radians(7.5)


def period_s(length_m, gravity_m_s2=9.80665, amplitude_rad=AMPLITUDE_RAD):
    """By the complete elliptic integral; the small angle alone is 0.1 % less."""
    return 4 * np.sqrt(length_m / gravity_m_s2) * ellipk(np.sin(amplitude_rad / 2) ** 2)


def read(tmp_path, text, scenario="pendulum"):
    """What a table holds for a scenario."""
    (tmp_path / "table.csv").write_text(text, encoding="utf-8")
    file = catalogue.load(scenario)
    table = tables.of(tmp_path / "table.csv", file)
    assert table is not None, "it is taken for a log"
    return tables.read(table, file, file.resolve())


def faults(tmp_path, text, scenario="pendulum"):
    with pytest.raises(InputError) as caught:
        read(tmp_path, text, scenario)
    return list(caught.value.faults)


def rows(found, result="mean_period"):
    """Lines, what was set, the mean and the number of repeats of every experiment."""
    return [
        (one.lines, *one.set.values(), round(one.readings[result].mean, 6),
         len(one.readings[result].values))
        for one in found.found
    ]  # fmt: skip


# ---- what headings mean ------------------------------------------------------------------------


@pytest.mark.parametrize(
    "heading",
    [
        "Length (m),Period (s)",
        "L / m,T / s",
        "Pendulum length L [m],Period T [s]",
        "length_m,period_s",
        "string length (meters),swing time (sec)",
        "Länge (m),Schwingungsdauer (s)",
    ],
)
def test_columns_are_known_by_many_names(tmp_path, heading):
    found = read(tmp_path, f"{heading}\n0.5,1.42\n1,2.01\n")
    assert rows(found) == [((2,), 0.5, 1.42, 1), ((3,), 1.0, 2.01, 1)]


@pytest.mark.parametrize(
    "heading",
    ["10 T (s)", "T10 (s)", "Time for 10 swings (s)", "time of ten oscillations (s)",
     "Zeit für 10 Schwingungen (s)"],
)  # fmt: skip
def test_the_time_of_many_is_divided_by_their_number(tmp_path, heading):
    found = read(tmp_path, f"Length (m),{heading}\n0.5,14.2\n1,20.1\n")
    assert [row[-2] for row in rows(found)] == [1.42, 2.01]
    assert found.columns[1].count == 10


def test_a_column_may_say_how_many_were_timed(tmp_path):
    text = "Length (m),number of swings,total time (s)\n0.5,20,28.4\n1,10,20.1\n"
    assert [row[-2] for row in rows(read(tmp_path, text))] == [1.42, 2.01]


@pytest.mark.parametrize(
    "text",
    [
        "L (cm),T1 (s),T2 (s),T3 (s)\n50,1.40,1.42,1.44\n",
        "L (cm),trial 1 (s),trial 2 (s),trial 3 (s)\n50,1.40,1.42,1.44\n",
        "L (cm),10 T 1 (s),10 T 2 (s),10 T 3 (s),mean T (s)\n50,14.0,14.2,14.4,1.4\n",
        "L (cm),Period (s)\n50,1.40\n50,1.42\n50,1.44\n",
    ],
)
def test_repeats_stand_beside_each_other_or_in_rows(tmp_path, text):
    ((_, length_m, mean_s, repeats),) = rows(read(tmp_path, text))
    assert (length_m, mean_s, repeats) == (0.5, 1.42, 3)


def test_a_repeat_may_be_missing(tmp_path):
    text = "L (cm);T1 (s);T2 (s)\n50;1,40;1,44\n100;;2,00\n"
    assert rows(read(tmp_path, text)) == [((2,), 0.5, 1.42, 2), ((3,), 1.0, 2.0, 1)]


@pytest.mark.parametrize(
    ("heading", "cell", "u_s"),
    [
        ("u(T) (ms)", "20", 0.02),
        ("± (s)", "0.02", 0.02 / 3**0.5),
        ("dT (s)", "0.02", 0.02),
        ("uncertainty of period (%)", "1", 0.01 * 1.42),
    ],
)
def test_an_uncertainty_belongs_to_the_column_that_it_names(tmp_path, heading, cell, u_s):
    found = read(tmp_path, f"Length (m),T (s),{heading}\n0.5,1.42,{cell}\n1,2.01,{cell}\n")
    assert found.found[0].readings["mean_period"].u == pytest.approx(u_s)


@pytest.mark.parametrize(
    "heading",
    [
        "10 T (s),u(10 T) (s)", "Time for 10 swings (s),± (s)", "10T (s),u_10T (s)",
        "T10 (s),dT10 (s)", "10 T (s),Unsicherheit (s)", "10 T (s),u(10 Perioden) (s)",
        "T10 (s),u(t) (s)", "number of swings,total time (s),u(total time) (s)",
        "Number of periods,Total time (s),u (s)", "n,t (s),Δt (s)",
    ],
)  # fmt: skip
def test_the_uncertainty_of_the_time_of_many_is_divided_too(tmp_path, heading):
    count = "10," if heading.count(",") == 2 else ""
    text = f"Length (m),{heading}\n0.5,{count}14.20,0.2\n1,{count}20.10,0.2\n"
    reading = read(tmp_path, text).found[0].readings["mean_period"]
    u_s = 0.02 / (3**0.5 if "±" in heading else 1)
    assert (reading.mean, reading.u) == (pytest.approx(1.42), pytest.approx(u_s))
    assert reading.digit == pytest.approx(0.01)


@pytest.mark.parametrize(
    "heading", ["10 T (s),u(T) (s)", "10 T (s),uncertainty of period (s)", "T1 (s),T2 (s),dT2 (s)"]
)
def test_the_uncertainty_of_one_period_is_not_divided(tmp_path, heading):
    cells = "14.2" if "10" in heading else "1.42,1.42"
    text = f"Length (m),{heading}\n0.5,{cells},0.02\n1,{cells},0.02\n"
    assert read(tmp_path, text).found[0].readings["mean_period"].u == pytest.approx(0.02)


def test_none_that_were_timed_together_is_a_fault_and_no_crash(tmp_path):
    text = "Length (m),number of swings,total time (s)\n0.5,0,28.4\n1,10,20.1\n"
    assert "line 2: number of swings is 0; expected a number above 0" in faults(tmp_path, text)


def test_what_is_calculated_or_not_known_is_left_out_and_named(tmp_path):
    head = "Length (m),Period (s),T^2 (s^2),g (m/s^2),error (%),who"
    text = f"{head}\n0.5,1.42,2,9.8,-1,A\n1,2.01,4,9.8,2,B\n"
    found = read(tmp_path, text)
    left = {one.heading.plain: one.note for one in found.columns if one.role == "left out"}
    assert left == {
        "T^2 (s^2)": "is calculated from another column",
        "g": "is neither a parameter nor a result of the scenario",
        "error": "may be a deviation from theory; an uncertainty is called u",
        "who": "holds no numbers",
    }


def test_lines_above_the_table_say_parameters(tmp_path):
    found = read(tmp_path, "# angle: 10 deg\n# by: our class\n" + PERIODS)
    assert found.above == {"start_angle_rad": pytest.approx(np.radians(10))}


@pytest.mark.parametrize(
    ("scenario", "text", "set_to", "result", "decisive"),
    [
        ("ball", "drop height (cm),rebound height (cm)\n50,32\n80,51\n", "drop_height_m",
         "rebound_height", "restitution"),
        ("ball", "height (m),total time (s)\n0.5,2.9\n0.8,3.6\n", "drop_height_m",
         "settling_time", "restitution"),
        ("motor_bench", "Voltage (V),idle speed (rpm)\n3,4700\n4,6300\n", "voltage_V",
         "no_load_speed", "torque_constant_N_m_A"),
        ("sliding_block", "v0 (m/s),braking distance (cm)\n1,17\n2,68\n", "start_speed_m_s",
         "final_position", "friction"),
    ],
)  # fmt: skip
def test_other_scenarios_have_tables_too(tmp_path, scenario, text, set_to, result, decisive):
    found = read(tmp_path, text, scenario)
    first = found.found[0]
    assert ([*first.set], [*first.readings]) == ([set_to], [result])
    form = ClosedForm(Setting(catalogue.load(scenario)), found.entries)
    (value,) = form.of([first.set])[0].values()
    # the tables are made up from a like motion, to a tenth
    assert value == pytest.approx(first.readings[result].mean, rel=0.1)
    assert decisive in form.decisive(first)


def test_a_log_of_samples_is_no_table(tmp_path):
    (tmp_path / "log.csv").write_text("t (s),angle (deg)\n0,10\n0.1,9\n0.2,7\n", encoding="utf-8")
    assert tables.of(tmp_path / "log.csv", catalogue.load("pendulum")) is None


# ---- what is wrong -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("Colour (m),Period (s)\n1,2\n2,3\n", ["is a parameter; known: length, start angle"]),
        ("Length (m),Delay (s)\n1,2\n2,3\n", ["is a measured result; known: mean period"]),
        ("Length (kg),Period (m)\n1,2\n2,3\n", ["'Length (kg)'", "'Period (m)'"]),
        ("Length (m),Period (s)\n1,2.01\n", ["has one row", "u(Period) (s)"]),
        ("Length (m),Period (s)\n-1,2\n2,-3\n", ["line 2: length_m = -1 m", "line 3: Period (s)"]),
        ("Length (m),Period (s)\nNaN,2\n2,nan\n3,3\n", ["line 2: Length (m)", "line 3: Period"]),
        ("Length (m),Period (s),Period (s)\n1,2,2\n2,3,3\n", ["number them: Period 1, Period 2"]),
        ("Length (m),L (cm),Period (s)\n1,100,2\n2,200,3\n", ["both hold the length"]),
        ("Length (m),Period (s),u(T) (s)\n1,2,0\n2,3,\n", ["line 2: u(T) (s) is 0", "line 3"]),
    ],
)
def test_faults_are_told_all_at_once(tmp_path, text, told):
    whole = "\n".join(faults(tmp_path, text))
    assert [one for one in told if one not in whole] == []


def test_a_long_table_is_refused(tmp_path):
    text = "Length (m),Period (s)\n" + "0.5,1.42\n" * 100_000
    (fault,) = faults(tmp_path, text)
    assert "a table of results has at most 200" in fault


def test_columns_without_a_unit_are_told_with_a_line_that_works(tmp_path):
    text = PERIODS.replace(" (m)", "").replace(" (s)", "")
    (fault,) = faults(tmp_path, text)
    line = fault.partition("(--map): ")[2]
    assert line.startswith("channels: {length: {column: Length, unit: m}, mean_period:")
    (tmp_path / "map.yaml").write_text(line, encoding="utf-8")
    file = catalogue.load("pendulum")
    table = tables.of(tmp_path / "table.csv", file, tmp_path / "map.yaml")
    assert table is not None
    assert rows(tables.read(table, file, file.resolve()))[0] == ((2,), 0.15, 0.78, 1)


def test_import_names_the_command_that_takes_the_table(tmp_path):
    (tmp_path / "periods.csv").write_text(PERIODS, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        simcompare.import_log(tmp_path / "periods.csv")
    assert f"simcompare validate pendulum --recording {tmp_path / 'periods.csv'}" in str(
        caught.value
    )


# ---- what comes of it --------------------------------------------------------------------------


class Elliptic(ClosedForm):
    """The period of a swing without the whole motion: a table takes milliseconds."""

    def of(self, rows):
        every = [self.setting.values(row) for row in rows]
        return [{"mean_period": float(
            period_s(one["length_m"], one["gravity_m_s2"], one["start_angle_rad"])
        )} for one in every]  # fmt: skip


class NoForm(Elliptic):
    """A scenario without a closed form."""

    exists = False

    def of(self, rows):
        return [{"mean_period": None} for _ in rows]


def tabled(measured, u_s=None, digit=1e-6, factor=1.0, kind=Elliptic):
    """Verdicts on repeats (n, k) of periods over the lengths."""
    file = catalogue.load("pendulum")
    known = of_scenario(file, file.resolve())
    entry = next(one for one in known.entries if one.name == "mean_period")
    found = [
        Experiment((line,), {"length_m": float(length)}, {},
                   {"mean_period": Reading(tuple(map(float, values)), u_s, digit)})
        for line, (length, values) in enumerate(zip(LENGTHS_M, measured, strict=True))
    ]  # fmt: skip
    form = kind(Setting(file), (entry,))
    closed = form.of([one.set for one in found])
    values = tuple({"mean_period": factor * float(one)} for one in period_s(LENGTHS_M))
    nothing = tuple({"mean_period": None} for _ in found)
    engines = [
        EngineValues("toy", "ok", None, "1", values),
        EngineValues("absent", "missing", "absent is not installed", None, nothing),
    ]
    return judged(entry, found, form, closed, engines)


def test_the_closed_form_is_that_of_the_elliptic_integral():
    file = catalogue.load("pendulum")
    known = of_scenario(file, file.resolve())
    entry = next(one for one in known.entries if one.name == "mean_period")
    form = ClosedForm(Setting(file), (entry,))
    rows = [{"length_m": 0.4}, {"length_m": 1.2}]
    found = [one["mean_period"] for one in form.of(rows)]
    # passages of the angle of rest are found between samples, to 1e-9 of a period
    assert found == pytest.approx([period_s(0.4), period_s(1.2)], rel=1e-8)


def test_an_engine_that_is_wrong_disagrees():
    result = tabled(period_s(LENGTHS_M)[:, None], u_s=0.005, factor=1.02)
    closed, toy, absent = result.verdicts
    assert (closed.verdict, toy.verdict) == ("agrees", "disagrees")
    assert (absent.verdict, absent.status) == ("open", "missing")
    assert toy.ratio == pytest.approx(1 / 1.02)


def test_without_a_closed_form_engines_alone_are_held_against_the_table():
    result = tabled((period_s(LENGTHS_M) + 0.004 * np.array([1, -1, 1, -1, 1, -1]))[:, None],
                    kind=NoForm)  # fmt: skip
    assert [(one.source, one.verdict) for one in result.verdicts] == [
        ("toy", "agrees"), ("absent", "open"),
    ]  # fmt: skip
    assert (result.told, result.curve, result.points[0].u_input) == ((), (), None)


def test_rows_that_scatter_more_than_stated_disagree():
    noise = 0.01 * np.array([1, -1, 1, -1, 1, -1])  # ten times what is stated
    result = tabled((period_s(LENGTHS_M) + noise)[:, None], u_s=0.001)
    assert result.verdicts[0].verdict == "disagrees"
    assert result.verdicts[0].scatter > 5


def test_repeats_that_are_all_alike_are_no_better_than_their_last_digit():
    result = tabled(np.repeat(np.round(period_s(LENGTHS_M), 2)[:, None], 3, axis=1), digit=0.01)
    assert result.points[0].u_measured == pytest.approx(0.01 / 12**0.5 / 3**0.5)


def test_a_length_that_is_measured_to_the_wrong_place_is_seen():
    result = tabled(period_s(LENGTHS_M + 0.008)[:, None], u_s=0.002)
    plain, shifted = result.told
    assert shifted.offset == "length_m"
    assert shifted.offset_value == pytest.approx(0.008, abs=1e-6)  # no noise was added
    assert shifted.value == pytest.approx(9.80665, abs=1e-4)
    assert abs(shifted.offset_value) > shifted.offset_expanded
    assert plain.scatter > 2 * shifted.scatter


def test_ten_that_were_timed_together_are_suspected():
    result = tabled(10 * period_s(LENGTHS_M)[:, None])
    assert (result.timed, result.told) == (10, ())


@pytest.mark.parametrize("kind", ["repeats", "scatter"])
def test_intervals_hold_what_was_true(kind):
    """Ruler, gravity, amplitude and stopwatch drawn as they are assumed, 40 tables."""
    draw = np.random.default_rng(3)
    held = []
    for _ in range(40):
        gravity = 9.80665 + draw.uniform(-0.03, 0.03)
        lengths = LENGTHS_M + draw.uniform(-5e-4, 5e-4, 6)
        true = period_s(lengths, gravity, np.radians(draw.uniform(0, 15)))
        noise = draw.normal(0, 0.01, (6, 3 if kind == "repeats" else 1))
        result = tabled(true[:, None] + noise)
        first = result.told[0]
        held.append((result.verdicts[0].verdict == "agrees",
                     abs(first.value - gravity) <= first.expanded))  # fmt: skip
    # 95 % of 40 are 38, standard deviation 1.4; the seed is fixed
    assert (np.sum(held, axis=0) >= 34).all()


# ---- the verb ----------------------------------------------------------------------------------


def test_the_command_answers_and_writes_numbers_and_one_page(call, tmp_path):
    (tmp_path / "periods.csv").write_text(PERIODS, encoding="utf-8")
    code, out, _ = call(
        "validate", "pendulum", "--recording", "periods.csv", "--engine", "mujoco", "--out", "runs"
    )
    assert code == 0
    text = " ".join(out.split())
    assert text.startswith(
        "mujoco and the closed form agree with the measured mean period: measured over simulated"
        " is 1.0002 ± "
    )
    assert "By the closed form the table itself says gravity = (9.80" in text
    assert "Start angle = 7.5° ± 4.3° (u): No column is an angle" in text
    (folder,) = (tmp_path / "runs").iterdir()
    (result,) = json.loads((folder / "table.json").read_text(encoding="utf-8"))["results"]
    simulated = [point["values"]["mujoco"] for point in result["points"]]
    # a step of 1 ms leaves 3e-6 of a period
    assert simulated == pytest.approx([*period_s(LENGTHS_M)], rel=1e-5)
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.index("Mean period over length") < page.index("Every row")


def test_a_faulty_table_ends_with_2_and_no_traceback(call, tmp_path):
    (tmp_path / "periods.csv").write_text("Length (kg),Period (s)\n1,2\n", encoding="utf-8")
    code, out, err = call("validate", "pendulum", "--recording", "periods.csv")
    assert (code, out) == (2, "")
    assert "does not fit; expected m or a multiple of it" in err
    assert "Traceback" not in err


def test_python_gets_a_result_that_shows_itself(tmp_path):
    (tmp_path / "drops.csv").write_text(
        "drop height (cm),rebound height (cm)\n50,32\n80,51\n120,77\n", encoding="utf-8"
    )
    found = simcompare.validate("ball", recording=tmp_path / "drops.csv", engine="mujoco")
    assert [*found.table().index] == ["closed form", "mujoco"]
    assert len(found.table("rebound_height")) == 3
    assert found.plot().axes[0].get_title() == "Rebound height"
    assert "agree" in repr(found)
    assert "<table" in found._repr_html_()


def test_a_setting_that_stands_in_a_column_is_refused(tmp_path):
    (tmp_path / "periods.csv").write_text(PERIODS, encoding="utf-8")
    with pytest.raises(InputError, match="length_m stands in a column of the table"):
        simcompare.validate("pendulum", recording=tmp_path / "periods.csv", set={"length": 1})
