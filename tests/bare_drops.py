"""One-bounce drops in bare engines: a sphere on a fixed plane, one fixed step, no adapter."""

import itertools

import numpy as np

from simcompare.engine.calibration.drops import read_drop, read_drops, start_above

G = 9.80665
#: flight after the contact that is recorded [steps]
AFTER = 6


def ends(heights):
    """Whether a flight has begun above the floor, so that the contact is over."""
    return len(heights) > AFTER and 0 < heights[-AFTER] < heights[1 - AFTER]


class BareDrops:
    """Common to all: starts, recording and reading."""

    most = 600

    def __init__(self, step_s, radius_m=0.02):
        self.step_s, self.radius_m, self.count, self.numbers = step_s, radius_m, 0, None

    def __call__(self, numbers, speed_m_s, phases):
        if numbers != self.numbers:
            self.numbers = numbers
            self.open(*numbers)
        records = [self.record(*start_above(speed_m_s, p, self.step_s, G)) for p in phases]
        self.count += len(records)
        return read_drops(records, self.step_s, G)

    def record(self, height_m, speed_m_s):
        self.place(height_m, -speed_m_s)
        heights = [height_m]
        for _ in range(self.most):
            heights.append(self.step())
            if ends(heights) or self.rests(heights):
                break
        return np.array(heights)

    def rests(self, heights):
        return len(heights) > 60 and abs(heights[-1] - heights[-30]) < 1e-12

    def long(self, numbers, height_m, time_s):
        """Heights of a long drop from rest."""
        self.numbers = numbers
        self.open(*numbers)
        self.place(height_m, 0.0)
        return np.array([height_m] + [self.step() for _ in range(round(time_s / self.step_s))])


class MujocoDrops(BareDrops):
    def open(self, k, b):
        import mujoco

        self.mujoco = mujoco
        r = self.radius_m
        self.model = mujoco.MjModel.from_xml_string(f"""
<mujoco><option timestep="{self.step_s!r}" jacobian="dense" cone="elliptic" gravity="0 0 {-G}">
<flag autoreset="disable"/></option><worldbody><geom name="f" type="plane" size="0 0 1"/>
<body><freejoint/><inertial pos="0 0 0" mass=".0027" diaginertia="4e-7 4e-7 4e-7"/>
<geom name="b" size="{r!r}"/></body></worldbody><contact><pair geom1="f" geom2="b" condim="1"
 solref="{k!r} {b!r}" solimp="0.9999 0.9999 0.001"/></contact></mujoco>""")
        self.data = mujoco.MjData(self.model)

    def place(self, height, speed):
        self.mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[2], self.data.qvel[2] = height + self.radius_m, speed

    def step(self):
        self.mujoco.mj_step(self.model, self.data)
        return self.data.qpos[2] - self.radius_m


class DartDrops(BareDrops):
    def open(self, p):
        import dartpy as dart

        world = dart.simulation.World()
        world.setGravity([0, 0, -G])
        world.setTimeStep(self.step_s)
        world.getConstraintSolver().setCollisionDetector(dart.collision.OdeCollisionDetector())
        options = world.getDeactivationOptions()
        options.mEnabled = False
        world.setDeactivationOptions(options)
        floor = dart.dynamics.Skeleton("floor")
        _, node = floor.createWeldJointAndBodyNodePair()
        solid = node.createShapeNode(dart.dynamics.PlaneShape([0.0, 0.0, 1.0], 0.0))
        solid.createCollisionAspect()
        solid.createDynamicsAspect().setRestitutionCoeff(1.0)
        world.addSkeleton(floor)
        ball = dart.dynamics.Skeleton("ball")
        self.joint, node = ball.createFreeJointAndBodyNodePair()
        solid = node.createShapeNode(dart.dynamics.SphereShape(self.radius_m))
        solid.createCollisionAspect()
        solid.createDynamicsAspect().setRestitutionCoeff(p)
        inertia = dart.dynamics.Inertia()
        inertia.setMass(0.0027)
        inertia.setMoment(np.diag([4e-7] * 3))
        node.setInertia(inertia)
        world.addSkeleton(ball)
        self.world = world

    def place(self, height, speed):
        self.joint.setPositions([0, 0, 0, 0, 0, height + self.radius_m])
        self.joint.setVelocities([0, 0, 0, 0, 0, speed])

    def step(self):
        self.world.step()
        return self.joint.getPosition(5) - self.radius_m


class PymunkDrops(BareDrops):
    def open(self, p):
        import pymunk

        self.space = pymunk.Space()
        self.space.gravity = (0, -G)
        self.space.collision_slop = 1e-9
        floor = pymunk.Segment(self.space.static_body, (-5, 0), (5, 0), 0)
        floor.elasticity = 1
        self.body = pymunk.Body(0.0027, 4e-7)
        circle = pymunk.Circle(self.body, self.radius_m)
        circle.elasticity = p
        self.space.add(self.body, circle, floor)

    def place(self, height, speed):
        # pymunk keeps a contact for some steps, and warms the next one with it
        self.body.position, self.body.velocity = (0, 10), (0, 0)
        for _ in range(self.space.collision_persistence + 1):
            self.space.step(self.step_s)
        self.body.position, self.body.velocity = (0, height + self.radius_m), (0, speed)

    def step(self):
        self.space.step(self.step_s)
        return self.body.position.y - self.radius_m


class PybulletDrops(BareDrops):
    client = None

    def open(self, p):
        import pybullet

        self.bullet = pybullet
        if self.client is not None:
            pybullet.disconnect(self.client)
        c = self.client = pybullet.connect(pybullet.DIRECT)
        at = {"physicsClientId": c}
        pybullet.setGravity(0, 0, -G, **at)
        pybullet.setTimeStep(self.step_s, c)
        pybullet.setPhysicsEngineParameter(
            erp=0, contactERP=0, contactSlop=0, restitutionVelocityThreshold=0, **at
        )
        plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, **at)
        sphere = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=self.radius_m, **at)
        floor = pybullet.createMultiBody(0, plane, **at)
        self.ball = pybullet.createMultiBody(0.0027, sphere, **at)
        for body, e in ((floor, 1.0), (self.ball, p)):
            pybullet.changeDynamics(body, -1, restitution=e, **at)
            pybullet.changeDynamics(
                body, -1, linearDamping=0, angularDamping=0, contactProcessingThreshold=0, **at
            )
        self.floor = floor

    def place(self, height, speed):
        p, c = self.bullet, self.client
        p.resetBasePositionAndOrientation(
            self.ball, (0, 0, height + self.radius_m), (0, 0, 0, 1), c
        )
        p.resetBaseVelocity(self.ball, (0, 0, speed), (0, 0, 0), c)
        p.setCollisionFilterPair(self.ball, self.floor, -1, -1, True, c)

    def step(self):
        self.bullet.stepSimulation(self.client)
        position, _ = self.bullet.getBasePositionAndOrientation(self.ball, self.client)
        return position[2] - self.radius_m


COEFFICIENT_ENGINES = {"dart": DartDrops, "pymunk": PymunkDrops, "pybullet": PybulletDrops}


def bounce_by_bounce(heights, step_s, count):
    """Restitution of the first impacts of a long drop, each read between two apexes."""
    tops, low = [0], False
    for i in range(1, len(heights) - 1):
        low = low or heights[i] <= 0
        if low and heights[i - 1] <= heights[i] > heights[i + 1] and heights[i] > 0:
            tops.append(i)
            low = False
    pieces = itertools.pairwise(tops[: count + 1])
    return [read_drop(heights[a : b + 1], step_s, G)[0] for a, b in pieces]
