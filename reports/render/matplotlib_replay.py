"""A replay on paper and as a film, drawn by matplotlib."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.reports.render import matplotlib_
from simcompare.reports.render.meshes import Mesh
from simcompare.reports.render.replays import Actor, Replay

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

#: width and height of a picture, and of a film [inch]
SIZE, FILM_SIZE = (7.2, 4.0), (8.0, 4.5)
#: pictures of one source in a still: the last is full, those before are shades
_INSTANTS, _SHADE = 9, 0.16
_FLOOR, _LIGHT = "#E4E4E4", np.array((0.35, -0.5, 0.8))
#: dots of a film in an inch, and its pictures in a second
_FILM_DPI, FILM_HZ = 120, 25.0


def still(replay: Replay, level: str) -> Canvas:
    """Several instants in one picture, the last one full."""
    page = matplotlib_.blank(SIZE)
    axes = _axes(page, replay, replay.shown(level))
    places = np.unique(np.linspace(0, len(replay.time_s) - 1, _INSTANTS).round().astype(int))
    _surfaces(axes, replay, replay.shown(level), places.tolist())
    return page


def film(
    replay: Replay,
    level: str,
    path: Path,
    writer: Any,  # noqa: ANN401  (one of matplotlib's)
    progress: Callable[[float], None],
) -> None:
    """Writes all of a replay as moving pictures, in real time.

    Args:
        replay: the scene.
        level: words of the contact level that is shown.
        path: file to write.
        writer: of matplotlib, for the format.
        progress: is told the part that is done.
    """
    page, actors = matplotlib_.blank(FILM_SIZE), replay.shown(level)
    axes = _axes(page, replay, actors)
    span = float(replay.time_s[-1] - replay.time_s[0])
    count = max(2, round(span * FILM_HZ) + 1)
    with writer.saving(page, str(path), dpi=_FILM_DPI):
        for k, place in enumerate(np.linspace(0, len(replay.time_s) - 1, count).round()):
            drawn = _surfaces(axes, replay, actors, [int(place)])
            axes.set_title(f"{replay.time_s[int(place)]:.2f} s", loc="right")
            writer.grab_frame()
            for one in drawn:
                one.remove()
            progress((k + 1) / count)


def _shifts(replay: Replay, count: int) -> list[float]:
    middle = (count - 1) / 2
    return [(k - middle) * replay.width_m if replay.is_flat else 0.0 for k in range(count)]


def _axes(page: Canvas, replay: Replay, actors: Sequence[Actor]) -> Any:  # noqa: ANN401
    """Axes on which a metre is as long along each, and the names of who is seen."""
    from matplotlib.patches import Patch

    axes: Any = page.add_subplot(projection="3d", computed_zorder=False)
    low, high = replay.low_m.copy(), replay.high_m.copy()
    wider = max(_shifts(replay, len(actors)))
    low[replay.across] -= wider
    high[replay.across] += wider
    for axis, begin, end in zip("xyz", low, high, strict=True):
        getattr(axes, f"set_{axis}lim")(begin, end)
        getattr(axes, f"set_{axis}label")(f"{axis} (m)")
        axes.locator_params(axis=axis, nbins=4)
    axes.set_box_aspect(high - low, zoom=1.1)
    axes.view_init(*_eye(replay))
    hidden = {
        *([replay.across] if replay.is_flat else []),
        *([1 - replay.across] if _faces(replay) else []),
    }
    for axis in ("xy"[number] for number in hidden):
        getattr(axes, f"set_{axis}ticks")([])
        getattr(axes, f"set_{axis}label")("")
    handles = [Patch(color=actor.colour, label=matplotlib_.plain(actor.label)) for actor in actors]
    page.legend(handles=handles, loc="outside upper center", frameon=False, ncols=6)
    return axes


def _faces(replay: Replay) -> bool:
    """Whether it is seen from the front."""
    return replay.is_flat and replay.is_upright


def _eye(replay: Replay) -> tuple[float, float]:
    """From where it is seen: height and turn [°]."""
    if _faces(replay):
        return 8, 0 if replay.across == 1 else -90
    return 25, -60


def _surfaces(
    axes: Any,  # noqa: ANN401
    replay: Replay,
    actors: Sequence[Actor],
    places: Sequence[int],
) -> list[Any]:
    """Draws what never moves and all sources at some instants, the last one full."""
    shifts = _shifts(replay, len(actors))
    drawn = [
        _surface(axes, mesh, _FLOOR, 1.0, 0)
        for mesh in (
            _ground(replay, shifts),
            *(_moved(replay.still, replay, one) for one in shifts),
        )
        if len(mesh.corners)
    ]
    for actor, shift in zip(actors, shifts, strict=True):
        for place in places:
            for name in actor.motions:
                mesh = _moved(actor.placed(name, replay.bodies[name], place), replay, shift)
                alpha = 1.0 if place == places[-1] else _SHADE
                drawn.append(_surface(axes, mesh, actor.colour, alpha, 1 + place))
    return drawn


def _ground(replay: Replay, shifts: Sequence[float]) -> Mesh:
    """Floors and walls under all lanes."""
    corners, across = replay.ground.corners.copy(), replay.across
    middle = (replay.low_m[across] + replay.high_m[across]) / 2
    corners[:, across] += np.where(corners[:, across] > middle, max(shifts), min(shifts))
    return replace(replay.ground, corners=corners)


def _moved(mesh: Mesh, replay: Replay, shift: float) -> Mesh:
    return replace(mesh, corners=mesh.corners + shift * np.eye(3)[replay.across])


def _surface(axes: Any, mesh: Mesh, colour: str, alpha: float, rank: int) -> Any:  # noqa: ANN401
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    faces = mesh.corners[mesh.triangles]
    light = np.clip(_normals(faces) @ (_LIGHT / np.linalg.norm(_LIGHT)), 0.0, 1.0)
    tone = (0.6 + 0.45 * light) * mesh.tones[mesh.triangles[:, 0]]
    colours = np.clip(np.outer(tone, to_rgb(colour)), 0.0, 1.0)
    solid = np.column_stack([colours, np.full(len(faces), alpha)])
    surface = Poly3DCollection(faces, facecolors=solid, linewidths=0, zorder=rank)
    return axes.add_collection3d(surface)


def _normals(faces: Array) -> Array:
    sides = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    length = np.linalg.norm(sides, axis=1, keepdims=True)
    return np.asarray(sides / np.where(length > 0, length, 1.0))


def rendered(replay: Replay, level: str, format: str = "png") -> bytes:
    """A still as the content of a picture file."""
    stream = io.BytesIO()
    still(replay, level).savefig(stream, format=format, dpi=matplotlib_.DPI / 2)
    return stream.getvalue()
