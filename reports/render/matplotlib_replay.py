"""A replay on paper, drawn by matplotlib."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.reports.render import matplotlib_
from simcompare.reports.render.meshes import Mesh, joined
from simcompare.reports.render.output import MADE_BY
from simcompare.reports.render.replays import Actor, Replay

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

#: width and height of a still [inch], and its dots in an inch of a screen
SIZE, DPI = (7.2, 4.0), 110
#: pictures of one source in a still: the last is full, those before are shades
_INSTANTS, _SHADE = 9, 0.16
#: width over height of a scene below which numbers would stand on its edge
_THIN = 0.3
_FLOOR, _LIGHT = "#E4E4E4", np.array((0.35, -0.5, 0.8))


def still(replay: Replay, level: str) -> Canvas:
    """Several instants in one picture, the last one full."""
    page = matplotlib_.blank(SIZE)
    places = np.unique(np.linspace(0, len(replay.time_s) - 1, _INSTANTS).round().astype(int))
    Stage(page, replay, level).show(places.tolist())
    return page


def rendered(replay: Replay, level: str, dpi: int = DPI) -> bytes:
    """A still as the content of a PNG file."""
    return png(still(replay, level), dpi)


def png(page: Canvas, dpi: int = DPI) -> bytes:
    """A picture as the content of a PNG file."""
    stream = io.BytesIO()
    page.savefig(stream, format="png", dpi=dpi, metadata={"Software": MADE_BY})
    return stream.getvalue()


class Stage:
    """Axes with what never moves, on which bodies are shown.

    Args:
        page: to draw on; has nothing else.
        replay: the scene.
        level: words of the contact level that is shown.
    """

    def __init__(self, page: Canvas, replay: Replay, level: str) -> None:
        self._replay, self._actors = replay, replay.shown(level)
        self._shifts = _shifts(replay, len(self._actors))
        self._axes = _axes(page, replay, self._actors)
        self._drawn: list[Any] = []
        for mesh in (_ground(replay, self._shifts), *map(self._solid, self._shifts)):
            _surface(self._axes, mesh, _FLOOR, 1.0, 0)

    def show(self, places: Sequence[int]) -> None:
        """Shows all sources at some instants, the last one full, and nothing of before."""
        for one in self._drawn:
            one.remove()
        self._drawn = []
        lanes = zip(self._actors, self._shifts, strict=True)
        # who is farther away, and how it stood before, is behind
        for actor, shift in reversed([*lanes]):
            for place in places:
                alpha = 1.0 if place == places[-1] else _SHADE
                mesh = self._bodies(actor, shift, place)
                rank = 1 + len(self._drawn)
                self._drawn.append(_surface(self._axes, mesh, actor.colour, alpha, rank))

    def say(self, text: str) -> None:
        """Writes a text at the right above the scene."""
        self._axes.set_title(text, loc="right")

    def _bodies(self, actor: Actor, shift: float, place: int) -> Mesh:
        bodies = self._replay.bodies
        found = joined(actor.placed(name, bodies[name], place) for name in actor.motions)
        return _moved(found, self._replay, shift)

    def _solid(self, shift: float) -> Mesh:
        return _moved(self._replay.still, self._replay, shift)


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
        getattr(axes, f"set_{axis}label")(f"{axis} (m)", labelpad=0 if axis == "z" else 16)
        share = (end - begin) / float(np.max(high - low))
        axes.locator_params(axis=axis, nbins=max(1, round(5 * share)))
    axes.set_box_aspect(high - low, zoom=_zoom(replay, high - low))
    axes.view_init(*_eye(replay))
    hidden = {
        *([replay.across] if replay.is_flat else []),
        *([1 - replay.across] if _faces(replay) else []),
    }
    for axis in ("xy"[number] for number in hidden):
        getattr(axes, f"set_{axis}ticks")([])
        getattr(axes, f"set_{axis}label")("")
    if _faces(replay):  # a thin scene has no room for a name beside the numbers
        axes.set_zlabel("")
        axes.zaxis.set_major_formatter("{x:g} m")
        is_thin = high[replay.across] - low[replay.across] < _THIN * (high[2] - low[2])
        axes.tick_params(axis="z", pad=26 if is_thin else 8)
    handles = [Patch(color=actor.colour, label=matplotlib_.plain(actor.label)) for actor in actors]
    if any(actor.label for actor in actors):
        page.legend(handles=handles, loc="outside upper center", frameon=False, ncols=6)
    return axes


def _faces(replay: Replay) -> bool:
    """Whether it is seen from the front."""
    return replay.is_flat and replay.is_upright


def _zoom(replay: Replay, size_m: Array) -> float:
    """How large the box about all is drawn, so that it fills the page; found by trying."""
    if not _faces(replay):
        return 1.25
    shares = size_m / np.linalg.norm(size_m)
    return float(np.clip(min(0.74 / shares[2], 1.3 / shares[replay.across]), 1.0, 2.0))


def _eye(replay: Replay) -> tuple[float, float]:
    """From where it is seen: height and turn [°]."""
    if _faces(replay):
        return 8, 0 if replay.across == 1 else -90
    return 25, -60


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
    surface.set_clip_on(False)  # the axes are a square in the middle of the page
    return axes.add_collection3d(surface)


def _normals(faces: Array) -> Array:
    sides = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    length = np.linalg.norm(sides, axis=1, keepdims=True)
    return np.asarray(sides / np.where(length > 0, length, 1.0))
