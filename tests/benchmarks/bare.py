"""The same drops by hand for each engine: what a careful user would write without simcompare.

Every class builds the scene, steps it and records position, orientation, velocity and rate of the
ball at every step through the engine's own API. Run as a script it does the drops of
``simcompare run ball --engine all`` one after another: nine heights, with the engine's defaults
and twice with the restitution set by hand.
"""

import numpy as np

RADIUS, MASS, INERTIA, G, E = 0.02, 0.0027, 7.2e-7, 9.80665, 0.8
#: MuJoCo's spring and damper: with one step, and with ten steps, in each recorded one
SOLREF = {"tuned": "-114000 -49.7", "assisted": "-100000000 -1487"}


class Mujoco:
    """A compiled model; bouncing needs ten steps within each recorded one."""

    def __init__(self, drop, step_s, contact):
        import mujoco

        self.mujoco, self.substeps = mujoco, 10 if contact == "assisted" else 1
        spring = f'solref="{SOLREF[contact]}" solimp=".99 .99 .001"' if contact in SOLREF else ""
        self.model = mujoco.MjModel.from_xml_string(
            f"""<mujoco><option timestep="{step_s / self.substeps}" gravity="0 0 {-G}"/>
            <worldbody>
            <geom type="plane" size="0 0 1" {spring}/><body pos="0 0 {RADIUS + drop}"><freejoint/>
            <geom type="sphere" size="{RADIUS}" mass="{MASS}" {spring}/></body>
            </worldbody></mujoco>"""
        )
        self.data = mujoco.MjData(self.model)

    def record(self, count):
        step, model, data, substeps = self.mujoco.mj_step, self.model, self.data, self.substeps
        rows = np.empty((count, 13))
        qpos, qvel = data.qpos, data.qvel
        for i in range(count):
            step(model, data, substeps)
            rows[i, :7] = qpos
            rows[i, 7:] = qvel
        return rows


class Pybullet:
    """A client in DIRECT mode."""

    def __init__(self, drop, step_s, contact):
        import pybullet

        self.p, self.client = pybullet, pybullet.connect(pybullet.DIRECT)
        p, at = pybullet, {"physicsClientId": self.client}
        p.setGravity(0, 0, -G, **at)
        p.setTimeStep(step_s, **at)
        plane = p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE, **at), **at)
        shape = p.createCollisionShape(p.GEOM_SPHERE, radius=RADIUS, **at)
        self.ball = p.createMultiBody(MASS, shape, -1, [0, 0, RADIUS + drop], **at)
        if contact != "default":
            p.setPhysicsEngineParameter(erp=0, contactERP=0, restitutionVelocityThreshold=0, **at)
            p.changeDynamics(plane, -1, restitution=1, contactProcessingThreshold=0, **at)
            p.changeDynamics(
                self.ball, -1, restitution=E, linearDamping=0, contactProcessingThreshold=0, **at
            )

    def record(self, count):
        step, pose, motion = (
            self.p.stepSimulation,
            self.p.getBasePositionAndOrientation,
            self.p.getBaseVelocity,
        )
        ball, client, rows = self.ball, self.client, []
        for _ in range(count):
            step(client)
            position, orientation = pose(ball, client)
            linear, angular = motion(ball, client)
            rows.append((*position, *orientation, *linear, *angular))
        self.p.disconnect(client)
        return np.array(rows)


class Pymunk:
    """A space with one segment and one circle."""

    def __init__(self, drop, step_s, contact):
        import pymunk

        self.space, self.step_s = pymunk.Space(), step_s
        self.space.gravity = (0, -G)
        floor = pymunk.Segment(self.space.static_body, (-100, 0), (100, 0), 0)
        self.ball = pymunk.Body(MASS, INERTIA)
        self.ball.position = (0, RADIUS + drop)
        circle = pymunk.Circle(self.ball, RADIUS)
        if contact != "default":
            self.space.collision_slop = 1e-4
            floor.elasticity, circle.elasticity = 1, E
        self.space.add(self.ball, floor, circle)

    def record(self, count):
        step, step_s, ball, rows = self.space.step, self.step_s, self.ball, []
        for _ in range(count):
            step(step_s)
            rows.append((*ball.position, *ball.velocity, ball.angle, ball.angular_velocity))
        return np.array(rows)


class Dart:
    """A world with two skeletons."""

    def __init__(self, drop, step_s, contact):
        import dartpy as dart

        self.world = dart.simulation.World()
        self.world.setGravity([0, 0, -G])
        self.world.setTimeStep(step_s)
        self.ball = dart.dynamics.Skeleton("ball")
        _, body = self.ball.createFreeJointAndBodyNodePair()
        solid = body.createShapeNode(dart.dynamics.SphereShape(RADIUS))
        body.setMass(MASS)
        self.ball.setPositions([0, 0, 0, 0, 0, RADIUS + drop])
        floor = dart.dynamics.Skeleton("floor")
        _, base = floor.createWeldJointAndBodyNodePair()
        ground = base.createShapeNode(dart.dynamics.PlaneShape([0, 0, 1], 0))
        for shape, e in ((solid, E), (ground, 1.0)):
            shape.createCollisionAspect()
            aspect = shape.createDynamicsAspect()
            if contact != "default":
                aspect.setRestitutionCoeff(e)
        self.world.addSkeleton(self.ball)
        self.world.addSkeleton(floor)

    def record(self, count):
        step, positions, velocities = (
            self.world.step,
            self.ball.getPositions,
            self.ball.getVelocities,
        )
        rows = np.empty((count, 12))
        for i in range(count):
            step()
            rows[i, :6] = positions()
            rows[i, 6:] = velocities()
        return rows


ENGINES = {"mujoco": Mujoco, "pybullet": Pybullet, "pymunk": Pymunk, "dart": Dart}


def main():
    for engine in ENGINES.values():
        for contact in ("default", "tuned", "assisted"):
            for i in range(9):
                engine(1.0 + (i - 4) / 9 * 0.0044, 0.001, contact).record(4155)


if __name__ == "__main__":
    main()
