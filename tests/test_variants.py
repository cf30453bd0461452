"""Variants of engines: names, what they change, what is read back, and what they cannot take."""

import json
import re
import subprocess
import sys
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

import simcompare
from simcompare.backends import conformance
from simcompare.cli import complete
from simcompare.engine import engines
from simcompare.engine.calibration import cache
from simcompare.engine.helps import CENTRED_EFFORTS, HALF_STEP_START, HELPS, LANDING
from simcompare.engine.variants import Variant
from simcompare.errors import InputError, UnknownName, UnknownVariant, Unsupported
from simcompare.kit import Traits
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED, Settings
from simcompare.reports.run.source_styles import looks
from simcompare.running.jobs import facts_of
from simcompare.scenarios import catalogue
from tests.present import INSTALLED, built_in, need
from tests.toy_engine import ToyBackend

EVERY = [(name, variant) for _, name in built_in() for variant in engines.quick_variants(name)]
NAMES = [f"{name}:{variant}" for name, variant in EVERY]
#: a level and a scenario in which each is measured to be another engine, and by how much at least
#: one of its signals differs; a variant that is what an engine does by default differs in tuned
SHOWN = {
    "box2d:substeps1": ("pendulum_double", DEFAULT, 1e-4),
    "box2d:substeps4": ("pendulum_double", TUNED, 1e-5),
    "box2d:substeps16": ("pendulum_double", DEFAULT, 1e-4),
    "dart:fcl": ("sliding_block", TUNED, 1e-4),
    "dart:ode": ("robot_cylinder", DEFAULT, 1e-3),
    "dart:bullet": ("robot_cylinder", TUNED, 0.1),
    "dart:dart": ("sliding_block", TUNED, 1e-3),
    "dart:dantzig": ("robot", TUNED, 1e-9),
    "dart:nsgs": ("robot_cylinder", TUNED, 0.1),
    "mujoco:rk4": ("motor_step", TUNED, 1e-3),
    "mujoco:implicit": ("pendulum_double", TUNED, 1e-2),
    "mujoco:pyramidal": ("robot", TUNED, 1e-4),
    "mujoco:elliptic": ("robot", COEFFICIENTS, 0.1),
    "ode:quickstep": ("robot", TUNED, 1e-3),
    "pybullet:recipe": ("ball", COEFFICIENTS, 1e-3),
    "pymunk:iterations1": ("pendulum_double", DEFAULT, 1e-6),
    "pymunk:iterations10": ("robot_planar", TUNED, 1e-9),
    "pymunk:iterations100": ("pendulum_double", DEFAULT, 1e-8),
}
#: what people ask for to see that it changes nothing: Euler's method takes the dampers of joints
#: after the step, too, so that only rounding is left
SAME = {"mujoco:implicitfast": ("pendulum_double", TUNED, 1e-9)}
#: what each sets, and to which value; what has no getter is told as set
SETS = {
    **{f"box2d:substeps{n}": ("World.step(sub_step_count)", n, False) for n in (1, 4, 16)},
    "dart:fcl": ("FCLCollisionDetector", 1, True),
    "dart:ode": ("OdeCollisionDetector", 1, True),
    "dart:bullet": ("BulletCollisionDetector", 1, True),
    "dart:dart": ("DARTCollisionDetector", 1, True),
    "dart:dantzig": ("DantzigBoxedLcpSolver", 1, True),
    "dart:nsgs": ("NsgsFrictionSolver.tolerance", 1e-6, True),
    "mujoco:rk4": ("opt.integrator", 1, True),
    "mujoco:implicit": ("opt.integrator", 2, True),
    "mujoco:implicitfast": ("opt.integrator", 3, True),
    "mujoco:pyramidal": ("opt.cone", 0, True),
    "mujoco:elliptic": ("opt.cone", 1, True),
    "ode:quickstep": ("dWorldQuickStep", 1, False),
    "pybullet:recipe": ("contactProcessingThreshold", 0, False),
    **{f"pymunk:iterations{n}": ("Space.iterations", n, True) for n in (1, 10, 100)},
}


def scene(name, duration_s=0.6):
    whole = catalogue.load(name).resolve()
    world = whole.world.model_copy(
        update={"duration_s": round(min(whole.world.duration_s, duration_s), 3)}
    )
    return whole.model_copy(update={"world": world})


def needed(name):
    engine, _ = engines.split(name)
    need(engine)
    return engines.get(name)


def largest_difference(one, other):
    assert set(one.signals) == set(other.signals)
    return max(float(np.abs(v - other.signals[n]).max()) for n, v in one.signals.items())


# --- names -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [name for _, name in built_in()])
def test_names_of_variants_are_known_without_their_backend(name):
    assert dict(engines.quick_variants(name)) == dict(getattr(engines.get(name), "variants", {}))


@pytest.mark.parametrize(("engine", "variant"), EVERY)
def test_a_variant_says_in_a_sentence_what_differs_and_where_that_is_documented(engine, variant):
    own = engines.get(engine).variants[variant]
    assert len(own.text.split()) > 5
    assert len(own.reference) > 10
    assert own.without <= engines.get(engine).helps
    assert bool(own.why) == bool(own.without), "what it cannot take has a reason"


def test_a_variant_is_the_backend_with_another_name():
    backend = engines.get("mujoco:rk4")
    assert (backend.name, backend.variant) == ("mujoco:rk4", "rk4")
    assert engines.get("mujoco").name == "mujoco", "the engine itself is as it was"
    assert type(backend) is type(engines.get("mujoco"))


@pytest.mark.parametrize("ask", [engines.get, engines.select])
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("mujoco:rk5", r"mujoco has no variant 'rk5'; it has elliptic, .*, pyramidal, rk4"),
        ("mujoco:", r"mujoco has no variant ''; it has elliptic"),
        ("mujoco:rk4:x", r"mujoco has no variant 'rk4:x'"),
        ("rapier:x", r"rapier has no variant 'x'; it has none; leave it out"),
    ],
)
def test_an_unknown_variant_names_those_that_there_are(ask, name, message):
    with pytest.raises(UnknownVariant, match=message):
        ask(name)


def test_a_variant_of_an_unknown_engine_is_an_unknown_engine():
    with pytest.raises(UnknownName, match="no engine is called 'mujco'; did you mean mujoco"):
        engines.select("mujco:rk4")
    with pytest.raises(UnknownName, match="Gazebo"):
        engines.select("gazebo:rk4")


def test_all_is_the_plain_engines_and_variants_are_added_to_them():
    assert engines.select("all") == engines.names()
    assert not any(engines.VARIANT in name for name in engines.names())
    assert engines.select("all,mujoco:rk4") == [*engines.names(), "mujoco:rk4"]
    assert engines.select("mujoco:rk4, mujoco,mujoco:rk4") == ["mujoco:rk4", "mujoco"]


def test_completion_offers_variants_once_their_engine_is_typed():
    assert complete.engines("pymunk,mujoco:r") == ["pymunk,mujoco:rk4"]
    assert "mujoco:rk4" not in complete.engines("mujoco:rk4,mujoco:")
    assert complete.engines("nothing:") == []
    assert "mujoco:rk4" not in complete.engines("m")


def test_the_commands_name_variants_where_they_name_engines(call):
    _, out, _ = call("list", "-v")
    assert "mujoco:rk4" in out
    _, out, _ = call("show", "ball", "-v")
    assert "Variants of mujoco: rk4, " in out


def test_the_examination_tells_what_each_variant_is():
    told = {one.name: (one.text, one.reference) for one in facts_of(engines.get("mujoco")).variants}
    assert set(told) == set(engines.quick_variants("mujoco"))
    assert told["rk4"] == (
        "the fourth-order method of Runge and Kutta in place of semi-implicit Euler",
        "MuJoCo documentation, Computation, Numerical integration",
    )


def test_an_unknown_variant_is_one_sentence_on_the_command_line(call):
    code, _, err = call("run", "ball", "--engine", "mujoco:rk5")
    assert (code, err.count("\n")) == (2, 1)
    assert "mujoco has no variant 'rk5'; it has" in err


# --- what they change --------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_a_variant_changes_what_is_measured_or_is_known_to_change_nothing(name):
    backend = needed(name)
    scenario, level, limit = SHOWN.get(name) or SAME[name]
    made, settings = scene(scenario), Settings(level)
    plain = engines.get(engines.split(name)[0]).simulate(made, settings)
    difference = largest_difference(backend.simulate(made, settings), plain)
    assert difference > limit if name in SHOWN else difference < limit


@pytest.mark.parametrize("level", [DEFAULT, COEFFICIENTS, TUNED])
@pytest.mark.parametrize("name", NAMES)
def test_what_a_variant_sets_is_in_the_audit_at_every_level(name, level):
    simulation = needed(name).open(scene("robot_planar", 0.1), Settings(level))
    simulation.close()
    parameter, value, has_getter = SETS[name]
    (row,) = [row for row in simulation.audit if row.engine_parameter == parameter]
    assert (row.set_value, row.read_value) == (value, value if has_getter else None)
    assert any(note.startswith("variant ") for note in simulation.notes)


@pytest.mark.parametrize("name", NAMES)
def test_a_variant_keeps_the_contract(name):
    """Also that a state is restored to the last bit, and that a run is the same twice."""
    backend = needed(name)
    conformance.check(backend, catalogue.load("ball").resolve(), Settings(TUNED))
    conformance.check(backend, catalogue.load("robot_planar").resolve(), Settings(COEFFICIENTS))


@pytest.mark.engines("mujoco")
def test_a_wrong_read_back_of_a_variant_is_noticed(monkeypatch):
    import mujoco

    from simcompare.errors import ReadBackMismatch

    whole = mujoco.MjModel.from_xml_string

    def forgetful(text):
        return whole(text.replace('integrator="RK4"', ""))

    class Stand:
        def __getattr__(self, name):
            return getattr(mujoco, name)

        class MjModel:
            from_xml_string = staticmethod(forgetful)

    backend = engines.get("mujoco:rk4")
    with pytest.raises(ReadBackMismatch, match=r"opt\.integrator = 1\.0 but it is 0\.0"):
        backend.build(Stand(), scene("ball", 0.1), Settings(DEFAULT))


# --- helps -------------------------------------------------------------------------------------


def test_rk4_takes_no_help_of_ours_and_says_so():
    need("mujoco")
    backend = engines.get("mujoco:rk4")
    assert backend.helps == frozenset()
    with pytest.raises(Unsupported, match="takes none of our helps: they are for velocities half"):
        backend.open(scene("ball"), Settings(ASSISTED))
    none = backend.simulate(scene("ball"), Settings(ASSISTED, helps=frozenset()))
    assert largest_difference(none, backend.simulate(scene("ball"), Settings(TUNED))) == 0
    with pytest.raises(InputError, match="mujoco:rk4 takes no landing; it takes none"):
        simcompare.run("ball", engine="mujoco:rk4", assist="landing")


def test_a_variant_without_a_help_of_its_engine_tells_of_it():
    need("mujoco")
    backend = engines.get("mujoco:implicit")
    assert backend.helps == {LANDING, HALF_STEP_START}
    ran = backend.simulate(scene("pendulum"), Settings(ASSISTED))
    assert CENTRED_EFFORTS not in ran.helps
    assert any(note.startswith("variant implicit takes no centred_efforts: ") for note in ran.notes)


def test_a_variant_that_takes_no_help_is_a_row_and_spoils_no_run():
    need("mujoco")
    run = simcompare.run("ball", engine="mujoco,mujoco:rk4", contact="assisted", seeds=1)
    assert [(s.name, s.status) for s in run.record.sources] == [
        ("mujoco", "ok"), ("mujoco:rk4", "unsupported"),
    ]  # fmt: skip
    assert run.exit_code == 0


# --- runs --------------------------------------------------------------------------------------


def test_a_plain_engine_looks_as_ever_beside_its_variants_and_none_looks_like_another():
    sources = (*engines.names(), *NAMES, *(f"{name}@1ms" for name in engines.names()))
    styles = looks(sources)
    assert [styles[n] for n in engines.names()] == [looks((n,))[n] for n in engines.names()]
    patterns = [(style.dash, style.marker) for style in styles.values()]
    assert len(set(patterns)) == len(patterns) == len(sources)
    for name in sources:
        engine, _, variant = name.partition("@")[0].partition(":")
        # a step has the colour of its engine, a variant a shade of it
        assert (styles[name].colour == styles[engine].colour) == (not variant)


def test_the_cache_keeps_variants_apart(tmp_path, monkeypatch):
    monkeypatch.setenv("SIMCOMPARE_CACHE", str(tmp_path))
    asked = {"drop": 1}
    for i, name in enumerate(["mujoco", "mujoco:rk4", "mujoco:implicit"]):
        need("mujoco")
        assert cache.kept(engines.get(name), asked, int, lambda i=i: i) == i
    assert cache.kept(engines.get("mujoco:rk4"), asked, int, lambda: 9) == 1


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("mujoco:rk4", 'integrator="RK4"'),
        ("dart:fcl", "FCLCollisionDetector"),
        ("pybullet:recipe", "contactERP"),
        ("pymunk:iterations1", "iterations = 1"),
    ],
)
def test_a_script_of_a_variant_gives_the_same_numbers(name, line, tmp_path):
    from simcompare.exporters.scripts.write import script

    needed(name)
    made = script("robot_planar", engine=name, contact="coefficients")
    assert line in made.text
    assert ":" not in made.name, "it becomes the name of a file"
    (tmp_path / f"{made.name}.py").write_text(made.text, encoding="utf-8")
    if made.inputs:
        np.savez(tmp_path / f"{made.name}_inputs.npz", **made.inputs)
    runner = Path(__file__).with_name("script_runner.py")
    done = subprocess.run(
        [sys.executable, "-I", runner, tmp_path],
        capture_output=True, text=True, check=True, cwd=tmp_path,
    )  # fmt: skip
    (printed,) = json.loads(done.stdout.splitlines()[-1]).values()
    rows = re.findall(r"\] +(\S+) .* simcompare (\S+)", printed["out"])
    assert len(rows) == 4
    for own, ours in rows:  # six digits are shown
        assert float(own) == pytest.approx(float(ours), rel=2e-5, abs=1e-8)


@pytest.mark.engines("ode")
def test_a_variant_of_an_engine_without_scripts_is_refused_in_a_sentence(call):
    code, _, err = call("export", "ball", "--format", "script", "--engine", "ode:quickstep")
    assert code == 2
    assert "ode:quickstep cannot be written as a script" in err


# --- the kit -----------------------------------------------------------------------------------


class Doubling(ToyBackend):
    """A toy in which a variant is free to do what it wants with the scene."""

    variants = MappingProxyType({"heavy": Variant("it falls twice as fast", "this file", 2.0)})
    helps = frozenset(HELPS)

    def make(self, engine, scene):
        self.asked = scene.variant
        return super().make(engine, scene)


FALL = {
    "name": "fall", "title": "t", "question": "q?", "world": {"duration_s": 0.1},
    "bodies": {"ball": {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "position_m": [0, 0, 1]}},
}  # fmt: skip


def test_an_adapter_is_told_the_variant_in_the_scene():
    backend, made = Doubling(), Scenario.model_validate(FALL)
    heavy = backend.with_variant("heavy")
    heavy.open(made, Settings(TUNED)).close()
    assert heavy.asked == "heavy"
    assert heavy.traits == Traits(bounces_by="")
    assert heavy.name == "toy:heavy"
    assert heavy.helps == backend.helps
    backend.open(made, Settings(TUNED)).close()
    assert backend.asked == ""
    with pytest.raises(UnknownVariant, match="toy has no variant 'light'; it has heavy"):
        backend.with_variant("light")


def test_a_backend_of_somebody_else_without_variants_says_so(add_engine):
    add_engine("toy")
    assert engines.quick_variants("toy") == {}
    with pytest.raises(UnknownVariant, match="toy has no variant 'x'; it has none"):
        engines.get("toy:x")


def test_every_variant_is_shown_to_differ():
    assert {*SHOWN, *SAME} == set(SETS) == set(NAMES)
    assert INSTALLED


def test_variants_of_one_engine_differ_in_shade():
    styles = looks(("mujoco", "mujoco:rk4", "mujoco:implicit", "mujoco:implicitfast"))
    assert len({style.colour for style in styles.values()}) == 4
