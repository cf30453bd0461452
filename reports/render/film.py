"""A replay as a film, drawn by matplotlib: GIF by Pillow, which matplotlib needs, MP4 by ffmpeg."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from simcompare.errors import InputError
from simcompare.reports.render import matplotlib_, matplotlib_replay, output
from simcompare.reports.render.replays import Replay

if TYPE_CHECKING:
    from matplotlib.animation import AbstractMovieWriter

FORMATS = ("gif", "mp4")
#: width and height [inch], dots in an inch, pictures in a second and at most: 20 s, 1 or 2 MB
_SIZE, _DPI, _RATE_HZ, _MOST = (8.0, 4.5), 100, 25, 500
#: in the extra [film]; brings an ffmpeg of its own
_CURE = "install ffmpeg, or: pip install 'simcompare[film]'; --format gif needs neither"

#: is told how many pictures are done, of how many
Told = Callable[[int, int], None]


def write(replay: Replay, level: str, path: Path, format: str, told: Told) -> Path:
    """Writes all of a replay as a film, in real time; a long one runs faster.

    Args:
        replay: the scene.
        level: words of the contact level that is shown.
        path: file to write.
        format: "gif" or "mp4".
        told: progress.

    Raises:
        InputError: no ffmpeg for mp4.
        OutputError: it cannot be written.
    """
    import matplotlib as mpl

    program = _ffmpeg() if format == "mp4" else ""
    with tempfile.TemporaryDirectory() as folder, mpl.rc_context():
        if program:
            mpl.rcParams["animation.ffmpeg_path"] = program
        made = Path(folder) / f"film.{format}"
        _draw(replay, level, _writer(format), made, told)
        return output.write(path, made.read_bytes(), output.MARKS[format])


def _ffmpeg() -> str:
    """The program that writes MP4: that of the machine, else that of a package."""
    found = shutil.which("ffmpeg")
    if found:
        return found
    try:
        import imageio_ffmpeg
    except ImportError:
        raise InputError("--format mp4", [f"no ffmpeg is installed; cure: {_CURE}"]) from None
    return str(imageio_ffmpeg.get_ffmpeg_exe())


def _writer(format: str) -> AbstractMovieWriter:
    from matplotlib.animation import FFMpegWriter, PillowWriter

    class Gif(PillowWriter):
        """Says in the file who made it."""

        def finish(self) -> None:
            frames = cast("Any", self)._frames
            frames[0].info["comment"] = output.MARKS["gif"]
            super().finish()

    if format == "gif":
        return Gif(fps=_RATE_HZ)
    said = {"comment": output.MADE_BY}
    # so that a page can begin to play before it has all
    return FFMpegWriter(fps=_RATE_HZ, metadata=said, extra_args=["-movflags", "+faststart"])


def instants(replay: Replay) -> tuple[list[int], float]:
    """Which pictures of a replay a film holds, and how many times faster than in truth it runs."""
    span_s = float(replay.time_s[-1] - replay.time_s[0])
    count = round(span_s * _RATE_HZ) + 1
    shown = int(np.clip(count, 2, _MOST))
    places = np.linspace(0, len(replay.time_s) - 1, shown).round().astype(int)
    return places.tolist(), max(1.0, count / shown)


def _draw(replay: Replay, level: str, writer: Any, path: Path, told: Told) -> None:  # noqa: ANN401
    page = matplotlib_.blank(_SIZE)
    stage = matplotlib_replay.Stage(page, replay, level)
    places, faster = instants(replay)
    speed = f", {faster:.3g} times as fast" if faster > 1.005 else ""
    with writer.saving(page, str(path), dpi=_DPI):
        for k, place in enumerate(places, start=1):
            stage.show([place])
            stage.say(f"{replay.time_s[place]:.2f} s{speed}")
            writer.grab_frame()
            told(k, len(places))
