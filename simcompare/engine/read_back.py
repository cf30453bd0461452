"""What is asked of an engine after a scene was built, and how its answers become the audit.

The core asks for every physical value of a scene, and an adapter answers each: with what its engine
holds, or with a reason why that cannot be read. What is not answered is a fault of the adapter, so
nothing can be left out without a word.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.engine.scene import Scene
from simcompare.errors import ReadBackMismatch
from simcompare.model.audit import Audit, AuditRow
from simcompare.model.settings import SPRING, TUNED
from simcompare.model.shapes import sizes_m

#: what acts on a joint: the part of its law -> unit on a hinge and on a slider
LAW_UNITS = {
    "stiffness": ("N·m/rad", "N/m"), "damping": ("N·m·s/rad", "N·s/m"),
    "friction": ("N·m", "N"), "armature": ("kg·m²", "kg"),
}  # fmt: skip


@dataclass(frozen=True)
class Quantity:
    """One physical value of a scene.

    Attributes:
        kind: what it is: "step_s", "gravity_m_s2"; of a body "mass_kg", "inertia_kg_m2" (principal
            moments), "position_m", "center_of_mass_m", "size_m" (of one shape); of a joint
            "anchor_m" (in the parent's frame), "axis" (in the child's frame), "stiffness", "rest",
            "damping", "friction", "armature"; of a pair "restitution", "friction".
        of: the body, joint or pair, empty for the world.
        value: what the scenario states, one number for each of ``parts``.
        parts: what tells the numbers apart in their names, such as ".x".
        unit: of all of them.
        bodies: of a pair.
        index: which shape of a body.
        is_given: whether this level gives it to the engine; else the engine's own is shown.
        owner: what it belongs to: "world", "body", "joint" or "pair".
        is_stated: whether the scenario states it; else it is of a shape that a help builds.
        put: what is to be given where that is something else than is stated: moments of inertia
            with an armature in them, a coefficient that was sought for this step.
    """

    kind: str
    of: str
    value: tuple[float, ...]
    parts: tuple[str, ...] = ("",)
    unit: str = "1"
    bodies: tuple[str, str] = ("", "")
    index: int = 0
    is_given: bool = True
    owner: str = "body"
    is_stated: bool = True
    put: tuple[float, ...] | None = None

    @property
    def name(self) -> str:
        """Its name in the audit, without the parts."""
        if self.owner == "pair":
            return f"{self.of} {self.kind}"
        if self.kind == "step_s":
            return f"engine {self.kind}"
        return f"{self.of}.{self.kind}" if self.of else self.kind


@dataclass(frozen=True)
class Held:
    """An answer: what the engine holds.

    Attributes:
        parameter: what the engine calls it.
        value: what it holds, in the order of :attr:`Quantity.parts`; ``None`` in place of a part
            that it does not have, and for all where it cannot be read.
        put: what it was given where that is something else than :attr:`Quantity.put`.
        note: why it was set so, or why it cannot be read.
        unit: where it is another one.
    """

    parameter: str
    value: float | Sequence[float | None] | None
    put: float | Sequence[float] | None = None
    note: str = ""
    unit: str = ""


def unreadable(parameter: str, note: str) -> Held:
    """The answer for what was set and has no getter."""
    return Held(parameter, None, note=note)


#: an adapter's answer: one value, or several that stand for the one that is asked for
HeldValues = Held | Sequence[Held]
#: what an engine holds of one thing, by :attr:`Quantity.kind`; of "size_m" one for each shape
Table = Mapping[str, HeldValues]


def quantities(scene: Scene) -> Iterator[Quantity]:
    """Every physical value of a scene."""
    scenario = scene.scenario
    yield Quantity("step_s", "", (scenario.world.engine_step_s,), unit="s", owner="world")
    yield Quantity("gravity_m_s2", "", scenario.world.gravity_m_s2, _XYZ, "m/s²", owner="world")
    free = scenario.free_bodies()
    for name, body in scenario.moving_bodies().items():
        assert body.mass_kg is not None
        assert body.inertia_kg_m2 is not None
        yield Quantity("mass_kg", name, (body.mass_kg,), unit="kg")
        put = (*np.diag(scene.inertia(name)).tolist(),) if scene.armature_on(name) else None
        yield Quantity("inertia_kg_m2", name, body.inertia_kg_m2, _PRINCIPAL, "kg·m²", put=put)
        if name in free:  # those on joints are compared where they are at the start
            yield Quantity("position_m", name, body.position_m, _XYZ, "m")
        if any(body.center_of_mass_m):
            yield Quantity("center_of_mass_m", name, body.center_of_mass_m, _XYZ, "m")
        stated = tuple(body.shapes) == tuple(scene.shapes[name])
        for i, shape in enumerate(scene.shapes[name]):
            sizes = sizes_m(shape)
            parts, values = tuple(f".{part}" for part in sizes), tuple(sizes.values())
            if sizes:
                yield Quantity("size_m", name, values, parts, "m", index=i, is_stated=stated)
    yield from _joints(scene)
    for pair in scene.contacts.touching:
        given = scene.contacts.are_given
        # a spring and damper is no coefficient: it is given with everything else, or where asked
        typed_in = scene.gives(TUNED) or len(pair.numbers) > 1
        bounces = given and (scene.traits.bounces_by != SPRING or typed_in)
        for kind, value, put, is_given in (
            ("restitution", pair.restitution, pair.numbers[:1], bounces),
            ("friction", pair.friction, None, given),
        ):
            yield Quantity(
                kind, pair.name, (value,), bodies=pair.bodies, is_given=is_given, owner="pair",
                put=put,
            )  # fmt: skip


_XYZ = (".x", ".y", ".z")
_PRINCIPAL = (".1", ".2", ".3")


def _joints(scene: Scene) -> Iterator[Quantity]:
    for name, joint in scene.joints.items():
        yield Quantity("anchor_m", name, joint.joint.anchor_m, _XYZ, "m", owner="joint")
        if not joint.is_movable:
            continue
        yield Quantity("axis", name, joint.mount.axis, _XYZ, owner="joint")
        for part, units in LAW_UNITS.items():
            value = getattr(joint.law, part)
            if value:
                unit = units[joint.joint.type == "slider"]
                yield Quantity(part, name, (value,), unit=unit, owner="joint")
        if joint.law.stiffness and joint.law.rest:
            yield Quantity("rest", name, (joint.law.rest,), unit="SI", owner="joint")


def audit_of(
    scene: Scene, answers: Sequence[tuple[Quantity, HeldValues | None]], own: Sequence[AuditRow]
) -> tuple[AuditRow, ...]:
    """All rows: what was asked for, then the engine's own parameters.

    Raises:
        ReadBackMismatch: the engine holds another value than was set, or an answer is missing; all
            of them are named.
    """
    silent = [quantity for quantity, answer in answers if answer is None]
    if silent:
        raise ReadBackMismatch(
            scene.engine,
            [
                f"{quantity.name}: the adapter does not say what the engine holds"
                for quantity in silent
            ],
        )
    audit = Audit(scene.engine, relative=scene.traits.precision)
    for quantity, answer in answers:
        assert answer is not None
        for held in (answer,) if isinstance(answer, Held) else answer:
            _add(audit, quantity, held, scene.traits.precision)
    audit.rows += own
    return audit.finish()


#: what is placed: rounding about 0 is no difference there
_PLACES = ("anchor_m", "axis", "position_m", "center_of_mass_m")
_ROUNDING = 1e-12


def _add(audit: Audit, one: Quantity, held: Held, precision: float) -> None:
    values = _parts_of(one, held.value)
    to_give = one.value if one.put is None else one.put
    puts = _parts_of(one, to_give if held.put is None else held.put)
    slack = max(_ROUNDING, precision * max(map(abs, one.value))) if one.kind in _PLACES else 0.0
    for part, wanted, put, value in zip(one.parts, one.value, puts, values, strict=True):
        if value is None and held.value is not None:
            continue  # the engine has no such part
        assert put is not None
        name = f"{one.of}{part}" if one.kind == "size_m" else f"{one.name}{part}"
        clean = put if value is not None and abs(put - value) < slack else value
        audit.add(
            name, wanted if one.is_stated else None, held.parameter,
            (put if one.is_given else None, clean),
            held.unit or one.unit, held.note if one.is_given else "engine's default",
        )  # fmt: skip


def _parts_of(
    quantity: Quantity, values: float | Sequence[float | None] | None
) -> Sequence[float | None]:
    """One value for each part of what was asked for; engines like to give arrays."""
    if isinstance(values, np.ndarray | np.generic):
        values = values.tolist()
    parts = (
        [values] * len(quantity.parts)
        if values is None or isinstance(values, float | int)
        else values
    )
    assert len(parts) == len(quantity.parts), f"{quantity.name} has {len(quantity.parts)} parts"
    return parts
