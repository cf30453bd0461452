"""Stepping and reading a MuJoCo model; many steps in one native call where that can be."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from simcompare.backends.mujoco.mjcf import (
    JOINT_FRICTION,
    choices_of,
    geom_name,
    mjcf,
    pair_names,
    springs_of,
)
from simcompare.kit import (
    TUNED,
    Array,
    Audit,
    FreeCoordinates,
    Held,
    Numbers,
    Pair,
    ReducedSimulation,
    Scene,
    Shape,
    SimulationDiverged,
    Table,
    Vector,
    sizes_m,
)

#: a native call costs as much as some steps, so fewer recorded steps than this take the plain loop
MIN_ROLLOUT = 4


class MujocoSimulation(ReducedSimulation):
    """A compiled MJCF model and its data."""

    FREE = FreeCoordinates("wxyz", body_rates=True)
    efforts_last = True

    def __init__(self, mujoco: Any, scene: Scene) -> None:
        super().__init__(scene)
        self._mujoco = mujoco
        self._model = model = mujoco.MjModel.from_xml_string(mjcf(scene))
        self.data = data = mujoco.MjData(model)
        # a row is MuJoCo's own: all coordinates, then all rates
        slots = {name: (model.joint(name).qposadr, model.joint(name).dofadr) for name in self.slots}
        self.slots = {name: (int(q[0]), model.nq + int(v[0])) for name, (q, v) in slots.items()}
        # views, through which everything is read and written in place
        self._places = {name: (data.joint(name).qpos, data.joint(name).qvel) for name in slots}
        self._pushes = {name: data.body(name).xfrc_applied[:3] for name in self._bodies}
        self._qpos, self._qvel = data.qpos, data.qvel
        self._numbers = {name: model.body(name).id for name in self.scenario.bodies} | {"": -1}
        self.place_all()

    def take_steps(self, count: int) -> None:
        self._mujoco.mj_step(self._model, self.data, count)

    def set_engine_step(self, step_s: float) -> None:
        self._model.opt.timestep = step_s

    def get(self, name: str) -> tuple[Numbers, Numbers]:
        position, rate = self._places[name]
        return position.tolist(), rate.tolist()

    def put(self, name: str, q: Numbers | None, v: Numbers) -> None:
        position, rate = self._places[name]
        if q is not None:
            position[:] = q
        rate[:] = v

    def origin_of(self, body: str) -> Vector:
        self._mujoco.mj_kinematics(self._model, self.data)
        x, y, z = self.data.body(body).xpos.tolist()
        return x, y, z

    def give(self, efforts: Sequence[float]) -> None:
        self.data.ctrl[:] = efforts

    def push(self, body: str, force: Vector) -> None:
        self._pushes[body][:] = force

    def cast_rays(
        self, origin_m: Vector, directions: Array, without_body: str, reach_m: float
    ) -> Array:
        mujoco, count = self._mujoco, len(directions)
        mujoco.mj_kinematics(self._model, self.data)  # a step leaves bodies where it began
        geoms, distances = np.empty(count, np.int32), np.empty(count)
        mujoco.mj_multiRay(
            self._model, self.data, origin_m, directions.ravel(), None, True,
            self._numbers[without_body], geoms, distances, None, count, reach_m,
        )  # fmt: skip
        distances[(distances < 0) | (distances > reach_m)] = np.inf
        return distances

    def row(self) -> Any:
        return [*self._qpos.tolist(), *self._qvel.tolist()]

    def forces(self) -> list[float]:
        found: list[float] = self._forces_of(self.data.sensordata[None])[0].tolist()
        return found

    def _forces_of(self, sensed: Array) -> Array:
        """Readings (n, k) of force sensors; a contact sensor gives the normal force of each point.

        MuJoCo fills sensors from the state before a step, so they hold the forces in that step.
        """
        columns = [sensed[:, :0]]
        for name, sensor in self._force_sensors.items():
            held = self._model.sensor(name)
            block = sensed[:, int(held.adr[0]) : int(held.adr[0] + held.dim[0])]
            columns.append(
                block if sensor.type == "force" else block[:, ::3].sum(axis=1, keepdims=True)
            )
        return np.hstack(columns)

    def record(self, count: int) -> Any:
        """Native rollout; it keeps no forces from Python, so drag takes the plain loop."""
        if self._dragged or count < MIN_ROLLOUT:
            return super().record(count)
        from mujoco import rollout

        kind, steps = self._mujoco.mjtState.mjSTATE_FULLPHYSICS, count * self.substeps
        efforts = None if self._drive is None else self._drive.rows(steps)[None]
        # the solver goes on from its last solution, as it does in single steps
        last = self.data.qacc_warmstart[None].copy()
        states, sensed = rollout.rollout(
            self._model, self.data, self._state(kind)[None], efforts,
            nstep=steps, initial_warmstart=last,
        )  # fmt: skip
        self._mujoco.mj_setState(self._model, self.data, states[0, -1], kind)
        # the time comes first, then a row
        motion = states[0, self.substeps - 1 :: self.substeps, 1 : 1 + len(self.row())]
        return np.hstack((motion, self._forces_of(sensed[0, :: self.substeps])))

    def _state(self, kind: Any) -> Array:
        state = np.empty(self._mujoco.mj_stateSize(self._model, kind))
        self._mujoco.mj_getState(self._model, self.data, state, kind)
        return state

    def snapshot(self) -> Array:
        return self._state(self._mujoco.mjtState.mjSTATE_INTEGRATION)

    def take_back(self, snapshot: object) -> None:
        self._mujoco.mj_setState(
            self._model, self.data, snapshot, self._mujoco.mjtState.mjSTATE_INTEGRATION
        )

    def forget(self) -> None:
        # the solver starts from its last solution, which is no part of a state
        self.data.qacc_warmstart[:] = 0

    def check(self) -> None:
        """MuJoCo itself warns of numbers that are no motion any more."""
        counts = self.data.warning.number
        if counts.any():
            kind = self._mujoco.mjtWarning(int(counts.nonzero()[0][0]))
            raise SimulationDiverged(f"MuJoCo warned: {kind.name}; try a smaller --step")

    # --- what the model holds -----------------------------------------------------------------

    def held_of_world(self) -> Table:
        option = self._model.opt
        return {
            "step_s": Held("opt.timestep", option.timestep),
            "gravity_m_s2": Held("opt.gravity", option.gravity.tolist()),
        }

    def held_of_body(self, body: str) -> Table:
        held, moments = self._model.body(body), self.scenario.bodies[body].inertia_kg_m2 or ()
        shapes = enumerate(self.scene.shapes[body])
        return {
            "mass_kg": Held("body_mass", held.mass[0]),
            # MuJoCo may order the principal axes anew, so the moments are compared sorted
            "inertia_kg_m2": Held("body_inertia", sorted(held.inertia.tolist()), sorted(moments)),
            "position_m": Held("body_pos", held.pos.tolist()),
            "center_of_mass_m": Held("body_ipos", held.ipos.tolist()),
            "size_m": [_size(self._model.geom(geom_name(body, i)), shape) for i, shape in shapes],
        }

    def held_of_joint(self, joint: str) -> Table:
        model, built = self._model, self.scene.joints[joint]
        if not built.is_movable:  # it is no joint in MuJoCo, only a place in the parent
            place = model.body(built.joint.child).pos.tolist()
            return {"anchor_m": Held("body_pos", place, built.mount.position_m, "of the child")}
        held, frame = model.joint(joint), "in the child's frame"
        damping, note = held.damping[0], ""
        if built.actuator_damping:
            damping -= model.actuator(joint).biasprm[2]
            note = "half with the rate before the step, half with that after it"
        return {
            "anchor_m": Held("jnt_pos", held.pos.tolist(), built.mount.anchor_m, frame),
            "axis": Held("jnt_axis", held.axis.tolist(), note=frame),
            "stiffness": Held("dof stiffness", held.stiffness[0]),
            "rest": Held("dof rest", held.qpos_spring[0]),
            "damping": Held("dof damping", damping, note=note),
            "friction": Held("dof friction", held.frictionloss[0]),
            "armature": Held("dof armature", held.armature[0]),
        }

    @functools.cached_property
    def _touching(self) -> dict[tuple[str, str], tuple[Pair, dict[str, Any], list[Any]]]:
        """Of each pair of bodies what was given, and where the model holds it."""
        return {
            pair.bodies: (
                pair,
                springs_of(self.scene, pair),
                [self._model.pair(name) for name in pair_names(self.scene, pair)]
                if self.scene.contacts.are_given
                else [self._model.geom(geom_name(pair.bodies[0], 0))],  # all are alike
            )
            for pair in self.scene.contacts.touching
        }

    def held_of_pair(self, first: str, second: str) -> Table:
        pair, springs, contacts = self._touching[first, second]
        friction = "pair_friction" if self.scene.contacts.are_given else "geom_friction"
        put: Sequence[float] = springs.get("solref", (0.0, 0.0))
        names = (
            ("solref[0]", "solref[1]")
            if springs
            else ("solref time constant", "solref damping ratio")
        )
        units, note = ("s", "1"), "" if pair.restitution > 0 else "no bounce"
        if put[0] < 0:
            units, note = ("1/s²", "1/s"), f"ζ = {-put[1] / 2 / math.sqrt(-put[0]):.6g}"
        return {
            "friction": [Held(friction, contact.friction[0]) for contact in contacts],
            "restitution": [
                Held(names[i], contact.solref[i], put[i], note, units[i])
                for contact in contacts
                for i in range(2)
            ],
        }

    def own_parameters(self, audit: Audit) -> None:
        scene, model = self.scene, self._model
        for name, choice in choices_of(scene).items():
            values, note = (choice.number, getattr(model.opt, name)), choice.enum
            of = "contact" if name == "cone" else "step"
            audit.add(of, None, f"opt.{name}", values, "1", f"{choice.word} ({note})")
        if not scene.gives(TUNED):
            return
        for name in [name for name, joint in scene.joints.items() if joint.own.friction]:
            dof = model.joint(name).dofadr[0]
            for parameter, held, units in (
                ("solreffriction", model.dof_solref[dof], ("s", "1")),
                ("solimpfriction", model.dof_solimp[dof], ("1", "1", "SI")),
            ):
                audit.add_all(f"{name}.friction", parameter, JOINT_FRICTION[parameter], held, units)
        where = "of the <pair>; typed into geoms: into both, or with the higher priority into one"
        for pair, springs, contacts in self._touching.values():
            for held in contacts:
                audit.add_all(
                    f"{pair.name} friction", "solreffriction", springs.get("solreffriction", ()),
                    model.pair_solreffriction[held.id], ("SI", "SI"),
                )  # fmt: skip
                audit.add_all(
                    f"{pair.name} contact", "solimp", springs["solimp"], held.solimp.tolist(),
                    ("1", "1", "m"), where,
                )  # fmt: skip


def _size(geom: Any, shape: Shape) -> Held:
    """Lengths of a geom, of which MuJoCo holds radii, and the half of all others."""
    halves = zip(sizes_m(shape), geom.size.tolist(), strict=False)
    whole = [half if name == "radius_m" else 2 * half for name, half in halves]
    return Held("geom_size", whole)
