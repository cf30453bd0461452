"""Adapters translate: they are small, contain no help, and take what they need from the kit."""

import ast
from pathlib import Path

import pytest

from simcompare.backends import conformance
from simcompare.engine import engines
from simcompare.engine.features import Feature

FOLDER = Path(conformance.__file__).resolve().parent
#: most statements of an adapter, its script writer and known limits apart: a planar engine whose
#: joints are constraints has to build these; every other one has 250, for variants 25 more, and for
#: casting rays 10 more
MOST, USUAL, FOR_VARIANTS, FOR_RAYS = {"pymunk": 350}, 250, 25, 10


def files_of(engine):
    """Python files of an adapter, without what writes its scripts."""
    one = FOLDER / f"{engine}_.py"
    found = [one] if one.is_file() else sorted((FOLDER / engine).glob("*.py"))
    return [path for path in found if not path.name.startswith("script")]


def statements(path):
    """Number of statements, docstrings apart."""
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    return sum(
        isinstance(node, ast.stmt)
        and not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))
        for node in nodes
    )


BUILT_IN = [n for n, t in engines.targets().items() if t.startswith("simcompare.backends.")]


@pytest.mark.parametrize("engine", BUILT_IN)
def test_an_adapter_is_small(engine):
    files = files_of(engine)
    assert files
    most = MOST.get(engine, USUAL) + FOR_VARIANTS * bool(engines.quick_variants(engine))
    most += FOR_RAYS * (Feature.RAYS in engines.get(engine).features)
    assert sum(map(statements, files)) <= most


@pytest.mark.parametrize("engine", BUILT_IN)
def test_an_adapter_contains_no_help_and_no_other_adapter(engine):
    for path in files_of(engine):
        text = path.read_text(encoding="utf-8")
        assert ".takes(" not in text, f"{path} asks for a help; the core does"
        others = [other for other in BUILT_IN if other != engine]
        named = [o for o in others if f"simcompare.backends.{o}" in text]
        assert not named, f"{path} takes from {named}"


@pytest.mark.parametrize("engine", BUILT_IN)
def test_an_adapter_takes_all_of_ours_from_the_kit(engine):
    for path in files_of(engine):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            module = (node.module or "") if isinstance(node, ast.ImportFrom) else ""
            own = module.startswith(f"simcompare.backends.{engine}.")
            # names of variants are shown by commands that load nothing heavy, and the kit is
            light = path.name == "variants.py"
            kit = "simcompare.engine.variants" if light else "simcompare.kit"
            assert own or module == kit or not module.startswith("simcompare"), path


def test_all_helps_together_are_small():
    helps = FOLDER.parent / "simcompare" / "engine" / "helps"
    assert sum(map(statements, helps.glob("*.py"))) <= 700
