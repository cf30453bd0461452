"""Texts and names from elsewhere stay texts in what is generated: nothing in them is run."""

from __future__ import annotations

import ast
import json
from xml.etree import ElementTree as ET

import pytest
from pydantic import ValidationError

import simcompare
from simcompare.errors import InputError
from simcompare.model.scenario import Scenario
from simcompare.scenarios import scenario_file
from tests.conftest import FALL_YAML
from tests.export_scenes import moving, scene

#: each would end what it stands in, in one language or another
TEXTS = (
    'x"""\nimport os; os.system("touch PWNED")\n"""',
    "x'''\nboom()\n'''",
    '"', '""', '"""', "\\", '\\"""\nboom()\n"""', "\\\\" * 70 + '"""', '{boom()} {0} %s "',
    "--><robot/><!--", "---", "----->", "]]>", "</robot><script>boom()</script>", "&lt; &amp <",
    "\u202etxt\u2066\u200b", "\u2028boom()", "\ufffe\uffff",
)  # fmt: skip
NAMES = (
    'a"', "a'", "a\n", "a b", "a.b", "a::b", "{a}", "a;b", "1e5", "", "a<b", "a\\", "$(a)",
    "a" * 101,
)  # fmt: skip


def titled(folder, text):
    """The file of a scenario with a title and a question."""
    path = folder / "fall.yaml"
    yaml = FALL_YAML.replace("title: Free fall", f"title: {json.dumps(text)}")
    path.write_text(yaml, encoding="utf-8")
    return path


@pytest.mark.parametrize("text", TEXTS)
def test_a_title_stays_the_docstring_of_a_script(tmp_path, text):
    script = simcompare.export(titled(tmp_path, text), format="script", engine="pymunk")
    plain = simcompare.export(titled(tmp_path, "Fall"), format="script", engine="pymunk")
    (first, *rest), (_, *others) = ast.parse(script).body, ast.parse(plain).body
    assert isinstance(first.value, ast.Constant)
    assert list(map(ast.dump, rest)) == list(map(ast.dump, others))


@pytest.mark.parametrize("format", ["urdf", "sdf", "mjcf"])
def test_a_title_stays_a_comment_of_a_twin(tmp_path, format):
    plain = ET.canonicalize(simcompare.export(titled(tmp_path, "Fall"), format=format))
    for text in TEXTS:
        found = simcompare.export(titled(tmp_path, text), format=format)
        assert ET.canonicalize(found) == plain, text


@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_code_could_not_hold_is_refused(name):
    parts = {
        "bodies": {name: moving(1, [1, 1, 1], [0, 0, 1])},
        "joints": {name: {"type": "fixed", "parent": "a", "child": "b"}},
        "inputs": {name: {"signal": "constant", "value": 1}},
        "probes": {name: {"observe": "a.position_m", "label": "x", "unit": "m"}},
        "measures": [{"function": "f", "probe": "p", "names": {"x": name}}],
    }
    whole = scene("odd", {"a": moving(1, [1, 1, 1], [0, 0, 1])}).model_dump(exclude_none=True)
    for key, part in parts.items():
        with pytest.raises(ValidationError, match="begins with no digit") as caught:
            Scenario.model_validate({**whole, key: part})
        assert caught.value.error_count() == 1, key


def test_a_refused_name_is_told_with_its_line(tmp_path):
    path = tmp_path / "fall.yaml"
    path.write_text(FALL_YAML.replace("  ball:", "  'a\"b':", 1), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        scenario_file.read(path)
    expected = "expected a name of letters, digits and _ that begins with no digit"
    assert any(f'bodies.a"b: {expected}' in fault for fault in caught.value.faults)


@pytest.mark.parametrize("sign", ["\x1b", "\x00", "\r", "\x85", "\ud800"])
def test_no_text_of_a_scenario_holds_what_steers(tmp_path, sign):
    with pytest.raises(InputError) as caught:
        scenario_file.read(titled(tmp_path, f"Fall{sign}"))
    told = f"line 2, title: holds the control character {sign!a}; delete it"
    assert caught.value.faults == (told,)


def test_a_title_of_several_lines_becomes_one(tmp_path):
    file = scenario_file.read(titled(tmp_path, "Free\n  fall\n"))
    assert file.resolve().title == "Free fall"
