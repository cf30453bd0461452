"""Products of inertia in a digital twin; scenarios hold moments along the axes alone."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from xml.etree import ElementTree as ET

from simcompare.exporters.parts import Twin, number, numbers
from simcompare.model.shapes import Vector


def with_products(twin: Twin, products_kg_m2: Mapping[str, Vector]) -> Twin:
    """The same twin with products of inertia of some of its bodies.

    Args:
        twin: as the scenario is written.
        products_kg_m2: body -> I_xy, I_xz and I_yz about its centre of mass, along its axes.
    """
    root = ET.fromstring(twin.text, ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    kind = "body" if twin.format == "mjcf" else "link"
    for name, values in products_kg_m2.items():
        for inertial in root.findall(f".//{kind}[@name='{name}']/inertial"):
            _SETTERS[twin.format](inertial, values)
    head = twin.text[: twin.text.index("\n") + 1]
    return dataclasses.replace(twin, text=f"{head}{ET.tostring(root, encoding='unicode')}\n")


def _in_urdf(inertial: ET.Element, values: Vector) -> None:
    for inertia in inertial.iter("inertia"):
        for axes, value in zip(("ixy", "ixz", "iyz"), values, strict=True):
            inertia.set(axes, number(value))


def _in_sdf(inertial: ET.Element, values: Vector) -> None:
    for axes, value in zip(("ixy", "ixz", "iyz"), values, strict=True):
        for element in inertial.iter(axes):
            element.text = number(value)


def _in_mjcf(inertial: ET.Element, values: Vector) -> None:
    moments = inertial.attrib.pop("diaginertia")
    inertial.set("fullinertia", f"{moments} {numbers(values)}")


_SETTERS = {"urdf": _in_urdf, "sdf": _in_sdf, "mjcf": _in_mjcf}
