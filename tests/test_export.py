"""What other simulators read out of exported files is the scenario, and it moves the same."""

from __future__ import annotations

import math
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import simcompare
from simcompare.exporters.parts import roll_pitch_yaw, turned_from_z
from simcompare.exporters.twins import FORMATS
from simcompare.model.rotations import matrix_of
from simcompare.scenarios import catalogue
from tests.export_scenes import arm, cart, moving, scene, sensed, two_free

#: torque on each wheel of the robot
TORQUE_N_M = 0.02


def robot():
    return catalogue.load("robot").resolve()


@pytest.fixture
def written(tmp_path):
    """Writes an export and returns the path: ``written(scenario, "urdf")``."""

    def to(scenario, format, change=lambda text: text):
        path = tmp_path / f"{scenario.name}{FORMATS[format]}"
        path.write_text(change(simcompare.export(scenario, format=format)), encoding="utf-8")
        return path

    return to


# --- numbers and rotations --------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("pitch", [None, math.pi / 2, -math.pi / 2, math.pi / 2 - 1e-9])
def test_roll_pitch_yaw_are_exact_also_where_pitch_is_a_right_angle(seed, pitch):
    angles = np.random.default_rng(seed).uniform(-3, 3, 3)
    angles[1] = angles[1] if pitch is None else pitch
    x, y, z, w = Rotation.from_euler("xyz", angles).as_quat()
    again = Rotation.from_euler("xyz", roll_pitch_yaw((w, x, y, z))).as_matrix()
    np.testing.assert_allclose(again, matrix_of((w, x, y, z)), atol=2e-15)


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -2), (1, 2, 3), (1e-9, 0, -1), (0, -1, 0)])
def test_a_plane_is_turned_so_that_z_is_its_normal(normal):
    wanted = np.array(normal) / np.linalg.norm(normal)
    np.testing.assert_allclose(matrix_of(turned_from_z(normal))[:, 2], wanted, atol=1e-15)


def test_numbers_are_read_back_as_they_were():
    mass = 0.1 + 0.2
    made = scene("one", {"stone": moving(mass, [1 / 3, 1 / 3, 1 / 3], [0, 0, 1 / 7])})
    urdf = ET.fromstring(simcompare.export(made, format="urdf"))
    sdf = ET.fromstring(simcompare.export(made, format="sdf"))
    assert float(urdf.find(".//mass").get("value")) == mass
    assert float(urdf.find(".//inertia").get("izz")) == 1 / 3
    assert float(sdf.findtext(".//mass")) == mass
    assert float(sdf.findtext(".//model/pose").split()[2]) == 1 / 7


# --- what the readers hold --------------------------------------------------------------------


def urdf_poses(text, part):
    """World frames of every link's first such part by URDF's own rules, from the text alone."""
    robot = ET.fromstring(text)

    def frame(element):
        found = np.eye(4)
        origin = element.find("origin")
        if origin is not None:
            numbers = {key: [float(x) for x in origin.get(key).split()] for key in ("xyz", "rpy")}
            found[:3, :3] = Rotation.from_euler("xyz", numbers["rpy"]).as_matrix()
            found[:3, 3] = numbers["xyz"]
        return found

    above = {j.find("child").get("link"): j for j in robot.findall("joint")}

    def of(link):
        if link not in above:
            return np.eye(4)
        joint = above[link]
        return of(joint.find("parent").get("link")) @ frame(joint)

    links = [link for link in robot.findall("link") if link.find(part) is not None]
    return {x.get("name"): of(x.get("name")) @ frame(x.find(part)) for x in links}


def world_frame(pose):
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = matrix_of(pose.orientation_wxyz), pose.position_m
    return found


@pytest.mark.parametrize("make", [arm, two_free, sensed])
def test_urdf_puts_every_body_where_it_is_drawn(make):
    made = make()
    text = simcompare.export(made, format="urdf")
    poses = urdf_poses(text, "inertial")
    assert set(poses) == {name for name in made.bodies if name != "floor"}
    for name, pose in poses.items():
        np.testing.assert_allclose(pose, world_frame(made.bodies[name]), atol=1e-14)
    for part in ("visual", "collision"):
        solids = urdf_poses(text, part)
        assert set(solids) == {name for name in poses if made.bodies[name].shapes}
        for name, pose in solids.items():
            body = made.bodies[name]
            expected = world_frame(body) @ world_frame(body.shapes[0])
            np.testing.assert_allclose(pose, expected, atol=1e-14)


def joint_in_world(scenario, joint):
    """Anchor and unit axis of a joint in the world, as drawn."""
    parent = world_frame(scenario.bodies[joint.parent])
    axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
    return parent[:3, :3] @ joint.anchor_m + parent[:3, 3], parent[:3, :3] @ axis


@pytest.fixture
def bullet():
    import pybullet

    for number in range(64):  # what other tests left open would be taken for the one of this test
        if pybullet.isConnected(number):
            pybullet.disconnect(number)
    client = pybullet.connect(pybullet.DIRECT)
    yield pybullet
    pybullet.disconnect(client)


def load_urdf(bullet, path, **more):
    uid = bullet.loadURDF(str(path), flags=bullet.URDF_USE_INERTIA_FROM_FILE, **more)
    links = {bullet.getBodyInfo(uid)[0].decode(): -1}
    for j in range(bullet.getNumJoints(uid)):
        links[bullet.getJointInfo(uid, j)[12].decode()] = j
    return uid, links


def bullet_pose(bullet, uid, link):
    """World pose of a link's centre of mass, in double precision."""
    if link < 0:
        position, xyzw = bullet.getBasePositionAndOrientation(uid)
    else:
        position, xyzw = bullet.getLinkState(uid, link)[:2]
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = Rotation.from_quat(xyzw).as_matrix(), position
    return found


def test_pybullet_reads_the_same_out_of_urdf(bullet, written):
    made = arm()
    uid, links = load_urdf(bullet, written(made, "urdf"))
    assert links.keys() == {"world", "base", "upper", "rod", "hand"}
    for name, body in made.moving_bodies().items():
        info = bullet.getDynamicsInfo(uid, links[name])
        assert info[0] == pytest.approx(body.mass_kg, rel=1e-12)
        np.testing.assert_allclose(info[2], body.inertia_kg_m2, rtol=1e-12)
        pose = bullet_pose(bullet, uid, links[name])
        np.testing.assert_allclose(pose, world_frame(body), atol=1e-9)
    for joint in made.movable_joints().values():
        info = bullet.getJointInfo(uid, links[joint.child])
        # where the joint is, relative to the parent's centre of mass
        above = bullet_pose(bullet, uid, links[joint.parent])
        anchor, axis = joint_in_world(made, joint)
        np.testing.assert_allclose((above @ [*info[14], 1])[:3], anchor, atol=1e-9)
        child = bullet_pose(bullet, uid, links[joint.child])
        np.testing.assert_allclose(child[:3, :3] @ info[13], axis, atol=1e-9)
        assert info[6] == pytest.approx(joint.damping)
        assert info[7] == pytest.approx(joint.friction)


def dart_world(path, format):
    import dartpy

    if format == "urdf":
        skeleton = dartpy.utils.DartLoader().parseSkeleton(str(path))
        assert skeleton is not None
        return [skeleton]
    world = dartpy.utils.SdfParser.readWorld(dartpy.common.Uri(str(path)))
    assert world is not None
    return [world.getSkeleton(i) for i in range(world.getNumSkeletons())]


#: DART reads SDF up to 1.6, which takes the same out of a file that names no frames
AS_1_6 = {"urdf": lambda text: text,
          "sdf": lambda text: text.replace('<sdf version="1.8">', '<sdf version="1.6">')
          .replace('<sdf version="1.7">', '<sdf version="1.6">')}  # fmt: skip


def without_capsules(scenario):
    """DART's reader of SDF 1.6 knows no capsules."""
    bodies = {
        name: body.model_copy(update={"shapes": [s for s in body.shapes if s.type != "capsule"]})
        for name, body in scenario.bodies.items()
    }
    return scenario.model_copy(update={"bodies": bodies})


@pytest.mark.parametrize("format", ["urdf", "sdf"])
@pytest.mark.parametrize("make", [arm, cart])
def test_dart_reads_the_same_out_of_urdf_and_sdf(written, format, make):
    made = without_capsules(make())
    skeletons = dart_world(written(made, format, AS_1_6[format]), format)
    nodes = {node.getName(): node for s in skeletons for node in s.getBodyNodes()}
    start = np.eye(4)
    if make is cart and format == "urdf":  # a free robot is placed by whoever loads it
        start = np.linalg.inv(world_frame(made.bodies["chassis"]))
    for name, body in made.moving_bodies().items():
        assert nodes[name].getMass() == pytest.approx(body.mass_kg, rel=1e-12)
        moment = nodes[name].getInertia().getMoment()
        np.testing.assert_allclose(moment, np.diag(body.inertia_kg_m2), atol=1e-15)
        pose = nodes[name].getWorldTransform().matrix().copy()
        pose[:3, 3] += pose[:3, :3] @ nodes[name].getInertia().getLocalCOM()
        np.testing.assert_allclose(pose, start @ world_frame(body), atol=1e-9)
    for name, joint in made.movable_joints().items():
        node = nodes[joint.child]
        held = node.getParentJoint()
        place = node.getWorldTransform().matrix() @ held.getTransformFromChildBodyNode().matrix()
        anchor, axis = joint_in_world(made, joint)
        np.testing.assert_allclose(place[:3, 3], (start @ [*anchor, 1])[:3], atol=1e-9)
        np.testing.assert_allclose(place[:3, :3] @ held.getAxis(), start[:3, :3] @ axis, atol=1e-9)
        assert held.getName() == name
        assert held.getDampingCoefficient(0) == joint.damping
        if format == "sdf":
            assert held.getSpringStiffness(0) == joint.stiffness
            assert held.getRestPosition(0) == joint.rest


def test_mujoco_reads_the_same_out_of_mjcf(written):
    import mujoco

    made = arm()
    model = mujoco.MjModel.from_xml_path(str(written(made, "mjcf")))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert tuple(model.opt.gravity) == made.world.gravity_m_s2
    for name, body in made.moving_bodies().items():
        held = model.body(name)
        assert held.mass[0] == body.mass_kg
        np.testing.assert_allclose(sorted(held.inertia), sorted(body.inertia_kg_m2), rtol=1e-12)
        np.testing.assert_allclose(data.body(name).xipos, body.position_m, atol=1e-9)
        matrix = data.body(name).xmat.reshape(3, 3)
        np.testing.assert_allclose(matrix, matrix_of(body.orientation_wxyz), atol=1e-9)
    for name, joint in made.movable_joints().items():
        anchor, axis = joint_in_world(made, joint)
        np.testing.assert_allclose(data.joint(name).xanchor, anchor, atol=1e-9)
        np.testing.assert_allclose(data.joint(name).xaxis, axis, atol=1e-9)


# --- the same motion --------------------------------------------------------------------------


@pytest.mark.parametrize("coordinates", [(0.0, 0.0), (0.7, -0.2)])
def test_all_readers_agree_on_inertia_and_gravity_of_the_whole_mechanism(
    written, bullet, coordinates
):
    """The mass matrix and the forces of gravity and motion: with them the motion is the same."""
    import mujoco

    made = without_capsules(arm())
    joints = {n: j.model_copy(update={"armature": 0.0}) for n, j in made.joints.items()}
    made = made.model_copy(update={"joints": joints})
    rates = (1.3, -0.4)
    model = mujoco.MjModel.from_xml_path(str(written(made, "mjcf")))
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = coordinates, rates
    mujoco.mj_forward(model, data)
    mass = np.zeros((2, 2))
    for row, unit in zip(mass, np.eye(2), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    for format in ("urdf", "sdf"):
        (arm_,) = (s for s in dart_world(written(made, format, AS_1_6[format]), format)
                   if s.isMobile())  # fmt: skip
        arm_.setGravity(made.world.gravity_m_s2)
        arm_.setPositions(coordinates)
        arm_.setVelocities(rates)
        np.testing.assert_allclose(arm_.getMassMatrix(), mass, rtol=1e-9, atol=1e-12)
        forces = arm_.getCoriolisAndGravityForces()
        np.testing.assert_allclose(forces, data.qfrc_bias, rtol=1e-9, atol=1e-12)
    uid, _ = load_urdf(bullet, written(made, "urdf"))
    bullet.setGravity(*made.world.gravity_m_s2)
    held = bullet.calculateMassMatrix(uid, coordinates)
    np.testing.assert_allclose(held, mass, rtol=1e-9, atol=1e-12)
    held = bullet.calculateInverseDynamics(uid, coordinates, rates, (0.0, 0.0))
    np.testing.assert_allclose(held, data.qfrc_bias, rtol=1e-9)


def assert_closed_form(places, step_s):
    """The robot's a = (2τ/r)/(m + 2J/r²) without slip, after it has settled on its wheels."""
    acceleration = 2 * np.polyfit(step_s * np.arange(100, len(places)), places[100:], 2)[0]
    radius, inertia = 0.0325, 1.584375e-05
    truth = (2 * TORQUE_N_M / radius) / (0.6 + 2 * inertia / radius**2)
    assert truth == pytest.approx(1.953602, abs=1e-6)
    assert acceleration == pytest.approx(truth, rel=3e-3)


@pytest.mark.parametrize("make", [cart, robot])
def test_the_robot_drives_in_pybullet_as_the_closed_form_says(bullet, written, make):
    made, step_s = make(), 0.001
    start = made.bodies["chassis"].position_m
    uid, links = load_urdf(bullet, written(made, "urdf"), basePosition=start)
    floor = bullet.createMultiBody(0, bullet.createCollisionShape(bullet.GEOM_PLANE))
    bullet.setGravity(*made.world.gravity_m_s2)
    bullet.setTimeStep(step_s)
    bullet.changeDynamics(floor, -1, lateralFriction=1)
    for name, link in links.items():
        friction = made.contact_of(name, "floor").friction
        bullet.changeDynamics(
            uid, link, lateralFriction=friction, linearDamping=0, angularDamping=0, jointDamping=0
        )
    wheels = [links["left_wheel"], links["right_wheel"]]
    bullet.setJointMotorControlArray(uid, wheels, bullet.VELOCITY_CONTROL, forces=[0, 0])
    places = []
    for _ in range(600):
        bullet.setJointMotorControlArray(
            uid, wheels, bullet.TORQUE_CONTROL, forces=[TORQUE_N_M] * 2
        )
        bullet.stepSimulation()
        places.append(bullet.getBasePositionAndOrientation(uid)[0][0])
    assert_closed_form(places, step_s)


def test_the_robot_drives_in_plain_mujoco_as_the_closed_form_says(written):
    import mujoco

    made = robot()
    model = mujoco.MjModel.from_xml_path(str(written(made, "mjcf")))
    data = mujoco.MjData(model)
    assert model.nu == 2
    data.ctrl[:] = TORQUE_N_M
    places = []
    for _ in range(600):
        mujoco.mj_step(model, data)
        places.append(data.body("chassis").xpos[0])
    assert_closed_form(places, made.world.engine_step_s)


def test_the_mjcf_of_a_bouncing_ball_bounces_in_plain_mujoco(written):
    import mujoco

    made = catalogue.load("ball").resolve({"drop_height_m": 0.01})
    model = mujoco.MjModel.from_xml_path(str(written(made, "mjcf")))
    data = mujoco.MjData(model)
    fall_s = math.sqrt(2 * 0.01 / 9.80665)
    mujoco.mj_step(model, data, nstep=round(1.1 * fall_s / model.opt.timestep))
    expected = 0.8 * 9.80665 * fall_s - 9.80665 * (data.time - fall_s)
    assert data.qvel[2] == pytest.approx(expected, rel=0.01)
