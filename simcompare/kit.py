"""The kit: all that an adapter of an engine is written with, in one place.

Each name is explained in the module that it comes from; CONTRIBUTING.md leads through them.
"""

from simcompare.engine.backend import EngineBackend, KnownLimit
from simcompare.engine.combination import Rule, combined
from simcompare.engine.contacts import Pair, untouching_pairs
from simcompare.engine.features import JOINTS_AND_FORCES, SPATIAL_RIGID_BODIES, Feature
from simcompare.engine.helps import (
    CENTRED_EFFORTS,
    HALF_STEP_START,
    HELPS,
    LANDING,
    RAYS,
    REACTIONS,
    RECOIL,
    RIMS,
)
from simcompare.engine.helps.rims import Rims
from simcompare.engine.helps.spring_contact import SOFT_STEP_S
from simcompare.engine.kept import Keeper
from simcompare.engine.kinematics import trees
from simcompare.engine.library import OtherPython, PipPackage, Program, SharedLibrary
from simcompare.engine.own_values import OwnValue
from simcompare.engine.planar import PlanarSimulation
from simcompare.engine.planar_joints import (
    PlanarHinge,
    PlanarJoint,
    PlanarMotion,
    PlanarSlider,
    PlanarWeld,
    Point,
    angle_of,
    direction,
    planar,
    turned_by,
)
from simcompare.engine.read_back import Held, Table, unreadable
from simcompare.engine.reduced import FreeCoordinates, ReducedSimulation
from simcompare.engine.scene import Scene, SceneJoint, Traits
from simcompare.engine.spatial import SpatialSimulation
from simcompare.engine.spatial_joints import mobility
from simcompare.engine.speeds import fastest_turn_rad_s
from simcompare.engine.state import BodyState
from simcompare.engine.sweeps import Row, row_of, sweeps_for
from simcompare.engine.turns import Turns
from simcompare.engine.variants import Variant
from simcompare.errors import EngineBroken, SimulationDiverged, Unsupported
from simcompare.model.audit import Audit
from simcompare.model.rotations import matrix_of, xyzw
from simcompare.model.scenario import Scenario
from simcompare.model.settings import COEFFICIENTS, SPRING, TUNED
from simcompare.model.shapes import Shape, Vector, sizes_m
from simcompare.model.trajectory import Array, Trajectory
from simcompare.model.vectors import (
    Numbers,
    dot,
    minus,
    multiplied,
    plus,
    times,
    turned_back,
    x_turned_to,
)

__all__ = [
    "CENTRED_EFFORTS", "COEFFICIENTS", "HALF_STEP_START", "HELPS", "JOINTS_AND_FORCES",
    "LANDING", "RAYS", "REACTIONS", "RECOIL", "RIMS", "SOFT_STEP_S", "SPATIAL_RIGID_BODIES",
    "SPRING", "TUNED", "Array", "Audit", "BodyState", "EngineBackend", "EngineBroken", "Feature",
    "FreeCoordinates", "Held", "Keeper", "KnownLimit", "Numbers", "OtherPython", "OwnValue", "Pair",
    "PipPackage", "PlanarHinge", "PlanarJoint", "PlanarMotion", "PlanarSimulation",
    "PlanarSlider", "PlanarWeld", "Point", "Program", "ReducedSimulation", "Rims", "Row",
    "Rule", "Scenario", "Scene", "SceneJoint", "Shape", "SharedLibrary", "SimulationDiverged",
    "SpatialSimulation", "Table", "Traits", "Trajectory", "Turns", "Unsupported", "Variant",
    "Vector", "angle_of", "combined", "direction", "dot", "fastest_turn_rad_s", "matrix_of",
    "minus", "mobility", "multiplied", "planar", "plus", "row_of", "sizes_m", "sweeps_for",
    "times", "trees", "turned_back", "turned_by", "unreadable", "untouching_pairs",
    "x_turned_to", "xyzw",
]  # fmt: skip
