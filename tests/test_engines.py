"""Engines are found without importing them, also those of other people's packages."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from simcompare.engine import engines
from simcompare.engine.backend import Backend
from simcompare.errors import EngineBroken, UnknownName

BUILT_IN = ["box2d", "dart", "mujoco", "ode", "pybullet", "pymunk", "rapier"]
ENGINES = ["mujoco", "pybullet", "pymunk", "dartpy", "cffi", "pyb2d3", "rapier3d"]
HEAVY = ["numpy", "pandas", "scipy", "pydantic", "pint", *ENGINES]


def test_naming_the_engines_imports_nothing_heavy():
    code = (
        "import sys, json; from simcompare.engine import engines; names = engines.names();"
        f"print(json.dumps([names, [m for m in {HEAVY!r} if m in sys.modules]]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names, loaded = json.loads(done.stdout)
    assert set(BUILT_IN) <= set(names)
    assert loaded == []


@pytest.mark.parametrize("name", BUILT_IN)
def test_a_built_in_backend_keeps_the_contract_and_its_engine_unloaded(name):
    code = (
        f"import sys; from simcompare.engine import engines; engines.get({name!r});"
        f"print([m for m in {ENGINES!r} if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    backend = engines.get(name)
    assert isinstance(backend, Backend)
    assert backend.name == name
    assert all(limit.text and limit.reference for limit in backend.known_limits)


def test_another_packages_engine_is_found_by_its_entry_point(add_engine):
    add_engine("toy")
    assert engines.names() == [*sorted(BUILT_IN), "toy"]
    backend = engines.get("toy")
    assert isinstance(backend, Backend)
    assert backend.version() == "1.0"


def test_a_toy_engine_runs_a_toy_scenario_without_touching_the_project(add_engine, fall, command):
    add_engine("toy")
    done = command("run", fall, "--engine", "toy", "--contact", "assisted", "--json", "--no-report")
    assert done.returncode == 0, done.stderr
    record = json.loads(done.stdout)
    (source,) = record["sources"]
    assert (source["name"], source["version"], source["status"]) == ("toy", "1.0", "ok")
    assert source["steps"] == 400
    penetration = {s["measure"]: s for s in record["scores"] if s["index"] is None}["penetration"]
    assert penetration["verdict"] == "pass"
    assert record["truth"] is not None


def test_a_toy_engine_over_a_package_gets_the_frame_for_nothing(add_engine, fall, command):
    """Subclassing EngineBackend: refusing, loading, read-back and the recording loop come along."""
    code = (
        "from simcompare.kit import (EngineBackend, Feature, Held, PipPackage,\n"
        "    ReducedSimulation, Traits)\n"
        "class Falling(ReducedSimulation):\n"
        "    def __init__(self, scene):\n"
        "        super().__init__(scene)\n"
        "        self.body = scene.scenario.bodies['ball']\n"
        "        self.place_all()\n"
        "    def get(self, name): return self.q, self.v\n"
        "    def put(self, name, q, v): self.q, self.v = list(q or self.q), list(v)\n"
        "    def take_steps(self, count):\n"
        "        for _ in range(count):\n"
        "            self.v[2] += -9.80665 * self.step_now_s\n"
        "            self.q[2] += self.v[2] * self.step_now_s\n"
        "    def set_engine_step(self, step_s): pass\n"
        "    def held(self, ask):\n"
        "        if ask.kind == 'gravity_m_s2': return Held('g', (None, None, -9.80665))\n"
        "        return Held(ask.kind, ask.value)\n"
        "class Backend(EngineBackend):\n"
        "    name = 'framed'; known_limits = (); mapping = 'none'; traits = Traits(bounces_by='')\n"
        "    library = PipPackage('colorsys', 'none', ['framed_engine'])\n"
        "    features = frozenset({Feature.FREE_BODY, Feature.SPHERE})\n"
        "    def make(self, engine, scene): return Falling(scene)\n"
        "BACKEND = Backend\n"
    )
    add_engine("framed", code=code)
    done = command("run", fall, "--engine", "framed", "--json", "--no-report")
    assert done.returncode == 0, done.stdout + done.stderr
    sources = json.loads(done.stdout)["sources"]
    assert [s["status"] for s in sources] == ["ok", "ok", "ok"]
    held = {row["quantity"]: row["read_value"] for row in sources[0]["audit"]}
    assert held["gravity_m_s2.z"] == -9.80665
    assert sources[0]["version"] == "1.0"


def test_an_unknown_engine_names_the_nearest():
    with pytest.raises(UnknownName, match="no engine is called 'mujco'; did you mean mujoco"):
        engines.get("mujco")


@pytest.mark.parametrize(
    "code",
    [
        "import no_such_module_at_all\n",
        "1 / 0\n",
        "BACKENDS = 3\n",
        "def f(:\n",
        "raise SystemExit(0)\n",
        "class BACKEND:\n    def __init__(self): raise RuntimeError('no licence')\n",
    ],
    ids=["import", "raise", "no attribute", "syntax", "exit", "constructor"],
)
def test_a_backend_that_cannot_be_loaded_is_told_with_its_place(add_engine, code):
    add_engine("broken", code=code)
    assert "broken" in engines.names()
    with pytest.raises(EngineBroken, match="broken_engine:BACKEND"):
        engines.get("broken")


def test_a_built_in_engine_cannot_be_taken_over_by_another_package(add_engine):
    add_engine("mujoco")
    assert engines.targets()["mujoco"].startswith("simcompare.backends.")


def test_a_selection_is_a_list_with_commas_or_all():
    assert engines.select("all") == engines.names()
    assert engines.select(" pymunk , mujoco,pymunk ") == ["pymunk", "mujoco"]


@pytest.mark.parametrize("text", ["", ",", "pymunk,mujco", "pymunk mujoco"])
def test_a_selection_of_what_does_not_exist_is_refused(text):
    with pytest.raises(UnknownName):
        engines.select(text)


def test_all_among_others_means_all_or_is_explained():
    try:
        found = set(engines.select("all,pymunk"))
    except UnknownName as error:
        found = set() if "did you mean all" in str(error) else set(engines.names())
    assert found == set(engines.names()), "'all' is not called 'all'; did you mean all?"
