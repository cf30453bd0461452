"""Units at the rim: inside the program everything is SI and the unit is in the name.

``drop_height_m`` is a height in metres. A user may write ``drop_height=30cm``; it becomes
``drop_height_m = 0.3`` here and nowhere else.
"""

from __future__ import annotations

import difflib
import functools
import math
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from simcompare.errors import InputError
from simcompare.units import spelling, table

#: name suffix -> unit as pint reads it; the longest suffix that fits wins
UNITS_BY_SUFFIX = {
    "_m": "m",
    "_m2": "m**2",
    "_kg": "kg",
    "_s": "s",
    "_m_s": "m/s",
    "_m_s2": "m/s**2",
    "_kg_m2": "kg*m**2",
    "_kg_m3": "kg/m**3",
    "_rad": "rad",
    "_rad_s": "rad/s",
    "_N": "N",
    "_N_m": "N*m",
    "_N_s_m": "N*s/m",
    "_N_m_s_rad": "N*m*s/rad",
    "_J": "J",
    "_Hz": "Hz",
    "_V": "V",
    "_A": "A",
    "_A_s": "A*s",
    "_Ohm": "ohm",
    "_H": "H",
    "_K": "K",
    "_Pa": "Pa",
    "_W": "W",
    "_N_m_A": "N*m/A",
    "_N_m_rad": "N*m/rad",
    "_N_m_s": "N*m/s",
    "_N_s": "N/s",
    "_V_s": "V/s",
    "_V_rad": "V/rad",
    "_K_W": "K/W",
    "_J_K": "J/K",
    "_rad_s2": "rad/s**2",
    "_T": "tesla",
    "_m3": "m**3",
    "_kg_m_s": "kg*m/s",
    "_N_per_m": "N/m",
    "_K_s": "K/s",
    "_m_s3": "m/s**3",
    "_m3_s": "m**3/s",
    "_kg_m2_s": "kg*m**2/s",
}

_WANTED = "a unit such as m, s, m/s^2, deg/s, V, or 1 for a plain number"
#: units that are proposed for what is written nearly so
_USUAL = (
    "m", "mm", "cm", "km", "s", "ms", "us", "ns", "min", "h", "kg", "g_0", "mg_0", "m/s", "mm/s",
    "km/h", "m/s^2", "mm/s^2", "rad", "mrad", "deg", "rad/s", "deg/s", "deg/s^2", "rad/s^2",
    "turn/s", "turn/min", "N", "mN", "kN", "N*m", "N*mm", "N*cm", "mN*m", "Pa", "hPa", "kPa", "bar",
    "mbar", "MPa", "N/m", "V", "mV", "A", "mA", "uA", "K", "degC", "Hz", "kHz", "MHz", "T", "mT",
    "uT", "W", "mW", "kW", "J", "ohm", "percent",
)  # fmt: skip
#: part of the letters that a slip leaves in place
_ALIKE = 0.6
#: units of which a multiple is read without pint, whose import takes longer than a scenario's
_PLAIN = {"m": "m", "s": "s", "g": "kg", "N": "N", "V": "V", "A": "A", "Hz": "Hz", "W": "W",
          "Pa": "Pa", "J": "J"}  # fmt: skip
_PREFIXES = {"n": 1e-9, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "c": 1e-2, "": 1.0, "k": 1e3}
#: unit -> the SI unit, and what a value in it is multiplied by
MULTIPLES = {
    prefix + plain: (si, factor * (1e-3 if plain == "g" else 1.0))
    for plain, si in _PLAIN.items()
    for prefix, factor in _PREFIXES.items()
} | {"deg": ("rad", math.pi / 180)}

_SYMBOLS = {"**2": "²", "**3": "³", "*": "·", "ohm": "Ω", "tesla": "T"}
_QUANTITY = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
#: a number of many countries: 0,5 and 1.234,5
_COMMA = re.compile(r"^\s*([-+]?)(\d+|\d{1,3}(?:\.\d{3})+),(\d+)\s*(|[^\d\s,.].*?)\s*$")


@functools.lru_cache(maxsize=4096)
def suffix_of(name: str) -> str:
    """Unit suffix of a name, the longest that fits (``""`` for a number without unit)."""
    fitting = (suffix for suffix in UNITS_BY_SUFFIX if name.endswith(suffix))
    return max(fitting, key=len, default="")


def unit_of(name: str) -> str:
    """Unit that a name carries, as pint writes it (``"1"`` for a number without unit)."""
    return UNITS_BY_SUFFIX.get(suffix_of(name), "1")


def symbol(unit: str) -> str:
    """Unit as people write it: ``m/s**2`` becomes ``m/s²``."""
    for plain, pretty in _SYMBOLS.items():
        unit = unit.replace(plain, pretty)
    return unit


def find_name(given: str, known: Iterable[str]) -> str | None:
    """The known name that ``given`` means, with or without its unit suffix, else ``None``."""
    names = list(known)
    if given in names:
        return given
    return next((name for name in names if name.removesuffix(suffix_of(name)) == given), None)


@functools.cache
def _registry() -> Any:  # noqa: ANN401  (pint.UnitRegistry; pint is slow to import and rarely needed)
    import pint

    registry: Any = pint.UnitRegistry()
    registry.define("log_gauss = 1e-4 * tesla")  # pint's own belongs to another system of units
    return registry


def to_si(text: str | float, unit: str, where: str) -> float:
    """Reads ``"30cm"``, ``"0.3"`` or ``0.3`` as a number in the given SI unit.

    Args:
        text: number, or number with a unit; without a unit it is in ``unit`` already.
        unit: the SI unit wanted, ``"1"`` for a plain number.
        where: the argument or place named in the error.

    Returns:
        The value in ``unit``.

    Raises:
        InputError: not a number, an unknown unit, or a unit of another dimension.
    """
    pointed = with_point(text) if isinstance(text, str) else None
    if pointed is not None:
        to_si(pointed, unit, where)  # what else is wrong with it comes first
        raise InputError(where, [f"{str(text).strip()!r} has a decimal comma; write {pointed}"])
    wanted = "a number without unit" if unit == "1" else f"a number in {symbol(unit)}"
    match = _QUANTITY.match(text) if isinstance(text, str) else None
    if isinstance(text, str) and match is None:
        raise InputError(where, [f"{text!r} is not a number; expected {wanted}"])
    number, given_unit = (float(match[1]), match[2]) if match else (float(text), "")
    if not math.isfinite(number):
        raise InputError(where, [f"{text!r} is too large; expected {wanted}"])
    if not given_unit or given_unit == unit:
        return number
    return _converted(number, given_unit, unit, where)


def quantity(text: str | float, where: str) -> tuple[float, str]:
    """Reads ``"20 mN*m"`` as the value in SI and its SI unit, ``"1"`` where there is no unit.

    Raises:
        InputError: not a number, or what is no unit.
    """
    match = _QUANTITY.match(text) if isinstance(text, str) else None
    if match is None or not match[2]:
        return to_si(text, "1", where), "1"
    pointed = with_point(str(text))
    if pointed is not None:
        raise InputError(where, [f"{str(text).strip()!r} has a decimal comma; write {pointed}"])
    factor, offset, unit = si_of(match[2], where)
    return factor * float(match[1]) + offset, unit


def with_point(text: str) -> str | None:
    """``"0,5m"`` as it is written here, ``"0.5m"``; ``None`` where there is no decimal comma."""
    match = _COMMA.match(text)
    return match and f"{match[1]}{match[2].replace('.', '')}.{match[3]}{match[4]}"


def conversion_factor(given: str, unit: str, where: str) -> float:
    """Factor by which a value in unit ``given`` is multiplied to be in the SI unit ``unit``.

    Raises:
        InputError: ``given`` is unknown, of another dimension, or has an offset (°C).
    """
    if _converted(0.0, given, unit, where) != 0:
        raise InputError(where, [f"{given!r} has an offset; give the values in {symbol(unit)}"])
    return _converted(1.0, given, unit, where)


def si_of(text: str, where: str) -> tuple[float, float, str]:
    """What a unit in a log means: value in SI = factor·number + offset, and that SI unit.

    Angles stay angles: ``deg`` becomes ``rad`` and ``rpm`` ``rad/s``, but ``Hz`` stays ``Hz``.

    Args:
        text: the unit as the log writes it ("deg/s", "m/s^2", "°C", "1").
        where: the place named in the error.

    Raises:
        InputError: it is no unit, or one whose SI unit is not in ``UNITS_BY_SUFFIX``.
    """
    found = _meaning(text)
    if isinstance(found, str):
        raise InputError(where, [found])
    return found


def ways(text: str) -> tuple[str, ...]:
    """How each meaning of a spelling is written: ``g`` is ``gram`` or ``g_0``, ``V`` itself."""
    return spelling.ways(text)


def is_written(text: str) -> bool:
    """Whether a text stands for a unit in logs, be it one of several, or one of counts."""
    if len(spelling.ways(text)) > 1 or text.strip() in table.NO_UNITS:
        return True
    return not isinstance(_meaning(text), str)


@functools.lru_cache(maxsize=4096)
def _meaning(text: str) -> tuple[float, float, str] | str:
    """Factor, offset and SI unit, or what is wrong; a log may ask for thousands of columns."""
    found = spelling.read(text)
    if found is None:
        return _not_a_unit(text)
    if not found.expression:
        return 1.0, 0.0, "1"
    if text in MULTIPLES:
        si, factor = MULTIPLES[text]
        return factor, 0.0, si
    registry = _registry()
    unit = registry.Unit(found.expression)
    si_unit = _si_unit(unit, is_angle=found.is_angle, is_energy=found.is_energy)
    if si_unit is None:
        return f"{text!r} has no place here; expected {_WANTED}"
    target = "" if si_unit == "1" else si_unit
    zero, one = (float(registry.Quantity(x, unit).to(target).magnitude) for x in (0.0, 1.0))
    return one - zero, zero, si_unit


def unit_of_result(
    formula: Callable[[Mapping[str, Any]], Any], values: Mapping[str, float], of: Mapping[str, str]
) -> str:
    """SI unit of what a formula makes of quantities with units, ``"1"`` for a plain number.

    Args:
        formula: called with quantities of pint by name; may raise what pint raises.
        values: of the quantities [SI].
        of: their SI units.
    """
    registry = _registry()
    quantities = {
        name: registry.Quantity(value, "" if of[name] == "1" else of[name])
        for name, value in values.items()
    }
    unit = registry.Quantity(formula(quantities)).to_base_units().units
    if unit.dimensionality == registry.Unit("Hz").dimensionality:
        return "1/s"  # a rate of turning or of events: nothing tells which
    known = _si_unit(unit, is_angle=False, is_energy=False)
    return known or f"{unit:~C}"


def _not_a_unit(text: str) -> str:
    """What to say of a unit that is none, with the one that is written nearly so."""
    bare = text.strip()
    if bare == "?":
        return "'?' is no unit; replace the ? by the unit, or by 1 for a plain number"
    several = spelling.ways(text)
    if len(several) > 1:
        spoken = " or ".join(table.SPOKEN.get(way, way) for way in several)
        return f"{bare!r} may be {spoken}; write {' or '.join(several)}"
    none = table.NO_UNITS.get(bare.partition("/")[0])
    if none:
        return f"{bare!r} cannot be converted: {none}"
    near = nearest(bare) or _alike(bare)
    hint = f"did you mean {near}? E" if near else "e"
    return f"{text!r:.60} is not a unit; {hint}xpected {_WANTED}"


def _alike(bare: str) -> str:
    """The usual unit that a text is most like, of several the most usual; empty for none."""
    likes = [difflib.SequenceMatcher(None, unit, bare).ratio() for unit in _USUAL]
    best = max(likes)
    return _USUAL[likes.index(best)] if len(bare) > 1 and best >= _ALIKE else ""


def nearest(text: str) -> str:
    """The usual unit that differs from a text by capitals alone, empty where there is none."""
    return next((unit for unit in _USUAL if unit.lower() == text.strip().lower()), "")


def _si_unit(unit: Any, *, is_angle: bool, is_energy: bool) -> str | None:  # noqa: ANN401
    known = ["1", *UNITS_BY_SUFFIX.values()]
    fitting = [
        si for si in known
        if _registry().Unit("" if si == "1" else si).dimensionality == unit.dimensionality
    ]  # fmt: skip
    if not fitting:
        return None
    # a turn and a number, a torque and an energy, have the same dimension
    plain = [si for si in fitting if "rad" not in si]
    if is_angle:
        return next((si for si in fitting if "rad" in si), None)
    if is_energy and "J" in plain:
        return "J"
    return plain[0] if plain else None


def suffix_for(si_unit: str) -> str:
    """Suffix of a name that carries an SI unit: ``m/s**2`` gives ``_m_s2``, ``1`` nothing."""
    return next((s for s, unit in UNITS_BY_SUFFIX.items() if unit == si_unit), "")


def _converted(number: float, given: str, unit: str, where: str) -> float:
    si, factor = MULTIPLES.get(given, ("", 1.0))
    if si == unit:
        return number * factor
    expected = "a plain number, no unit" if unit == "1" else f"{symbol(unit)} or a multiple of it"
    import pint

    for way in spelling.ways(given):  # a mass of 5 g, an acceleration of 5 g
        found = spelling.read(way)
        if found is None:
            raise InputError(where, [f"{given!r} is not a unit; expected {expected}"])
        try:
            quantity = _registry().Quantity(number, found.expression)
            return float(quantity.to("" if unit == "1" else unit).magnitude)
        except pint.DimensionalityError:
            continue
    raise InputError(where, [f"the unit {given!r} does not fit; expected {expected}"])
