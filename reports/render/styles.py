"""How sources look in figures; none is told by its colour alone."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

from simcompare.engine import engines
from simcompare.model.trajectory import AT

# Okabe and Ito: told apart by colour-blind readers; yellow is left out, it vanishes on white, and
# Tol's wine stands in its place
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#882255")
_DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
_MARKERS = ("circle", "square", "diamond", "triangle-up", "triangle-down", "x", "star")
#: shades of an engine's colour for its variants: how bright the grey is, and its part
_SHADES = ((0, 0.65), (0, 0.35), (255, 0.4))
PATTERNS = len(_DASHES) * len(_MARKERS)


@dataclass(frozen=True)
class Style:
    """How one source looks in every figure; it is never told by its colour alone.

    Attributes:
        colour: as ``#rrggbb``.
        dash: solid, dash, dot, dashdot, longdash or longdashdot.
        marker: circle, square, diamond, triangle-up, triangle-down, triangle-left,
            triangle-right, x or star.
        width: width of lines [px].
        hollow: whether markers are outlines.
    """

    colour: str
    dash: str = "solid"
    marker: str = "circle"
    width: float = 2.5
    hollow: bool = False


TRUTH_STYLE = Style("#BDBDBD", width=8.0)
MEASURED_STYLE = Style("#000000", marker="circle")


@functools.cache
def style_of(source: str) -> Style:
    """The look of an engine, the same in every report; see ``looks`` where it has several sources.

    One of several steps has its colour with another dash and marker, a variant of it a shade of
    it besides.
    """
    name = source.partition(AT)[0]
    engine, variant = engines.split(name)
    plain = _style_of(engine)
    if source == engine:
        return plain
    known = list(engines.quick_variants(engine))
    ahead = 1 + (known.index(variant) if variant in known else 0)
    varied = with_pattern(plain, _MARKERS.index(plain.marker) + ahead)
    if not variant:
        return varied
    return replace(varied, colour=_shade(varied.colour, *_SHADES[ahead % len(_SHADES)]))


def _shade(colour: str, grey: int, part: float) -> str:
    """A colour with so much of it replaced by a grey."""
    channels = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return "#" + "".join(f"{round((1 - part) * one + part * grey):02X}" for one in channels)


def numbered_style(number: int) -> Style:
    """The look of one of several lines that are no sources."""
    return Style(_COLOURS[number % len(_COLOURS)], _DASHES[number % len(_DASHES)])


def with_pattern(style: Style, number: int) -> Style:
    """A style with one of 42 pairs of dash and marker."""
    turn, place = divmod(number % PATTERNS, len(_MARKERS))
    return replace(style, dash=_DASHES[(turn + place) % len(_DASHES)], marker=_MARKERS[place])


def _style_of(engine: str) -> Style:
    known = engines.names()
    # an engine of somebody else's that is no longer installed still gets a look of its own
    number = known.index(engine) if engine in known else len(known) + sum(map(ord, engine))
    # only the first one is solid: a solid line over dashed ones would hide them
    turn = 2 * (number // len(_DASHES))
    return Style(
        _COLOURS[number % len(_COLOURS)],
        _DASHES[(number + turn) % len(_DASHES)],
        _MARKERS[number % len(_MARKERS)],
    )
