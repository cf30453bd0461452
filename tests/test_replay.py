"""Scenes that can be played: surfaces, motion, and what a page holds of them."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence
from pydantic import TypeAdapter

import simcompare
from simcompare.engine import engines
from simcompare.errors import InputError, OutputError, UnknownName
from simcompare.model import drawing
from simcompare.model.drawing import DrawnBody, DrawnEye, drawn
from simcompare.model.rotations import rotate
from simcompare.model.settings import Settings
from simcompare.model.shapes import Shape
from simcompare.model.trajectory import TRUTH, Array, Trajectory
from simcompare.reports import builder
from simcompare.reports.pages import document
from simcompare.reports.render import film, matplotlib_replay, replay_page
from simcompare.reports.render.meshes import Mesh, mesh_of, sheet
from simcompare.reports.render.staging import Source, staged
from simcompare.reports.run.replay import replay_of
from simcompare.results.run import Stored
from simcompare.scenarios import catalogue
from simcompare.verbs.result import Result

SHAPES: TypeAdapter[Shape] = TypeAdapter(Shape)
TURNED = [0.5, 0.5, -0.5, 0.5]


def _shape(**what: object) -> Shape:
    return SHAPES.validate_python(
        {"position_m": [0.3, -0.2, 1.0], "orientation_wxyz": TURNED} | what
    )


def _volume_m3(mesh: Mesh) -> float:
    """Of a closed surface whose triangles are turned outwards (divergence theorem)."""
    a, b, c = (mesh.corners[mesh.triangles[:, i]] for i in range(3))
    return float(np.sum(np.einsum("ij,ij->i", a, np.cross(b, c))) / 6)


@pytest.mark.parametrize(
    ("shape", "exact_m3"),
    [
        (_shape(type="box", size_m=[0.1, 0.2, 0.4]), 0.1 * 0.2 * 0.4),
        (_shape(type="sphere", radius_m=0.3), 4 / 3 * np.pi * 0.3**3),
        (_shape(type="cylinder", radius_m=0.2, length_m=0.5), np.pi * 0.2**2 * 0.5),
        (
            _shape(type="capsule", radius_m=0.2, length_m=0.5),
            np.pi * 0.2**2 * 0.5 + 4 / 3 * np.pi * 0.2**3,
        ),
    ],
)
def test_a_shape_is_a_closed_surface_of_its_volume(shape: Shape, exact_m3: float) -> None:
    mesh = mesh_of([shape])
    # what is round has flat sides: 18 around and 8 from pole to pole lose 2 % and 5 %
    assert exact_m3 * 0.9 < _volume_m3(mesh) <= exact_m3 * (1 + 1e-9)
    corners = np.round(mesh.corners, 9)
    edges = Counter(
        (tuple(corners[one]), tuple(corners[other]))
        for triangle in mesh.triangles
        for one, other in zip(triangle, np.roll(triangle, -1), strict=True)
        if (corners[one] != corners[other]).any()
    )
    assert all(edges[other, one] == count for (one, other), count in edges.items())


def test_a_sheet_lies_in_its_plane_and_fills_the_box() -> None:
    normal = np.array([-0.6, 0.0, 0.8])
    mesh = sheet(np.array([1.0, 0.0, 0.5]), normal, np.array([-1.0, -2, 0]), np.array([3.0, 2, 9]))
    assert np.allclose((mesh.corners - [1.0, 0.0, 0.5]) @ normal, 0, atol=1e-12)
    assert np.ptp(mesh.corners, axis=0)[:2].tolist() == [4.0, 4.0]


@pytest.fixture(scope="module")
def run() -> Result:
    found: Result = simcompare.run("ball", engine="pymunk", contact="default,tuned", seeds=1)
    return found


def test_a_run_is_replayed_as_it_was_simulated(run: Result) -> None:
    replay = replay_of(run)
    assert replay is not None
    assert replay.levels == ["by default, as it comes", "tuned, in a plain loop"]
    assert [actor.label for actor in replay.shown(replay.levels[0])] == [
        f"truth ({TRUTH})", "pymunk",
    ]  # fmt: skip
    stored = next(one for one in run.trajectories if one.contact == "default").trajectory
    actor = next(one for one in replay.actors if one.level == replay.levels[0])
    heights = np.interp(replay.time_s, stored.time_s, stored.signals["ball.position_m"][:, 2])
    # a picture shows the next sample: the ball falls at most 4.4 m/s for one step of 1 ms
    assert actor.motions["ball"].position_m[:, 2] == pytest.approx(heights, abs=5e-3)


def test_sources_of_a_falling_ball_stand_side_by_side(run: Result) -> None:
    replay = replay_of(run)
    assert replay is not None
    assert replay.is_flat
    assert replay.is_upright


def test_who_flies_away_is_not_followed(run: Result) -> None:
    near = replay_of(run)
    gone = next(one for one in run.trajectories if one.contact == "tuned")
    signals = dict(gone.trajectory.signals)
    signals["ball.position_m"] = signals["ball.position_m"] * [1.0, 1.0, 28_000.0]
    away = replace(gone, trajectory=replace(gone.trajectory, signals=signals))
    far = replay_of(
        replace(run, trajectories=tuple(away if one is gone else one for one in run.trajectories))
    )
    assert near is not None
    assert far is not None
    assert far.high_m[2] < 2 * near.high_m[2]


def test_a_page_holds_the_motion_and_stays_small(run: Result, tmp_path: Path) -> None:
    replay = replay_of(run)
    assert replay is not None
    text = replay_page.embedded(replay)
    assert len(text) < 1e6  # what a replay may add to a report
    held = json.loads(text)
    motion = held["actors"][0]["motions"]["ball"]["at"]
    found = np.frombuffer(base64.b64decode(motion), dtype="<f4").reshape(-1, 3)
    assert found == pytest.approx(replay.actors[0].motions["ball"].position_m, abs=1e-6)
    turns = np.frombuffer(base64.b64decode(held["actors"][0]["motions"]["ball"]["turn"]), "<i2")
    assert turns.tolist() == [32767, 0, 0, 0]  # the ball does not turn, so it is told once
    page = builder.write_html([run], tmp_path / "report.html").read_text(encoding="utf-8")
    assert text in page
    assert "class Replay" in page


def test_a_run_without_a_scene_has_no_player(run: Result, tmp_path: Path) -> None:
    """Those that were stored before scenes were."""
    old = replace(run, record=replace(run.record, scene={}))
    page = builder.write_html([old], tmp_path / "report.html").read_text(encoding="utf-8")
    assert "class Replay" not in page


def test_a_body_is_drawn_by_its_visual_and_simulated_by_its_shapes() -> None:
    robot = catalogue.load("robot").resolve()
    wheel = robot.bodies["left_wheel"]
    assert [shape.type for shape in wheel.shapes] == ["sphere"]
    assert [shape.type for shape in drawing.drawn(robot)["left_wheel"].shapes] == [
        "cylinder",
        "box",
    ]


@pytest.mark.parametrize("name", catalogue.names())
def test_a_scenario_can_be_seen(name: str) -> None:
    """With all its presets; bodies that only carry others may stay unseen."""
    file = catalogue.load(name)
    for values in [{}, *(preset.set for preset in file.presets.values())]:
        scene = drawn(file.resolve(dict(values)))
        moving = [body for body in scene.values() if not body.fixed]
        assert moving
        assert all(len(mesh_of(body.shapes).corners) for body in moving)


def test_engines_never_see_how_a_body_is_drawn() -> None:
    file = catalogue.load("pendulum")
    scenario = file.resolve()
    bare = scenario.model_copy(
        update={
            "bodies": {
                name: body.model_copy(update={"visual": ()})
                for name, body in scenario.bodies.items()
            }
        }
    )
    backend = engines.get("pymunk")
    one, other = (backend.simulate(each, Settings()) for each in (scenario, bare))
    assert np.array_equal(one.signals["bob.position_m"], other.signals["bob.position_m"])


def _turning(rate_rad_s: float, duration_s: float) -> Trajectory:
    time_s = np.arange(0, duration_s, 1e-3)
    half = rate_rad_s * time_s / 2
    turns = np.stack([np.cos(half), 0 * half, np.sin(half), 0 * half], axis=1)
    place = np.zeros((len(time_s), 3))
    return Trajectory("engine", time_s, {"disc.position_m": place, "disc.orientation_wxyz": turns})


DISC = {
    "disc": DrawnBody(
        False, (0, 0, 0), (1, 0, 0, 0), (_shape(type="box", size_m=[0.1, 0.02, 0.1]),)
    )
}


def test_what_turns_fast_is_shown_often_enough() -> None:
    """Above half a turn from picture to picture it would seem to turn backwards."""
    replay = staged(DISC, [Source("engine", "#112233", "", _turning(300, 1.0))], "")
    assert replay is not None
    motion = replay.actors[0].motions["disc"]
    assert 300 / len(replay.time_s) < np.pi / 2
    assert motion.position_m.shape == (1, 3)


def test_what_stays_in_its_place_stands_side_by_side_along_its_swing() -> None:
    """A disc on an axle along y is seen along y."""
    replay = staged(DISC, [Source("engine", "#112233", "", _turning(10, 1.0))], "")
    assert replay is not None
    assert (replay.across, replay.is_flat, replay.is_upright) == (0, True, True)


LOOKING = {"eye": DrawnEye("cart", (0.1, 0, 0), (1, 0, 0, 0), 8, None, None)}
CART = {
    "cart": DrawnBody(False, (0, 0, 0), (1, 0, 0, 0), (_shape(type="box", size_m=[0.1, 0.1, 0.1]),))
}


def _looking(ranges: Array) -> Trajectory:
    """A cart that is turned to the left and drives there, past what it sees."""
    count = len(ranges)
    time_s = np.linspace(0, 1, count)
    place = np.column_stack((0 * time_s, time_s, 0 * time_s))
    left = np.tile([np.sqrt(0.5), 0, 0, np.sqrt(0.5)], (count, 1))
    signals = {"cart.position_m": place, "cart.orientation_wxyz": left, "eye.range_m": ranges}
    return Trajectory("engine", time_s, signals)


def test_rays_end_where_a_sensor_sees_something() -> None:
    ranges = np.full((61, 64), 2.0)
    ranges[:, 0] = 4.0  # the reach: there is nothing
    source = Source("engine", "#112233", "", _looking(ranges))
    replay = staged(CART, [source], "", LOOKING)
    assert replay is not None
    ends = replay.actors[0].ray_ends("eye", replay.eyes["eye"])
    assert np.isnan(ends[:, 0]).all()
    # ahead is now to the left: 2 m before the sensor, which is 0.1 m before the cart
    assert ends[-1, 1:, 1] == pytest.approx(1 + 0.1 + 2.0)
    assert ends[-1, 7, 0] == pytest.approx(2 * np.tan(np.radians(3.5 * 5.625)))  # right, above
    assert ends[-1, 7, 2] == pytest.approx(2 * np.tan(np.radians(3.5 * 5.625)))
    assert replay.high_m[1] >= 3.1
    assert not replay.is_flat


def test_a_page_holds_ranges_as_whole_numbers() -> None:
    ranges = np.linspace(0.5, 4.0, 3)[:, None] * np.ones(64)
    replay = staged(CART, [Source("engine", "#112233", "", _looking(ranges))], "", LOOKING)
    assert replay is not None
    (actor,) = replay_page.as_dict(replay)["actors"]
    packed = np.frombuffer(base64.b64decode(actor["ranges"]["eye"]), "<u2").reshape(-1, 64)
    assert len(packed) == len(replay.time_s)
    assert packed[0] / 65535 * 4 == pytest.approx(0.5, abs=1e-4)
    assert not packed[-1].any()  # at its reach it sees nothing


def test_a_source_that_tells_no_ranges_has_no_rays() -> None:
    moved = _looking(np.ones((5, 64)))
    del moved.signals["eye.range_m"]  # type: ignore[attr-defined]
    replay = staged(CART, [Source("engine", "#112233", "", moved)], "", LOOKING)
    assert replay is not None
    assert not replay.actors[0].ranges


def test_a_placed_surface_is_turned_and_moved(run: Result) -> None:
    replay = replay_of(run)
    assert replay is not None
    actor, mesh = replay.actors[1], replay.bodies["ball"]
    placed = actor.placed("ball", mesh, 5)
    motion = actor.motions["ball"]
    turn = np.tile(
        motion.orientation_wxyz[min(5, len(motion.orientation_wxyz) - 1)], (len(mesh.corners), 1)
    )
    assert placed.corners == pytest.approx(rotate(turn, mesh.corners) + motion.position_m[5])


def test_a_still_is_a_picture(run: Result) -> None:
    replay = replay_of(run)
    assert replay is not None
    assert matplotlib_replay.rendered(replay, replay.levels[0])[:4] == b"\x89PNG"


def _short(run: Result) -> Result:
    """The same run, of which only the first 0.1 s are there: films take a while to draw."""
    stored = tuple(
        replace(one, trajectory=_beginning(one.trajectory, 0.1)) for one in run.trajectories
    )
    return replace(run, trajectories=stored)


def _beginning(trajectory: Trajectory, end_s: float) -> Trajectory:
    count = int(np.searchsorted(trajectory.time_s, end_s))
    signals = {name: values[:count] for name, values in trajectory.signals.items()}
    return replace(trajectory, time_s=trajectory.time_s[:count], signals=signals)


def test_a_film_is_as_long_as_what_it_shows(run: Result, tmp_path: Path) -> None:
    told: list[tuple[str, int, int]] = []
    written = simcompare.report(
        _short(run), format="gif", contact="tuned", out=tmp_path / "ball.gif",
        progress=lambda *step: told.append(step),
    )  # fmt: skip
    with Image.open(written) as seen:
        # 0.1 s at 25 pictures a second, first and last one included
        assert len([*ImageSequence.Iterator(seen)]) == len(told) == 3
        assert seen.info["duration"] == 40
    assert told[-1] == ("film", 3, 3)


def test_a_film_never_replaces_one_of_somebody_else(run: Result, tmp_path: Path) -> None:
    theirs = tmp_path / "ball.gif"
    Image.new("RGB", (4, 4)).save(theirs)
    with pytest.raises(OutputError, match="is another file"):
        simcompare.report(_short(run), format="gif", out=theirs)


def test_a_long_run_plays_faster_in_a_film(run: Result) -> None:
    replay = replay_of(run)
    assert replay is not None
    long = replace(replay, time_s=np.linspace(0, 60, len(replay.time_s)))
    places, faster = film.instants(long)
    assert len(places) == 500
    assert faster == pytest.approx(60 * 25 / 500, rel=0.01)
    assert film.instants(replay)[1] == 1


def test_a_film_is_written_as_mp4_where_there_is_an_ffmpeg(run: Result, tmp_path: Path) -> None:
    if shutil.which("ffmpeg") is None:
        pytest.importorskip("imageio_ffmpeg")
    written = simcompare.report(_short(run), format="mp4", out=tmp_path / "ball.mp4")
    assert written.read_bytes()[4:8] == b"ftyp"
    simcompare.report(_short(run), format="mp4", out=written)  # one of ours is replaced


def test_without_ffmpeg_the_cure_is_told(
    run: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(InputError, match=r"no ffmpeg is installed; cure: install ffmpeg, or: pip"):
        simcompare.report(run, format="mp4", out=tmp_path / "ball.mp4")


def test_a_film_shows_one_run_at_a_level_that_it_has(run: Result, tmp_path: Path) -> None:
    out = tmp_path / "ball.gif"
    with pytest.raises(InputError, match="2 runs are given; a film shows one"):
        simcompare.report([run, run], format="gif", out=out)
    with pytest.raises(UnknownName, match="no contact level is called 'assisted'"):
        simcompare.report(run, format="gif", contact="assisted", out=out)
    with pytest.raises(InputError, match="pdf shows all levels"):
        simcompare.report(run, format="pdf", contact="tuned", out=out)
    old = replace(run, record=replace(run.record, scene={}))
    with pytest.raises(InputError, match="nothing moves in"):
        simcompare.report(old, format="gif", out=out)
    assert not out.exists()


def test_paper_shows_the_scene(run: Result) -> None:
    pages = document(builder.blocks_of([run]))
    assert any(
        picture.get_size() == (800, 1440)  # 4 × 7.2 inches of 200 dots
        for page in pages
        for axes in page.axes
        for picture in axes.images
    )


def _show(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "simcompare", "show", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_show_draws_the_scene(tmp_path: Path) -> None:
    place = tmp_path / "scene.png"
    done = _show("ball", "--json", "--picture", str(place))
    assert json.loads(done.stdout)["is_visible"]
    assert f"Picture: {place}" in done.stderr
    with Image.open(place) as picture:
        assert picture.format == "PNG"
    refused = _show("ball", "--picture", str(tmp_path / "scene.jpg"))
    assert refused.returncode == 2
    assert "a picture is a PNG file" in refused.stderr


def test_a_notebook_shows_the_scene() -> None:
    assert "data:image/png;base64," in simcompare.show("cube_toss")._repr_html_()


def test_a_scene_that_nobody_sees_is_told(tmp_path: Path) -> None:
    file = tmp_path / "bare.yaml"
    file.write_text(
        "name: bare\ntitle: Bare\nquestion: Is it seen?\nparameters: {}\n"
        "world: {gravity_m_s2: [0, 0, 0], duration_s: 1, step_s: 0.01}\n"
        "bodies: {point: {mass_kg: 1, inertia_kg_m2: [1, 1, 1]}}\n"
        "probes: {x_m: {observe: point.position_m, component: 0, label: Place, unit: m}}\n"
    )
    facts = simcompare.show(file)
    assert not facts.is_visible
    assert "data:image" not in facts._repr_html_()
    with pytest.raises(InputError, match="no body has shapes or visual"):
        facts.plot()


@pytest.mark.parametrize("name", catalogue.names())
def test_the_page_of_a_scenario_begins_with_its_picture(name: str) -> None:
    page = catalogue.load(name).path.with_name("README.md")
    assert f"({name}.png)" in page.read_text(encoding="utf-8").split("```")[0]
    assert page.with_name(f"{name}.png").stat().st_size < 60_000


def test_a_fit_plays_what_was_measured_beside_the_engines(run: Result) -> None:
    """The first segment of a recording; what is measured has no parameters of its own."""
    moved = next(one for one in run.trajectories if one.source == "pymunk")
    measured = Stored("measured", "", 0, moved.trajectory)
    engine = replace(moved, parameters="best")
    later = replace(engine, segment=1)
    record = replace(run.record, kind="validation")
    replay = replay_of(replace(run, record=record, trajectories=(measured, later, engine)))
    assert replay is not None
    assert [(one.label, one.level) for one in replay.actors] == [
        ("measured", ""), ("pymunk", "with the fitted parameters"),
    ]  # fmt: skip
    # a recording alone is no comparison
    assert replay_of(replace(run, record=record, trajectories=(measured,))) is None


def test_many_sources_that_turn_fast_stay_small() -> None:
    """Seven engines at four levels and two steps, and more."""
    moved = _turning(300, 2.0)
    sources = [Source(f"engine {k}", "#112233", f"level {k % 4}", moved) for k in range(60)]
    replay = staged(DISC, sources, "")
    assert replay is not None
    assert len(replay_page.embedded(replay)) < 1e6


def test_a_picture_runs_no_code_that_nobody_said_yes_to(tmp_path: Path) -> None:
    folder = tmp_path / "ball"
    shutil.copytree(catalogue.load("ball").path.parent, folder)
    ran = tmp_path / "ran"
    (folder / "reference.py").write_text(f"open({str(ran)!r}, 'w').close()\n")
    assert simcompare.show(folder).plot().axes
    assert not ran.exists()
