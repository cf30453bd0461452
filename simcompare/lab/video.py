"""Films of a ball: followed in a process of its own, then measured by a length that is clicked."""

from __future__ import annotations

import importlib.util
import json
import math
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware import confined
from simcompare.lab import recordings, tracking
from simcompare.lab.contents import TABLE, VIDEO
from simcompare.lab.numbers import listed, shortened
from simcompare.lab.tracking import Film
from simcompare.model import plain, whole
from simcompare.model.plain import Plain

#: what is kept beside a film: the track in pixels, and in metres
TRACK, METRES = "track.json", "track.csv"
#: what the process may take; OpenCV's readers of films have many threads with their own memory
_LIMITS = confined.Limits(memory_bytes=3 << 30, file_bytes=64 << 20, seconds=90.0)
#: lengths that can be clicked [m], and how far apart the two points must be [px]
_SHORTEST_M, _LONGEST_M, _APART_PX = 0.001, 100.0, 10.0
_CURE = "pip install 'simcompare[web]'"


def received(path: Path) -> Plain:
    """What moves in a film.

    Returns:
        The track in pixels of the film, and its first picture to click a length in.

    Raises:
        InputError: it is no film, too short, without a moving ball, or with two of them.
    """
    if importlib.util.find_spec("cv2") is None:
        raise InputError(path.name, [f"OpenCV, which reads films, is not installed: {_CURE}"])
    film = _followed(path)
    whole.write(path.with_name(TRACK), plain.text(film).encode())
    notes = ["Click two points whose distance you know, beside where the ball fell."]
    if film.is_cut:
        notes.append(f"Only the first {film.count} pictures were looked at.")
    return {
        "kind": VIDEO, "width": film.width, "height": film.height, "pictures": film.count,
        "frame": f"data:image/jpeg;base64,{film.picture}", "notes": notes, "impacts": [],
        "track": {
            "t": listed(np.array(film.time_s)), "x": listed(np.array(film.x)),
            "y": listed(np.array(film.y)), "radius": shortened(float(np.median(film.radius))),
        },
    }  # fmt: skip


def scaled(place: Path, points: Any, metres: float) -> Plain:  # noqa: ANN401
    """The drop in a film, with a length that was clicked.

    Args:
        place: folder of the recording.
        points: two points of the film, each (x, y) [px].
        metres: how far apart they are [m].

    Raises:
        InputError: they are no two points, or no such length.
    """
    film = _stored(place)
    metre_px = _scale(film, points, metres)
    ground_px = max(film.y)
    rows = [
        f"{time_s!r},{(ground_px - y) * metre_px!r}"
        for time_s, y in zip(film.time_s, film.y, strict=True)
    ]
    file = place / METRES
    whole.write(file, "\n".join(["time (s),height (m)", *rows, ""]).encode())
    found = recordings.received(file, TABLE)
    heights = (ground_px - np.array(film.y)) * metre_px
    return {
        **found, "kind": VIDEO, "width": film.width, "height": film.height, "metres": metres,
        "points": points, "curve": {"t": listed(np.array(film.time_s)), "y": listed(heights)},
    }  # fmt: skip


def _scale(film: Film, points: Any, metres: float) -> float:  # noqa: ANN401
    """Metres of a pixel."""
    try:
        (x, y), (other_x, other_y) = [(float(a), float(b)) for a, b in points]
    except (TypeError, ValueError):
        raise InputError("points", ["expected two points of the picture"]) from None
    apart = math.hypot(other_x - x, other_y - y)
    largest = 2 * (film.width + film.height)
    if not all(abs(one) <= largest for one in (x, y, other_x, other_y)) or not apart >= _APART_PX:
        fault = f"are {apart:.3g} pixels apart; click two points that are far from each other"
        raise InputError("points", [fault])
    if not _SHORTEST_M <= metres <= _LONGEST_M:
        raise InputError("metres", [f"{metres:g} m is not within {_SHORTEST_M:g} … {_LONGEST_M:g}"])
    return metres / apart


def _stored(place: Path) -> Film:
    try:
        return plain.of_plain(Film, json.loads((place / TRACK).read_text(encoding="utf-8")))
    except (OSError, ValueError):
        raise InputError("recording", ["is no film in which a ball was followed"]) from None


def _followed(path: Path) -> Film:
    with TemporaryDirectory(prefix="simcompare-", ignore_cleanup_errors=True) as folder:
        request = {"path": str(path.resolve()), "name": path.name}
        (Path(folder) / confined.REQUEST).write_text(json.dumps(request), encoding="utf-8")
        ending = confined.run(tracking.serve, f"{tracking.__name__}:serve", Path(folder), _LIMITS)
        answer = Path(folder) / confined.ANSWER
        if not answer.exists():
            raise InputError(path.name, [_why_not(ending)])
        content = json.loads(answer.read_text(encoding="utf-8"))
    if "faults" in content:
        raise InputError(path.name, content["faults"])
    return plain.of_plain(Film, content)


def _why_not(ending: confined.Ending) -> str:
    if ending.is_late:
        return f"took more than {_LIMITS.seconds:g} s; cut out the part with the bounces"
    return f"ended its reader ({ending.said or f'signal {ending.signal}'}); film it anew as MP4"
