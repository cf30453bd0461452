"""The verb robot: what it writes, prints and leaves alone."""

from __future__ import annotations

import csv
import importlib.util
import json
import sys
from xml.etree import ElementTree as ET

import pytest
import yaml
from typer.testing import CliRunner

import simcompare
from simcompare.cli import app, register
from simcompare.errors import OutputError
from simcompare.hardware.robot import built, robot_file

TABLES = ("bill_of_materials.csv", "wiring.csv", "pins.csv")
DRAWINGS = ("chassis.step", "chassis.stl", "robot.step")


def call(*words):
    register()
    return CliRunner().invoke(app, ["robot", *map(str, words)])


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture
def without_cad(monkeypatch):
    monkeypatch.setitem(sys.modules, "build123d", None)


def test_without_the_library_of_cad_all_else_is_written(without_cad, tmp_path):
    made = simcompare.robot(out=tmp_path)
    assert made.left_out == (
        "STEP and STL: build123d is not installed; cure: pip install 'simcompare[cad]'",
    )
    names = {path.name for path in made.files}
    assert {"robot.urdf", "robot.sdf", "robot.xml", "driver.py", *TABLES} <= names
    assert not names & set(DRAWINGS)
    assert all(path.is_file() for path in made.files)
    for ending in ("urdf", "sdf", "xml"):
        ET.parse(tmp_path / f"robot.{ending}")


def test_the_same_robot_is_the_same_files_and_replaces_them(tmp_path):
    first = {path: path.read_bytes() for path in simcompare.robot(out=tmp_path).files}
    again = {path: path.read_bytes() for path in simcompare.robot(out=tmp_path).files}
    assert set(first) == set(again)
    # the library of CAD numbers the parts of assemblies on and on, as long as it runs
    changed = {path.name for path in first if first[path] != again[path]}
    assert changed <= {"robot.step"}
    if importlib.util.find_spec("build123d") is not None:
        assert {tmp_path / name for name in DRAWINGS} <= set(first)


def test_files_of_others_are_left_alone(without_cad, tmp_path):
    (tmp_path / "wiring.csv").write_text("red,blue\n", encoding="utf-8")
    with pytest.raises(OutputError, match="is another file"):
        simcompare.robot(out=tmp_path)
    assert (tmp_path / "wiring.csv").read_text(encoding="utf-8") == "red,blue\n"
    assert [path.name for path in tmp_path.iterdir()] == ["wiring.csv"]


@pytest.mark.parametrize("name", ["x" * 300, "a\0b"])
def test_a_folder_that_cannot_be_is_told(without_cad, tmp_path, name):
    with pytest.raises(OutputError, match="cannot be written"):
        simcompare.robot(out=tmp_path / name)


def test_the_bill_has_every_part_and_the_mass_of_the_whole(without_cad, tmp_path):
    made = simcompare.robot(out=tmp_path)
    bill = rows(tmp_path / "bill_of_materials.csv")
    total = sum(int(row["count"]) * float(row["mass_each_kg"]) for row in bill)
    assert total == pytest.approx(made.mass_kg, abs=1e-5)  # written to the milligram
    assert made.mass_kg == pytest.approx(0.6, abs=1e-6)
    assert {row["part"] for row in bill if row["confirmed"] == "no"} == set(made.unconfirmed)
    # a price without its source would be made up
    assert all(bool(row["price_each"]) == bool(row["price_source"]) for row in bill)
    assert all(row["source"] for row in bill)


def test_no_text_of_a_table_is_a_formula(without_cad, tmp_path):
    """A file of others may say anything; a table program would work it out."""
    tree = yaml.safe_load(robot_file.OWN.read_text(encoding="utf-8"))
    tree["wheels"]["text"] = '=HYPERLINK("http://example.org")'
    path = tmp_path / "my.yaml"
    path.write_text(yaml.safe_dump(tree), encoding="utf-8")
    simcompare.robot(path, out=tmp_path / "out")
    for name in ("bill_of_materials.csv", "wiring.csv", "pins.csv"):
        text = (tmp_path / "out" / name).read_text(encoding="utf-8")
        cells = [one for row in csv.reader(text.splitlines()) for one in row if len(one) > 1]
        assert not [one for one in cells if one.startswith(("=", "+", "-", "@"))], name
        assert "'=HYPERLINK" in text or name != "bill_of_materials.csv"


def test_every_pin_of_the_controller_has_one_use(without_cad, tmp_path):
    simcompare.robot(out=tmp_path)
    wiring, pins = rows(tmp_path / "wiring.csv"), rows(tmp_path / "pins.csv")
    led = {row["to_pin"] for row in wiring if row["to_part"] == "board"}
    assert led == {row["pin"] for row in pins if row["for"]}
    for row in pins:
        if row["for"] in ("in", "out"):
            assert len(row["leads_to"].split()) == 1, row
    assert {row["for"] for row in pins if row["kind"] == "flash"} == {""}


def test_what_is_printed_is_what_follows(without_cad, tmp_path):
    done = call("--out", tmp_path, "--json")
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert told["parameters"] == pytest.approx(dict(built.parameters(robot_file.read())))
    shown = call()
    assert "Table-top robot" in shown.stdout
    assert "nothing is written without --out FOLDER" in shown.stdout


def test_the_template_is_a_robot(tmp_path):
    path = tmp_path / "my.yaml"
    path.write_text(call("--template").stdout, encoding="utf-8")
    assert robot_file.read(path) == robot_file.read()


def test_a_tilted_body_is_told(without_cad, tmp_path):
    tree = yaml.safe_load(robot_file.OWN.read_text(encoding="utf-8"))
    tree["chassis"]["length_m"] = 0.2
    path = tmp_path / "my.yaml"
    path.write_text(yaml.safe_dump(tree), encoding="utf-8")
    (told,) = simcompare.robot(path).left_out
    assert "scenarios leave out the robot's product of inertia I_xz" in told


def test_faults_end_with_2_and_no_traceback(tmp_path):
    path = tmp_path / "my.yaml"
    text = robot_file.OWN.read_text(encoding="utf-8").replace("width_m: 0.020", "width_m: 0.2")
    path.write_text(text, encoding="utf-8")
    done = call("--robot", path)
    assert done.exit_code == 2
    assert "is wider than the chassis" in done.output
    assert call("--robot", tmp_path / "none.yaml").exit_code == 2


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        (
            "body",
            "trunk",
            "no body of the robot in the scenario robot is called 'trunk'; known: chassis",
        ),
        (
            "body",
            "floor",
            "no body of the robot in the scenario robot is called 'floor'; known: chassis",
        ),
        (
            "body",
            "left_wheel",
            "body of the robot in the scenario robot is called 'left_wheel'; known: chassis",
        ),
        ("scenario", "robott", "no scenario is called 'robott'; did you mean robot"),
        ("scenario", "ball", "the scenario ball has no parameter of a robot"),
    ],
)
def test_a_scene_that_does_not_fit_is_told(tmp_path, key, value, words):
    tree = yaml.safe_load(robot_file.OWN.read_text(encoding="utf-8")) | {key: value}
    path = tmp_path / "my.yaml"
    path.write_text(yaml.safe_dump(tree), encoding="utf-8")
    with pytest.raises(simcompare.SimcompareError, match=words):
        simcompare.robot(path, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_models_show_every_part_in_its_place(without_cad, tmp_path):
    """The boxes that are seen, from the axle: those of the file."""
    simcompare.robot(out=tmp_path)
    robot = robot_file.read()
    center = built.body_of(robot).center_m
    (link,) = ET.parse(tmp_path / "robot.urdf").getroot().findall("link[@name='chassis']")
    seen = {
        tuple(float(x) for x in visual.find("geometry/box").get("size").split()): [
            float(x) + shift
            for x, shift in zip(visual.find("origin").get("xyz").split(), center, strict=True)
        ]
        for visual in link.findall("visual")
        if visual.find("geometry/box") is not None
    }
    for name in ("battery", "board", "imu", "range_sensor"):
        part = robot.parts[name]
        assert seen[part.size_m] == pytest.approx(part.position_m, abs=1e-12), name
    # what touches stays the caster's ball alone
    assert len(link.findall("collision")) == 1
    in_sdf = ET.parse(tmp_path / "robot.sdf").getroot().find(".//link[@name='chassis']")
    assert len(in_sdf.findall("visual")) == len(link.findall("visual")) > 15
