"""Bodies in space with hinges and contacts as constraints: a truth that knows no closed form.

For every body Newton and Euler; for every hinge five equations of its acceleration, for a tyre that
rolls three, for one that slides two, for the caster one. In each moment that is one linear system
for all accelerations and forces, integrated by DOP853. Everything is read from a scenario.
"""

import numpy as np
from scipy.integrate import solve_ivp

from simcompare.model.rotations import matrix_of

UP = np.array([0.0, 0.0, 1.0])


def cross(vector):
    """Matrix of the product vector × …"""
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


class Robot:
    """A chassis on a caster, with wheels on hinges.

    Args:
        scenario: the scene; its moving bodies are a chassis and wheels, every shape a sphere.
        torque: (time, hinge, its rate) -> torque on the hinge's child.
        sliding: whether tyres spin, so that traction is friction times load.
        armature: of every hinge.
    """

    def __init__(self, scenario, torque, sliding=False, armature=0.0):
        self.scenario, self.torque = scenario, torque
        self.sliding, self.armature = sliding, armature
        self.bodies = list(scenario.moving_bodies())
        self.size = 6 * len(self.bodies)

    def start(self):
        parts = []
        for name in self.bodies:
            body = self.scenario.bodies[name]
            parts += [*body.position_m, *body.orientation_wxyz, *np.zeros(6)]
        return np.array(parts)

    def split(self, state):
        names = zip(self.bodies, state.reshape(-1, 13), strict=True)
        return {
            name: (x[:3], matrix_of(x[3:7] / np.linalg.norm(x[3:7])), x[7:10], x[10:])
            for name, x in names
        }

    def columns(self, name, linear, angular):
        """A row of the constraint matrix, or a force direction: what acts on one body."""
        row = np.zeros(self.size)
        i = 6 * self.bodies.index(name)
        row[i : i + 3], row[i + 3 : i + 6] = linear, angular
        return row

    def solve(self, time_s, state):
        """All accelerations, and the loads of the contacts by body."""
        motion, scenario = self.split(state), self.scenario
        mass, force = np.zeros((self.size, self.size)), np.zeros(self.size)
        gravity = np.array(scenario.world.gravity_m_s2)
        for k, name in enumerate(self.bodies):
            body, (_, turn, _, rate) = scenario.bodies[name], motion[name]
            inertia = turn @ np.diag(body.inertia_kg_m2) @ turn.T
            i = 6 * k
            mass[i : i + 3, i : i + 3] = body.mass_kg * np.eye(3)
            mass[i + 3 : i + 6, i + 3 : i + 6] = inertia
            force[i : i + 3] = body.mass_kg * gravity
            force[i + 3 : i + 6] = -np.cross(rate, inertia @ rate)
        rows, pushes, right, loads = [], [], [], {}
        for name, joint in scenario.joints.items():
            _, turn, _, rate = motion[joint.parent]
            _, _, _, child_rate = motion[joint.child]
            axis = turn @ np.array(joint.axis)
            spin = self.columns(joint.child, 0, axis) - self.columns(joint.parent, 0, axis)
            force += spin * self.torque(time_s, name, axis @ (child_rate - rate))
            mass += self.armature * np.outer(spin, spin)
            arm = turn @ np.array(joint.anchor_m)
            for e in np.eye(3):  # the anchor is the child's centre here
                rows.append(
                    self.columns(joint.child, e, 0)
                    - self.columns(joint.parent, e, np.cross(arm, e))
                )
                right.append(e @ np.cross(rate, np.cross(rate, arm)))
            for e in (turn @ np.array(v) for v in _perpendicular(joint.axis)):
                rows.append(self.columns(joint.child, 0, e) - self.columns(joint.parent, 0, e))
                right.append(-np.cross(rate, e) @ (child_rate - rate))
            pushes += rows[-5:]
            self.tyre(joint.child, turn, rows, pushes, right, loads)
        self.caster(motion, rows, pushes, right, loads)
        system = np.block(
            [[mass, -np.array(pushes).T], [np.array(rows), np.zeros((len(rows), len(rows)))]]
        )
        found = np.linalg.lstsq(system, np.concatenate([force, right]), rcond=1e-13)[0]
        return found[: self.size], {name: found[self.size + k] for name, k in loads.items()}

    def tyre(self, name, turn, rows, pushes, right, loads):
        radius = self.scenario.bodies[name].shapes[0].radius_m
        friction = self.scenario.contact_of(name, "floor").friction
        down, ahead, aside = -radius * UP, turn[:, 0], turn[:, 1]
        loads[name] = len(pushes)
        at = {
            k: self.columns(name, e, np.cross(down, e))
            for k, e in (("up", UP), ("ahead", ahead), ("aside", aside))
        }
        rows += [self.columns(name, UP, 0), at["aside"]]
        pushes += [at["up"] + self.sliding * friction * at["ahead"], at["aside"]]
        # straight below the centre, so that the rate at which the contact moves has no more terms
        right += [0.0, 0.0]
        if not self.sliding:
            rows.append(at["ahead"])
            pushes.append(at["ahead"])
            right.append(0.0)

    def caster(self, motion, rows, pushes, right, loads):
        _, turn, _, rate = motion["chassis"]
        shape = self.scenario.bodies["chassis"].shapes[0]
        friction = self.scenario.contact_of("chassis", "floor").friction
        arm = turn @ np.array(shape.position_m)
        down = arm - shape.radius_m * UP
        drag = -friction * turn[:, 0]
        loads["chassis"] = len(pushes)
        rows.append(self.columns("chassis", UP, np.cross(arm, UP)))
        pushes.append(self.columns("chassis", UP + drag, np.cross(down, UP + drag)))
        right.append(-UP @ np.cross(rate, np.cross(rate, arm)))

    def derivative(self, time_s, state):
        accelerations, _ = self.solve(time_s, state)
        change = np.empty_like(state).reshape(-1, 13)
        for k, x in enumerate(state.reshape(-1, 13)):
            w, u, rate = x[3], x[4:7], x[10:]
            change[k, :3] = x[7:10]
            change[k, 3] = -rate @ u / 2
            change[k, 4:7] = (w * rate + np.cross(rate, u)) / 2
            change[k, 7:] = accelerations[6 * k : 6 * k + 6]
        return change.ravel()

    def positions(self, time_s, start=None, tolerance=1e-12):
        """Position (n, 3), orientation (n, 4), velocity (n, 3) and rate (n, 3) of every body."""
        first = self.start() if start is None else start
        found = solve_ivp(
            self.derivative, (time_s[0], time_s[-1]), first, "DOP853",
            t_eval=time_s, rtol=tolerance, atol=tolerance,
        )  # fmt: skip
        parts = found.y.T.reshape(len(time_s), -1, 13)
        return {
            name: (parts[:, k, :3], parts[:, k, 3:7], parts[:, k, 7:10], parts[:, k, 10:])
            for k, name in enumerate(self.bodies)
        }


def _perpendicular(axis):
    """Two directions at right angles to an axis and to each other."""
    other = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = np.cross(axis, other)
    return first, np.cross(axis, first)
