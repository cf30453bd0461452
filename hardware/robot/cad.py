"""Solids as files of CAD: STEP for drawing on, STL for printing; build123d does the work.

Both formats are in millimetres here, as is usual for them.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from simcompare.errors import InputError
from simcompare.hardware.robot.solids import Solid
from simcompare.model import whole

#: stands in each file
MADE_BY = b"simcompare"
#: bytes at the beginning of an STL that are free
_STL_HEAD = 80
_CURE = "pip install 'simcompare[cad]'"
_MM = 1000.0
#: how far a printed surface may be from a round one [mm], and how far facets may turn [rad]
_CHORD_MM, _TURN = 0.01, 0.05


class CadMissing(InputError):
    """The library that writes STEP and STL is not installed."""

    def __init__(self) -> None:
        super().__init__("STEP and STL", [f"build123d is not installed; cure: {_CURE}"])


def step(bodies: Mapping[str, Iterable[Solid]], title: str) -> bytes:
    """A STEP file with one solid for each body, under its name.

    Args:
        bodies: name -> its solids, which touch, less its holes.
        title: of the whole.

    Raises:
        CadMissing: build123d is not installed.
    """
    cad = _library()
    parts = [_labelled(_shape(cad, solids), name) for name, solids in bodies.items()]
    whole_ = parts[0] if len(parts) == 1 else cad.Compound(label=title, children=parts)
    # no time stamp, so that the same robot is the same file
    made = _written("robot.step", lambda path: cad.export_step(whole_, path, timestamp=""))
    return made.replace(b"Open CASCADE Model", MADE_BY, 1)


def stl(solids: Iterable[Solid]) -> bytes:
    """One body as triangles.

    Raises:
        CadMissing: build123d is not installed.
    """
    cad = _library()
    shape = _shape(cad, solids)
    made = _written(
        "robot.stl",
        lambda path: cad.export_stl(shape, path, tolerance=_CHORD_MM, angular_tolerance=_TURN),
    )
    return MADE_BY.ljust(_STL_HEAD, b"\0") + made[_STL_HEAD:]


def _library() -> Any:  # noqa: ANN401
    try:
        import build123d
    except ModuleNotFoundError:
        raise CadMissing from None
    return build123d


def _shape(cad: Any, solids: Iterable[Solid]) -> Any:  # noqa: ANN401
    """One shape of solids that touch, less their holes."""
    solids = list(solids)
    made = [_primitive(cad, one) for one in solids if not one.is_hole]
    holes = [_primitive(cad, one) for one in solids if one.is_hole]
    return functools.reduce(operator.sub, holes, functools.reduce(operator.add, made))


def _primitive(cad: Any, solid: Solid) -> Any:  # noqa: ANN401
    at = cad.Pos(*(_MM * x for x in solid.position_m))
    if solid.kind == "box":
        return at * cad.Box(*(_MM * x for x in solid.size_m))
    turned = {"x": (0, 90, 0), "y": (90, 0, 0), "z": (0, 0, 0)}[solid.kind]
    length = solid.size_m["xyz".index(solid.kind)]
    return at * cad.Rot(*turned) * cad.Cylinder(_MM * solid.radius_m, _MM * length)


def _labelled(shape: Any, name: str) -> Any:  # noqa: ANN401
    shape.label = name
    return shape


def _written(name: str, write: Callable[[Path], object]) -> bytes:
    with whole.temporary("simcompare-cad-") as folder:
        write(folder / name)
        return (folder / name).read_bytes()
