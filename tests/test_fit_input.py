"""What a fit of bounces cannot use is refused in words: values, options, tables and tracks."""

import numpy as np
import pytest

import simcompare
from simcompare.errors import InputError
from simcompare.fitting.bounces import tables
from simcompare.fitting.bounces.reading import drops_of, from_times
from tests.bounces import filmed_samples, times_of

#: a ball of restitution 0.78 from 0.8 m: times between impacts [s]
FLIGHTS = (0.630121, 0.491495, 0.383366, 0.299025, 0.233240, 0.181927)


def table(path, values=FLIGHTS, heading="bounce,interval (s)"):
    rows = "".join(f"{k},{value}\n" for k, value in enumerate(values, start=1))
    path.write_text(f"{heading}\n{rows}", encoding="utf-8")
    return path


@pytest.fixture
def drop(tmp_path):
    return table(tmp_path / "drop.csv")


def fitted(*recordings, **more):
    return simcompare.fit("ball", recordings=recordings, engine="pymunk", **more)


def faults_of(*recordings, **more):
    with pytest.raises(InputError) as error:
        fitted(*recordings, **more)
    return error.value.faults


# ---- values and options -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("option", "given", "message"),
    [
        ("fixed", {"gravity": 0}, "--fix gravity=0m/s² is outside 0.1m/s² to 30m/s²"),
        ("fixed", {"gravity": 981}, "--fix gravity=981m/s² is outside 0.1m/s² to 30m/s²"),
        ("fixed", {"restitution": 1.5}, "--fix restitution=1.5 is outside 0.01 to 0.99"),
        ("fixed", {"terminal_speed": "0m/s"}, "terminal_speed=0m/s is outside 0.5m/s and more"),
        ("fixed", {"terminal_speed": -3}, "terminal_speed=-3m/s is outside 0.5m/s and more"),
        ("priors", {"clock_skew": (100, 5e-6)}, "are written --prior clock_skew=100ppm:5ppm"),
        ("priors", {"clock_skew": (0, 5)}, "are written --prior clock_skew=0:5ppm"),
        ("priors", {"scale": (0.0, 0.01)}, "scale=0:0.01: the value is outside 0.1 to 10"),
        ("priors", {"gravity_m_s2": (-9.81, 0.01)}, "gravity=-9.81m/s²:0.01m/s²: the value"),
        ("priors", {"terminal_speed_m_s": (9, 20)}, "the uncertainty is above 9m/s"),
        ("priors", {"restitution": (0.8, 0)}, "the uncertainty must be above 0"),
    ],
)  # fmt: skip
def test_what_is_known_must_be_possible(drop, option, given, message):
    (fault,) = faults_of(drop, **{option: given})
    assert message in fault


def test_all_that_is_impossible_is_told_at_once(drop):
    found = faults_of(drop, fixed={"gravity": 0, "restitution": 2}, priors={"scale": (0, 1)})
    assert len(found) == 3


@pytest.mark.parametrize(
    "more", [{"priors": {"drop_height_m": (0.8, 1e-3)}}, {"unknowns": "drop_height"}]
)
def test_what_is_exact_is_not_sought_too(drop, more):
    (fault,) = faults_of(drop, fixed={"drop_height": "0.8m"}, **more)
    assert "drop_height stands in --fix and in" in fault


def test_unknowns_have_the_names_that_fixed_values_have(drop):
    found = fitted(drop, unknowns="gravity").record.fit
    assert "gravity_m_s2" in found.closed_form.parameters


@pytest.mark.parametrize("value", [0.78, 0.9])
def test_a_restitution_can_be_fixed(drop, value):
    form = fitted(drop, fixed={"restitution": value}).record.fit.closed_form
    assert form.fixed["restitution"] == value
    assert "restitution" not in form.parameters


# ---- data that tell nothing ---------------------------------------------------------------------


def test_flights_that_become_longer_are_none_of_a_ball(tmp_path):
    grow = table(tmp_path / "grow.csv", [0.2 / 0.8**k for k in range(6)])
    (fault,) = faults_of(grow)
    assert "the data tell no restitution: the bounces do not become lower" in fault


@pytest.mark.parametrize(
    ("heading", "bounces"),
    [
        ("bounce,interval (s)", [0.4] * 6),
        ("bounce,rebound_height (m)", [0.5] * 6),
        ("bounce,impact_time (s)", [0.4 * k for k in range(1, 7)]),
    ],
)
def test_flights_that_are_all_equal_have_no_restitution(tmp_path, heading, bounces):
    (fault,) = faults_of(table(tmp_path / "equal.csv", bounces, heading))
    assert fault.startswith(
        "the data tell no restitution: the bounces do not become lower, which would be a"
        " restitution of 1 or beyond"
    )


@pytest.mark.parametrize("u_s", [10.0, 1e9])
def test_without_any_information_there_is_no_number(drop, u_s):
    (fault,) = faults_of(drop, u_time_s=u_s)
    assert "the measured numbers tell nothing of restitution" in fault
    assert "--u-time" in fault


@pytest.mark.parametrize(
    ("factor", "heading"), [(1e3, "bounce,interval (s)"), (1e2, "bounce,rebound_height (m)")]
)
def test_a_wrong_unit_is_suspected_where_a_drop_is_too_high(tmp_path, factor, heading):
    (fault,) = faults_of(table(tmp_path / "wrong.csv", [factor * t for t in FLIGHTS], heading))
    assert fault.startswith("wrong.csv would be a drop from ")
    assert "whether the unit of the recording is the right one" in fault


@pytest.mark.parametrize("last", [501, 10**9])
def test_a_drop_has_no_more_bounces_than_a_fit_takes(tmp_path, last):
    path = table(tmp_path / "many.csv")
    path.write_text(path.read_text(encoding="utf-8") + f"{last},0.1\n", encoding="utf-8")
    (fault,) = faults_of(path)
    assert fault.startswith(f"a row is numbered {last}; a fit takes 500 bounces")


def test_a_track_in_which_nothing_moves_says_so(tmp_path):
    path = tmp_path / "still.csv"
    rows = "".join(f"{k / 30:.6f},0.5\n" for k in range(40))
    path.write_text(f"t (s),y (m)\n{rows}", encoding="utf-8")
    (fault,) = faults_of(path)
    assert "is 0.5 m in all samples, so nothing moves in it" in fault


# ---- few bounces --------------------------------------------------------------------------------


def test_too_few_bounces_are_one_fault_with_advice_that_works(tmp_path):
    path = table(tmp_path / "two.csv", (1.0, 1.63), "number,impact_time (s)")
    (fault,) = faults_of(path)
    assert "2 measured numbers and 0 priors cannot give 3 unknowns" in fault
    assert "record 2 more bounces at least, or measure the drop height" in fault
    assert "--fix drop_height=0.8m and state the uncertainty, such as --u-time 1ms" in fault
    found = fitted(path, fixed={"drop_height": "0.8m"}, u_time_s=1e-3)
    assert found.record.fit.sources[0].status == "ok"


def test_one_rebound_is_told_from_the_drop_height_in_a_row_or_a_line(tmp_path):
    path = tmp_path / "one.csv"
    rows = "number,rebound_height (m),u_rebound_height (m)\n1,0.49,0.002\n"
    path.write_text(rows, encoding="utf-8")
    (fault,) = faults_of(path)
    assert "# drop_height: 0.8 m" in fault
    path.write_text(f"# drop_height: 0.8 m\n{rows}", encoding="utf-8")
    assert fitted(path).record.fit.sources[0].status == "ok"


@pytest.mark.parametrize("model", ["auto", "constant"])
def test_an_exact_height_tells_no_scatter(tmp_path, model):
    path = tmp_path / "heights.csv"
    path.write_text("number,rebound_height (m)\n0,0.80\n1,0.49\n", encoding="utf-8")
    (fault,) = faults_of(path, fixed={"drop_height": "0.8m"}, model=model)
    assert "nothing tells the scatter of 1 measured number without" in fault
    assert "in a column u_rebound_height" in fault
    (fault,) = faults_of(path, fixed={"drop_height": "0.5m"}, model=model)
    assert "the drop height is 0.8 m in the recording, but fixed at 0.5 m" in fault


def test_what_is_sought_anyway_may_be_named(drop):
    assert "restitution" in fitted(drop, unknowns="restitution").record.fit.closed_form.parameters


# ---- headings -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("heading", "encoding"),
    [
        ("Aufprall;Zeitintervall (s)", "utf-8"),
        ("Nummer;Intervall (s)", "utf-8-sig"),
        ("Nr.;Zeitintervall (s)", "utf-8"),
        ("Bounce;Time interval (s)", "utf-16"),
    ],
)
def test_tables_are_read_as_they_are_called_in_german_and_saved_by_spreadsheets(
    tmp_path, heading, encoding
):
    rows = "".join(f"{k};{t}\n".replace(".", ",") for k, t in enumerate(FLIGHTS, start=1))
    path = tmp_path / "tabelle.csv"
    path.write_text(f"{heading}\n{rows}", encoding=encoding)
    assert tables.is_table(path)
    assert tables.read(path).intervals_s.tolist() == list(FLIGHTS)


def test_heights_without_a_time_are_those_of_the_bounces(tmp_path):
    path = tmp_path / "hoehen.csv"
    path.write_text("Nr.;Höhe (m)\n1;0,49\n2;0,30\n", encoding="utf-8")
    assert tables.is_table(path)
    assert tables.read(path).heights_m.tolist() == [0.49, 0.30]


def test_impacts_are_numbered_in_a_column_of_that_name(tmp_path):
    path = tmp_path / "impacts.csv"
    path.write_text(
        "impact,impact_time (s),u_impact_time (s)\n1,0.8,1e-4\n2,1.43,1e-4\n", encoding="utf-8"
    )
    assert tables.is_table(path)
    assert tables.read(path).u_s.tolist() == [1e-4, 1e-4]


@pytest.mark.parametrize("restitution", [0.992, 0.998])
@pytest.mark.parametrize("u_s", [1e-4, None])
def test_a_ball_that_loses_almost_nothing_is_followed(restitution, u_s):
    # flights of 0.5 s shorten by 1 ms at least, ten times the noise
    truth = {"restitution": restitution, "drop_height_m": 0.3, "release_time_s": 0.3}
    noise = np.random.default_rng(0).normal(0, 1e-4, 10)
    (drop,) = from_times(times_of(truth, 10) + noise, u_s)
    assert drop.numbers == tuple(range(1, 11))


@pytest.mark.parametrize(("separator", "mark"), [(",", "."), (";", ",")])
def test_a_table_without_headings_is_told_which_there_are(tmp_path, separator, mark):
    rows = [f"{k}{separator}{t:.6f}".replace(".", mark) for k, t in enumerate(FLIGHTS, start=1)]
    path = tmp_path / "bare.csv"
    path.write_text("\n".join(rows), encoding="utf-8")
    with pytest.raises(InputError) as error:
        drops_of(path, None, None, 9.80665)
    (fault,) = error.value.faults
    assert fault.endswith("known are bounce, impact_time_s, interval_s, rebound_height_m")
    path.write_text("\n".join([fault.split("'")[1], *rows]), encoding="utf-8")
    (drop,) = drops_of(path, None, None, 9.80665)
    assert drop.intervals_s == pytest.approx(FLIGHTS, abs=1e-6)  # written with six decimals


# ---- tracks without units -----------------------------------------------------------------------


def track(path, *, factor=1.0, held_s=0.0, rest_s=0.0, frames=False):
    """A file of Tracker, which writes no units."""
    _, height = filmed_samples(u_m=1e-3)
    held, rest = (np.full(int(30 * s), end) for s, end in ((held_s, height[0]), (rest_s, 0.123)))
    noise = np.random.default_rng(1).normal(0, 1e-3, len(held) + len(rest))
    y = factor * np.concatenate((held + noise[: len(held)], height, rest + noise[len(held) :]))
    t = np.arange(len(y)) / (1 if frames else 30)
    rows = "".join(f"{a:.6f}\t0\t{b:.6f}\n" for a, b in zip(t, y, strict=True))
    path.write_text(f"mass_A\t\t\nt\tx\ty\n{rows}", encoding="utf-8")
    return path


@pytest.mark.parametrize("where", ["held_s", "rest_s"])
def test_a_ball_that_is_held_or_rests_for_long_is_followed(tmp_path, where):
    (drop,) = drops_of(track(tmp_path / "clip.txt", **{where: 6.0}), None, None, 9.80665)
    assert drop.heights_m[0] == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    ("made", "message", "line"),
    [
        ({"factor": -1.0}, "y grows downwards", "unit: m, sign: -1"),
        ({"factor": -100.0}, "y grows downwards", "unit: cm, sign: -1"),
        ({"factor": 100.0}, "the lengths are in another unit", "unit: cm"),
        ({"frames": True}, "these are frames, not seconds", "time: {rate_Hz: 30}"),
    ],
)
def test_a_track_is_refused_with_the_line_that_opens_it(tmp_path, made, message, line):
    path = track(tmp_path / "clip.txt", **made)
    with pytest.raises(InputError, match=message) as error:
        drops_of(path, None, None, 9.80665)
    asked = str(error.value).partition('Write the line "')[2].partition('"')[0]
    assert line in asked
    (tmp_path / "map.yaml").write_text(asked, encoding="utf-8")
    (drop,) = drops_of(path, tmp_path / "map.yaml", None, 9.80665)
    assert drop.heights_m[0] == pytest.approx(1.0, abs=0.02)


def test_an_uncertainty_of_times_is_not_ignored_for_a_video(tmp_path):
    with pytest.raises(InputError, match=r"--u-time, clip\.txt: is of impact times, but"):
        drops_of(track(tmp_path / "clip.txt"), None, 1e-3, 9.80665)


def test_of_two_tracks_the_line_of_the_message_chooses_one(tmp_path):
    rows = track(tmp_path / "one.txt").read_text(encoding="utf-8").splitlines()[2:]
    both = "".join(f"{row}\t{row}\n" for row in rows)
    path = tmp_path / "clip.txt"
    head = "mass_A\t\t\tmass_B\t\t\nt\tx\ty\tt\tx\ty"
    path.write_text(f"{head}\n{both}", encoding="utf-8")
    with pytest.raises(InputError, match="mass_a_y_m, log/mass_b_y_m") as error:
        drops_of(path, None, None, 9.80665)
    (tmp_path / "map.yaml").write_text(
        str(error.value).split(" '")[1].split("',")[0], encoding="utf-8"
    )
    (drop,) = drops_of(path, tmp_path / "map.yaml", None, 9.80665)
    assert drop.heights_m[0] == pytest.approx(1.0, abs=0.02)
