"""The kit of an adapter: what it asks for, what it leaves out, and how it goes back."""

from contextlib import nullcontext

import numpy as np
import pytest

from simcompare.backends import conformance, conformance_physics
from simcompare.engine import engines
from simcompare.engine.read_back import audit_of, quantities
from simcompare.engine.scene import make_scene
from simcompare.errors import EngineBroken, EngineMissing, InputError, ReadBackMismatch, Unsupported
from simcompare.kit import Feature, Held, OtherPython, PipPackage, Program, SharedLibrary, Traits
from simcompare.model.scenario import Scenario
from simcompare.model.settings import CONTACT_LEVELS, TUNED, Settings
from simcompare.scenarios import catalogue
from tests.present import INSTALLED
from tests.toy_engine import ToyBackend, ToySimulation


def falling(**more):
    scenario = catalogue.load("ball").resolve({"restitution": 0.0}).model_dump()
    scenario["world"]["duration_s"] = 0.2
    scenario["bodies"]["ball"]["drag"] = None
    return Scenario.model_validate({**scenario, **more})


WEIGHED = falling(
    sensors={"scale": {"type": "contact_force", "pair": ["ball", "floor"]}},
    probes={
        "height_m": {"observe": "ball.position_m.z", "label": "Height", "unit": "m"},
        "weight_N": {"observe": "scale.normal_force_N", "label": "Weight", "unit": "N"},
    },
    measures=[
        {"function": "final", "probe": "weight_N"},
        {"function": "final", "probe": "height_m"},
    ],
    tolerances={},
)


# --- read-back ------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["gravity_m_s2", "mass_kg", "inertia_kg_m2", "size_m", "friction"])
def test_an_answer_that_is_missing_is_a_fault_and_named(kind):
    class Silent(ToySimulation):
        def held(self, ask):
            return None if ask.kind == kind else super().held(ask)

    with pytest.raises(ReadBackMismatch, match=f"{kind}: the adapter does not say"):
        ToyBackend(Silent).open(falling(), Settings(TUNED))


def test_all_missing_answers_are_named_at_once():
    class Silent(ToySimulation):
        def held_of_body(self, body):
            return {}

    with pytest.raises(ReadBackMismatch) as error:
        ToyBackend(Silent).open(falling(), Settings(TUNED))
    assert len(error.value.rows) == 4


def test_each_table_is_asked_for_once_as_a_scene_is_opened_and_anew_later():
    asked = []

    class Counting(ToySimulation):
        def held_of_body(self, body):
            asked.append(body)
            return super().held_of_body(body)

    simulation = ToyBackend(Counting).open(falling(), Settings(TUNED))
    assert asked == ["ball"]
    (mass,) = (one for one in quantities(simulation.scene) if one.kind == "mass_kg")
    for _ in range(2):
        simulation.held(mass)
    assert asked == ["ball"] * 3, "what is held may have changed"


def test_a_shape_of_which_no_sizes_are_told_is_a_fault():
    class Silent(ToySimulation):
        def held_of_body(self, body):
            return {
                **super().held_of_body(body),
                "size_m": super().held_of_body(body)["size_m"][1:],
            }

    shapes = [{"type": "sphere", "radius_m": 0.02, "position_m": [x, 0, 0]} for x in (0.0, 0.01)]
    scenario = falling().model_dump()
    scenario["bodies"]["ball"]["shapes"] = shapes
    with pytest.raises(ReadBackMismatch, match="size_m: the adapter does not say"):
        ToyBackend(Silent).open(Scenario.model_validate(scenario), Settings(TUNED))


def test_another_value_than_was_set_is_a_fault_at_every_level():
    class Light(ToySimulation):
        def held_of_body(self, body):
            return {**super().held_of_body(body), "mass_kg": Held("mass", 1.0)}

    for level in CONTACT_LEVELS:
        with pytest.raises(
            ReadBackMismatch, match=r"ball\.mass_kg: set mass = 0\.0027 but it is 1"
        ):
            ToyBackend(Light).open(falling(), Settings(level))


def test_what_a_level_does_not_give_is_the_engines_own():
    rows = {
        level: {row.quantity: row for row in ToyBackend().open(falling(), Settings(level)).audit}
        for level in ("default", TUNED)
    }
    default, tuned = (rows[level]["ball-floor friction"] for level in rows)
    assert default.set_value is None
    assert default.note == "engine's default"
    assert (tuned.set_value, tuned.read_value) == (0.0, 0.0)


def test_an_armature_that_was_left_out_of_a_moment_of_inertia_is_a_fault():
    told = falling().model_dump()
    told["joints"] = {
        "axle": {"type": "hinge", "parent": "floor", "child": "ball", "armature": 1e-3}
    }
    scenario = Scenario.model_validate(told)
    scene = make_scene("toy", Traits(), frozenset(), scenario, Settings(TUNED))
    (ask,) = [ask for ask in quantities(scene) if ask.kind == "inertia_kg_m2"]
    with pytest.raises(ReadBackMismatch, match=r"ball\.inertia_kg_m2\.3: set I = 0\.001"):
        audit_of(scene, [(ask, Held("I", ask.value))], [])
    audit_of(scene, [(ask, Held("I", scene.moments("ball")))], [])


# --- precision ------------------------------------------------------------------------------------


def moved(**traits):
    scenario = falling().model_dump()
    scenario["bodies"]["ball"]["velocity_m_s"] = (0.1, 0.2, 0.3)
    backend = ToyBackend(dtype=np.float32, **traits)
    return backend, Scenario.model_validate(scenario)


def test_single_precision_is_no_fault_where_it_is_stated():
    backend, scenario = moved(precision=1e-6)
    simulation = backend.open(scenario, Settings(TUNED))
    mass = next(row for row in simulation.audit if row.quantity == "ball.mass_kg")
    assert mass.read_value == float(np.float32(0.0027)) != mass.set_value
    backend, scenario = moved()
    with pytest.raises(ReadBackMismatch, match="mass"):
        backend.open(scenario, Settings(TUNED))


def test_a_wrong_value_is_a_fault_in_single_precision_too():
    class Light(ToySimulation):
        def held_of_body(self, body):
            mass = self.scenario.bodies[body].mass_kg * (1 + 1e-5)
            return {**super().held_of_body(body), "mass_kg": Held("mass", mass)}

    backend = ToyBackend(Light, np.float32, precision=1e-6)
    with pytest.raises(ReadBackMismatch, match="mass"):
        backend.open(falling(), Settings(TUNED))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_token_brings_everything_back_bit_for_bit(dtype):
    backend = ToyBackend(dtype=dtype, precision=1e-6)
    simulation = backend.open(falling(), Settings(TUNED))
    for _ in range(5):
        simulation.step()
    token = simulation.save()
    ends = []
    for _ in range(2):
        for _ in range(7):
            simulation.step()
        ends.append((simulation.time_s, simulation.state))
        simulation.restore(token)
    assert ends[0] == ends[1]
    assert simulation.time_s == pytest.approx(0.005)


# --- needs ----------------------------------------------------------------------------------------


def test_a_sensor_that_an_engine_lacks_refuses_no_scene():
    found = ToyBackend().simulate(WEIGHED, Settings(TUNED))
    assert "scale.normal_force_N" not in found.signals
    assert "toy has no contact forces" in found.lacks["scale.normal_force_N"]
    assert any("contact forces" in note for note in found.notes)


def test_a_joint_that_an_engine_lacks_does():
    hinged = falling(joints={"j": {"type": "hinge", "parent": "floor", "child": "ball"}})
    with pytest.raises(Unsupported, match="toy has no hinge joints"):
        ToyBackend().open(hinged, Settings(TUNED))


def test_a_step_that_is_too_long_for_an_engine_is_refused_with_the_longest():
    class Short(ToyBackend):
        def longest_step_s(self, scenario):
            return 2e-4

    with pytest.raises(Unsupported, match=r"at most 0\.0002 s, not 0\.001 s; use a shorter --step"):
        Short().open(falling(), Settings(TUNED))
    Short().open(falling(), Settings("default"))  # shown as it is met


# --- kinds of engine ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "library",
    [
        PipPackage("no_such_module", "pip install nothing", ["no-such-package"]),
        SharedLibrary("nosuch", "apt-get install nothing", ["libnosuch.so.1"], "int f(void);"),
        OtherPython("no_such_module", "apt-get install nothing"),
        OtherPython("json", "apt-get install nothing", "/no/such/python"),
        Program("no-such-program", "apt-get install nothing"),
    ],
    ids=lambda library: type(library).__name__,
)
def test_what_is_absent_has_no_version_and_says_how_to_get_it(library):
    assert library.version() is None
    with pytest.raises(EngineMissing, match=r"toy is not installed .*; cure: .* install nothing"):
        library.load("toy")


def test_a_shared_library_is_opened_without_a_compiler():
    pytest.importorskip("cffi")
    library = SharedLibrary("m", "none", ["libm.so.6"], "double cos(double x);")
    assert library.version() == "6"
    _, found = library.load("toy")
    assert found.cos(0.0) == 1.0


def test_a_shared_library_is_opened_once_so_that_its_structures_are_of_one_kind():
    pytest.importorskip("cffi")
    first, again = (
        SharedLibrary("m", "none", ["libm.so.6"], "double sin(double x);").load("toy")
        for _ in range(2)
    )
    assert first is again


def test_without_cffi_a_shared_library_says_how_to_get_that(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "cffi", None)
    library = SharedLibrary("m", "none", ["libm.so.6"], "double tan(double x);")
    with pytest.raises(EngineMissing, match=r"no module 'cffi'.*; cure: .* install cffi"):
        library.load("toy")


def test_a_file_that_is_no_library_is_absent(tmp_path):
    pytest.importorskip("cffi")
    wrong = tmp_path / "libwrong.so"
    wrong.write_text("no library")
    with pytest.raises(EngineMissing, match="wrong"):
        SharedLibrary("wrong", "none", [str(wrong)], "int f(void);").load("toy")


def test_another_python_and_a_program_are_asked_once_and_give_their_command():
    import sys

    other = OtherPython("json", "none", sys.executable)
    assert other.version()
    assert other.load("toy") == [sys.executable]
    program = Program("sh", "none", ("-c", "echo sh 1.0"))
    assert program.version() == "sh 1.0"
    assert program.load("toy")[0].endswith("sh")


def test_a_package_that_breaks_while_it_is_imported_says_why(tmp_path, monkeypatch):
    (tmp_path / "broken_toy.py").write_text("raise OSError('libToy.so.3: cannot open')")
    monkeypatch.syspath_prepend(tmp_path)
    library = PipPackage("broken_toy", "none", [], [("libToy.so.3", "apt-get install libtoy3")])
    with pytest.raises(EngineBroken, match=r"libToy\.so\.3.*cure: .*install libtoy3"):
        library.load("toy")


def test_the_kit_has_all_that_it_names():
    from simcompare import kit

    assert len(set(kit.__all__)) == len(kit.__all__)
    assert all(hasattr(kit, name) for name in kit.__all__)
    assert Feature in vars(kit).values()


# --- what the contract must notice ----------------------------------------------------------------


def test_an_engine_that_takes_one_step_for_many_is_caught():
    class OneStep(ToySimulation):
        def take_steps(self, count):
            super().take_steps(1)

    for simulation, is_caught in ((ToySimulation, False), (OneStep, True)):
        run = conformance.Run(ToyBackend(simulation), falling(), Settings(TUNED))
        with pytest.raises(AssertionError, match="flies") if is_caught else nullcontext():
            conformance.flies_freely(run)


def test_an_engine_that_says_it_bounces_and_never_does_fails_and_is_not_refused():
    class Dead(ToyBackend):
        features = ToyBackend.features | {Feature.RESTITUTION}

    backend = Dead()
    backend.traits = Traits()
    found = conformance_physics.look_at_all(backend, [TUNED])
    dead = [one for one in found if one.status == conformance_physics.Status.FAILED]
    assert any("bounces" in one.check for one in dead), found


# --- a simulation in wrong hands ------------------------------------------------------------------


@pytest.mark.parametrize("use", ["step", "read", "save", "run", "state", "set_state", "restore"])
@pytest.mark.parametrize("engine", [*INSTALLED, "toy"])
def test_a_closed_simulation_says_so_and_kills_nobody(engine, use):
    backend = ToyBackend() if engine == "toy" else engines.get(engine)
    simulation = backend.open(falling(), Settings(TUNED))
    state, token = simulation.state, simulation.save()
    simulation.close()
    simulation.close()  # once more does no harm
    calls = {
        "run": lambda: simulation.run(engine, "1"),
        "set_state": lambda: simulation.set_state(state),
        "restore": lambda: simulation.restore(token),
        "state": lambda: simulation.state,
    }
    with pytest.raises(InputError, match="it was closed; open a new one"):
        calls.get(use, lambda: getattr(simulation, use)())()


def test_a_run_begins_at_the_start_or_not_at_all():
    simulation = ToyBackend().open(falling(), Settings(TUNED))
    simulation.run("toy", "1")
    with pytest.raises(InputError, match=r"at t = 0\.2 s already; open a new one"):
        simulation.run("toy", "1")


def test_a_token_of_another_scene_or_engine_is_refused_and_that_of_a_twin_is_not():
    first, twin = (ToyBackend().open(falling(), Settings(TUNED)) for _ in range(2))
    first.step()
    twin.restore(first.save())
    assert twin.state == first.state
    other = falling(name="other")
    with pytest.raises(
        InputError, match="the token is of ball in toy, and this simulation of other"
    ):
        ToyBackend().open(other, Settings(TUNED)).restore(first.save())


def test_impacts_are_not_landed_on_where_single_precision_is_too_coarse():
    scenario = catalogue.load("ball").resolve().model_dump()
    for name, body in scenario["bodies"].items():
        x, y, z = body["position_m"]
        scenario["bodies"][name]["position_m"] = (x, y, z + 30)
    moved = Scenario.model_validate(scenario)
    backend = ToyBackend(precision=1e-6)
    backend.helps, backend.features = frozenset({"landing"}), frozenset(Feature)
    with pytest.raises(Unsupported, match=r"within 10 m of the origin, .* 31\.02 m away"):
        backend.open(moved, Settings())
