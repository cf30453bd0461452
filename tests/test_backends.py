"""What a backend set, it reads back; what was not set shows; what an engine lacks is refused."""

import math
import re

import numpy as np
import pytest

from simcompare.backends.dart.backend import DartBackend
from simcompare.engine import engines
from simcompare.engine.features import Feature
from simcompare.errors import (
    EngineBroken,
    EngineMissing,
    ReadBackMismatch,
    SimulationDiverged,
    Unsupported,
)
from simcompare.model.audit import Audit
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, TUNED, PairNumbers, Settings
from simcompare.scenarios import catalogue

ENGINES = engines.names()


BALL = catalogue.load("ball")


def rounding(engine):
    """Relative rounding of an engine's numbers."""
    return engines.get(engine).traits.precision


def audit_of(engine, contact="assisted"):
    return engines.get(engine).simulate(BALL.resolve({}), Settings(contact)).audit


@pytest.mark.parametrize("engine", ENGINES)
def test_every_physical_value_is_set_and_read_back(engine):
    rows = {row.quantity: row for row in audit_of(engine)}
    for quantity, value in {
        "ball.mass_kg": 0.0027,
        "ball.radius_m": 0.02,
        "ball.inertia_kg_m2.2": 2 / 3 * 0.0027 * 0.02**2,
        "ball.position_m.z": 1.02,
        "gravity_m_s2.z": -9.80665,
    }.items():
        row = rows[quantity]
        assert row.set_value == pytest.approx(value, rel=1e-12)
        assert row.read_value == pytest.approx(value, rel=rounding(engine))
    restitution = [row for row in audit_of(engine) if row.quantity.endswith("restitution")]
    assert restitution
    for row in restitution:
        assert row.scenario_value == 0.8
        assert row.set_value == pytest.approx(row.read_value, rel=rounding(engine))


@pytest.mark.parametrize("engine", ENGINES)
def test_default_mode_shows_that_the_restitution_was_not_applied(engine):
    rows = [row for row in audit_of(engine, "default") if row.quantity.endswith("restitution")]
    assert rows
    for row in rows:
        assert row.set_value is None
        assert row.read_value is not None
        assert row.scenario_value == 0.8


@pytest.mark.parametrize("engine", ENGINES)
def test_an_engine_that_keeps_another_value_fails(engine, monkeypatch):
    from simcompare.model import audit

    monkeypatch.setattr(audit.Audit, "_agrees", lambda self, row: row.quantity != "ball.mass_kg")
    with pytest.raises(ReadBackMismatch, match=r"did not take what was set: ball\.mass_kg"):
        engines.get(engine).simulate(BALL.resolve({}), Settings())


def test_a_parameter_that_a_call_ignores_is_caught(monkeypatch):
    # PyBullet leaves restitution at 0 for bodies in maximal coordinates, without a word
    import pybullet

    change = pybullet.changeDynamics

    def forgetful(*args, **kwargs):
        kwargs.pop("restitution", None)
        return change(*args, **kwargs)

    monkeypatch.setattr(pybullet, "changeDynamics", forgetful)
    with pytest.raises(ReadBackMismatch, match=r"restitution of ball = 0\.8 but it is 0\.0"):
        engines.get("pybullet").simulate(BALL.resolve({}), Settings())


def test_audit_compares_relatively_and_names_all():
    audit = Audit("toy", relative=1e-6)
    audit.add("a", 1.0, "alpha", (1.0, 1.0 + 1e-8), "m")
    audit.add("b", None, "beta", (None, 7.0), "kg")
    audit.add("c", 1.0, "gamma", (1.0, 1.1), "s")
    audit.add("d", 0.0, "delta", (0.0, 1e-30), "s")
    with pytest.raises(ReadBackMismatch) as caught:
        audit.finish()
    assert len(caught.value.rows) == 2
    assert "gamma = 1.0 but it is 1.1" in str(caught.value)


def test_a_planar_engine_refuses_motion_out_of_its_plane():
    scenario = BALL.resolve({}).model_dump()
    scenario["bodies"]["ball"]["velocity_m_s"] = (0.0, 1.0, 0.0)
    with pytest.raises(Unsupported, match="pymunk has no motion out of the x-z plane"):
        engines.get("pymunk").simulate(Scenario.model_validate(scenario), Settings())


@pytest.mark.parametrize("engine", ENGINES)
def test_what_no_backend_builds_yet_is_refused(engine):
    scenario = BALL.resolve({}).model_dump()
    scenario["joints"] = {"joint": {"type": "ball", "parent": "floor", "child": "ball"}}
    backend = engines.get(engine)
    assert Feature.BALL_JOINT not in backend.features
    with pytest.raises(Unsupported, match="ball joints"):
        backend.simulate(Scenario.model_validate(scenario), Settings())


def test_an_unknown_contact_mode_is_refused():
    with pytest.raises(Unsupported, match="contact level 'sticky'"):
        engines.get("pymunk").simulate(BALL.resolve({}), Settings("sticky"))


@pytest.mark.parametrize("engine", ENGINES)
def test_a_missing_engine_says_how_to_get_it(engine, monkeypatch):
    import sys

    from simcompare.engine import library

    backend = engines.get(engine)
    monkeypatch.setitem(sys.modules, backend.library.name, None)
    monkeypatch.setattr(library, "_opens", lambda file: False)
    monkeypatch.setattr(
        "importlib.import_module",
        lambda name: (_ for _ in ()).throw(ModuleNotFoundError(name=name)),
    )
    install = backend.library.install.removeprefix("sudo ")
    with pytest.raises(EngineMissing, match=rf"cure: .*{re.escape(install)}$"):
        backend.load()


def test_an_engine_that_lacks_a_system_library_says_how_to_get_it(monkeypatch):
    def broken(name):
        raise ImportError("libGL.so.1: cannot open shared object file: No such file or directory")

    monkeypatch.setattr("importlib.import_module", broken)
    with pytest.raises(EngineBroken, match=r"cure: (sudo )?apt-get install libgl1"):
        DartBackend().load()


@pytest.mark.parametrize("engine", [name for name in ENGINES if name not in ("pymunk", "box2d")])
def test_spin_and_velocity_are_in_the_world_frame(engine):
    # turned by 0.6 rad about x and spinning about all axes: a body-frame velocity would show
    scenario = BALL.resolve({}).model_dump()
    ball = scenario["bodies"]["ball"]
    ball["orientation_wxyz"] = (math.cos(0.3), math.sin(0.3), 0.0, 0.0)
    ball["velocity_m_s"], ball["rate_rad_s"] = (0.3, 0.2, 1.0), (1.0, 2.0, 3.0)
    scenario["world"]["duration_s"] = 0.2
    found = engines.get(engine).simulate(Scenario.model_validate(scenario), Settings())
    t = found.time_s[-1]
    moved = found.signals["ball.position_m"][-1] - found.signals["ball.position_m"][0]
    rtol = max(1e-9, 100 * rounding(engine))  # of hundreds of steps
    np.testing.assert_allclose(moved[:2], [0.3 * t, 0.2 * t], rtol=rtol)
    # a sphere keeps its rate in the world's frame
    np.testing.assert_allclose(found.signals["ball.rate_rad_s"][-1], [1, 2, 3], rtol=rtol)
    from scipy.spatial.transform import Rotation

    first, last = (
        Rotation.from_quat(found.signals["ball.orientation_wxyz"][k], scalar_first=True)
        for k in (0, -1)
    )
    turned = (last * first.inv()).as_rotvec()
    np.testing.assert_allclose(turned, np.array([1, 2, 3]) * t, rtol=2e-3)


def test_planar_engine_turns_the_right_way_about_y():
    scenario = BALL.resolve({}).model_dump()
    scenario["bodies"]["ball"]["rate_rad_s"] = (0.0, 2.0, 0.0)
    scenario["world"]["duration_s"] = 0.2
    checked = Scenario.model_validate(scenario)
    angles = {}
    for engine in ENGINES:
        found = engines.get(engine).simulate(checked, Settings())
        w, x, y, z = found.signals["ball.orientation_wxyz"][-1]
        assert x == pytest.approx(0, abs=1e-9)
        assert z == pytest.approx(0, abs=1e-9)
        angles[engine] = 2 * math.atan2(y, w)
    assert angles == pytest.approx(dict.fromkeys(ENGINES, 0.4), rel=5e-3)


def two_balls(*more):
    scenario = BALL.resolve({}).model_dump()
    second = {**scenario["bodies"]["ball"], "position_m": (1.0, 0.0, 0.52)}
    scenario["bodies"]["second"] = second
    scenario["contacts"] = [
        {"pair": ("ball", "floor"), "restitution": 0.8},
        {"pair": ("floor", "second"), "restitution": 0.5},
        *more,
    ]
    scenario["world"]["duration_s"] = 1.2
    return Scenario.model_validate(scenario)


@pytest.mark.parametrize("engine", [name for name in ENGINES if name != "mujoco"])
def test_two_balls_bounce_each_by_its_own_coefficient(engine):
    checked = two_balls()
    with pytest.raises(Unsupported, match="only where a single free body bounces"):
        engines.get(engine).simulate(checked, Settings(ASSISTED))
    found = engines.get(engine).simulate(checked, Settings(TUNED))
    for name, drop, e in (("ball", 1.0, 0.8), ("second", 0.5, 0.5)):
        height = found.signals[f"{name}.position_m"][:, 2] - 0.02
        fall = math.sqrt(2 * drop / 9.80665)
        after = height[found.time_s > fall + 0.05]
        # the engines' own error of a step of 1 ms: up to 2·g·dt/v in the height
        assert after.max() == pytest.approx(e**2 * drop, rel=0.02)


@pytest.mark.parametrize("engine", ["pybullet", "pymunk", "dart"])
def test_coefficients_that_no_product_gives_are_refused(engine):
    told = two_balls({"pair": ("ball", "second"), "restitution": 0.9})
    with pytest.raises(Unsupported, match="per body and multiplies"):
        engines.get(engine).simulate(told, Settings(TUNED))


def test_a_stiff_spring_is_refused_where_its_impacts_cannot_be_landed_on():
    # at a step of 1 ms it would throw the ball kilometres up, and call that a result
    with pytest.raises(Unsupported, match="single free body bounces"):
        engines.get("mujoco").simulate(two_balls(), Settings())
    with pytest.raises(Unsupported, match=r"of 0\.02 and more, not 0\.001"):
        engines.get("mujoco").simulate(BALL.resolve({"restitution": 0.001}), Settings())


def lying(shape, height, **body):
    """A body on the floor whose pair has no restitution."""
    scenario = BALL.resolve({"restitution": 0.0}).model_dump()
    ball = scenario["bodies"]["ball"]
    ball["shapes"], ball["position_m"] = shape, (0.0, 0.0, height + 0.001)
    ball.update(mass_kg=0.1, inertia_kg_m2=(1e-4, 1e-4, 1e-4), **body)
    scenario["world"]["duration_s"] = 0.5
    return Scenario.model_validate(scenario)


SHAPES = {
    "box": ({"type": "box", "size_m": (0.10, 0.08, 0.06)}, 0.03),
    "cylinder": ({"type": "cylinder", "radius_m": 0.05, "length_m": 0.06}, 0.03),
    "capsule": ({"type": "capsule", "radius_m": 0.05, "length_m": 0.06}, 0.08),
}


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("engine", ENGINES)
def test_every_shape_has_its_size(engine, kind):
    shape, height = SHAPES[kind]
    backend, scenario = engines.get(engine), lying([shape], height)
    if Feature[kind.upper()] not in backend.features:
        with pytest.raises(Unsupported):
            backend.simulate(scenario, Settings())
        return
    found = backend.simulate(scenario, Settings())
    sizes = [row for row in found.audit if "size_m" in row.quantity or "length_m" in row.quantity]
    assert sizes
    for row in sizes:
        # other shapes that a help builds have sizes of their own
        wanted = row.set_value if row.scenario_value is None else row.scenario_value
        assert row.read_value == pytest.approx(wanted, rel=max(1e-9, rounding(engine)))
    # at rest at its own height, to a millimetre: engines let a body sink or float a little
    assert found.signals["ball.position_m"][-1, 2] == pytest.approx(height, abs=1.1e-3)


@pytest.mark.parametrize("engine", ENGINES)
def test_what_a_backend_does_not_build_is_refused_and_never_left_out(engine):
    sphere = {"type": "sphere", "radius_m": 0.02}
    two = lying([sphere, {**sphere, "position_m": (0.0, 0.0, -0.1)}], 0.12)
    offset = lying([sphere], 0.02, center_of_mass_m=(0.01, 0.0, 0.0))
    backend = engines.get(engine)
    for scenario, wanted in ((two, 0.12), (offset, None)):
        try:
            found = backend.simulate(scenario, Settings())
        except Unsupported:
            continue
        if wanted is not None:
            last = found.signals["ball.position_m"][-1, 2]
            assert last == pytest.approx(wanted, abs=2e-3)


def test_mujoco_does_not_start_anew_when_numbers_run_away(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    explosive = PairNumbers(("ball", "floor"), (-1e18, -1e8))
    with pytest.raises(SimulationDiverged):
        engines.get("mujoco").simulate(BALL.resolve({}), Settings(TUNED, numbers=(explosive,)))
    assert "MuJoCo: " in capsys.readouterr().err
    assert not list(tmp_path.iterdir()), "its log must not land in the user's folder"
