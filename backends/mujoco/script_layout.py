"""MJCF in few lines: without MuJoCo's own defaults, and short elements beside each other."""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from simcompare.engine.scripting.text import WIDTH, number
from simcompare.errors import Unsupported

#: attributes that are left out where they have MuJoCo's own default
_DEFAULTS = {
    "pos": "0 0 0", "quat": "1 0 0 0", "stiffness": "0", "springref": "0", "damping": "0",
    "frictionloss": "0", "armature": "0", "autolimits": "true", "zaxis": "0 0 1",
    "gainprm": "1",
}  # fmt: skip
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")


def laid_out(engine: Any, first: str, last: str) -> list[str]:
    """A model's text in lines, whose numbers follow the phase where they differ.

    Args:
        engine: the module mujoco.
        first: the text at phase 0.
        last: at phase 1.

    Raises:
        Unsupported: the two have other parts.
    """
    kept = True
    roots = [_tidied(text) for text in (first, last)]
    for root, text in zip(roots, (first, last), strict=True):
        kept &= _same(engine, ET.tostring(root, encoding="unicode"), text)
    if not kept:  # something was no default after all
        roots = [ET.fromstring(text) for text in (first, last)]
    root = _merged(*roots)
    return _lines(root, "")


def _same(engine: Any, one: str, other: str) -> bool:
    """Whether two texts become the same model, bit for bit."""
    return np.array_equal(_compiled(engine, one), _compiled(engine, other))


def _compiled(engine: Any, text: str) -> NDArray[np.uint8]:
    model = engine.MjModel.from_xml_string(text)
    held = np.zeros(engine.mj_sizeModel(model), dtype=np.uint8)
    engine.mj_saveModel(model, None, held)
    return held


def _tidied(text: str) -> ET.Element:
    root = ET.fromstring(text)
    for child in list(root):
        if child.tag in ("contact", "actuator", "sensor") and not len(child):
            root.remove(child)
    for element in root.iter():
        for key, value in list(element.attrib.items()):
            short = _NUMBER.sub(lambda m: _short(m.group()), value) if _numeric(value) else value
            element.set(key, short)
            if _DEFAULTS.get(key) == short and element.tag != "inertial":
                del element.attrib[key]
    return root


def _numeric(value: str) -> bool:
    return all(_NUMBER.fullmatch(word) for word in value.split())


def _short(text: str) -> str:
    return number(float(text)) if re.search(r"[.eE]", text) else text


def _merged(first: ET.Element, last: ET.Element) -> ET.Element:
    if [one.tag for one in first.iter()] != [one.tag for one in last.iter()]:
        raise Unsupported("the scene has other parts at the other end of the phase")
    for one, other in zip(first.iter(), last.iter(), strict=True):
        if one.attrib.keys() != other.attrib.keys():
            raise Unsupported("the scene has other parts at the other end of the phase")
        for key, value in one.attrib.items():
            one.set(key, _following(value, other.attrib[key]))
    return first


def _following(first: str, last: str) -> str:
    """A value whose numbers follow the phase where they differ."""
    others = iter(_NUMBER.findall(last))

    def replace(match: re.Match[str]) -> str:
        a, b = match.group(), next(others)
        if a == b:
            return a
        return f"{{{a} + phase * {number(float(b) - float(a))}!r}}"

    return first if first == last else _NUMBER.sub(replace, first)


def _lines(element: ET.Element, indent: str) -> list[str]:
    """An element in lines; what fits is on one, and small neighbours share theirs."""
    whole = _in_one(element)
    if len(indent + whole) <= WIDTH and (len(element) < 2 or element.tag == "body"):
        return [indent + whole]
    head = _tag(element)
    if not len(element):
        return _broken(head, indent)
    lines, row = _broken(head, indent), ""
    for child in element:
        text = _in_one(child)
        if child.tag != "body" and len(f"{indent}  {row} {text}") <= WIDTH and row:
            row += f" {text}"
            continue
        lines += [f"{indent}  {row}"] if row else []
        row = ""
        if child.tag == "body" or len(f"{indent}  {text}") > WIDTH:
            lines += _lines(child, f"{indent}  ")
        else:
            row = text
    lines += [f"{indent}  {row}"] if row else []
    return [*lines, f"{indent}</{element.tag}>"]


def _in_one(element: ET.Element) -> str:
    if not len(element):
        return _tag(element)
    return f"{_tag(element)}{''.join(_in_one(one) for one in element)}</{element.tag}>"


def _tag(element: ET.Element) -> str:
    attributes = "".join(f' {key}="{value}"' for key, value in element.attrib.items())
    return f"<{element.tag}{attributes}{'' if len(element) else '/'}>"


def _broken(tag: str, indent: str) -> list[str]:
    """A tag in as many lines as it needs, broken between attributes."""
    lines, row = [], indent
    for part in re.split(r" (?=\w+=)", tag):
        if len(row) + len(part) + 1 > WIDTH:
            lines.append(row)
            row = f"{indent}    {part}"
        else:
            row += part if row == indent else f" {part}"
    return [*lines, row]
