"""A ball in a film before a wall that does not move: where its centre is in each picture.

What differs from the wall is a blob; those that one ball can have been are followed. The centre is
weighed by how much of each pixel is covered, so that of a smeared ball is where it was in the
middle of the exposure.
"""

from __future__ import annotations

import base64
import dataclasses
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware import confined
from simcompare.lab.blobs import Blob, followed

#: pictures that are looked at, and for how long; longest side with which that is done [px]
MOST_PICTURES, MOST_S, _SIDE = 2400, 60.0, 960
#: most pixels of a picture: 8K and a little
_MOST_PIXELS = 40_000_000
#: pictures whose median is the wall
_WALL = 31
#: least difference from the wall of 255, and in scatters of the noise
_LEAST, _SIGMAS = 14.0, 6.0
#: least area of a ball as a part of the picture, and the largest [1]
_SMALLEST, _LARGEST = 1.5e-5, 0.15
#: part of the picture above which all of it moves, and scatter of noise that no camera has: the
#: camera moves
_MOVES, _SHAKEN = 0.35, 10.0
#: blobs of a picture that may be the ball, and pictures in which it must be seen
_BLOBS, _SEEN = 6, 8
#: a shadow darkens all colours alike, to no less than this part
_DARKEST, _ALIKE = 0.35, 0.10
#: a second track is a ball where it moves as far, and not with the first as its shadow does
_AS_FAR, _SHADOW = 0.4, 0.9


@dataclass(frozen=True)
class Film:
    """A film and what moves in it.

    Attributes:
        width: of its pictures [px].
        height: of them [px].
        count: pictures that were looked at.
        time_s: when the ball was seen, from the film's own times (n,) [s].
        x: of its centre, from the left (n,) [px].
        y: from the top (n,) [px].
        radius: about its own (n,) [px].
        picture: the first picture, as JPEG in base64.
        is_cut: whether the film goes on after what was looked at.
    """

    width: int
    height: int
    count: int
    time_s: list[float]
    x: list[float]
    y: list[float]
    radius: list[float]
    picture: str
    is_cut: bool


def film_of(path: str, name: str) -> Film:
    """Follows the ball in a film.

    Args:
        path: of the film.
        name: that an error names.

    Raises:
        InputError: it is no film, too short, without a moving ball, or with two of them.
    """
    import cv2

    cv2.setNumThreads(1)  # there are other groups
    pictures = _Pictures(path, name)
    wall, noise, first = _wall_of(pictures)
    if noise > _SHAKEN:
        raise InputError(name, [_SHAKY])
    times, blobs = [], []
    for time_s, picture in pictures:
        times.append(time_s)
        blobs.append(_blobs(picture, wall, noise))
    _check_still(blobs, name)
    chosen = followed(blobs)
    seen = [i for i, one in enumerate(chosen) if one is not None]
    moved = _range([chosen[i] for i in seen])
    if len(seen) < _SEEN or moved < 3 * _radius(chosen):
        raise InputError(name, [_NO_BALL])
    _refuse_second(blobs, chosen, name)
    back = pictures.shrunk
    found = [one for one in chosen if one is not None]
    xs, ys = ([(at + 0.5) * back - 0.5 for at in own] for own in
              ([one.x for one in found], [one.y for one in found]))  # fmt: skip
    return Film(
        pictures.width, pictures.height, len(times), [times[i] for i in seen],
        xs, ys,
        [math.sqrt(one.area / math.pi) * back for one in found], first, pictures.is_cut,
    )  # fmt: skip


_NO_BALL = (
    "no moving ball is seen; film one ball of a colour that stands out from a plain wall, with the"
    " camera on a table, and let it bounce in the picture"
)
_SHAKY = (
    "the whole picture changes: the camera was moved; lay or lean it somewhere, and keep the light"
    " as it is"
)
_TWO = "two balls or more move in it; film one ball alone, and step out of the picture"


class _Pictures:
    """The pictures of a film, made small enough, each with its time; they can be read again."""

    def __init__(self, path: str, name: str) -> None:
        self._path, self.name = path, name
        self.width = self.height = 0
        self.shrunk, self.is_cut = 1.0, False

    def __iter__(self) -> Iterator[tuple[float, Any]]:
        import cv2

        film = cv2.VideoCapture(self._path)
        try:
            yield from self._read(cv2, film)
        finally:
            film.release()

    def _read(self, cv2: Any, film: Any) -> Iterator[tuple[float, Any]]:  # noqa: ANN401
        self._check(cv2, film)
        before = -math.inf
        for number in range(MOST_PICTURES + 1):
            is_there, picture = film.read()
            if not is_there:
                return
            time_s = float(film.get(cv2.CAP_PROP_POS_MSEC)) / 1e3
            if number == MOST_PICTURES or time_s > MOST_S:
                self.is_cut = True
                return
            if not time_s > before:  # the container has no times, or the same twice
                continue
            before = time_s
            self.height, self.width = picture.shape[:2]
            self.shrunk = max(1.0, max(picture.shape[:2]) / _SIDE)
            if self.shrunk > 1:
                size = round(self.width / self.shrunk), round(self.height / self.shrunk)
                picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
            yield time_s, picture

    def _check(self, cv2: Any, film: Any) -> None:  # noqa: ANN401
        if not film.isOpened():
            cure = "film it anew as MP4 (H.264), or send the sound or a table of the drop"
            raise InputError(self.name, [f"cannot be read as a film; {cure}"])
        size = film.get(cv2.CAP_PROP_FRAME_WIDTH) * film.get(cv2.CAP_PROP_FRAME_HEIGHT)
        if size > _MOST_PIXELS:
            raise InputError(self.name, ["has larger pictures than 8K; film with 1080 lines"])


def _wall_of(pictures: _Pictures) -> tuple[Any, float, str]:
    """Median of pictures from all of the film, the scatter of its noise, and the first picture."""
    import cv2

    kept: list[Any] = []
    first, every, count = "", 1, 0
    for _, picture in pictures:
        if not first:
            done, packed = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 80])
            first = base64.b64encode(packed.tobytes()).decode("ascii") if done else ""
        if count % every == 0:
            kept.append(picture)
        count += 1
        if len(kept) == 2 * _WALL:
            kept, every = kept[::2], 2 * every
    if count < _SEEN:
        fault = (
            f"has {count} pictures; expected a film of a second or more, in which a ball bounces"
        )
        raise InputError(pictures.name, [fault])
    wall = np.median(np.stack(kept), axis=0).astype(np.uint8)
    smooth = cv2.GaussianBlur(wall, (3, 3), 0)
    apart = [cv2.absdiff(cv2.GaussianBlur(kept[i], (3, 3), 0), smooth) for i in (0, -1)]
    return smooth, float(1.4826 * np.median(np.stack(apart))), first


def _blobs(picture: Any, wall: Any, noise: float) -> list[Blob]:  # noqa: ANN401
    """What may be the ball, the clearest first; without shadows where anything is left then."""
    import cv2

    now = cv2.GaussianBlur(picture, (3, 3), 0)
    blue, green, red = cv2.split(cv2.absdiff(now, wall))
    apart = cv2.max(cv2.max(blue, green), red)
    mask = apart > max(_LEAST, _SIGMAS * noise)
    if np.count_nonzero(mask) > _MOVES * mask.size:
        return [Blob(0.0, 0.0, float(mask.size), 0.0)]  # all of it moves
    solid = mask.copy()
    solid[mask] = ~_is_shadow(now[mask], wall[mask])
    return _of_mask(solid, apart) or _of_mask(mask, apart)


def _is_shadow(now: Any, wall: Any) -> Any:  # noqa: ANN401
    """Which pixels are only darker than the wall, alike in all colours (n, 3)."""
    part = (now.astype(float) + 8) / (wall.astype(float) + 8)
    highest, lowest = part.max(axis=1), part.min(axis=1)
    return (highest - lowest < _ALIKE) & (highest < 1) & (lowest > _DARKEST)


def _of_mask(mask: Any, apart: Any) -> list[Blob]:  # noqa: ANN401
    """Blobs of a mask, the clearest first."""
    import cv2

    left, top, width, height = cv2.boundingRect(mask.astype(np.uint8))
    inside = (slice(top, top + height), slice(left, left + width))
    if not width:
        return []
    kernel = np.ones((5, 5), np.uint8)
    closed = cv2.morphologyEx(mask[inside].astype(np.uint8), cv2.MORPH_CLOSE, kernel)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(closed, connectivity=8)
    least, most = _SMALLEST * mask.size, _LARGEST * mask.size
    found = [
        _weighed(number, labels, stats[number], apart[inside], (left, top))
        for number in range(1, count)
        if least < stats[number, cv2.CC_STAT_AREA] < most
    ]
    return sorted(found, key=lambda one: -one.weight * math.sqrt(one.area))[:_BLOBS]


def _weighed(
    number: int,
    labels: Any,  # noqa: ANN401
    stat: Any,  # noqa: ANN401
    apart: Any,  # noqa: ANN401
    corner: tuple[int, int],
) -> Blob:
    """A blob with its centre, weighed by how much each pixel is covered."""
    left, top, width, height, area = (int(value) for value in stat)
    inside = (slice(top, top + height), slice(left, left + width))
    differs = np.where(labels[inside] == number, apart[inside], 0).astype(float)
    full = max(float(np.percentile(differs[differs > 0], 75)), 1.0)
    cover = np.minimum(differs / full, 1.0)
    whole = float(cover.sum())
    x = float((cover.sum(axis=0) * np.arange(width)).sum()) / whole + left + corner[0]
    y = float((cover.sum(axis=1) * np.arange(height)).sum()) / whole + top + corner[1]
    return Blob(x, y, float(area), min(full / 255, 1.0))


def _check_still(blobs: Sequence[Sequence[Blob]], name: str) -> None:
    """Refuses a film in which all of the picture changes."""
    moving = sum(bool(one) and one[0].weight == 0.0 for one in blobs)
    if moving > 0.3 * len(blobs):
        raise InputError(name, [_SHAKY])


def _refuse_second(
    blobs: Sequence[Sequence[Blob]], chosen: Sequence[Blob | None], name: str
) -> None:
    """Refuses a film in which something as large moves otherwise than a shadow of the ball."""
    others = [
        [one for one in own if one is not mine] for own, mine in zip(blobs, chosen, strict=True)
    ]
    second = followed(others)
    both = [
        (mine.y, other.y)
        for mine, other in zip(chosen, second, strict=True)
        if mine is not None and other is not None
        and other.weight > 0.25 * mine.weight and other.area > 0.2 * mine.area
    ]  # fmt: skip
    if len(both) < max(_SEEN, 0.3 * sum(one is not None for one in chosen)):
        return
    ours, theirs = np.array(both).T
    if np.ptp(theirs) < _AS_FAR * np.ptp(ours):
        return
    if abs(float(np.corrcoef(ours, theirs)[0, 1])) < _SHADOW:
        raise InputError(name, [_TWO])


def _range(found: Sequence[Blob | None]) -> float:
    """How far the ball goes up and down [px]."""
    heights = [one.y for one in found if one is not None]
    return max(heights) - min(heights) if heights else 0.0


def _radius(found: Sequence[Blob | None]) -> float:
    radii = [math.sqrt(one.area / math.pi) for one in found if one is not None]
    return float(np.median(radii)) if radii else 0.0


def serve(folder: Path) -> None:
    """Follows the ball, in a process of its own."""
    request = json.loads((folder / confined.REQUEST).read_text(encoding="utf-8"))
    try:
        film = film_of(request["path"], request["name"])
    except InputError as error:
        confined.answer(folder, {"faults": list(error.faults)})
        return
    confined.answer(folder, dataclasses.asdict(film))
