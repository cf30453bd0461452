"""The robot by hand for each engine of three dimensions: torque on two wheels, by its own loop.

Every class builds the scene with sphere wheels, gives the torque in each step and records position,
orientation, velocity and rate of the chassis and angle and rate of both wheels, through the
engine's own API. Solvers are those of the backends, so that the ratio is the cost of the tool.
"""

import numpy as np

G, RADIUS, TORQUE = 9.80665, 0.0325, 0.02
BODY, WHEEL, TRACK, CASTER = 0.54, 0.03, 0.12, 0.01
BODY_MOMENTS, WHEEL_MOMENTS = (6e-4, 1.1e-3, 1.4e-3), (9e-6, 1.584375e-5, 9e-6)
#: of the centre of mass; the axle is 0.02 m before it and the caster 0.06 m behind
HEIGHT, AHEAD, BEHIND = 0.04, 0.02, 0.06


class Mujoco:
    """A compiled model with one actuator a wheel."""

    def __init__(self, step_s):
        import mujoco

        self.mujoco = mujoco
        wheels = "".join(
            f"""<body pos="{AHEAD} {side * TRACK / 2} {RADIUS - HEIGHT}">
            <joint name="{name}" axis="0 1 0"/>
            <inertial pos="0 0 0" mass="{WHEEL}" diaginertia="{" ".join(map(str, WHEEL_MOMENTS))}"/>
            <geom size="{RADIUS}" friction="0.6" solref="0.005 1"/></body>"""
            for name, side in (("left", 1), ("right", -1))
        )
        self.model = mujoco.MjModel.from_xml_string(
            f"""<mujoco><option timestep="{step_s}" gravity="0 0 {-G}" cone="elliptic"/>
            <worldbody><geom type="plane" size="0 0 1" friction="0 0 0" solref="0.005 1"/>
            <body pos="{-AHEAD} 0 {HEIGHT}"><freejoint/>
            <inertial pos="0 0 0" mass="{BODY}" diaginertia="{" ".join(map(str, BODY_MOMENTS))}"/>
            <geom size="{CASTER}" pos="{-BEHIND} 0 {CASTER - HEIGHT}" condim="1"
            friction="0 0 0" solref="0.005 1"/>{wheels}</body></worldbody>
            <actuator><motor joint="left"/><motor joint="right"/></actuator></mujoco>"""
        )
        self.data = mujoco.MjData(self.model)

    def record(self, count):
        step, model, data = self.mujoco.mj_step, self.model, self.data
        rows = np.empty((count, model.nq + model.nv))
        qpos, qvel, ctrl = data.qpos, data.qvel, data.ctrl
        for i in range(count):
            ctrl[:] = TORQUE
            step(model, data)
            rows[i, : model.nq] = qpos
            rows[i, model.nq :] = qvel
        return rows


class Pybullet:
    """A multi-body in DIRECT mode, its default motors switched off."""

    def __init__(self, step_s):
        import pybullet

        self.p, self.client = pybullet, pybullet.connect(pybullet.DIRECT)
        p, at = pybullet, {"physicsClientId": self.client}
        p.setGravity(0, 0, -G, **at)
        p.setTimeStep(step_s, **at)
        # the solver that the robot needs, as the backend has it
        p.setPhysicsEngineParameter(
            contactSlop=0, numSolverIterations=500, solverResidualThreshold=1e-24, **at
        )
        plane = p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE, **at), **at)
        wheel = p.createCollisionShape(p.GEOM_SPHERE, radius=RADIUS, **at)
        caster = p.createCollisionShape(
            p.GEOM_SPHERE, radius=CASTER, collisionFramePosition=(-BEHIND, 0, CASTER - HEIGHT), **at
        )
        upright = (0, 0, 0, 1)
        self.robot = p.createMultiBody(
            BODY, caster, -1, (-AHEAD, 0, HEIGHT),
            linkMasses=[WHEEL] * 2, linkCollisionShapeIndices=[wheel] * 2,
            linkVisualShapeIndices=[-1] * 2,
            linkPositions=[(AHEAD, side * TRACK / 2, RADIUS - HEIGHT) for side in (1, -1)],
            linkOrientations=[upright] * 2, linkInertialFramePositions=[(0, 0, 0)] * 2,
            linkInertialFrameOrientations=[upright] * 2, linkParentIndices=[0] * 2,
            linkJointTypes=[p.JOINT_REVOLUTE] * 2, linkJointAxis=[(0, 1, 0)] * 2, **at,
        )  # fmt: skip
        p.changeDynamics(plane, -1, lateralFriction=1, contactProcessingThreshold=0, **at)
        for link, mass, moments, friction in (
            (-1, BODY, BODY_MOMENTS, 0.0), (0, WHEEL, WHEEL_MOMENTS, 0.6),
            (1, WHEEL, WHEEL_MOMENTS, 0.6),
        ):  # fmt: skip
            p.changeDynamics(
                self.robot, link, mass=mass, localInertiaDiagonal=moments, lateralFriction=friction,
                linearDamping=0, angularDamping=0, jointDamping=0, contactProcessingThreshold=0,
                **at,
            )  # fmt: skip
        p.setJointMotorControlArray(self.robot, (0, 1), p.VELOCITY_CONTROL, forces=(0, 0), **at)

    def record(self, count):
        p, robot, client, rows = self.p, self.robot, self.client, []
        step, pose, motion = p.stepSimulation, p.getBasePositionAndOrientation, p.getBaseVelocity
        drive, joints, torque = p.setJointMotorControlArray, p.getJointStates, p.TORQUE_CONTROL
        for _ in range(count):
            drive(robot, (0, 1), torque, forces=(TORQUE, TORQUE), physicsClientId=client)
            step(client)
            position, orientation = pose(robot, client)
            linear, angular = motion(robot, client)
            left, right = joints(robot, (0, 1), client)
            rows.append((*position, *orientation, *linear, *angular, *left[:2], *right[:2]))
        p.disconnect(client)
        return np.array(rows)


class Dart:
    """A skeleton of a free chassis and two revolute joints, with ODE's collision detector."""

    def __init__(self, step_s):
        import dartpy as dart

        self.world = dart.simulation.World()
        self.world.setGravity([0, 0, -G])
        self.world.setTimeStep(step_s)
        detector = dart.collision.OdeCollisionDetector()
        self.world.getConstraintSolver().setCollisionDetector(detector)
        # the solver that the robot's friction needs, as the backend has it
        options = dart.constraint.NsgsFrictionSolver.Options()
        options.tolerance, options.maxSweeps = 1e-6, 100
        solver = dart.constraint.NsgsFrictionSolver(options)
        self.world.getConstraintSolver().setBoxedLcpSolver(solver)
        self.robot = dart.dynamics.Skeleton("robot")
        _, chassis = self.robot.createFreeJointAndBodyNodePair()
        self._fill(dart, chassis, (BODY, BODY_MOMENTS), CASTER, 0.0, (-BEHIND, 0, CASTER - HEIGHT))
        self.joints = []
        for side in (1, -1):
            joint, wheel = self.robot.createRevoluteJointAndBodyNodePair(chassis)
            joint.setAxis([0, 1, 0])
            place = dart.math.Isometry3()
            place.set_translation([AHEAD, side * TRACK / 2, RADIUS - HEIGHT])
            joint.setTransformFromParentBodyNode(place)
            self._fill(dart, wheel, (WHEEL, WHEEL_MOMENTS), RADIUS, 0.6, (0, 0, 0))
            self.joints.append(joint)
        positions = self.robot.getPositions()
        positions[3:6] = [-AHEAD, 0, HEIGHT]
        self.robot.setPositions(positions)
        floor = dart.dynamics.Skeleton("floor")
        _, base = floor.createWeldJointAndBodyNodePair()
        ground = base.createShapeNode(dart.dynamics.PlaneShape([0, 0, 1], 0))
        ground.createCollisionAspect()
        ground.createDynamicsAspect().setFrictionCoeff(0.6)
        self.world.addSkeleton(self.robot)
        self.world.addSkeleton(floor)

    @staticmethod
    def _fill(dart, node, inertia, radius, friction, place):
        mass, moments = inertia
        held = dart.dynamics.Inertia()
        held.setMass(mass)
        held.setMoment(np.diag(moments))
        node.setInertia(held)
        shape = node.createShapeNode(dart.dynamics.SphereShape(radius))
        pose = dart.math.Isometry3()
        pose.set_translation(place)
        shape.setRelativeTransform(pose)
        shape.createCollisionAspect()
        shape.createDynamicsAspect().setFrictionCoeff(friction)

    def record(self, count):
        step, robot = self.world.step, self.robot
        left, right = (joint.setForce for joint in self.joints)
        positions, velocities, rows = robot.getPositions, robot.getVelocities, np.empty((count, 16))
        for i in range(count):
            left(0, TORQUE)
            right(0, TORQUE)
            step()
            rows[i, :8] = positions()
            rows[i, 8:] = velocities()
        return rows


ENGINES = {"mujoco": Mujoco, "pybullet": Pybullet, "dart": Dart}
