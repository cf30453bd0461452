"""Fits by tosses as a user asks for them: roles, recordings, options, records, reports."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from pydantic import TypeAdapter

import simcompare
from simcompare.cli import console
from simcompare.engine import engines
from simcompare.errors import InputError, SimcompareError
from simcompare.fitting.tosses import engines as toss_engines
from simcompare.fitting.tosses.roles import roles_of
from simcompare.fitting.tosses.search import Search, estimates
from simcompare.fitting.tosses.setup import Setup, prepare
from simcompare.fitting.tosses.tosses import Errors, Toss
from simcompare.model.fittable import Grid
from simcompare.model.plain import plain
from simcompare.model.settings import TUNED, Settings
from simcompare.reports import builder
from simcompare.reports.fit import short, tosses
from simcompare.reports.fit.tosses import sentences
from simcompare.results import contact_values, fit_file, store
from simcompare.results.records.fit_tosses import TossFit
from simcompare.running.jobs import FAILED, UNSUPPORTED, Job
from simcompare.running.runner import run_jobs
from simcompare.scenarios import catalogue

FILE = catalogue.load("cube_toss")
RATE_HZ, PARTS, SAMPLES = 148, 14, 60
FRICTION = 0.22
CHANNELS = [*((axis, "m") for axis in "xyz"), *((f"q_{axis}", '"1"') for axis in "wxyz")]
MAP = "format: numpy\ntime: {rate_Hz: 148}\nchannels:\n" + "".join(
    f"  {name}: {{column: pose.{i}, unit: {unit}}}\n" for i, (name, unit) in enumerate(CHANNELS)
)


def poses(rate, speed):
    """A toss that an engine made, at the samples of a camera (n, 7)."""
    values = {
        "friction": FRICTION, "start_rate_y_rad_s": rate, "start_velocity_x_m_s": speed,
        "duration_s": SAMPLES / RATE_HZ,
    }  # fmt: skip
    scene = FILE.resolve(values, step_s=1 / RATE_HZ / PARTS)
    found = engines.get("dart").simulate(scene, Settings()).signals
    rows = slice(0, None, PARTS)
    return np.hstack([found["cube.position_m"][rows], found["cube.orientation_wxyz"][rows]])


def log(folder, tosses, name="tosses"):
    path = folder / f"{name}.npz"
    lengths = [len(toss) for toss in tosses]
    np.savez(path, pose=np.vstack(tosses), length=lengths, toss_id=np.arange(len(tosses)))
    return path


@pytest.fixture(scope="module")
def made():
    return [poses(rate, 0.8 + 0.1 * i) for i, rate in enumerate((2, 4, -3, 1, 3, -2, 5, 0.5))]


@pytest.fixture
def mapping(tmp_path):
    path = tmp_path / "map.yaml"
    path.write_text(MAP, encoding="utf-8")
    return path


def test_the_command_fits_stores_reports_and_is_run_again(made, mapping, tmp_path, call):
    recording = log(tmp_path, made)
    code, out, err = call(
        "fit", "cube_toss", "-r", recording, "--map", mapping, "--engine", "dart,pymunk",
        "--unknown", "friction", "-o", tmp_path / "runs", "--json", "--no-report",
    )  # fmt: skip
    assert code == 0, err
    record = json.loads(out)
    assert (record["by"], record["contact"], record["assist"]) == ("tosses", "assisted", "all")
    assert (len(record["fitted"]), len(record["held_out"])) == (4, 4)
    dart, pymunk = record["sources"]
    own = dart["parameters"]["friction"]
    low, high = own["interval95"]
    assert own["value"] == pytest.approx(FRICTION)
    assert low < FRICTION < high
    assert high - low >= 2 * own["spacing"]
    assert dart["holdout"]["position"]["mean"] < 1
    assert len(dart["holdout"]["rotations"]) == 4
    assert (pymunk["status"], pymunk["parameters"]) == ("unsupported", {})
    assert "plane" in pymunk["reason"]
    folder = Path(record["run"])
    written = json.loads((folder / "fit.json").read_text(encoding="utf-8"))
    assert {**written, "run": record["run"]} == record
    run = store.load(folder)
    assert isinstance(run.record.fit, TossFit)
    assert short.short(run)[1].endswith("% of the cube's width (95 %).")
    page = builder.write_html([run], tmp_path / "report.html").read_text(encoding="utf-8")
    for text in ("Tosses that were predicted", "What was tried", "seed 1", "simcompare fit cube"):
        assert text in page
    again = simcompare.run("cube_toss", engine="dart,pymunk", contact=str(folder))
    source = again.record.sources[0]
    held = [row.set_value for row in source.audit if "friction" in row.engine_parameter]
    assert pytest.approx(own["value"]) in held
    assert again.record.sources[1].reason == "pymunk: not in this fit"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"model": "constant"}, "model: cube_toss is fitted by tosses"),
        ({"priors": {"restitution": (0.2, 0.1)}}, "priors: cube_toss is"),
        ({"u_time_s": 1e-3}, "u_time_s: cube_toss is"),
        ({"unknowns": ["clock_skew"]}, "parameter of cube_toss that can be fitted"),
        ({"set": {"start_x": 1}}, "start_x_m is read off each toss"),
        ({"set": {"friction": 0.2}, "fixed": {"restitution": 0.1}}, "nothing is left to fit"),
        ({"fixed": {"scale": -1}}, "-1 is no scale; expected a number above 0"),
        ({"fixed": {"frction": 1}}, "did you mean friction"),
        ({"preset": "wood"}, "preset of cube_toss"),
        ({"hold_out": ["cube_toss"]}, "is given twice"),
        ({"assist": "some"}, "help is called 'some'"),
        ({"step": "0"}, "step: 0 is not a time above 0"),
    ],
)
def test_what_tosses_cannot_be_asked_for_is_refused(options, message):
    with pytest.raises(SimcompareError) as caught:
        simcompare.fit("cube_toss", recordings=["cube_toss"], engine="dart", **options)
    assert message in str(caught.value)


def test_two_tosses_tell_nothing(made, mapping, tmp_path):
    with pytest.raises(InputError, match="2 tosses can be used; expected at least 8, or 4 and"):
        simcompare.fit("cube_toss", recordings=[log(tmp_path, made[:2])], mapping=mapping)


def test_a_recording_without_poses_is_one_fault(made, mapping, tmp_path):
    mapping.write_text(MAP.partition("  q_z")[0], encoding="utf-8")
    with pytest.raises(InputError) as caught:
        simcompare.fit("cube_toss", recordings=[log(tmp_path, made)], mapping=mapping)
    (fault,) = caught.value.faults
    assert "toss.0, toss.1, toss.2 and 5 more: no channel q_z; expected the poses" in fault


def test_uneven_samples_are_refused(made, tmp_path):
    times = np.arange(len(made[0])) / RATE_HZ
    times[30:] += 0.003
    path = tmp_path / "toss.csv"
    header = "t," + ",".join(name for name, _ in CHANNELS)
    np.savetxt(path, np.column_stack([times, made[0]]), delimiter=",", header=header, comments="")
    mapping = tmp_path / "map.yaml"
    mapping.write_text(
        "time: {column: t, unit: s}\nchannels:\n"
        + "".join(f"  {name}: {{column: {name}, unit: {unit}}}\n" for name, unit in CHANNELS),
        encoding="utf-8",
    )
    with pytest.raises(InputError, match="log: samples are not evenly spaced"):
        simcompare.fit("cube_toss", recordings=[path], mapping=mapping)


def test_a_toss_that_is_too_short_is_left_out_and_said(made, mapping, tmp_path):
    early = made[0][:6]
    run = simcompare.fit(
        "cube_toss", recordings=[log(tmp_path, [early, *made])], mapping=mapping, engine="pymunk"
    )
    assert run.record.fit.told[0].startswith("Fitted to 4 of the 8 tosses")
    assert "Left out" in run.record.fit.told[1]
    assert "toss.0: fewer than 10 samples" in run.record.fit.told[1]


def test_tosses_that_are_held_out_by_name_are_predicted_and_all_others_fitted(
    made, mapping, tmp_path
):
    fitted, held = log(tmp_path, made[:5], "fitted"), log(tmp_path, made[5:], "held")
    found = prepare(
        roles_of(FILE, {}), [str(fitted)], [str(held)], unknowns=["inertia"], given={},
        scale=0.98, mapping=mapping,
    )  # fmt: skip
    assert list(found.grids) == ["inertia_kg_m2"]
    assert (len(found.fitted), len(found.held)) == (5, 3)
    assert found.told == (f"Fitted to the 5 tosses of {fitted}; the 3 of {held} are predicted.",)
    np.testing.assert_allclose(found.fitted[0].position_m, made[0][:, :3] / 0.98)


# --- roles -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("  body: cube\n", "  body: cuke\n", "fit.body: no body is called 'cuke'; did you mean"),
        ("  body: cube\n", "", "fit.body: is missing and needed for by: tosses"),
        ("  width: width_m\n", "", "fit.width: is missing and needed for by: tosses; expected a"),
        ("  width: width_m\n", "  width: mass_kg\n", "'mass_kg' is in kg; expected a parameter"),
        ("  width: width_m\n", "  width: start_x_m\n", "is the width already"),
        ("[start_rate_x_rad_s, ", "[start_rate_u_rad_s, ", "is called 'start_rate_u_rad_s'"),
        ("[start_rate_x_rad_s, ", "[", "fit.start_rate"),
        ("  duration: duration_s\n", "  height: start_z_m\n", "only fits by: bounces have this"),
        ("by: tosses", "by: waveform", "only fits by: tosses have this"),
        ("    friction: {spacing: 0.04, min: 0.02, max: 1}\n", "", "'friction' has no grid"),
        ("    friction: {spacing", "    mass_kg: {spacing", "is none of fit.parameters"),
        ("spacing: 0.04, min: 0.02, max: 1}", "spacing: 1, min: 0.02, max: 1}", "has no room"),
        ("parameters: [friction,", "parameters: [width_m,", "is known of each toss"),
    ],
)
def test_a_wrong_role_is_a_clear_fault(tmp_path, old, new, message):
    text = FILE.path.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "cube_toss.yaml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        catalogue.load(str(path))
    assert message in str(caught.value)
    assert "line " in str(caught.value)


def test_only_a_cube_is_fitted(tmp_path):
    path = tmp_path / "cube_toss.yaml"
    text = FILE.path.read_text(encoding="utf-8")
    size = 'size_m: ["${width_m}", "${width_m}", '
    path.write_text(text.replace(size, 'size_m: ["${width_m}", 0.2, '), encoding="utf-8")
    with pytest.raises(InputError, match=r"cube is no box with edges of 0.1048 m; only a cube"):
        roles_of(catalogue.load(str(path)), {})


# --- the search --------------------------------------------------------------------------------

GRIDS = {"a": Grid(spacing=0.4, min=0, max=1), "b": Grid(spacing=4, min=-10, max=10)}


def errors_at(a, b, count=40):
    """Errors of tosses, each with a best point of its own about (0.35, 3)."""
    off = np.random.default_rng(1).normal(size=(count, 2))
    cost = 10 + 100 * (a - 0.35 - 0.03 * off[:, 0]) ** 2 + (b - 3 - 0.5 * off[:, 1]) ** 2
    return tuple(Errors(value, value, value) for value in cost.tolist())


def searched(able=lambda a, b: True):
    search = Search(GRIDS, (0.1, -2.0))
    while points := search.wanted():
        for point in points:
            search.tried[point] = errors_at(*point) if able(*point) else None
    return search


def test_the_search_ends_beside_the_minimum_and_says_how_near():
    search = searched()
    for name, truth in (("a", 0.35), ("b", 3.0)):
        own, spacing = estimates(search)[name], GRIDS[name].spacing / 8
        assert abs(own.value - truth) <= spacing
        low, high = own.interval95
        assert low <= own.value - spacing < truth < own.value + spacing <= high
        assert own.u > spacing / 3
        assert not own.at_bound


def test_points_that_an_engine_cannot_are_not_chosen():
    search = searched(lambda a, b: b < 2.5)
    assert search.best[1] < 2.5
    assert None in search.tried.values()
    assert estimates(search)["b"].value == search.best[1]


def test_a_minimum_beyond_the_range_ends_at_its_bound():
    search = Search({"a": Grid(spacing=0.1, min=0, max=0.2)}, (0.1,))
    while points := search.wanted():
        for point in points:
            search.tried[point] = errors_at(*point, 3.0)
    own = estimates(search)["a"]
    assert (own.value, own.at_bound, own.open, own.interval95[1]) == (0.2, True, True, 0.2)


def test_what_no_toss_tells_has_the_whole_range_for_an_interval():
    search = Search(GRIDS, (0.1, -2.0))
    while points := search.wanted():
        for point in points:
            search.tried[point] = errors_at(point[0], 3.0)  # whatever b is
    told, untold = (estimates(search)[name] for name in "ab")
    assert not told.open
    assert untold.interval95 == (GRIDS["b"].min, GRIDS["b"].max)
    assert untold.open
    assert untold.u == pytest.approx((GRIDS["b"].max - GRIDS["b"].min) / 12**0.5)


# --- engines that fail -------------------------------------------------------------------------


def failing(status, after):
    """Jobs whose inquiries fail, all or those after the first so many."""

    def run(jobs, **options):
        if any(isinstance(job, Job) for job in jobs):
            return run_jobs(jobs, **options)
        flat = Errors(1.0, 1.0, 1.0)
        good = toss_engines.Replayed(flat, 0.1)
        replies = []
        for number, job in enumerate(jobs):
            bad = dataclasses.replace(job.failed("dart: it broke"), status=status)
            fine = dataclasses.replace(bad, status="ok", reason=None, value=good)
            replies.append(fine if number < after else bad)
        return replies

    return run


@pytest.mark.parametrize("after", [0, 2])
@pytest.mark.parametrize("status", [FAILED, UNSUPPORTED])
def test_an_engine_that_breaks_is_a_row_with_its_reason(made, monkeypatch, status, after):
    times = np.arange(len(made[0])) / RATE_HZ
    tosses = tuple(Toss(str(i), times, one[:, :3], one[:, 3:]) for i, one in enumerate(made[:2]))
    grids = {"friction": Grid(spacing=0.04, min=0.02, max=1)}
    monkeypatch.setattr(toss_engines, "run_jobs", failing(status, after))
    setup = Setup(grids, tosses, (), 1.0, (), ())
    how = toss_engines.How(halvings=0)
    (found,) = toss_engines.fit_engines(roles_of(FILE, {}), setup, ["dart"], how)
    if status == UNSUPPORTED and after:  # only neighbours are out of reach
        assert found.is_ok
        assert found.search.best == (0.18,)
    else:
        where = "0.18" if after == 0 else "0.14"
        assert found.outcome.status == status
        assert found.outcome.reason == f"dart: it broke (with friction = {where})"


# --- what is said ------------------------------------------------------------------------------


def record(**changes):
    parameter = {
        "value": 0.2, "u": 0.01, "interval95": [0.18, 0.22], "unit": "1", "u_num": 0.002,
        "spacing": 0.005, "open": False, "at_bound": False,
    }  # fmt: skip
    mean = {"mean": 12.0, "sd": 3.0, "interval95": [11.0, 13.0]}
    held = {"position": mean, "rotation": mean, "positions": [11.0, 13.0], "rotations": [1, 2]}
    source = {
        "name": "dart", "version": "1", "contact": "assisted", "status": "ok", "reason": None,
        "simulations": 9, "wall_s": 2.0, "cost": 15.0,
        "parameters": {"friction": {**parameter, **changes.pop("parameter", {})}},
        "holdout": held, "tried": [{"values": {"friction": 0.2}, "cost": 15.0}],
    }  # fmt: skip
    return TypeAdapter(TossFit).validate_python({
        "contact": "assisted", "assist": "all", "scenario": "cube_toss", "given": {},
        "unknowns": ["friction"], "width_m": 0.1, "fitted": ["a"], "held_out": ["b", "c"],
        "scale": 1.0, "witnesses": [], "told": [], "sources": [source],
        "valid": {"step_s": 5e-4, "engine_step_s": 5e-4, "duration_s": 1, "speed_m_s": [1, 2]},
        "run_with": {"closed": {}, "engines": {}}, **changes,
    })  # fmt: skip


@pytest.mark.parametrize("contact", ["assisted", TUNED])
def test_a_stored_fit_gives_each_engine_its_own_values(tmp_path, contact):
    found = record(contact=contact, run_with={"closed": {}, "engines": {"dart": {"friction": 0.2}}})
    path = tmp_path / "fit.json"
    path.write_text(json.dumps(plain(found)), encoding="utf-8")
    fit = fit_file.read(path)
    assert fit.of_engine("dart", FILE) == {"friction": 0.2}
    assert fit.of_engine("ode", FILE) is None
    assert f"{FILE.name}, fitted at 1.00 to 2.00 m/s" in contact_values.contact_values(path)


WITNESS = {"name": "both", "scale": 0.98, "u": 0.004, "text": ""}


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({}, "dart lands the tosses best with friction 0.2 (95 %: 0.18 to 0.22)."),
        ({"parameter": {"interval95": [0.2, 0.2]}}, "friction 0.2 (95 %: 0.2)."),
        ({}, "In 2 tosses that were not fitted, dart is off by 12.0 (11.0 to 13.0) % of the cube"),
        ({}, "hold with all our helps, at a step of 0.5 ms"),
        ({"contact": TUNED, "assist": "none"}, "hold for a plain loop with a step of 0.5 ms"),
        ({"witnesses": [WITNESS]}, "--fix scale=0.9800 corrects them"),
        ({"witnesses": [WITNESS], "scale": 0.98}, "All lengths were divided by 0.98"),
        ({"witnesses": [{**WITNESS, "u": 0.02}]}, "as they should be"),
        ({"parameter": {"at_bound": True, "open": True}}, "In dart the friction ended at its"),
        ({"parameter": {"open": True}}, "In dart the tosses hardly tell the friction"),
    ],
)
def test_the_answer_says_what_must_be_known(changes, text):
    assert text in " ".join(sentences(record(**changes)))


def test_the_terminal_shows_every_engine(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    console.show_table(tosses.engines(record()))
    out = capsys.readouterr().out
    assert "dart 1" in out
    assert "12.0 (11.0 to 13.0)" in out
    assert TUNED not in out
