"""What a scene in PyBullet consists of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import ModuleType

from simcompare.scenario import Scenario
from simcompare.settings import Settings

#: a body, as PyBullet calls it: number of the articulated body and of its link, -1 for its base
Place = tuple[int, int]
BASE = -1


@dataclass
class Scene:
    """What was built, by the names of the scenario.

    Attributes:
        engine: the imported engine.
        client: its physics client.
        scenario: what was built.
        settings: how much of the scenario is given to the engine, and with which helps.
        bodies: place of every body.
        joints: place of every joint, which is that of its child.
        restitution: per body; empty where it is left to the engine.
        friction: per body, likewise.
    """

    engine: ModuleType
    client: int
    scenario: Scenario
    settings: Settings
    bodies: dict[str, Place] = field(default_factory=dict)
    joints: dict[str, Place] = field(default_factory=dict)
    restitution: Mapping[str, float] = field(default_factory=dict)
    friction: Mapping[str, float] = field(default_factory=dict)
