"""What was set in MuJoCo, and what the compiled model holds."""

from __future__ import annotations

import math
from types import ModuleType
from typing import Any

from simcompare.audit import Audit
from simcompare.backends._mujoco_scene import (
    FRICTION_SOLREF,
    SOLIMP,
    friction_solref,
    geom_name,
    pair_names,
    solref,
)
from simcompare.drives import JointLaw, laws_of
from simcompare.helps import CENTRED_EFFORTS
from simcompare.kinematics import Mount, mount_of
from simcompare.pairs import touching_pairs
from simcompare.scenario import Body, Contact, Scenario
from simcompare.settings import Settings


def audit_of(engine: ModuleType, model: Any, scenario: Scenario, settings: Settings) -> Audit:
    """Everything that was set, and what the model holds."""
    audit = Audit("mujoco")
    world = scenario.world
    step_s = world.engine_step_s
    audit.add("engine step_s", step_s, "opt.timestep", (step_s, model.opt.timestep), "s")
    if settings.gives_all:
        cone = (1, model.opt.cone)
        audit.add("contact", None, "opt.cone", cone, "1", "elliptic (mjCONE_ELLIPTIC)")
    for axis, wanted, held in zip("xyz", world.gravity_m_s2, model.opt.gravity, strict=True):
        audit.add(f"gravity_m_s2.{axis}", wanted, "opt.gravity", (wanted, held), "m/s²")
    for name, body in scenario.moving_bodies().items():
        _audit_body(audit, model, name, body, name in scenario.free_bodies())
    for name, law in laws_of(scenario).items():
        _audit_joint(audit, model, name, law, settings)
        _audit_place(audit, model, name, mount_of(scenario, scenario.joints[name]))
    for contact in touching_pairs(scenario):
        if settings.gives_all:
            _audit_pairs(audit, model, scenario, contact, settings)
        else:
            _audit_default(engine, audit, contact)
        if settings.gives_coefficients:
            _audit_friction(audit, model, scenario, contact)
    return audit


def _audit_joint(audit: Audit, model: Any, name: str, law: JointLaw, settings: Settings) -> None:
    held, dof = model.joint(name), int(model.joint(name).dofadr[0])
    explicit = -float(model.actuator(name).biasprm[2]) if law.is_driven else 0.0
    note = "half with the rate before the step, half with that after it"
    note = note if settings.takes(CENTRED_EFFORTS) else ""
    for part, wanted, got, extra in (
        ("stiffness", law.stiffness, held.stiffness[0], ""),
        ("rest", law.rest, model.qpos_spring[int(held.qposadr[0])], ""),
        ("damping", law.damping, model.dof_damping[dof] + explicit, note),
        ("friction", law.friction, model.dof_frictionloss[dof], ""),
        ("armature", law.armature, model.dof_armature[dof], ""),
    ):
        if wanted:
            audit.add(f"{name}.{part}", wanted, f"dof {part}", (wanted, got), "SI", extra)
    if law.friction and settings.gives_all:
        for i, value in enumerate(FRICTION_SOLREF):
            audit.add(
                f"{name}.friction", None, f"solreffriction[{i}]",
                (value, model.dof_solref[dof][i]), ("s", "1")[i],
            )  # fmt: skip
        for i, value in enumerate(SOLIMP):
            audit.add(
                f"{name}.friction", None, f"solimpfriction[{i}]",
                (value, model.dof_solimp[dof][i]), ("1", "1", "SI")[i],
            )  # fmt: skip


def _audit_place(audit: Audit, model: Any, name: str, mount: Mount) -> None:
    """Axis and anchor of a joint, both in the child's frame."""
    held = model.joint(name)
    rows = (("axis", mount.axis, held.axis, "1"), ("anchor_m", mount.anchor_m, held.pos, "m"))
    for part, wanted, got, unit in rows:
        for axis, a, b in zip("xyz", wanted, got.tolist(), strict=True):
            clean = a if abs(a - b) < 1e-12 else b  # MuJoCo makes the axis a unit vector once more
            audit.add(f"{name}.{part}.{axis}", a, f"jnt_{part[:4]}", (a, clean), unit)


def _audit_body(audit: Audit, model: Any, name: str, body: Body, free: bool) -> None:
    held = model.body(name)
    audit.add(f"{name}.mass_kg", body.mass_kg, "body_mass", (body.mass_kg, held.mass[0]), "kg")
    # MuJoCo may order the principal axes anew, so the moments are compared sorted
    moments = zip("123", sorted(body.inertia_kg_m2 or ()), sorted(held.inertia), strict=True)
    for axis, wanted, got in moments:
        quantity = f"{name}.inertia_kg_m2.{axis}"
        audit.add(quantity, wanted, "body_inertia", (wanted, got), "kg·m²")
    for axis, wanted, got in zip("xyz", body.position_m, held.pos, strict=True):
        if free:  # those on joints are compared where they are in the world
            audit.add(f"{name}.position_m.{axis}", wanted, "body_pos", (wanted, got), "m")
    for axis, wanted, got in zip("xyz", body.center_of_mass_m, held.ipos, strict=True):
        if wanted:
            quantity = f"{name}.center_of_mass_m.{axis}"
            audit.add(quantity, wanted, "body_ipos", (wanted, got), "m")
    for i, shape in enumerate(body.shapes):
        size = model.geom(geom_name(name, i)).size.tolist()
        halves = {"plane": [], "sphere": size[:1], "box": [2 * half for half in size]}
        length = [size[0], 2 * size[1]]  # cylinder and capsule
        audit.add_sizes(name, shape, "geom_size", halves.get(shape.type, length))


def _audit_default(engine: ModuleType, audit: Audit, contact: Contact) -> None:
    held = tuple(engine.MjModel.from_xml_string(_NEUTRAL).geom("g").solref)
    quantity = f"{'-'.join(contact.pair)} restitution"
    for parameter, unit, value in zip(
        ("solref time constant", "solref damping ratio"), ("s", "1"), held, strict=True
    ):
        values = (None, value)
        audit.add(quantity, contact.restitution, parameter, values, unit, "engine's default")


def _audit_pairs(
    audit: Audit, model: Any, scenario: Scenario, contact: Contact, settings: Settings
) -> None:
    label = "-".join(contact.pair)
    first, second = solref(scenario, contact, settings)
    note, units = "no bounce", ("s", "1")
    if first < 0:
        note, units = f"ζ = {-second / 2 / math.sqrt(-first):.6g}", ("1/s²", "1/s")
    for name in pair_names(scenario, contact):
        held = model.pair(name)
        for i, value in enumerate((first, second)):
            values = (value, held.solref[i])
            parameter = f"solref[{i}]"
            quantity = f"{label} restitution"
            audit.add(quantity, contact.restitution, parameter, values, units[i], note)
        sideways = friction_solref(scenario, contact, settings)
        for i, value in enumerate(sideways or ()):
            values = (value, model.pair_solreffriction[held.id][i])
            audit.add(f"{label} friction", None, f"solreffriction[{i}]", values, "SI")
        where = "of the <pair>; typed into geoms: into both, or with the higher priority into one"
        for i, (value, unit) in enumerate(zip(SOLIMP, ("1", "1", "m"), strict=True)):
            values = (value, held.solimp[i])
            audit.add(f"{label} contact", None, f"solimp[{i}]", values, unit, where)


def _audit_friction(audit: Audit, model: Any, scenario: Scenario, contact: Contact) -> None:
    mu = contact.friction
    for name in pair_names(scenario, contact):
        values = (mu, model.pair(name).friction[0])
        audit.add(f"{'-'.join(contact.pair)} friction", mu, "pair_friction", values, "1")


_NEUTRAL = '<mujoco><worldbody><geom name="g" size="1"/></worldbody></mujoco>'
