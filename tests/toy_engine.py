"""A small engine on the kit, for tests of the kit: semi-implicit Euler of free bodies."""

from __future__ import annotations

import numpy as np

from simcompare.kit import EngineBackend, Feature, Held, PipPackage, ReducedSimulation, Traits


class ToySimulation(ReducedSimulation):
    """Bodies that fall, and a floor that bounces with e in the step that finds it touched."""

    def __init__(self, scene, rounded):
        super().__init__(scene)
        self.rounded, self.q, self.v = rounded, {}, {}
        self.place_all()

    def get(self, name):
        return self.q[name], self.v[name]

    def put(self, name, q, v):
        self.q[name] = self.rounded(self.q[name] if q is None else q)
        self.v[name] = self.rounded(v)

    def set_engine_step(self, step_s):
        pass

    def take_steps(self, count):
        gravity = self.scenario.world.gravity_m_s2
        for _ in range(count):
            for name in self._free:
                q, v = map(list, self.get(name))
                for i in range(3):
                    v[i] += gravity[i] * self.step_now_s
                    q[i] += v[i] * self.step_now_s
                self.put(name, q, v)

    def held_of_world(self):
        world = self.scenario.world
        return {
            "step_s": Held("dt", world.engine_step_s),
            "gravity_m_s2": Held("g", world.gravity_m_s2),
        }

    def held_of_body(self, body):
        held = self.scenario.bodies[body]
        return {
            "mass_kg": Held("mass", self.rounded([held.mass_kg])[0]),
            "inertia_kg_m2": Held("inertia", self.rounded(held.inertia_kg_m2)),
            "position_m": Held("place", self.q[body][:3]),
            "size_m": [Held("radius", self.rounded([shape.radius_m])[0]) for shape in held.shapes],
        }

    def held_of_pair(self, first, second):
        return {"restitution": Held("e", 0.0, 0.0), "friction": Held("mu", 0.0, 0.0)}


class ToyBackend(EngineBackend):
    """The toy, in double or single precision, with what a test changes of it."""

    name = "toy"
    library = PipPackage("colorsys", "pip install toy", ["numpy"])
    features = frozenset({Feature.SPATIAL, Feature.FREE_BODY, Feature.SPHERE, Feature.PLANE})
    known_limits = ()
    mapping = "none"

    def __init__(self, simulation=ToySimulation, dtype=np.float64, **traits):
        self.simulation, self.dtype = simulation, dtype
        self.traits = Traits(bounces_by="", **traits)

    def make(self, engine, scene):
        return self.simulation(scene, lambda values: np.asarray(values, self.dtype).tolist())
