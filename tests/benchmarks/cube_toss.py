"""The real cube tosses on every engine: the published rows first, then what is fitted here.

    SIMCOMPARE_DATA=<folder> python -m tests.benchmarks.cube_toss --engine mujoco --scale published

Published for MuJoCo: 25.1 ± 10.8 % of the width and 21.7 ± 21.4° (Acosta, Yang and Posa 2022,
arXiv:2110.00541: 550 tosses from just before the first touch on, in steps of 0.68 ms), and 23.74 ±
9.19 % and 15.34 ± 17.4° (omnilink-tech/omnisim, lane 1R: 150 held-out tosses from their first
sample on, in steps of 0.5 ms). Both published their parameters (the former in DAIRLab/dairlib),
which are put into MuJoCo by hand here, without any backend of ours.
"""

import argparse
import functools
import math
import time

import numpy as np

from simcompare.engine import engines as backends
from simcompare.fitting.tosses import engines, tosses
from simcompare.fitting.tosses.replay import Replay
from simcompare.fitting.tosses.roles import roles_of
from simcompare.fitting.tosses.search import interval
from simcompare.fitting.tosses.setup import FITTED, SEED, Setup, of_recording
from simcompare.hardware import mapping
from simcompare.hardware.importing import read
from simcompare.hardware.recordings import registry
from simcompare.model import rotations
from simcompare.scenarios import catalogue

ENGINES = ("mujoco", "pybullet", "dart")
#: normal gravity in Philadelphia, WGS 84 at 39.95° of latitude [m/s²]
GRAVITY_M_S2 = 9.8017
CONTACT, EVERY = ("friction", "restitution"), ("friction", "restitution", "inertia_kg_m2")

#: name -> stiffness [1/s²], damping [1/s], friction, cone, impratio, steps in a sample, window
PUBLISHED = {
    "Acosta et al. 2022: 25.1 ± 10.8 %, 21.7 ± 21.4°": (
        3851.911388249514, 63.19506520795675, 0.23073491268082835, "pyramidal", 1, 10, "touch",
    ),
    "OmniBench lane 1R: 23.74 ± 9.19 %, 15.34 ± 17.4°": (
        2500.0, 67.1, 0.22, "elliptic", 10, 14, "whole",
    ),
}  # fmt: skip


@functools.cache
def recorded():
    """All tosses as published."""
    (path,) = registry.locate("cube_toss")
    wanted = mapping.Mapping.model_validate(registry.get("cube_toss").read)
    return of_recording(read(path, wanted))[0]


def from_touch(toss, width_m):
    """The end of a toss, with the start of it that the paper's own code reads off.

    It begins one sample before the centre is as low as half a diagonal of the cube. The velocity is
    that of the samples before, level by the first and the last of them, and the rate the turn since
    the first sample.
    """
    low = np.flatnonzero(toss.position_m[:, 2] <= width_m * math.sqrt(3) / 2)
    first = max(int(low[0]) - 1, 4)
    time_s, place = toss.time_s[:first], toss.position_m[:first]
    line = np.column_stack((np.ones(first), time_s))
    fall = 9.81 / 2 * time_s**2
    velocity = (place[-1] - place[0]) / time_s[-1]
    velocity[2] = np.linalg.lstsq(line, place[:, 2] + fall, rcond=None)[0][1] - 9.81 * time_s[-1]
    turn = rotations.multiply(
        rotations.conjugate(toss.orientation_wxyz[:1]), toss.orientation_wxyz[first : first + 1]
    )
    rate = rotations.rotation_vectors_of(turn)[0] / toss.time_s[first]
    cut = tosses.Toss(
        toss.name,
        toss.time_s[first:] - toss.time_s[first],
        toss.position_m[first:],
        toss.orientation_wxyz[first:],
    )
    return cut, (velocity, rate)


def published(found, width_m=0.1048):
    """Errors of the tosses in MuJoCo with each set of published parameters."""
    import mujoco

    rows = {}
    for name, (k, b, mu, cone, impratio, steps, window) in PUBLISHED.items():
        half, friction = width_m / 2, f'friction="{mu} 0.005 0.0001"'
        model = mujoco.MjModel.from_xml_string(
            f"""<mujoco><option timestep="{1 / 148 / steps}" cone="{cone}" impratio="{impratio}"
            gravity="0 0 -9.81"><flag refsafe="disable"/></option><worldbody>
            <geom type="plane" size="5 5 .1" solref="-{k} -{b}" {friction}/><body><freejoint/>
            <inertial pos="0 0 0" mass="0.37" diaginertia="0.00081 0.00081 0.00081"/>
            <geom type="box" size="{half} {half} {half}" {friction}/></body></worldbody></mujoco>"""
        )
        data, rows[name] = mujoco.MjData(model), []
        for whole in found:
            start = tosses.start_of(whole, width_m, GRAVITY_M_S2)
            toss, motion = whole, (start.velocity_m_s, start.rate_rad_s)
            if window == "touch":
                toss, motion = from_touch(whole, width_m)
            mujoco.mj_resetData(model, data)
            data.qpos[:] = np.concatenate((toss.position_m[0], toss.orientation_wxyz[0]))
            data.qvel[:] = np.concatenate(motion)
            poses = np.empty((len(toss.time_s), 7))
            for pose in poses:
                pose[:] = data.qpos
                mujoco.mj_step(model, data, steps)
            rows[name].append(tosses.errors(toss, poses[:, :3], poses[:, 3:], width_m))
    return rows


def told(rows):
    """Position and rotation error with 95 % intervals, in one line."""
    parts = []
    for i, unit in ((0, "%"), (1, "°")):
        one = interval([row[i] for row in rows])
        low, high = one.interval95
        parts.append(f"{one.mean:.2f} ± {one.sd:.2f} {unit} (mean within {low:.2f} to {high:.2f})")
    return ", ".join(parts) + f", {len(rows)} tosses"


def fitted(roles, engine, parts, names, which):
    """Prints what a fit to the first part finds and how far it is off in the second."""
    started = time.perf_counter()
    grids = {name: roles.fit.grids[name] for name in names}
    setup = Setup(grids, *map(tuple, parts), 1.0, (), ())
    (found,) = engines.fit_engines(roles, setup, [engine], engines.How())
    best, search = found.search.best, found.search
    values = ", ".join(f"{name} {value:.4g}" for name, value in search.values(best).items())
    print(
        f"scale {which}, {engine}: {values}; corners {search.cost(best):.2f} % off in training,"
        f" {len(search.tried)} points, {time.perf_counter() - started:.0f} s"
    )
    print(f"  held out: {told(found.held)}", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--engine", nargs="*", default=ENGINES)
    parser.add_argument("--scale", nargs="*", default=["published", "corrected"])
    parser.add_argument("--unknowns", nargs="*", type=int, default=[0, 2, 3])
    parser.add_argument("--train", type=int, default=FITTED)
    parser.add_argument("--test", type=int, default=None, help="all others where not given")
    asked = parser.parse_args()
    found, roles = recorded(), roles_of(catalogue.load("cube_toss"), {})
    width = roles.width_m({})
    witnesses = tosses.witnesses(found, width, GRAVITY_M_S2)
    scale = tosses.combined(witnesses)
    for witness in (*witnesses, scale):
        print(f"scale by {witness.name}: {witness.scale:.4f}, u = {witness.u:.4f}: {witness.text}")
    for name, rows in published(found, width).items():
        print(f"published {name}; here {told(rows)}")
    for which in asked.scale:
        factor = scale.scale if which == "corrected" else 1.0
        put = [toss.scaled(factor) for toss in found]
        test = asked.test or len(put) - asked.train
        train, held_out = tosses.split(put, asked.train, test, SEED)
        for engine in asked.engine:
            for names in (CONTACT, EVERY):
                if len(names) in asked.unknowns:
                    fitted(roles, engine, (train, held_out), names, which)
            if 0 in asked.unknowns:
                # what the authors measured is what the scenario begins with
                backend = backends.get(engine)
                authors = [Replay(roles, toss, {})(backend).errors for toss in held_out]
                print(f"scale {which}, {engine}, as the authors measured: {told(authors)}")


if __name__ == "__main__":
    main()
