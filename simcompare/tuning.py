"""An engine's numbers for the restitution of every pair of a scene, from drops in that engine.

They are kept in the user's cache, by scene, step, engine and adapter, since they take a second.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import math
import os
import sys
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from types import ModuleType
from typing import Any, Protocol

import numpy as np
import platformdirs

from simcompare import calibration, drops
from simcompare.calibration import Calibration, CannotCalibrate
from simcompare.drop_plan import drop_plans
from simcompare.drops import Bounces
from simcompare.engine.contacts import touching_pairs
from simcompare.engine.simulation import Simulation
from simcompare.engine.state import BodyState, State
from simcompare.errors import SimulationDiverged
from simcompare.scenario import Scenario
from simcompare.settings import SPRING, TUNED, DropPlan, PairNumbers, Settings
from simcompare.spring_calibration import DEPTH, calibrate_spring
from simcompare.trajectory import Array


class Tunable(Protocol):
    """What a backend offers to be tuned."""

    @property
    def name(self) -> str:
        """The engine's name."""

    @property
    def bounces_by(self) -> str:
        """What stands for a pair's restitution in it."""

    def version(self) -> str:
        """Version of the engine."""

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        """Builds a scene."""


#: weakest gravity with which a drop is read; without any it would have no apex [m/s²]
LEAST_GRAVITY_M_S2 = 0.1
#: impacts of a body that bounces on, whose speeds are looked at; the first one is right
IMPACTS = 4
#: steps that are recorded at once, and at most
_CHUNK, _MOST = 48, 1200
#: free steps after a contact that end a record
_AFTER = 6


def tuned(
    backend: Tunable, engine: ModuleType, scenario: Scenario, settings: Settings
) -> tuple[Settings, tuple[Mapping[str, Any], ...]]:
    """Settings with numbers for every pair that bounces, and how they were found.

    Raises:
        Unsupported: no numbers give a restitution at this step; says what is possible.
    """
    known = {frozenset(numbers.pair) for numbers in settings.numbers}
    wanted = {frozenset(contact.pair): contact.restitution for contact in touching_pairs(scenario)}
    # a plan that was made for another restitution, as in a repeat that varies it, is not for this
    plans = [*(settings.drops or ()), *drop_plans(scenario)]
    numbers, records = list(settings.numbers), []
    for plan in plans:
        open_pairs = [
            pair
            for pair in plan.pairs
            if frozenset(pair) not in known
            and math.isclose(wanted.get(frozenset(pair), -1.0), plan.restitution, rel_tol=1e-9)
        ]
        if not open_pairs:
            continue
        known |= {frozenset(pair) for pair in open_pairs}
        try:
            found = _cached(backend, engine, plan)
        except CannotCalibrate as error:
            sentence = f"{backend.name}: {error}"
            raise CannotCalibrate(sentence, error.longest_step_s) from None
        numbers += [PairNumbers(pair, found.numbers) for pair in open_pairs]
        records.append(record(plan, found))
    return replace(settings, numbers=tuple(numbers)), tuple(records)


def record(plan: DropPlan, found: Calibration) -> dict[str, Any]:
    """How numbers were found, as plain values for run.json."""
    plain: dict[str, Any] = asdict(found)
    return {
        "pairs": [list(pair) for pair in plan.pairs],
        "speed_m_s": plan.speed_m_s,
        "step_s": plan.step_s,
        "size_m": plan.size_m,
        "gravity_m_s2": plan.gravity_m_s2,
        "notes": list(plan.notes),
        **{name: value for name, value in plain.items() if not isinstance(value, tuple)},
        "numbers": list(found.numbers),
        "at": [_finite(asdict(one)) for one in found.at],
        "checks": [_finite(asdict(one)) for one in found.checks],
    }


def _finite(values: Mapping[str, float]) -> dict[str, float | None]:
    return {name: value if math.isfinite(value) else None for name, value in values.items()}


def calibrate(backend: Tunable, engine: ModuleType, plan: DropPlan) -> Calibration:
    """Finds numbers for a plan by dropping a sphere in the engine."""
    is_lossless = plan.restitution > calibration.LARGEST and backend.bounces_by != SPRING
    if is_lossless or not backend.bounces_by:
        # what hardly loses anything is typed in as it stands, and what comes of it is shown
        return Calibration(plan.restitution, (plan.restitution,))
    e, gravity = plan.restitution, max(plan.gravity_m_s2, LEAST_GRAVITY_M_S2)
    speeds = [plan.speed_m_s * e**k for k in range(IMPACTS)]
    if backend.bounces_by == SPRING:
        return calibrate_spring(
            EngineDrops(backend, engine, plan), e, speeds, plan.step_s, plan.size_m, gravity,
            lambda step_s: EngineDrops(backend, engine, replace(plan, step_s=step_s)),
        )  # fmt: skip
    found = calibration.calibrate_coefficient(
        EngineDrops(backend, engine, plan), e, speeds, plan.step_s, gravity
    )
    depth_m = found.at[0].penetration_m if found.at else 0.0
    if depth_m > DEPTH * plan.size_m:
        # in a step it goes no further than this
        longest_ms = math.floor(1e5 * DEPTH * plan.size_m / plan.speed_m_s) / 100
        raise CannotCalibrate(
            f"in a step of {1e3 * plan.step_s:.3g} ms a body at {plan.speed_m_s:.3g} m/s goes"
            f" {1e3 * depth_m:.3g} mm deep, more than half its size of {1e3 * plan.size_m:.3g} mm;"
            f" with a step of {longest_ms:g} ms it does not",
            longest_ms / 1e3,
        )
    return found


class EngineDrops:
    """Drops of a sphere on a fixed plane, in an engine's plain loop.

    Args:
        backend: the engine's backend.
        engine: the imported engine.
        plan: what is dropped.
    """

    def __init__(self, backend: Tunable, engine: ModuleType, plan: DropPlan) -> None:
        self._backend, self._engine, self._plan = backend, engine, plan
        self._gravity = max(plan.gravity_m_s2, LEAST_GRAVITY_M_S2)
        self._scene = _scene(plan, self._gravity)

    def __call__(self, numbers: tuple[float, ...], speed_m_s: float, phases: Array) -> Bounces:
        """Lets the sphere drop once for every phase."""
        pair = PairNumbers(("body", "ground"), numbers)
        settings = Settings(TUNED, numbers=(pair,))
        simulation = self._backend.build(self._engine, self._scene, settings)
        try:
            heights = [self._heights(simulation, speed_m_s, float(phase)) for phase in phases]
        finally:
            simulation.close()
        radius_m = self._plan.size_m / 2
        return drops.read_drops(heights, self._plan.step_s, self._gravity, radius_m)

    def _heights(self, simulation: Simulation, speed_m_s: float, phase: float) -> Array:
        """Height above the plane at every step, until the sphere has left it again."""
        step_s, radius = self._plan.step_s, self._plan.size_m / 2
        height, speed = drops.start_above(speed_m_s, phase, step_s, self._gravity)
        body = BodyState((0.0, 0.0, height + radius), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, -speed),
                         (0.0, 0.0, 0.0))  # fmt: skip
        simulation.set_state(State(0.0, {"body": body}, step_s))
        found = np.array([height])
        while len(found) < _MOST:
            rows = np.asarray(simulation.record(_CHUNK), dtype=float)
            more = simulation.motions(rows)["body.position_m"][:, 2] - radius
            if not np.isfinite(more).all():
                raise SimulationDiverged("the drops that calibrate its contact ran away")
            found = np.concatenate((found, more))
            left = np.flatnonzero((found[1:-1] > 0) & (np.diff(found)[1:] > 0))
            # from some sample on it rises above the plane, for long enough to be read
            if len(left) and len(found) - left[0] > _AFTER:
                return found
            if np.ptp(more) < 1e-12:  # it rests
                break
        return found


def _scene(plan: DropPlan, gravity_m_s2: float) -> Scenario:
    moment = 0.4 * plan.mass_kg * (plan.size_m / 2) ** 2
    return Scenario.model_validate(
        {
            "name": "drop",
            "title": "One bounce",
            "question": "How fast does it leave?",
            "world": {
                "gravity_m_s2": [0, 0, -gravity_m_s2],
                "duration_s": 1000 * plan.step_s,
                "step_s": plan.step_s,
            },
            "bodies": {
                "ground": {"fixed": True, "shapes": [{"type": "plane", "normal": [0, 0, 1]}]},
                "body": {
                    "mass_kg": plan.mass_kg,
                    "inertia_kg_m2": [moment] * 3,
                    "position_m": [0, 0, plan.size_m + plan.speed_m_s * plan.step_s],
                    "shapes": [{"type": "sphere", "radius_m": plan.size_m / 2}],
                },
            },
            "contacts": [{"pair": ["body", "ground"], "restitution": plan.restitution}],
        }
    )


# --- the cache --------------------------------------------------------------------------------


def cache_folder() -> Path:
    """Where calibrations are kept; SIMCOMPARE_CACHE names another folder."""
    folder = os.environ.get("SIMCOMPARE_CACHE") or platformdirs.user_cache_dir("simcompare")
    return Path(folder) / "calibrations"


def _cached(backend: Tunable, engine: ModuleType, plan: DropPlan) -> Calibration:
    key = _key(backend, plan)
    if key is None:
        return calibrate(backend, engine, plan)
    path = cache_folder() / f"{key}.json"
    # what is not there, or damaged, is found again
    with contextlib.suppress(OSError, ValueError, TypeError, KeyError, AttributeError):
        return _read(path)
    found = calibrate(backend, engine, plan)
    with contextlib.suppress(OSError):  # where nothing can be kept, it is found again
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(f".{os.getpid()}")
        text = json.dumps(asdict(found))
        part.write_text(f"{_digest(text)}\n{text}", encoding="utf-8")
        try:
            part.replace(path)
        except OSError:
            part.unlink()
    return found


def _read(path: Path) -> Calibration:
    digest, _, text = path.read_text(encoding="utf-8").partition("\n")
    if digest != _digest(text):  # changed, or cut off
        raise ValueError(path)
    plain = json.loads(text)
    for name in ("at", "checks"):
        plain[name] = tuple(
            calibration.AtSpeed(**{part: float(value) for part, value in one.items()})
            for one in plain[name]
        )
    numbers = tuple(float(value) for value in plain.pop("numbers"))
    return Calibration(numbers=numbers, **plain)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _key(backend: Tunable, plan: DropPlan) -> str | None:
    """What a calibration depends on: the drop, but not the pairs' names; engine and all our code.

    ``None`` where the backend has no file, so that a change of it would not be seen.
    """
    module = sys.modules.get(type(backend).__module__)
    own = getattr(module, "__file__", None)
    if own is None:
        return None
    asked = {**asdict(plan), "pairs": None, "notes": None}
    # beside a module that is in no package may lie anything
    adapter = Path(own).parent if getattr(module, "__package__", "") else Path(own)
    code = [_code(adapter), _code(Path(__file__).parent)]
    parts = [backend.name, backend.version(), *code, json.dumps(asked)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:32]


@functools.cache
def _code(folder: Path) -> str:
    """Digest of a module, or of all of a folder, read once in a process."""
    digest = hashlib.sha256()
    for path in [folder] if folder.is_file() else sorted(folder.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()
