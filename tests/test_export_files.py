"""The verb export: Gazebo's own checker, what cannot be written, and the command line."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from xml.etree import ElementTree as ET

import pytest

import simcompare
from simcompare.errors import InputError, UnknownName
from simcompare.exporters.twins import FORMATS, twin
from simcompare.scenarios import catalogue
from tests.export_scenes import SCENES, arm, cart, moving, scene, sensed, two_free
from tests.test_cli import loaded_by

PACKAGES = (
    "Gazebo's checker is missing; cure: sudo apt-get install ignition-tools libsdformat-dev"
    " (where Debian or Ubuntu has them)"
)


@pytest.fixture(scope="session")
def ign():
    """Runs Gazebo's tool: ``ign("-k", path) -> (exit code, stdout, stderr)``."""
    program = shutil.which("ign") or shutil.which("gz")  # newer releases renamed it
    if program is None or run_ign(program, "-d")[0] != 0:
        if os.environ.get("CI"):
            pytest.fail(PACKAGES)
        pytest.skip(PACKAGES)
    return lambda *words: run_ign(program, *words)


def run_ign(program, *words):
    done = subprocess.run(
        [program, "sdf", *map(str, words)],
        capture_output=True, text=True, timeout=300, check=False, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    # Debian builds the tool without an optional library and it says so in every run
    err = [line for line in done.stderr.splitlines() if "ignition-tools-backward" not in line]
    return done.returncode, done.stdout, "\n".join(err)


@pytest.fixture(scope="session")
def specification(ign):
    """The elements and attributes that a version of SDF has, as the tool describes them."""
    known = {}

    def of(version):
        if version not in known:
            _, out, _ = ign("-d", version)
            known[version] = ET.fromstring(out[out.index("<element") :])
        return known[version]

    return of


def unknown_parts(element, described):
    """Elements and attributes that the specification does not have; the checker lets them pass."""
    attributes = {a.get("name") for a in described.findall("attribute")}
    found = [f"{element.tag} {name}" for name in set(element.keys()) - attributes]
    for child in element:
        if child.tag is ET.Comment:
            continue
        inside = described.find(f"element[@name='{child.tag}']")
        found += [child.tag] if inside is None else unknown_parts(child, inside)
    return found


@pytest.fixture
def save(tmp_path):
    def to(text, name="scene.sdf"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return to


# --- SDF and URDF in Gazebo -------------------------------------------------------------------


def assert_valid_sdf(text, ign, specification, save):
    code, out, err = ign("-k", save(text))
    assert (code, out.strip(), err) == (0, "Valid.", "")
    root = ET.fromstring(text)
    assert unknown_parts(root, specification(root.get("version"))) == []


@pytest.mark.parametrize("name", SCENES)
def test_gazebo_takes_the_sdf_without_a_warning(name, ign, specification, save):
    assert_valid_sdf(simcompare.export(SCENES[name](), format="sdf"), ign, specification, save)


def test_gazebo_takes_the_rays_of_a_range_sensor(ign, specification, save):
    text = simcompare.export("time_of_flight", format="sdf")
    assert "<ray>" in text
    assert_valid_sdf(text, ign, specification, save)


@pytest.mark.parametrize(
    ("was", "broken"),
    [
        ("<child>upper</child>", "<child>nobody</child>"),
        ('type="revolute"', 'type="rotatory"'),
        ("<mass>1.7</mass>", "<mass>-1.7</mass>"),
        ("<ixx>0.02</ixx>", "<ixx>0.2</ixx>"),
        ("</world>", ""),
        ('name="visual_0"', 'name="collision_0"'),
        ('canonical_link="base"', 'canonical_link="nobody"'),
    ],
)
def test_the_check_of_sdf_can_fail(was, broken, ign, save):
    text = simcompare.export(arm(), format="sdf")
    assert was in text
    code, out, err = ign("-k", save(text.replace(was, broken)))
    assert code != 0 or out.strip() != "Valid." or err != ""


@pytest.mark.parametrize(
    ("was", "broken"), [("max_step_size", "step_size"), ("canonical_link", "main_link")]
)
def test_the_check_of_names_can_fail(was, broken, specification):
    text = simcompare.export(arm(), format="sdf")
    root = ET.fromstring(text.replace(was, broken))
    assert unknown_parts(root, specification(root.get("version"))) != []


@pytest.mark.parametrize("name", sorted(SCENES.keys() - {"two"}))
def test_gazebo_takes_the_urdf_with_all_its_links_and_joints(name, ign, save):
    made = twin(SCENES[name](), format="urdf")
    path = save(made.text, "scene.urdf")
    assert ign("-k", path)[:2] == (0, "Valid.\n")
    _, out, _ = ign("-p", path)
    model = ET.fromstring(out[out.index("<sdf") :]).find("model")
    joints = {joint.get("name") for joint in model.findall("joint")}
    # Gazebo melts links on fixed joints into one
    fixed = {n for n, joint in SCENES[name]().joints.items() if joint.type == "fixed"}
    assert set(made.joints) - fixed <= joints
    mass = sum(float(m.text) for m in model.findall("link/inertial/mass"))
    bodies = SCENES[name]().bodies
    assert mass == pytest.approx(sum(bodies[body].mass_kg or 1 for body in made.bodies))


def test_gazebo_refuses_two_free_bodies_in_urdf_and_the_twin_says_so(ign, save):
    made = twin(two_free(), format="urdf")
    assert ign("-k", save(made.text, "scene.urdf"))[0] != 0
    assert [text for text in made.left_out if "floating" in text] == [
        f"floating joint of {name}: PyBullet takes it for fixed, Gazebo refuses it"
        for name in ("a", "b")
    ]


# --- what is in the files ---------------------------------------------------------------------


def test_the_urdf_of_a_robot_has_the_free_body_as_root_and_no_floor():
    made = twin(cart(), format="urdf")
    robot = ET.fromstring(made.text)
    assert [link.get("name") for link in robot.findall("link")] == [
        "left_wheel",
        "chassis",
        "right_wheel",
    ]
    assert {joint.get("type") for joint in robot.findall("joint")} == {"continuous"}
    assert made.bodies == ("left_wheel", "chassis", "right_wheel")
    assert "floor: stands still and carries nothing; use the simulator's own" in made.left_out
    assert any("place of chassis at the start: -0.02 0 0.04 m" in t for t in made.left_out)


def test_a_capsule_in_urdf_is_a_cylinder_with_two_spheres_on_its_ends():
    made = scene("pill", {"pill": moving(1, [1, 1, 1], [0, 0, 1], {
        "type": "capsule", "radius_m": 0.1, "length_m": 0.6, "position_m": [1, 2, 3],
        "orientation_wxyz": [0.5, 0.5, 0.5, 0.5]})})  # fmt: skip
    solids = ET.fromstring(simcompare.export(made)).findall(".//collision")
    places = [[float(x) for x in s.find("origin").get("xyz").split()] for s in solids]
    assert [s.find("geometry")[0].tag for s in solids] == ["cylinder", "sphere", "sphere"]
    # turned so that its z axis is the body's x axis
    for place, x in zip(places, (1, 0.7, 1.3), strict=True):
        assert place == pytest.approx([x, 2, 3], abs=1e-15)


def test_a_plane_that_carries_joints_is_a_box_below_it_in_urdf():
    joints = {"up": {"type": "slider", "parent": "table", "child": "stone"}}
    bodies = {"table": {"fixed": True, "shapes": [{"type": "plane", "position_m": [0, 0, 0.2]}]},
              "stone": moving(1, [1, 1, 1], [0, 0, 1])}  # fmt: skip
    made = twin(scene("table", bodies, joints))
    solid = ET.fromstring(made.text).find(".//collision")
    assert solid.find("geometry/box").get("size") == "100 100 1"
    assert solid.find("origin").get("xyz") == "0 0 -0.3"
    assert "plane of table: a box of 100 m by 100 m instead" in made.left_out


def test_limits_of_joints_are_written():
    joint = {"type": "hinge", "parent": "a", "child": "b", "lower": -0.5, "upper": 1.5}
    bodies = {"a": {"fixed": True}, "b": moving(1, [1, 1, 1], [0, 0, 1])}
    made = scene("door", bodies, {"hinge": joint})
    urdf = ET.fromstring(simcompare.export(made)).find(".//joint[@name='hinge']")
    assert urdf.get("type") == "revolute"
    assert urdf.find("limit").attrib | {"effort": "", "velocity": ""} == {
        "lower": "-0.5", "upper": "1.5", "effort": "", "velocity": "",
    }  # fmt: skip
    limit = ET.fromstring(simcompare.export(made, format="sdf")).find(".//limit")
    assert (limit.findtext("lower"), limit.findtext("upper")) == ("-0.5", "1.5")
    with pytest.raises(InputError, match="limits of the joint hinge"):
        simcompare.export(made, format="mjcf")


def test_sensors_that_sdf_knows_are_written_and_the_others_are_named():
    made = twin(sensed(), format="sdf")
    root = ET.fromstring(made.text)
    found = {s.get("name"): s.get("type") for s in root.iter("sensor")}
    assert found == {"acc": "imu", "gyro": "imu", "baro": "air_pressure", "force": "force_torque"}
    assert "sensor marks: encoder of shoulder" in made.left_out
    assert sum("sensor " in text for text in twin(sensed(), format="urdf").left_out) == 5


def test_a_motor_is_damping_and_friction_with_the_effort_of_a_volt_named():
    """48·0.35·5.5e-3/6 N·m/V; 0.35·48²·(5.5e-3²/6 + 2e-7) N·m·s; 0.35·48·4e-4 N·m."""
    for format in ("urdf", "sdf"):
        made = twin(SCENES["motor"](), format=format)
        (said,) = (text for text in made.left_out if text.startswith("left_motor"))
        assert "give the joint left 0.0154 N·m for each volt of the input volt" in said
        assert any("rotor inertia at the joint left: 8.064e-05" in t for t in made.left_out)
        joint = ET.fromstring(made.text).find(".//joint[@name='left']")
        if format == "urdf":
            held = joint.find("dynamics").attrib
        else:
            held = {item.tag: item.text for item in joint.find("axis/dynamics")}
        assert float(held["damping"]) == pytest.approx(0.00422688, rel=1e-9)
        assert float(held["friction"]) == pytest.approx(0.00672, rel=1e-9)


def surfaces(text):
    """Friction and restitution of each body in an SDF."""
    found = {}
    for link in ET.fromstring(text).iter("link"):
        for surface in link.iter("surface"):
            mu = float(surface.findtext("friction/ode/mu"))
            found[link.get("name")] = mu, float(surface.findtext("bounce/restitution_coefficient"))
            assert float(surface.findtext("bounce/threshold")) == 0
    return found


def test_contact_of_pairs_becomes_values_of_bodies_that_give_it_by_both_rules():
    made = twin(cart(), format="sdf")
    held = surfaces(made.text)
    assert held == {
        "floor": (1, 1), "left_wheel": (0.6, 0), "right_wheel": (0.6, 0), "chassis": (0, 0)
    }  # fmt: skip
    assert not any("friction of" in text for text in made.left_out)


def test_contact_that_values_of_bodies_cannot_give_is_named():
    stone = {"type": "sphere", "radius_m": 0.1}
    bodies = {"floor": {"fixed": True, "shapes": [{"type": "plane"}]},
              "a": moving(1, [1, 1, 1], [0, 0, 1], stone),
              "b": moving(1, [1, 1, 1], [1, 0, 1], stone)}  # fmt: skip
    contacts = [
        {"pair": ["a", "floor"], "friction": 1.2},
        {"pair": ["a", "b"], "friction": 0.3},
        {"pair": ["b", "floor"], "friction": 0.5, "restitution": 0.7},
    ]
    made = twin(scene("stones", bodies, contacts=contacts), format="sdf")
    assert [text for text in made.left_out if " of the two bodies" in text] == [
        "friction of a and floor is 1.2: the smaller value of the two bodies (Gazebo) is 1.2,"
        " the product 1.44",
        "friction of b and floor is 0.5: the smaller value of the two bodies (Gazebo) is 0.5,"
        " the product 0.6",
        "friction of a and b is 0.3: the smaller value of the two bodies (Gazebo) is 0.5,"
        " the product 0.6",
    ]
    assert surfaces(made.text)["b"] == (0.5, 0.7)


@pytest.mark.parametrize("format", FORMATS)
def test_what_is_left_out_stands_in_the_file_too(format):
    made = twin(SCENES["motor"](), format=format)
    assert made.left_out
    (comment,) = (e for e in ET.fromstring(with_comments(made.text)).iter("comment"))
    for sentence in made.left_out:
        assert sentence.replace("--", "- -") in comment.text


def with_comments(text):
    """ElementTree drops comments when it reads."""
    assert text.count("<!--") == 1
    return text.replace("<!--", "<comment>").replace("-->", "</comment>")


def test_motion_at_the_start_and_drag_are_named():
    thrown = moving(1, [1, 1, 1], [0, 0, 1], velocity_m_s=[3, 0, 0],
                    drag={"coefficient": 0.5, "area_m2": 2, "air_density_kg_m3": 1.2})  # fmt: skip
    for format in FORMATS:
        said = " ".join(twin(scene("thrown", {"stone": thrown}), format=format).left_out)
        assert "motion of stone at the start: velocity 3 0 0 m/s" in said
        assert "air drag of stone: 0.6 kg/m times speed squared" in said


# --- the catalogue ----------------------------------------------------------------------------


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("name", catalogue.names())
def test_every_scenario_can_be_exported(name, format, request, save):
    made = twin(name, format=format)
    scenario = catalogue.load(name).resolve()
    assert set(made.joints) == set(scenario.joints)
    assert scenario.moving_bodies().keys() <= set(made.bodies)
    path = save(made.text, f"scene{FORMATS[format]}")
    if format == "sdf":
        fixtures = map(request.getfixturevalue, ("ign", "specification", "save"))
        assert_valid_sdf(made.text, *fixtures)
    elif format == "mjcf":
        import mujoco

        model = mujoco.MjModel.from_xml_path(str(path))
        assert model.njnt == len(scenario.movable_joints()) + len(scenario.free_bodies())
    else:
        import dartpy

        skeleton = dartpy.utils.DartLoader().parseSkeleton(str(path))
        masses = {node.getName(): node.getMass() for node in skeleton.getBodyNodes()}
        for body, held in scenario.moving_bodies().items():
            assert masses[body] == held.mass_kg
        assert pybullet_masses(path).items() >= masses.items()


def pybullet_masses(path):
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    try:
        uid = pybullet.loadURDF(str(path), flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        links = {pybullet.getJointInfo(uid, j)[12]: j for j in range(pybullet.getNumJoints(uid))}
        links[pybullet.getBodyInfo(uid)[0]] = -1
        return {n.decode(): pybullet.getDynamicsInfo(uid, j)[0] for n, j in links.items()}
    finally:
        pybullet.disconnect(client)


# --- bad input and the command line -----------------------------------------------------------


@pytest.mark.parametrize("name", ["world", "__a__"])
@pytest.mark.parametrize("format", ["urdf", "sdf", "mjcf"])
def test_names_that_a_format_keeps_to_itself_are_refused(name, format):
    with pytest.raises(InputError, match="cannot be the name of anything"):
        simcompare.export(scene("odd", {name: moving(1, [1, 1, 1], [0, 0, 1])}), format=format)


def test_a_ball_joint_is_written_where_the_format_has_one(ign, specification, save):
    joints = {"hip": {"type": "ball", "parent": "a", "child": "b"}}
    bodies = {"a": {"fixed": True}, "b": moving(1, [1, 1, 1], [0, 0, 1])}
    made = scene("hip", bodies, joints)
    assert_valid_sdf(simcompare.export(made, format="sdf"), ign, specification, save)
    for format in ("urdf", "mjcf"):
        with pytest.raises(InputError, match="hip is a ball joint") as fault:
            simcompare.export(made, format=format)
        assert fault.value.exit_code == 2


def test_a_scene_in_which_nothing_moves_has_no_urdf():
    still = scene("still", {"floor": {"fixed": True, "shapes": [{"type": "plane"}]}})
    with pytest.raises(InputError, match="nothing in it moves"):
        simcompare.export(still, format="urdf")


def test_a_scenario_that_is_built_takes_no_parameters():
    with pytest.raises(InputError, match="have their numbers already"):
        simcompare.export(cart(), set={"mass": 1})
    with pytest.raises(UnknownName, match="did you mean sdf"):
        simcompare.export(cart(), format="sdv")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["bal"], "did you mean ball?"),
        (["ball", "--format", "urfd"], "did you mean urdf?"),
        (["ball", "--set", "drop_hight=1"], "did you mean drop_height_m?"),
        (["ball", "--set", "drop_height"], "not of the form parameter=value"),
        (["ball", "--preset", "tenis"], "did you mean tennis"),
        (["ball", "-o", "file/ball.urdf"], "choose another place"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_2_and_one_sentence_when_the_user_is_wrong(call, write, words, expected):
    write("file", "x")
    code, out, err = call("export", *words)
    assert (code, out) == (2, "")
    assert expected in err
    assert "Traceback" not in err


def test_the_text_goes_to_stdout_and_remarks_to_stderr(call):
    code, out, err = call("export", "ball", "--set", "mass=10g", "--format", "sdf")
    assert code == 0
    assert out == simcompare.export("ball", format="sdf", set={"mass": "10g"})
    assert ET.fromstring(out).findtext(".//model[@name='ball']//mass") == "0.01"
    assert err == ""
    _, _, err = call("export", "ball", "--preset", "golf")
    assert "left out: floor: stands still and carries nothing" in err


@pytest.mark.parametrize(("out", "file"), [("twin.sdf", "twin.sdf"), ("new/t.sdf", "new/t.sdf"),
                                           (".", "ball.sdf")])  # fmt: skip
def test_a_file_or_folder_gets_the_text_and_its_path_is_printed(call, tmp_path, out, file):
    code, printed, _ = call("export", "ball", "--format", "sdf", "-o", out)
    assert (code, printed) == (0, f"{file}\n")
    text = (tmp_path / file).read_text(encoding="utf-8")
    assert text == simcompare.export("ball", format="sdf")


def test_json_is_one_object(call, tmp_path):
    code, out, err = call("export", "ball", "--format", "mjcf", "-o", "b.xml", "--json")
    assert (code, err, out.count("\n")) == (0, "", 1)
    found = json.loads(out)
    assert found["left_out"][0].startswith("steps of 0.001 s: the contact that bounces")
    assert found | {"left_out": []} == {
        "format": "mjcf", "file": "b.xml", "bodies": ["floor", "ball"], "joints": [],
        "left_out": [],
    }  # fmt: skip
    assert json.loads(call("export", "ball", "--json")[1])["file"] is None


def test_the_text_is_utf_8_in_every_locale(tmp_path):
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "latin-1"}
    done = subprocess.run(
        [sys.executable, "-m", "simcompare", "export", "ball"],
        capture_output=True, cwd=tmp_path, check=True, env={**os.environ, **plain}, timeout=3000,
    )  # fmt: skip
    assert done.stdout.decode("utf-8") == simcompare.export("ball")
    assert "m/s²" in done.stdout.decode("utf-8")


def test_help_loads_nothing_heavy(tmp_path):
    out, loaded = loaded_by(["export", "--help"], tmp_path)
    assert "urdf" in out
    assert loaded == []


@pytest.mark.parametrize(
    "words", [("--format", "sdf"), ("--format", "script", "--engine", "pymunk")], ids=" ".join
)
def test_an_export_replaces_its_like_and_nothing_else(call, tmp_path, words):
    name = f"ball.{'py' if 'script' in words else 'sdf'}"
    for _ in range(2):
        assert call("export", "ball", *words, "-o", name)[0] == 0
    (tmp_path / name).write_text("import simcompare  # my own\n", encoding="utf-8")
    code, _, err = call("export", "ball", *words, "-o", name)
    assert (code, "is another file, and is left as it is; choose another name" in err) == (2, True)
    assert (tmp_path / name).read_text(encoding="utf-8") == "import simcompare  # my own\n"
