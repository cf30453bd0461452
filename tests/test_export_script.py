"""Scripts run without simcompare and move as its own runs do, to the last bit."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from simcompare import catalogue, engines
from simcompare.drop_plan import drop_plans
from simcompare.errors import InputError
from simcompare.scripts import write
from simcompare.settings import CONTACT_LEVELS, Settings
from simcompare.trajectory import BODY_SIGNALS

LEVELS = [level for level in write.LEVELS if level in CONTACT_LEVELS]
RUNNER = Path(__file__).with_name("script_runner.py")
PHASE = 0.37
#: lines that are not blank, of a scene with one moving body and of others
MOST_LINES = (76, 144)


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


@pytest.fixture(scope="module", params=engines.names())
def written(request, tmp_path_factory):
    """All scripts of an engine: folder, (scenario, level) -> script, what they printed."""
    engine = request.param
    folder = tmp_path_factory.mktemp(engine)
    made = {}
    for scenario in catalogue.names():
        for level in LEVELS:
            try:
                name = f"{scenario}_{level}"
                one = write.script(scenario, engine=engine, contact=level, name=name)
            except InputError:  # the engine refuses it, see test_backends
                continue
            made[scenario, level] = one
            save(folder, one)
    for level in LEVELS:
        one = write.script("ball", engine=engine, contact=level, name=f"phase_{level}")
        save(folder, one, PHASE)
    return engine, folder, made, run_all(folder)


def test_each_script_runs_without_simcompare(written):
    _, _, made, said = written
    assert {name: one["error"] for name, one in said.items() if "error" in one} == {}
    assert len(made) >= 2 * len(LEVELS)


def assert_same_motion(engine, folder, name, scenario, level):
    stored = np.load(folder / f"{name}_motion.npz")
    own = engines.get(engine).simulate(scenario, Settings(level))
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
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=most * size, err_msg=signal)
    seen = {f"{body}.{part}" for body in scenario.moving_bodies() for part in BODY_SIGNALS}
    assert seen <= set(stored)


def test_scripts_move_as_simcompares_own_runs(written):
    engine, folder, made, said = written
    for scenario, level in made:
        if "error" not in said[f"{scenario}_{level}"]:
            file = catalogue.load(scenario)
            assert_same_motion(engine, folder, f"{scenario}_{level}", file.resolve(), level)


def test_the_phase_shifts_the_dithered_parameter(written):
    engine, folder, _, said = written
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
    _, _, made, said = written
    compared = 0
    for scenario, level in made:
        if catalogue.load(scenario).resolve().dither is not None:
            continue
        for line in said[f"{scenario}_{level}"]["out"].splitlines():
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
    engine, _, made, _ = written
    module = engines.get(engine).module
    for (scenario, level), one in made.items():
        lines = [line for line in one.text.splitlines() if line.strip()]
        most = MOST_LINES[len(one.bodies) > 1]
        assert len(lines) <= most, f"{scenario}, {level}: {len(lines)} lines"
        imported = {
            alias.name
            for node in ast.walk(ast.parse(one.text))
            if isinstance(node, ast.Import)
            for alias in node.names
        }
        assert imported <= {"sys", "numpy", module}, f"{scenario}, {level}"


def test_drag_acts_in_a_script_too(tmp_path):
    made = {}
    for engine in engines.names():
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
        (["ball"], "give one of dart"),
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
    from simcompare.backend import installed_version
    from simcompare.errors import EngineMissing

    chosen = engines.get("pymunk")
    monkeypatch.setattr(type(chosen), "distribution", "no-such-package")
    installed_version.cache_clear()
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
