"""The plan of the house: imports run one way, also those inside functions and for types alone."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
OUTER = ("backends", "hardware", "reports", "scenarios")
#: rooms from the lowest to the highest; those on one line do not know each other
FLOORS = (
    ("errors",),
    ("units", "notation", "glossary", "arguments"),
    ("model",),
    ("statistics",),
    ("alignment",),
    ("engine",),
    ("kit", "running"),
    ("backends", "hardware"),
    ("measures",),
    ("estimation",),
    ("scenarios",),
    ("comparison",),
    ("inference",),
    ("tuning", "characterization", "propagation", "gauging", "learning"),
    ("results",),
    ("exporters", "reports"),
    ("fitting", "validation"),
    ("verbs",),
    ("lab",),
    ("cli",),
)
FLOOR = {room: number for number, rooms in enumerate(FLOORS) for room in rooms}
#: the front doors: they reach any room
DOORS = ("simcompare", "simcompare.__main__")
#: where a module of ours may be imported late, and what is saved by it
LATE = {
    "simcompare.cli": "help and completion answer at once, without numpy and pydantic",
    "simcompare.verbs.import_log": "tables of results are known where a log may be one of them",
    "simcompare.verbs.levels": "the file of a fit is read where a level is one",
    "simcompare.results.store": "records of fits and validations are read where one is stored",
    "simcompare.reports.sections": "sections of fits and validations are read for these alone",
    "simcompare.verbs.fit": "of three kinds of fits only the one that is asked for is read",
    "simcompare.reports.validation": "words of validations serve fits, which need no records",
    "simcompare.hardware.conditioning.drive": "mistakes of drives are looked for in drives alone",
    "simcompare.scenarios.catalogue": "names are listed without reading a file",
}


@cache
def modules() -> dict[str, Path]:
    """Every module of the product by its name."""
    found = {}
    for top in ("simcompare", *OUTER):
        for path in sorted((ROOT / top).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            if top == "simcompare" and parts[1] in OUTER:
                continue
            parts = parts if top == "simcompare" else ("simcompare", *parts)
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def targets(node: ast.AST) -> list[str]:
    """The modules of ours that one statement imports."""
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    elif isinstance(node, ast.ImportFrom) and node.module:
        assert node.level == 0, "imports name the whole path"
        names = [
            whole if (whole := f"{node.module}.{alias.name}") in modules() else node.module
            for alias in node.names
        ]
    else:
        return []
    return [name for name in names if name in modules()]


@cache
def arrows() -> dict[str, dict[str, set[str]]]:
    """Module -> the modules it imports -> where: at the top, "late" or for a "type" alone."""
    found: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))

    def visit(name: str, node: ast.AST, where: str) -> None:
        for child in ast.iter_child_nodes(node):
            for target in targets(child):
                if target != name:
                    found[name][target].add(where)
            if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
                visit(name, child, "late")
            elif isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING":
                visit(name, child, "type")
            else:
                visit(name, child, where)

    for name, path in modules().items():
        visit(name, ast.parse(path.read_text(encoding="utf-8")), "top")
    return found


def is_late(places: set[str]) -> bool:
    return "late" in places and "top" not in places


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """Groups that can reach each other (Tarjan)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def walk(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in graph.get(node, ()):
            if other not in index:
                walk(other)
            if other in stack:
                low[node] = min(low[node], low[other])
        if low[node] == index[node]:
            group = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(group) > 1:
                found.append(sorted(group))

    for node in graph:
        if node not in index:
            walk(node)
    return found


def room_of(module: str) -> str:
    return module.split(".")[1] if "." in module else module


def test_every_room_has_its_floor():
    rooms = {room_of(name) for name in modules() if name not in DOORS}
    assert rooms == set(FLOOR)


def test_imports_run_one_way():
    against = [
        f"{name} imports {target}"
        for name, found in arrows().items()
        for target in found
        if name not in DOORS
        and (
            target in DOORS
            or (room_of(name) != room_of(target) and FLOOR[room_of(target)] >= FLOOR[room_of(name)])
        )
    ]
    assert not against


def test_no_modules_import_each_other_in_a_circle():
    assert circles({name: set(found) for name, found in arrows().items()}) == []


def test_no_folders_within_a_room_import_each_other_in_a_circle():
    folders: dict[str, set[str]] = defaultdict(set)
    for name, found in arrows().items():
        for target in found:
            here, there = folder_of(name), folder_of(target)
            # what stands in a folder may use the folders in it, and may be used by them
            nested = f"{here}.".startswith(f"{there}.") or f"{there}.".startswith(f"{here}.")
            if room_of(here) == room_of(there) and not nested:
                folders[here].add(there)
    assert circles(folders) == []


def folder_of(module: str) -> str:
    is_folder = modules()[module].name == "__init__.py"
    return module if is_folder or module in DOORS else module.rpartition(".")[0]


def test_late_imports_save_start_up_time_and_nothing_else():
    late = [
        f"{name} imports {target} late"
        for name, found in arrows().items()
        for target, places in found.items()
        if is_late(places)
        and name not in DOORS
        and not any(name.startswith(place) for place in LATE)
    ]
    assert not late


@pytest.mark.parametrize("place", LATE)
def test_places_of_late_imports_exist(place):
    assert any(
        name.startswith(place) and any(map(is_late, found.values()))
        for name, found in arrows().items()
    )


def test_the_written_plan_is_the_plan():
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    table = re.findall(r"^\| ((?:`\w+`(?:, )?)+) \|", text, flags=re.MULTILINE)
    written = tuple(tuple(re.findall(r"`(\w+)`", row)) for row in table)
    assert written == tuple(reversed(FLOORS))


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "docs/architecture.md"])
def test_files_that_the_papers_name_are_there(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    named = re.findall(
        r"`((?:simcompare|tests|docs|tools|" + "|".join(OUTER) + r")/[\w/.-]+)`", text
    )
    assert named or name == "README.md"
    assert not [path for path in named if not (ROOT / path).exists()]
