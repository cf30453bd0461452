"""Runs of a pendulum held against a made-up recording, for tests of reports."""

from dataclasses import replace

import numpy as np
import yaml

import simcompare
from simcompare.inference.reference_model import model_of
from simcompare.model import plain as json_values
from simcompare.results.records.validation import Validation
from simcompare.scenarios import catalogue
from tests import records

NOISE_RAD = 1e-3
EVIL = "<script>alert(1)</script>|x$y_{ \x1b[31m*b*"
ENGINES = "pymunk,mujoco"


def swing(start_rad):
    """Times and angles of a pendulum, measured with noise."""
    model = model_of(catalogue.load("pendulum"))
    scene = model.file.resolve(
        {"length_m": 0.25, "damping_N_m_s_rad": 4e-4, "friction_N_m": 0.0,
         "start_angle_rad": start_rad, "start_rate_rad_s": 0.0, "duration_s": 6.0}
    )  # fmt: skip
    time_s = np.arange(0, 6, 0.01)
    probe = scene.probes["angle_rad"]
    angle = model.truth(scene, time_s).signals[probe.observe] + probe.offset
    return time_s, angle + np.random.default_rng(0).normal(0, NOISE_RAD, len(time_s))


def known(value, u):
    """What a plan says of a parameter."""
    return {"value": value, "u": u, "source": "made up so"}


def make(folder):
    """A log and mapping files that say how it is judged, with and without a fit."""
    rows = [f"{t:.4f},{a:.6f}" for t, a in zip(*swing(0.9), strict=True)]
    (folder / "swing.csv").write_text("t (s),a (rad)\n" + "\n".join(rows) + "\n")
    entry = {
        "scenario": "pendulum",
        "parameters": {
            "length_m": known(0.24, 0.01), "damping_N_m_s_rad": known(3e-4, 2e-4),
            "friction_N_m": known(0.0, 0.0), "start_angle_rad": known(0.9, 1e-5),
            "start_rate_rad_s": known(0.0, 1e-5),
        },
        "compare": {"angle_rad": {"channel": "angle"}},
    }  # fmt: skip
    channels = {"angle": {"column": "a", "unit": "rad", "u": NOISE_RAD}}
    fit = {"calibrate": {"parameters": ["length_m", "damping_N_m_s_rad"]}}
    for name, more in (("known", {}), ("fitted", fit)):
        tree = {"channels": channels, "validate": [entry | more]}
        (folder / f"{name}.yaml").write_text(yaml.safe_dump(tree))
    return folder


def run_of(made, mapping):
    """A run on two engines with one of the mapping files."""
    return simcompare.validate(
        "pendulum", recording=str(made / "swing.csv"), mapping=made / f"{mapping}.yaml",
        engine=ENGINES,
    )  # fmt: skip


def plain(run):
    """What run.json says of a validation."""
    return json_values.plain(run.record.validation)


def changed(run, **more):
    """The same run with another record of its validation."""
    found = json_values.of_plain(Validation, plain(run) | more)
    return records.changed(run, validation=found)


def renamed(value, old, new):
    """The same tree with every text that is exactly ``old`` replaced."""
    if isinstance(value, dict):
        return {renamed(k, old, new): renamed(v, old, new) for k, v in value.items()}
    if isinstance(value, list):
        return [renamed(v, old, new) for v in value]
    return value.replace(old, new) if value == old else value


def streams(run, count):
    """The same run as if the log had held so many segments."""
    found = plain(run)
    names = [f"part {i}" for i in range(count)]
    several = dict(found)
    for key in ("waveforms", "values", "gaps", "cases", "agreement"):
        several[key] = [renamed(row, "log", name) for name in names for row in found[key]]
    for i, row in enumerate(several["waveforms"]):
        row["nrmse"] = 0.01 * (1 + i // len(found["waveforms"]))
    trajectories = tuple(replace(s, segment=i)
                         for i in range(count) for s in run.trajectories)  # fmt: skip
    several["alignments"] = [None] * count
    return replace(changed(run, **several), trajectories=trajectories)


def hostile(run):
    """The same run with names from files that mean harm."""
    found = renamed(plain(run), "log", EVIL)
    found["provenance"]["repairs"] = [
        {"rule": "bad", "severity": "repair", "text": f"found {EVIL}", "stream": EVIL,
         "channel": EVIL, "rows": [[3, 5], [9, 9]], "count": 4, "before": {"max": 9.0},
         "after": {"max": 1.0}}
    ]  # fmt: skip
    found["provenance"]["conversions"] = [
        {"raw": EVIL, "raw_unit": EVIL, "channel": EVIL, "unit": "rad", "factor": 1.0,
         "offset": 0.0, "reason": EVIL}
    ]  # fmt: skip
    found["about"] = {"title": EVIL, EVIL: EVIL}
    found["compare"]["angle_rad"]["channel"] = EVIL
    found["note"] = EVIL
    found["sentences"] = [f"The worst is {EVIL}."]
    found["events"] = [
        {"name": EVIL, "time_s": 1.0, "stream": EVIL, "u_s": 0.1, "value": None}
    ]  # fmt: skip
    return changed(run, **found)


def cells(table):
    """Rows of all groups of a table."""
    return [row for group in table.groups for row in group.rows]
