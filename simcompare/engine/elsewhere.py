"""Physics engines that people ask for and that simcompare cannot run, as data.

They are no backends: ``--engine all`` does not mean them. Each says why it cannot run, and how a
user who has it carries a scene there; the results come back in one way for all of them. A new one
is one more block in :data:`ENGINES`. Nothing is imported here, so that naming them costs nothing.
"""

from __future__ import annotations

import difflib
from collections.abc import Collection
from dataclasses import dataclass


@dataclass(frozen=True)
class Elsewhere:
    """An engine that runs elsewhere, not in simcompare.

    Attributes:
        name: as it is typed after ``--engine``, small letters and digits.
        title: its full name.
        why: why simcompare cannot run it.
        why_reference: where that is documented.
        file_format: format of ``simcompare export`` that it reads.
        way: what reads that file there.
        way_reference: where that is documented.
        contains: engine of ours that it contains as well, empty where there is none.
        contains_reference: where that is documented.
        also_called: other names that people type, small letters and digits.
    """

    name: str
    title: str
    why: str
    why_reference: str
    file_format: str
    way: str
    way_reference: str
    contains: str = ""
    contains_reference: str = ""
    also_called: tuple[str, ...] = ()

    @property
    def command(self) -> str:
        """The command that writes a scene for it."""
        return f"simcompare export robot --format {self.file_format} -o robot.{self.file_format}"

    @property
    def here(self) -> str:
        """The command that runs what it contains and we have, empty where there is nothing."""
        return f"simcompare run robot --engine {self.contains}" if self.contains else ""

    def lines(self) -> list[str]:
        """What a user can do, a sentence or a command a line."""
        found = [
            f"carry a scene there: {self.command}",
            f"{self.way} [{self.way_reference}]",
        ]
        if self.contains:
            told = f"{self.contains}, which it contains [{self.contains_reference}], runs here"
            found.append(f"{told}: {self.here}")
        return found

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        return {
            "engine": self.name,
            "title": self.title,
            "why": self.why,
            "why_reference": self.why_reference,
            "commands": [command for command in (self.command, self.here) if command],
            "way": self.way,
            "way_reference": self.way_reference,
            "commands_back": [command for _, commands in BACK for command in commands],
        }


#: said before all of them
UNTRIED = "No scene was run in any of these; what they read is what their documents say."

#: how results come back from any of them: a sentence, and commands to be pasted one by one
BACK = (
    (
        "What the file cannot hold is printed, and stands in it as a comment: set that by hand.",
        (),
    ),
    (
        "Save the results as a table, robot.csv with the header: time (s),speed (m/s). Then",
        (
            "simcompare import robot.csv",
            'echo "validate: [{scenario: robot, compare: {speed_m_s: {channel: speed}}}]"'
            " > robot.yaml",
            "simcompare validate robot --recording robot.csv --map robot.yaml",
        ),
    ),
    (
        "Of a ball that bounces: bounces.csv with the header: bounce,rebound_height (m). Then",
        ("simcompare run ball --against bounces.csv",),
    ),
    (
        "More: docs/run.md (tables); CONTRIBUTING.md (a backend of your own, for an engine"
        " that Python can import).",
        (),
    ),
)

ENGINES = (
    Elsewhere(
        name="agx",
        title="AGX Dynamics",
        why="It is a product that is installed from its makers' download with a licence file;"
        " the package agx of pip holds no engine.",
        why_reference="pypi.org/project/agx",
        file_format="urdf",
        way="agxModel::UrdfReader reads it, in C++ and in Python.",
        way_reference="AGX Dynamics user manual, chapter URDF",
        also_called=("agxdynamics", "algoryx"),
    ),
    Elsewhere(
        name="chrono",
        title="Project Chrono",
        why="Its Python package comes through conda or is compiled; the package projectchrono of"
        " pip is empty (0.0.0), and pychrono is something else.",
        why_reference="pypi.org/project/projectchrono; api.projectchrono.org, Install PyChrono",
        file_format="urdf",
        way="chrono::parsers::ChParserURDF of the module Parsers reads it, in C++.",
        way_reference="api.projectchrono.org, Install the PARSERS module",
        also_called=("pychrono", "projectchrono"),
    ),
    Elsewhere(
        name="coppeliasim",
        title="CoppeliaSim",
        why="It is a program that is downloaded from its makers; pip has only clients that talk to"
        " a CoppeliaSim that is already running.",
        why_reference="pypi.org/project/coppeliasim-zmqremoteapi-client",
        file_format="urdf",
        way="simURDF.import('robot.urdf') reads it in a script of CoppeliaSim.",
        way_reference="github.com/CoppeliaRobotics/simURDF, manual/simURDF.htm",
        contains="mujoco",
        contains_reference="coppeliarobotics.com/helpFiles/en/dynamicsModule.htm",
        also_called=("coppelia", "vrep"),
    ),
    Elsewhere(
        name="gazebo",
        title="Gazebo",
        why="It is a program with package sources of its own; the package gazebo-py-bindings of"
        " pip does not bring the libraries that it needs (libgz-sim8).",
        why_reference="gazebosim.org/docs/jetty/getstarted; tried with gazebo-py-bindings 1.0.0",
        file_format="sdf",
        way="gz sim -r robot.sdf runs it.",
        way_reference="gazebosim.org/api/sim/8/log.html",
        contains="dart",
        contains_reference="gazebosim.org/api/sim/10/physics.html",
        also_called=("gz", "gzsim", "ignition"),
    ),
    Elsewhere(
        name="newton",
        title="Newton Dynamics",
        why="It is a C++ library that is compiled from its source; the package newton of pip is"
        " another engine, for GPUs.",
        why_reference="github.com/MADEAPPS/newton-dynamics, README.md; pypi.org/project/newton",
        file_format="urdf",
        way="ndUrdfFile::Import reads it, in C++; some versions do not read every joint and shape,"
        " so look at what was built.",
        way_reference="github.com/MADEAPPS/newton-dynamics, newton-4.00/sdk/dModel/ndUrdfFile.cpp",
        also_called=("newtondynamics",),
    ),
    Elsewhere(
        name="raisim",
        title="RaiSim",
        why="It is downloaded from its makers and needs an activation key from raisim.com.",
        why_reference="github.com/raisimTech/raisim2Lib, README.md",
        file_format="urdf",
        way='world.addArticulatedSystem("robot.urdf") reads it, in C++.',
        way_reference="raisim.com/sections/ArticulatedSystem.html",
        also_called=("raisim2", "raisimpy"),
    ),
    Elsewhere(
        name="vortex",
        title="Vortex Studio",
        why="It is a product with an installer of its own; pip has no package of it, and pyvortex"
        " is something else.",
        why_reference="vortexstudio.atlassian.net, URDF Importer; pypi.org/project/pyvortex",
        file_format="urdf",
        way="python urdf_to_vxassembly.py -i robot.urdf -o robot.vxassembly makes an assembly of"
        " it; the script lies in bin\\vxurdf of Vortex.",
        way_reference="vortexstudio.atlassian.net, URDF Importer",
        also_called=("vortexstudio", "vortexdynamics", "cmlabs"),
    ),
)


def names(known: Collection[str] = ()) -> list[str]:
    """Their names, without those of backends that exist."""
    return [engine.name for engine in others(known)]


def others(known: Collection[str] = ()) -> list[Elsewhere]:
    """All of them, without those for which somebody's package has a backend of that name."""
    return [engine for engine in ENGINES if engine.name not in known]


def find(text: str) -> Elsewhere | None:
    """The engine that is meant by a name, in any spelling; ``None`` where none is."""
    called = {word: engine for engine in ENGINES for word in (engine.name, *engine.also_called)}
    plain = "".join(letter for letter in text.lower() if letter.isalnum())
    near = difflib.get_close_matches(plain, called, n=1, cutoff=0.85)
    return called[near[0]] if near else None
