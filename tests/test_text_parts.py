"""One file that holds several tables: below each other, or with rows of several kinds."""

from __future__ import annotations

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import importing
from simcompare.hardware.mapping import NOTHING


@pytest.fixture
def read(tmp_path):
    def of(text, name="log.csv"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return importing.read(tmp_path / name, NOTHING)

    return of


def rows(count, start=0.0, step=0.01, slope=0.1, kind="", separator=","):
    return "".join(
        f"{kind}{start + step * i:.3f}{separator}{slope * i:.4f}\n" for i in range(count)
    )


def shape(recording):
    """Stream -> its samples and channels."""
    return {name: (len(s.time_s), [*s.channels]) for name, s in recording.streams.items()}


def told(recording, rule):
    return [repair.text for repair in recording.provenance.repairs if repair.rule == rule]


def test_tables_below_each_other_are_streams(read):
    made = read("t (s),x (m)\n" + rows(30) + "\nTime (s),F (N)\n" + rows(20, step=0.02, slope=2))
    assert shape(made) == {"table_1": (30, ["x_m"]), "table_2": (20, ["f_N"])}
    assert made.streams["table_2"].channels["f_N"].values[-1] == 38.0


def test_sections_of_nexus_have_their_own_rates_units_and_names(read):
    def section(word, rate, names, unit, count, sub):
        head = f"{word},,,\n{rate},,,\n,,box:a,\nFrame,Sub Frame,{names}\n,,{unit},{unit}\n"
        return head + "".join(
            f"{1 + i // sub},{i % sub},{0.5 * i:.1f},{-i}\n" for i in range(count * sub)
        )

    made = read(
        section("Devices", 1000, "Fx,Fy", "N", 20, 10)
        + "\n"
        + section("Trajectories", 100, "X,Y", "mm", 20, 1)
    )
    assert [*made.streams] == ["devices", "trajectories"]
    forces, places = made.streams.values()
    assert np.diff(forces.time_s) == pytest.approx(0.001)
    assert np.diff(places.time_s) == pytest.approx(0.01)
    assert {channel.unit for channel in places.channels.values()} == {"m", "1"}
    x = next(c for name, c in places.channels.items() if name.endswith("x_m"))
    assert x.values[2] == pytest.approx(0.001)  # 1 mm


def test_the_header_again_after_an_empty_line_goes_on_with_the_table(read):
    made = read("t (s),x (m)\n" + rows(30) + "\nt (s),x (m)\n" + rows(30, start=0.3))
    assert shape(made) == {"log": (60, ["x_m"])}


@pytest.mark.parametrize("count", [1, 100])
def test_text_below_the_rows_is_left_out_and_told(read, count):
    remarks = "".join(f"Remark {i}: the table was pushed, twice\n" for i in range(count))
    made = read("t (s),x (m)\n" + rows(30) + "\n" + remarks)
    assert shape(made) == {"log": (30, ["x_m"])}
    (text,) = told(made, "trailing_text")
    assert "Remark 0" in text


def test_more_remarks_than_rows_directly_below_them(read):
    remarks = "".join(f"Remark {i}: the table was pushed\n" for i in range(100))
    assert shape(read("t (s),x (m)\n" + rows(30) + remarks)) == {"log": (30, ["x_m"])}


def test_a_summary_below_the_rows_is_no_sample(read):
    made = read("t (s),x (m)\n" + rows(30) + "\nchannel,mean\nx,1.2\n")
    assert shape(made) == {"log": (30, ["x_m"])}
    assert told(made, "trailing_text")


def test_a_list_of_settings_above_the_table_is_no_table(read):
    made = read("Setting,Value\nRate,100\nGain,2\nOffset,3\n\nt (s),x (m)\n" + rows(30))
    assert shape(made) == {"log": (30, ["x_m"])}


def test_a_table_without_a_time_beside_one_with_it_is_left_out_and_told(read):
    made = read("t (s),x (m)\n" + rows(30) + "\ngain,offset\n1,2\n2,3\n3,5\n")
    assert [*made.streams] == ["table_1"]
    (text,) = told(made, "left_out_table")
    assert "table_2" in text


HEADS = "IMU,t_ms,x_m\nGPS,t_ms,lat_deg,lon_deg\n"


@pytest.mark.parametrize(
    "heads", [HEADS, "# " + HEADS.replace("\n", "\n# ", 1), HEADS.replace("\n", "\nMSG,hello\n", 1)]
)
def test_rows_that_begin_with_their_kind_are_a_stream_for_each(read, heads):
    text = "".join(
        f"IMU,{10 * i},{0.1 * i:.2f}\n" + (f"GPS,{10 * i},48.1,11.5\n" if i % 5 == 0 else "")
        for i in range(60)
    )
    made = read(heads + text)
    assert shape(made) == {"imu": (60, ["x_m"]), "gps": (12, ["lat_rad", "lon_rad"])}
    assert made.streams["imu"].time_s[-1] == pytest.approx(0.59)
    assert bool(told(made, "few_rows")) == ("MSG" in heads)


def test_a_kind_that_begins_late_is_read_whole(read):
    early = "".join(f"IMU,{10 * i},{0.1 * i:.2f}\n" for i in range(5000))
    late = "".join(f"GPS,{50_000 + 10 * i},{i}\nIMU,{50_000 + 10 * i},1\n" for i in range(50))
    begin = "IMU,t_ms,x_m\nGPS,t_ms,h_m\nGPS,0,7\nGPS,5,7\nGPS,9,7\n"
    assert shape(read(begin + early + late)) == {"imu": (5050, ["x_m"]), "gps": (53, ["h_m"])}


def test_a_stamp_before_the_kind_stays(read):
    text = "".join(f"{0.01 * i:.2f} ACC {0.1 * i:.2f}\n{0.01 * i:.2f} GYR 0.5\n" for i in range(60))
    with pytest.raises(InputError) as caught:
        read(text)
    line = "time: {column: column_1, unit: s}"
    assert line in str(caught.value)


def test_a_column_of_types_parts_the_rows_that_share_its_header(read):
    text = "".join(f"acc,{10 * i},{0.1 * i:.2f}\ngyr,{10 * i + 3},7\n" for i in range(60))
    made = read("type,t_ms,value (m)\n" + text)
    assert shape(made) == {"acc": (60, ["value_m"]), "gyr": (60, ["value_m"])}
    assert made.streams["gyr"].channels["value_m"].values[0] == 7


@pytest.mark.parametrize("mark", ["", "# "])
def test_a_text_column_that_tells_no_type_stays_one(read, mark):
    text = "".join(f"{'up' if i % 3 else 'down'},{10 * i},{0.1 * i:.2f}\n" for i in range(60))
    made = read(f"{mark}state,t_ms,x (m)\n" + text)
    assert shape(made) == {"log": (60, ["x_m"])}


def test_labelled_lines_of_two_kinds(read):
    text = "".join(
        f"IMU: t_ms={10 * i} x_m={0.1 * i:.2f}\nBAR: t_ms={10 * i} p_Pa=101325\n" for i in range(60)
    )
    assert shape(read(text, "log.txt")) == {"imu": (60, ["x_m"]), "bar": (60, ["p_Pa"])}


def test_a_kind_of_words_alone_is_left_out_and_told(read):
    text = "".join(
        f"MSG,hello,{'a' * (i % 3 + 1)}\nIMU,{10 * i},{0.1 * i:.2f}\n" for i in range(60)
    )
    made = read("MSG,text,more\nIMU,t_ms,x_m\n" + text)
    assert shape(made) == {"imu": (60, ["x_m"])}
    assert any("msg" in one for one in told(made, "left_out_table"))


def test_names_of_ardupilot_stand_in_its_format_lines(read):
    text = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
    text += "FMT, 130, 45, IMU, Qf, t_us,x_m\nFMT, 131, 45, BAT, Qf, t_us,Volt_V\n"
    text += "".join(
        f"IMU, {10_000 * i}, {0.1 * i:.2f}\nBAT, {10_000 * i}, 12.1\n" for i in range(60)
    )
    made = read(text, "00000001.log")
    assert shape(made) == {"imu": (60, ["x_m"]), "bat": (60, ["volt_V"])}
