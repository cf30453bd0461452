"""From a unit as a log writes it to a unit that pint reads, by the table alone."""

from __future__ import annotations

import functools
import re
import unicodedata
from dataclasses import dataclass

from simcompare.units import table

_LONGEST = 40
#: characters that look alike, and words for signs
_DEGREE = r"(?:deg(?:rees?)?\.?|grad|°|')\s*"
_ALIKE = (
    ("Â(?=[°µ²³·])", ""), ("[º˚]", "°"), (r"[$]|\\(?=[a-z])", ""),
    (r"\b(?:per|pro|par)\b", "/"), (r"\s+squared$", "^2"),
    (rf"{_DEGREE}(?:C|celsius)\b", "°C"), (rf"{_DEGREE}(?:F|fahrenheit)\b", "°F"),
    ("/S(?![a-z])", "/s"),
    (r"%\s*(?:r\.?\s?[hf]\.?)", "%rh"), ("mm Hg", "mmHg"),
)  # fmt: skip
_PREFIXED = re.compile(
    "(nano|micro|mikro|milli|centi|zenti|deci|dezi|hecto|hekto|kilo|mega|giga)(.{3,})", re.I
)
_ENGLISH = {"mikro": "micro", "zenti": "centi", "dezi": "deci", "hekto": "hecto"}
#: a metre and a second written as one word, as in ms⁻¹; the power is that of the second alone
_GLUED = re.compile(
    r"(?P<per>rads?|degs?|°|revs?|turns?|km|cm|mm|m|N)(?P<below>[sm])(?:\^|\*\*)?"
    r"[{(]?[-−](?P<power>[12])[})]?"
)
_TOKEN = re.compile(
    r"(?P<word>[A-Za-zèμΩ°%‰″]+(?:_[0n]|(?<=g)0)?)"
    r"(?:(?:\*\*|\^)?[{(]?(?P<power>[-−+]?\d)[})]?(?![\w.]))?"
    r"|(?P<sign>\*(?!\*)|[/∕⁄·⋅∙•×.()-])|(?P<one>1)(?=\s*[/∕⁄])"
)


@dataclass(frozen=True)
class Unit:
    """A unit that is known.

    Attributes:
        expression: as pint reads it; empty for a plain number.
        is_angle: whether an angle is in it, which pint takes for a plain number.
        is_energy: whether it is an energy, which pint takes for a torque.
    """

    expression: str
    is_angle: bool = False
    is_energy: bool = False


def plain(text: str) -> str:
    """A text without what only looks different: ``º/s`` becomes ``°/s``, ``m·s⁻²`` ``m·s−2``."""
    for pattern, instead in _ALIKE:
        text = re.sub(pattern, instead, text, flags=re.IGNORECASE)
    text = " ".join(unicodedata.normalize("NFKC", text).split()).rstrip(".")
    return table.SAME.get(text) or _apart(text)


def _apart(text: str) -> str:
    """``cms⁻¹`` as ``cm/s``; ``ms⁻¹``, which may be a metre a second, in one way of writing."""
    match = _GLUED.fullmatch(text)
    if match is None or (match["per"] == "N") != (match["below"] == "m"):
        return text
    power = "" if match["power"] == "1" else "^2"
    per_millisecond = match["per"] == "m" and not power
    return "ms^-1" if per_millisecond else f"{match['per']}/{match['below']}{power}"


def ways(text: str) -> tuple[str, ...]:
    """How each meaning of a spelling is written without doubt; itself where it has one."""
    text = plain(text)
    return table.AMBIGUOUS.get(text, (text,))


def any_case(text: str) -> tuple[str, ...]:
    """Every unit that a word may be, whatever the size of its letters, each once."""
    found: dict[Unit | None, str] = {}
    for known in (text, *_names(), *table.AMBIGUOUS):
        if known.lower() == text.lower():
            for way in ways(known):
                found.setdefault(read(way), way)
    return tuple(way for unit, way in found.items() if unit is not None)


@functools.lru_cache(maxsize=4096)
def read(text: str) -> Unit | None:
    """The unit that a spelling is, ``None`` where it is none, or one of several."""
    text = plain(text)
    if text in table.PLAIN:
        return Unit("")
    if len(text) > _LONGEST or text in (*table.AMBIGUOUS, *table.ONLY_IN_PRODUCTS):
        return None
    whole = _atom(text)
    parts = [(whole, 1)] if whole else _parts(text)
    return _unit(parts) if parts else None


def _atom(text: str) -> str | None:
    """Unit of pint of one word."""
    names = _names()
    small = (text[:1] + text[1:].lower(), text.lower())  # the first letter may be a prefix: MOhm
    for word in (text, *(small if len(text) > 2 else ())):
        if word in names:
            return names[word]
    match = _PREFIXED.fullmatch(text)
    base = names.get(match[2].lower()) if match else None
    if match and base and "(" not in base:
        return _ENGLISH.get(match[1].lower(), match[1].lower()) + base
    return None


@functools.cache
def _names() -> dict[str, str]:
    """Every word and every symbol with its prefixes."""
    exact: dict[str, str] = {}
    for symbol, (name, prefixes) in table.SYMBOLS.items():
        exact[symbol] = name
        exact |= {f"{p}{symbol}": _scaled(table.PREFIXES[p], name) for p in prefixes}
    exact |= {word: name for name, words in table.WORDS.items() for word in words.split()}
    return exact


def _scaled(prefix: str, name: str) -> str:
    return f"({prefix}{name[1:]}" if name.startswith("(") else f"{prefix}{name}"


def _parts(text: str) -> list[tuple[str, int]]:
    """Atoms of a product with their powers, none where it can be read in two ways."""
    parts: list[tuple[str, int]] = []
    at, below, outer, divided = 0, False, False, False
    while at < len(text) and text.count("(") == text.count(")"):
        if text[at] == " ":
            at += 1
            continue
        match = _TOKEN.match(text, at)
        if match is None:
            return []
        at = match.end()
        sign = match["sign"]
        if sign == "(":
            outer, below, divided = below, False, False
        elif sign == ")":
            outer, divided = False, True
        elif sign in ("/", "∕", "⁄"):
            below, divided = True, True
        elif match["word"]:
            name, power = _atom(match["word"]), int((match["power"] or "1").replace("−", "-"))
            if name is None or not power or (divided and (not below or power < 0)):
                return []  # what stands behind J/kg K is above or below the line
            if power != 1 and _is_two(match["word"], name):
                return []
            parts.append((name, -power if below != outer else power))
            below = False
    return parts


def _is_two(word: str, name: str) -> bool:
    """Whether a power may belong to the last letter alone: ``Nm2``, ``ms-1``, ``rads-1``."""
    return "*" in name or "/" in name or (word[-1] == "s" and _atom(word[:-1]) is not None)


def _unit(parts: list[tuple[str, int]]) -> Unit:
    if parts == [("minute", -1)]:  # a speed of rotation, on every motor
        parts = [("turn", 1), ("minute", -1)]
    parts = _weighed(parts)
    if parts != [(parts[0][0], 1)]:
        parts = [(table.TEMPERATURES.get(name, name), power) for name, power in parts]
    names = [name for name, _ in parts]
    return Unit(
        "*".join(name if power == 1 else f"{name}**{power}" for name, power in parts),
        any(angle in name for name in names for angle in table.ANGLES if "degree_" not in name),
        any(energy in name for name in names for energy in table.ENERGIES),
    )  # fmt: skip


def _weighed(parts: list[tuple[str, int]]) -> list[tuple[str, int]]:
    """``kg·cm`` and ``lb/in²`` are made with weights: no quantity is a mass times a length."""
    powers = dict(parts)
    masses = [name for name in powers if name in table.WEIGHTS and powers[name] == 1]
    lengths = [name for name in powers if name in table.LENGTHS]
    if len(parts) != 2 or not masses or not lengths:
        return parts
    if powers[lengths[0]] == 1 or (powers[lengths[0]] == -2 and lengths[0] != "meter"):
        return [(table.WEIGHTS.get(name, name), power) for name, power in parts]
    return parts
