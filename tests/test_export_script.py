"""Scripts run without simcompare and move as its own runs do, to the last bit."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

import simcompare
from simcompare.engine import engines
from simcompare.engine.calibration.plan import drop_plans
from simcompare.errors import InputError, UnknownName
from simcompare.exporters.scripts import expected, write
from simcompare.model.settings import CONTACT_LEVELS, Settings
from simcompare.model.trajectory import BODY_SIGNALS
from simcompare.scenarios import catalogue

LEVELS = [level for level in write.LEVELS if level in CONTACT_LEVELS]
RUNNER = Path(__file__).with_name("script_runner.py")
PHASE = 0.37
#: lines of a scene with one moving body, and of others
MOST_LINES = (60, 120)
#: more lines for each thing that stands about, beside a floor: a body, and its pair with each wheel
MORE_LINES = 7
MOST_SIGNS = 100


def save(folder, made, arg=None):
    (folder / f"{made.name}.py").write_text(made.text, encoding="utf-8")
    if made.inputs:
        np.savez(folder / f"{made.name}_inputs.npz", **made.inputs)
    if arg is not None:
        (folder / f"{made.name}.arg").write_text(str(arg))


def run_all(folder):
    """What every script of a folder printed, each in one process that has no simcompare."""
    done = subprocess.run(
        [sys.executable, "-I", str(RUNNER), str(folder)],
        capture_output=True, text=True, timeout=300, check=False, cwd=folder,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@dataclass
class Written:
    """All scripts of an engine.

    Attributes:
        engine: its name.
        folder: where they are.
        made: (scenario, level) -> script.
        own: (scenario, level) -> the scene of simcompare's own run at phase 0, and that run, which
            the numbers in the script are of.
        said: name -> what the script printed.
    """

    engine: str
    folder: Path
    made: dict = field(default_factory=dict)
    own: dict = field(default_factory=dict)
    said: dict = field(default_factory=dict)


#: engines whose scenes can be written as scripts
WRITERS = [name for name in engines.names() if getattr(engines.get(name), "script_module", "")]


@pytest.fixture(scope="module", params=WRITERS)
def written(request, tmp_path_factory):
    engine = request.param
    folder = tmp_path_factory.mktemp(engine)
    found = Written(engine, folder)
    runs = []

    def noted(job):
        runs.append((job, run(job)))
        return runs[-1][1]

    run = expected._run
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(expected, "_run", noted)
        for scenario in catalogue.names():
            for level in LEVELS:
                runs.clear()
                try:
                    name = f"{scenario}_{level}"
                    one = write.script(scenario, engine=engine, contact=level, name=name)
                except InputError:  # the engine refuses it, see test_backends
                    continue
                found.made[scenario, level] = one
                found.own[scenario, level] = runs[len(runs) // 2]
                save(folder, one)
    for level in LEVELS:
        one = write.script("ball", engine=engine, contact=level, name=f"phase_{level}")
        save(folder, one, PHASE)
    found.said = run_all(folder)
    return found


def test_each_script_runs_without_simcompare(written):
    said = written.said
    assert {name: one["error"] for name, one in said.items() if "error" in one} == {}
    assert len(written.made) >= 2 * len(LEVELS)


def assert_same_motion(engine, folder, name, scenario, own):
    stored = np.load(folder / f"{name}_motion.npz")
    assert np.array_equal(stored["t"], own.time_s)
    free, joints = scenario.free_bodies(), scenario.movable_joints()
    # what an engine reads of links is set beside the kinematics of the joints' coordinates; DART's
    # own transforms take small angles by a series
    linked = 1e-10 if engine == "dart" else 1e-12
    for signal in set(stored) - {"t"}:
        owner, part = signal.split(".")
        ours, theirs = stored[signal], own.signals[signal]
        if owner in joints or part.endswith("force_N") or (owner in free and part == "position_m"):
            assert np.array_equal(ours, theirs), f"{name}: {signal}"
            continue
        if part == "orientation_wxyz":
            ours = ours * np.sign(np.sum(ours * theirs, axis=1, keepdims=True))
        size = max(1.0, np.abs(theirs).max())
        most = 1e-12 if owner in free else linked
        if most == 1e-10 and part == "rate_rad_s":
            most *= (
                2  # a quaternion that is 1e-10 off is turned by twice that, and the rate with it
            )
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=most * size, err_msg=signal)
    seen = {f"{body}.{part}" for body in scenario.moving_bodies() for part in BODY_SIGNALS}
    assert seen <= set(stored)


def test_scripts_move_as_simcompares_own_runs(written):
    for (scenario, level), (job, own) in written.own.items():
        name, scene = f"{scenario}_{level}", catalogue.load(scenario).resolve()
        assert (job.engine, job.settings.contact) == (written.engine, level)
        assert job.scenario.parameters == scene.parameters
        if "error" not in written.said[name]:
            assert_same_motion(written.engine, written.folder, name, scene, own)


def test_the_phase_shifts_the_dithered_parameter(written):
    engine, folder, said = written.engine, written.folder, written.said
    file = catalogue.load("ball")
    nominal = file.resolve()
    dither = nominal.dither
    height = nominal.parameters[dither.parameter] + PHASE * dither.span
    shifted = file.vary(nominal, dither.parameter, height)
    for level in LEVELS:
        assert "error" not in said[f"phase_{level}"]
        stored = np.load(folder / f"phase_{level}_motion.npz")
        # the numbers of tuned are those of the nominal drop, at every phase
        own = engines.get(engine).simulate(shifted, Settings(level, drops=drop_plans(nominal)))
        before = own.time_s < 0.45
        found, wanted = stored["ball.position_m"], own.signals["ball.position_m"]
        np.testing.assert_allclose(found[before], wanted[before], rtol=1e-14, atol=1e-15)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9)
        at_rest = np.load(folder / f"ball_{level}_motion.npz")["ball.position_m"]
        assert found[0, 2] - at_rest[0, 2] == pytest.approx(PHASE * dither.span, rel=1e-9)


def test_what_a_script_measures_is_what_simcompare_measures(written):
    """Where nothing is dithered, so that both are of one run."""
    compared = 0
    for scenario, level in written.made:
        lines = written.said[f"{scenario}_{level}"]["out"].splitlines()
        lines = [line for line in lines if "closed form" in line]
        assert lines, f"{scenario}, {level}: prints no measure"
        if catalogue.load(scenario).resolve().dither is not None:
            continue
        for line in lines:
            head, _, rest = line.partition("closed form")
            here, told = head.split()[-1], rest.split()[-1]
            if told == "–":
                assert here == "nan", f"{scenario}, {level}: {line}"
                continue
            compared += 1
            # by simpler means: periods from straight lines, amplitudes from samples
            size = max(abs(float(told)), 1e-3 if scenario == "pendulum" else 1e-6)
            assert abs(float(here) - float(told)) <= 2e-3 * size, f"{scenario}, {level}: {line}"
    assert compared > 3


def test_scripts_are_short_and_import_only_engine_and_numpy(written):
    module = engines.get(written.engine).library.name
    for (scenario, level), one in written.made.items():
        lines = one.text.splitlines()
        bodies = catalogue.load(scenario).resolve().bodies.values()
        standing = max(0, sum(body.fixed for body in bodies) - 1)
        most = MOST_LINES[len(one.bodies) > 1] + MORE_LINES * standing
        assert len(lines) <= most, f"{scenario}, {level}: {len(lines)} lines"
        wide = [line for line in lines if len(line) > MOST_SIGNS]
        assert wide == [], f"{scenario}, {level}"
        imported = {
            alias.name
            for node in ast.walk(ast.parse(one.text))
            if isinstance(node, ast.Import)
            for alias in node.names
        }
        assert imported <= {"sys", "numpy", module}, f"{scenario}, {level}"


def test_a_ball_tells_the_restitution_of_each_impact(written):
    for level in LEVELS:
        first, second = written.said[f"ball_{level}"]["out"].splitlines()[:2]
        assert first.startswith("restitution of each impact: ")
        each = np.array(first.split()[4:], dtype=float)
        assert each.mean() == pytest.approx(float(second.split()[2]), abs=1e-4)
    assert each[0] == pytest.approx(0.8, abs=0.03)  # what the numbers were tuned for


def test_python_gets_the_same_text(call):
    words = ("--format", "script", "--engine", "pymunk", "--contact", "tuned")
    code, out, err = call("export", "ball", *words)
    assert (code, err) == (0, "")
    text = simcompare.export("ball", format="script", engine="pymunk", contact="tuned")
    assert text == out


def test_python_is_told_what_a_script_cannot():
    with pytest.raises(InputError, match="engine is for"):
        simcompare.export("ball", engine="mujoco")
    with pytest.raises(InputError, match="beside it"):
        simcompare.export("motor_step", format="script", engine="pymunk")
    with pytest.raises(InputError, match="name, folder or file"):
        simcompare.export(catalogue.load("ball").resolve(), format="script", engine="pymunk")
    with pytest.raises(UnknownName, match="script"):
        simcompare.export("ball", format="scrypt")


def test_drag_acts_in_a_script_too(tmp_path):
    made = {}
    for engine in WRITERS:
        settings = {"drag_coefficient": 0.47, "restitution": 0.3}
        one = write.script(
            "ball", engine=engine, contact="coefficients", set=settings, name=f"ball_{engine}"
        )
        save(tmp_path, one)
        made[engine] = catalogue.load("ball").resolve(settings)
    said = run_all(tmp_path)
    for engine, scenario in made.items():
        assert "error" not in said[f"ball_{engine}"], said[f"ball_{engine}"]
        stored = np.load(tmp_path / f"ball_{engine}_motion.npz")["ball.position_m"]
        own = engines.get(engine).simulate(scenario, Settings("coefficients"))
        np.testing.assert_allclose(stored, own.signals["ball.position_m"], rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["ball"], "give one of dart, mujoco, pybullet, pymunk\n"),
        (["ball", "--engine", "nope"], "no engine is called 'nope'"),
        (["ball", "--engine", "mujoco", "--contact", "assisted"], "is no plain loop"),
        (["ball", "--engine", "mujoco", "--contact", "best"], "is no level of a script"),
        (["robot", "--engine", "pymunk"], "no motion out of the x-z plane"),
        (["ball", "--engine", "dart", "--step", "5s"], "--step"),
        (["ball", "--engine", "dart", "--step", "5kg"], "--step"),
        (["ball", "--engine", "dart", "--set", "hight=1"], "hight"),
        (["motor_step", "--engine", "dart"], "-o motor_step_dart.py"),
        (["ball", "--engine", "dart", "-o", "ball.txt"], "ends with .py"),
    ],
)
def test_wrong_words_end_with_a_sentence(call, words, told):
    code, out, err = call("export", *words, "--format", "script")
    assert (code, out) == (2, "")
    assert told in err
    assert "Traceback" not in err


def test_options_of_a_script_are_refused_elsewhere(call):
    code, _, err = call("export", "ball", "--engine", "mujoco")
    assert code == 2
    assert "--engine is for --format script" in err


def test_a_missing_engine_is_told_with_its_cure(monkeypatch):
    from simcompare.errors import EngineMissing
    from simcompare.kit import PipPackage

    absent = PipPackage("no_such_module", "pip install nothing", ["no-such-package"])
    monkeypatch.setattr(type(engines.get("pymunk")), "library", absent)
    with pytest.raises(EngineMissing, match="pip install") as told:
        write.script("ball", engine="pymunk")
    assert told.value.exit_code == 3


def test_a_backend_that_has_no_scripts_says_so(monkeypatch):
    class Other:
        name = "other"

    monkeypatch.setattr(engines, "get", lambda name: Other())
    with pytest.raises(Exception, match="has no method script") as told:
        write.script("ball", engine="other")
    assert told.value.exit_code == 2


def test_the_command_writes_the_script_and_its_inputs(call, tmp_path):
    words = ("--format", "script", "--engine", "pymunk", "-o", tmp_path / "made" / "motor.py")
    code, out, err = call("export", "motor_step", *words)
    assert (code, err) == (0, "")
    assert [Path(line).name for line in out.splitlines()] == ["motor.py", "motor_inputs.npz"]
    assert "out" in run_all(tmp_path / "made")["motor"]
    code, out, _ = call("export", "ball", "--format", "script", "--engine", "pymunk")
    assert code == 0
    ast.parse(out)
