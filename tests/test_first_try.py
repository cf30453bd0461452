"""Logs whose columns say what they are open at the first try; the rest is told with one line."""

from __future__ import annotations

import json

import numpy as np
import pytest
import yaml

import simcompare
from simcompare.errors import InputError
from simcompare.hardware.raw import told_apart


@pytest.fixture
def read(tmp_path):
    def of(text, name="log.csv", **more):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return simcompare.import_log(tmp_path / name, **more)

    return of


@pytest.fixture
def mapped(read, tmp_path):
    def of(text, line):
        (tmp_path / "map.yaml").write_text(line, encoding="utf-8")
        return read(text, mapping=tmp_path / "map.yaml")

    return of


def rows(count, *columns, start=""):
    """Lines of numbers: 10 ms apart, then what each function makes of the row."""
    return start + "".join(
        ",".join([f"{0.01 * i:.2f}", *(str(column(i)) for column in columns)]) + "\n"
        for i in range(count)
    )


def channels(recording):
    (stream,) = recording.streams.values()
    return stream.channels


def middle(recording, name):
    return float(np.median(channels(recording)[name].values))


def left_out(recording):
    return {c.raw: c for c in recording.provenance.conversions if not c.channel}


def rules(recording):
    return {repair.rule for repair in recording.provenance.repairs}


@pytest.mark.parametrize(
    "names", ["ax,ay,az", "acc_x,acc_y,acc_z", "x,y,z", "x-axis,y-axis,z-axis"]
)
@pytest.mark.parametrize(("unit", "one"), [("g", 1), ("G", 1), ("mg", 1000)])
def test_axes_in_g_that_show_gravity_are_accelerations(read, names, unit, one):
    head = ",".join(f"{name} [{unit}]" for name in names.split(","))
    made = read(f"t (s),{head}\n" + rows(200, lambda i: 0.01 * one * (i % 3),
                                         lambda _: 0, lambda _: one))  # fmt: skip
    last = names.split(",")[-1].replace("-", "_") + "_m_s2"
    assert middle(made, last) == pytest.approx(9.80665)
    assert channels(made)[last].kind == "specific_force"
    told = [r.text for r in made.provenance.repairs if r.rule == "gravity_unit"]
    # a name that says acceleration needs no note
    assert bool(told) == names.startswith("x")


@pytest.mark.parametrize("one", [1.0, 9.81])
def test_an_accelerometer_without_a_unit_that_shows_gravity_is_known_by_it(read, one):
    numbers = [lambda i: 0.01 * one * (i % 3), lambda _: 0, lambda _: one, lambda i: i]
    made = read("t (s),acc_x,acc_y,acc_z,gyr_x\n" + rows(200, *numbers))
    assert middle(made, "acc_z_m_s2") == pytest.approx(9.81, rel=1e-3)  # of 9.80665
    assert [*left_out(made)] == ["gyr_x"]
    assert "gravity_unit" in rules(made)


def test_two_axes_in_g_of_which_one_carries_gravity_are_accelerations(read):
    made = read("t (s),x (g),z (g)\n" + rows(200, lambda i: 0.01 * (i % 3), lambda _: -1))
    assert middle(made, "z_m_s2") == pytest.approx(-9.80665)


@pytest.mark.parametrize("name", ["x", "b"])
def test_what_may_be_grams_is_left_out_with_the_line_that_says_what_it_is(read, mapped, name):
    text = f"t (s),{name} (g),u (V)\n" + rows(200, lambda i: 37 + i % 3, lambda i: i)
    one = left_out(read(text))[name]
    assert one.reason == "'g' may be gram or standard gravity; write gram or g_0"
    assert middle(mapped(text, one.cure), f"{name}_m_s2") == pytest.approx(38 * 9.80665)


def test_ascii_spellings_and_german_turns_are_understood(read):
    head = "time (s),torque (N.m),moment (N-m),load (oz-in),field (gauss),speed (U/min)\n"
    numbers = [lambda _: 0.12, lambda _: 0.12, lambda _: 17, lambda _: 0.48, lambda _: 1500]
    made = read(head + rows(40, *numbers))
    found = [middle(made, name) for name in channels(made)]
    assert found == pytest.approx([0.12, 0.12, 0.120047, 4.8e-5, 157.0796], rel=1e-5)


@pytest.mark.parametrize("brackets", ["[]", "()", "(-)", "[1]", "(1)", "[ - ]"])
def test_empty_brackets_say_that_there_is_no_unit(read, brackets):
    made = read(f"t (s),duty {brackets},u (V)\n" + rows(30, lambda i: i / 50, lambda i: i))
    assert channels(made)["duty"].unit == "1"
    assert channels(made)["duty"].values[-1] == pytest.approx(0.58)


@pytest.mark.parametrize(
    "heads", ["x [0],x [1],x [2]", "x (1),x (2),x (3)", "ch (A),ch (B),ch (C)"]
)
def test_brackets_that_count_are_no_units(read, heads):
    made = read(f"t (s),{heads},u (V)\n" + rows(30, *[lambda i: i] * 4))
    assert [*channels(made)] == ["u_V"]
    assert [*left_out(made)] == heads.split(",")


def test_a_last_letter_that_counts_is_no_unit(read):
    made = read("t (s),enc_A,enc_B,motor_A,motor_V\n" + rows(30, *[lambda i: i] * 4))
    assert [*channels(made)] == ["motor_A", "motor_V"]
    assert [*left_out(made)] == ["enc_A", "enc_B"]


def test_a_letter_behind_a_symbol_is_no_unit_that_the_symbol_cannot_have(read):
    heads = ["omega_m", "v_s", "u_N", "F_H", "x_m", "i_A", "T_s", "F_N", "v_ms", "speed_ms"]
    made = read(f"time (s),{','.join(heads)}\n" + rows(30, *[lambda i: i] * len(heads)))
    assert [*left_out(made)] == heads[:4]
    assert [c.unit for c in channels(made).values()] == ["m", "A", "s", "N", "m/s", "m/s"]


def test_prefixes_of_angles_are_angles(read):
    head = "t (s),gx [mdps],gy [mdeg/s],gz (mrad/s),n (krpm),slope (mrad)\n"
    made = read(head + rows(40, *[lambda _: 1750] * 5))
    found = {name: middle(made, name) for name in channels(made)}
    assert found == pytest.approx(
        {"gx_rad_s": 0.0305433, "gy_rad_s": 0.0305433, "gz_rad_s": 1.75, "n_rad_s": 183259.57,
         "slope_rad": 1.75}, rel=1e-5,  # they are rounded here
    )  # fmt: skip


def test_relative_humidity_is_a_fraction(read):
    made = read("t (s),temp (°C),humidity (%RH)\n" + rows(30, lambda _: 21.4, lambda _: 43.1))
    assert middle(made, "humidity") == pytest.approx(0.431)
    assert middle(made, "temp_K") == pytest.approx(294.55)


def test_a_unit_that_the_quantity_cannot_have_is_not_believed(read, mapped):
    text = "t (s),humidity (mH),u (V)\n" + rows(30, lambda _: 2, lambda i: i)
    one = left_out(read(text))["humidity"]
    assert one.reason == "is in H, but by its name in a plain number"
    assert middle(mapped(text, one.cure), "humidity_H") == pytest.approx(2e-3)


PWM = "Zeit (s), PWM, Spannung (V), Drehzahl (rad/s)\n" + rows(50, *[lambda i: i] * 3)


def test_one_column_without_a_unit_does_not_refuse_the_log(read, mapped):
    made = read(PWM)
    assert [*channels(made)] == ["spannung_V", "drehzahl_rad_s"]
    one = left_out(made)["PWM"]
    assert (one.reason, one.cure) == (
        "no unit is known", "channels: {pwm: {column: PWM, unit: 1}}",
    )  # fmt: skip
    assert channels(mapped(PWM, one.cure))["pwm"].unit == "1"


def test_who_asks_for_a_column_that_was_left_out_is_told_why(read):
    with pytest.raises(InputError, match=r"no unit is known, so it was left out.*channels: {pwm: "):
        read(PWM).find("pwm")


def test_what_was_left_out_is_one_line_on_the_terminal_and_in_the_json(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_text(PWM, encoding="utf-8")
    code, out, err = call("import", "log.csv")
    assert (code, err) == (0, "")
    assert "left out: 'PWM': no unit is known" in out
    assert "\n  channels: {pwm: {column: PWM, unit: 1}}\n" in out
    _, out, _ = call("import", "log.csv", "--json")
    conversions = json.loads(out)["provenance"]["conversions"]
    assert [c["cure"] for c in conversions if not c["channel"]] == [
        "channels: {pwm: {column: PWM, unit: 1}}"
    ]


def test_strict_refuses_a_column_without_a_unit(read):
    with pytest.raises(InputError, match=r"'PWM': no unit is known.*cure: channels: {pwm: "):
        read(PWM, strict=True)


def test_a_log_of_which_nothing_is_left_is_refused_with_one_line_that_opens_it(read, mapped):
    text = "t (s),a,on/off\n" + rows(30, lambda i: i, lambda i: i % 2)
    with pytest.raises(InputError) as error:
        read(text)
    line = error.value.faults[0].partition("; cure: ")[2]
    assert yaml.safe_load(line)["channels"]["on_off"] == {"column": "on/off", "unit": 1}
    assert [*channels(mapped(text, line))] == ["a", "on_off"]


def test_columns_of_text_and_empty_ones_are_told_as_such(read):
    text = "t (s),u (V),Notes,comment\n" + rows(40, lambda i: i, lambda i: "hit" * (i == 9),
                                               lambda _: "")  # fmt: skip
    assert {raw: one.reason for raw, one in left_out(read(text)).items()} == {
        "Notes": "holds text such as 'hit'", "comment": "is empty",
    }  # fmt: skip


def test_a_second_clock_alone_is_no_measurement(read):
    text = "Timestamp,Milliseconds,X\n"
    text += "".join(f"2021-07-30 13:28:{54 + i // 20},{50 * i + 1},{i}\n" for i in range(60))
    with pytest.raises(InputError, match="'X': no unit is known"):
        read(text)


def test_a_clock_without_a_measurement_is_refused(read):
    with pytest.raises(InputError, match="no column of numbers beside its time"):
        read("t (s),note\n0,a\n1,b\n2,c\n3,d\n")


def test_pixels_are_told_what_is_missing(read):
    made = read("t (s),x (px),u (V)\n" + rows(30, lambda i: i, lambda i: i))
    assert (
        left_out(made)["x"].reason
        == "'px' cannot be converted: write unit: m, scale: metres per pixel"
    )


def test_the_index_of_a_table_program_is_left_out(read):
    made = read("Unnamed: 0,time,x [m]\n" + "".join(f"{2 * i},{i / 60},{i}\n" for i in range(40)))
    assert [*channels(made)] == ["x_m"]
    assert [*left_out(made)] == ["Unnamed: 0"]


def test_a_column_that_is_empty_but_for_a_remark_is_a_column_of_text(read):
    text = "t (s),tau (N·m),App message\n" + rows(1500, lambda _: 0.1, lambda _: "")
    made = read(text + rows(5, lambda _: 0.1, lambda _: '"Cutoff (val=1, limit=0)"').replace(
        "0.0", "15.0"))  # fmt: skip
    assert [*channels(made)] == ["tau_N_m"]
    assert left_out(made)["App message"].reason == (
        "holds text such as 'Cutoff (val=1, limit=0)' (line 1502)"
    )


@pytest.mark.parametrize(
    "head", ["time (s),T [Nm]", "t,T (°C)", "Zeit [s],T [mNm]", "elapsed,T (K)"]
)
def test_a_torque_or_a_temperature_is_no_time(read, head):
    (stream,) = read(f"{head},n (rpm)\n" + rows(30, *[lambda i: 300 + i] * 2)).streams.values()
    assert stream.time_s[-1] == pytest.approx(0.29)
    assert len(stream.channels) == 2


@pytest.mark.parametrize(
    ("head", "last_s"),
    [("Zeit (s)", 0.29), ("Uhrzeit / s", 0.29), ("t/s", 0.29), ("temps (s)", 0.29),
     ("Time, s", 0.29),
     ("epoc (ms)", 29e-5), ("Time (mS)", 29e-5), ("time [S]", 0.29), ("Device Time (s)", 0.29),
     ("seconds_elapsed", 0.29), ("TimeStamp (Sec)", 0.29), ("elapsed (min)", 17.4),
     ("Zeit (in s)", 0.29), ("Prüfzeit [s]", 0.29),
     ("unit:timestamp [ms]", 29e-5)],
)  # fmt: skip
def test_a_time_is_known_by_name_and_unit(read, head, last_s):
    (stream,) = read(f'"{head}",u (V)\n' + rows(30, lambda i: i)).streams.values()
    assert stream.time_s[-1] == pytest.approx(last_s)


def test_of_several_columns_that_tell_the_same_time_the_finest_is_the_clock(read):
    text = "time (s),timestamp (ms),u (V)\n"
    text += "".join(f"{i // 4 / 25:.2f},{1.7e12 + 10 * i:.0f},{i}\n" for i in range(60))
    made = read(text)
    (stream,) = made.streams.values()
    assert stream.time_s[-1] == pytest.approx(0.59)
    assert "clock" in rules(made)


def test_a_last_line_of_words_is_passed_over_and_recorded(read):
    made = read("time_ms,force (N)\n" + "".join(f"{10 * i},{i}\n" for i in range(50))
                + "Session closed\n")  # fmt: skip
    assert len(channels(made)["force_N"].values) == 50
    assert [(r.severity, r.rows) for r in made.provenance.repairs if r.rule == "remark_line"] == [
        ("repair", ((52, 52),))
    ]


@pytest.mark.parametrize("line", ["restarted", "0.5", "0.31,1,2,3", "x,,", "gone,"])
def test_a_line_that_is_no_row_among_many_that_are_is_left_out_and_recorded(read, line):
    text = rows(40, lambda i: i, start="t (s),u (V)\n")
    text += f"{line}\n" + "".join(f"{0.01 * i:.2f},{i}\n" for i in range(40, 80))
    made = read(text)
    assert channels(made)["u_V"].values.tolist() == [*range(80)]
    assert rules(made) & {"remark_line", "ragged_row"}
    with pytest.raises(InputError, match="refused by strict"):
        read(text, strict=True)


def test_many_rows_of_another_width_are_a_fault(read):
    text = rows(40, lambda i: i, start="t (s),u (V)\n") + "1,2,3\n" * 5 + "2,3\n"
    with pytest.raises(InputError, match="line 42: has 3 cells, expected 2"):
        read(text)


def test_names_that_stand_twice_are_told_apart_and_can_be_mapped(read, mapped):
    text = "t (s),theta (rad),,t (s),theta (rad),frame\n" + rows(
        60,
        lambda i: i / 60,
        lambda _: "",
        lambda i: f"{0.01 * i:.2f}",
        lambda i: i / 30,
        lambda i: i,
    )
    made = read(text)
    assert [*channels(made)] == ["theta_rad", "t_2_s", "theta_2_rad"]
    line = 'channels: {second: {column: "theta #2", unit: rad}}'
    assert channels(mapped(text, line))["second_rad"].values[-1] == pytest.approx(59 / 30)
    assert told_apart(["x", "x #3", "x", "y", "y"]) == ["x", "x #3", "x #4", "y", "y #2"]


def test_columns_that_a_mapping_leaves_alone_do_not_block(mapped):
    text = "t (s),u (V),note\n" + rows(60, lambda i: i, lambda i: "ERR 7" if i == 31 else i)
    made = mapped(text, "channels: {supply: {column: u, unit: V}}")
    assert [*channels(made)] == ["supply_V"]
    assert left_out(made)["note"].reason == "holds text such as 'ERR 7' (line 33)"


def test_an_accelerometer_that_never_rests_is_known_by_its_mean(read):
    head = "t (s),acc_x,acc_y,acc_z\n"
    swing = [
        lambda i: 0.4 * np.sin(i),
        lambda i: 0.3 * np.cos(2 * i),
        lambda i: 1 + 0.2 * (-1) ** i,
    ]
    made = read(head + rows(400, *swing))
    assert middle(made, "acc_z_m_s2") == pytest.approx(9.81, rel=0.21)  # it swings up by 0.2 g
    assert "gravity_unit" in rules(made)
    with pytest.raises(
        InputError, match="no unit is known"
    ):  # as a phone gives it, without gravity
        read(head + rows(400, *swing[:2], lambda i: 2.5 * (-1) ** i))


def test_a_quaternion_is_known_by_its_length(read):
    q = [lambda i: np.cos(i / 50), lambda i: np.sin(i / 50), lambda _: 0, lambda _: 0]
    made = read(
        "t (s),pose_w,pose_x,pose_y,pose_z,q0,q1,q2,q3\n" + rows(100, *q, *([lambda _: 2] * 4))
    )
    assert [*channels(made)] == ["pose_w", "pose_x", "pose_y", "pose_z"]
    assert [*left_out(made)] == ["q0", "q1", "q2", "q3"]
    assert "quaternion" in rules(made)


def test_counts_and_turns_are_known_by_their_names(read):
    made = read("t (s),TargetCounts,rpm_left,rpm_kp\n" + rows(50, *[lambda _: 30] * 3))
    assert {n: c.unit for n, c in channels(made).items()} == {
        "targetcounts": "1", "rpm_left_rad_s": "rad/s",
    }  # fmt: skip
    assert middle(made, "rpm_left_rad_s") == pytest.approx(np.pi)
    assert [*left_out(made)] == ["rpm_kp"]


def test_a_date_that_never_changes_is_no_clock(read):
    lines = [f"2024-10-17 19:22:22;{1729182142 + i / 50:.3f};{i}" for i in range(100)]
    made = read("Date;Timestamp;u (V)\n" + "\n".join(lines) + "\n")
    (stream,) = made.streams.values()
    assert stream.time_s[-1] == pytest.approx(1.98)
    assert left_out(made)["Date"].reason == "is the same in all rows"


def test_how_sure_the_numbers_are_hides_no_unit(read):
    made = read("Time (seconds) (± 0.008s)\tx-coordinate of mass 1 (cm) (+- 0.2 cm)\n" + rows(
        50, lambda i: i).replace(",", "\t"))  # fmt: skip
    assert [*channels(made)] == ["x_coordinate_of_mass_1_m"]


def test_beside_decimal_points_a_comma_is_none(read):
    made = read("t (s),u (V),temp (C)\n" + rows(50, lambda i: i / 8, lambda i: f'"20,{i % 7}"'))
    assert [*channels(made)] == ["u_V"]
    assert left_out(made)["temp"].reason == "holds text such as '20,0'"


def test_an_attitude_beyond_radians_is_in_degrees(read):
    head = "t (s),roll,pitch,yaw\n"
    made = read(head + rows(90, lambda i: i, lambda i: i / 30, lambda i: 2 * i))
    assert middle(made, "roll_rad") == pytest.approx(np.radians(44.5))
    assert "attitude" in rules(made)
    for size in (0.01, 3.0):  # what may be radians, and what may be turns that were added up
        with pytest.raises(InputError, match="no unit is known"):
            read(head + rows(90, lambda i, s=size: s * i, lambda i: i / 90, lambda i: i))


@pytest.mark.parametrize("names", ["roll_rate,pitch_rate,yaw_rate", "roll,pitch,throttle"])
def test_rates_and_sticks_are_no_attitude(read, names):
    with pytest.raises(InputError, match="no unit is known"):
        read(f"t (s),{names}\n" + rows(90, *[lambda i: i / 2] * 3))


@pytest.mark.parametrize("value", [0, "nan"])
def test_an_accelerometer_that_says_nothing_has_no_unit(read, value):
    made = read("t (s),u (V),acc_x,acc_y,acc_z\n" + rows(90, lambda i: i, *[lambda _: value] * 3))
    assert [*channels(made)] == ["u_V"]
