"""A replay as the values that the page's own script plays."""

from __future__ import annotations

import base64
import json
from typing import Any

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.reports.render.meshes import Mesh
from simcompare.reports.render.replays import Actor, Eye, Motion, Replay

Json = dict[str, Any]
#: digits of a corner: a tenth of a micrometre
_DIGITS = 7
#: parts of a quaternion are whole numbers: 1 is this one
_ONE = 32767
#: ranges are whole numbers: the reach is this one, 0 is nothing
_FAR = 65535


def embedded(replay: Replay) -> str:
    """A replay as JSON that can stand inside of a script element."""
    text = json.dumps(as_dict(replay), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def as_dict(replay: Replay) -> Json:
    """A replay as plain values; places of bodies are packed as base64."""
    return {
        "begin": float(replay.time_s[0]),
        "end": float(replay.time_s[-1]),
        "count": len(replay.time_s),
        "bodies": {name: _mesh(mesh) for name, mesh in replay.bodies.items()},
        "still": _mesh(replay.still),
        "ground": _mesh(replay.ground),
        "levels": replay.levels,
        "actors": [_actor(actor, replay) for actor in replay.actors],
        "low": replay.low_m.tolist(),
        "high": replay.high_m.tolist(),
        "across": replay.across,
        "width": replay.width_m,
        "flat": replay.is_flat,
        "upright": replay.is_upright,
        "eyes": {name: _eye(eye) for name, eye in replay.eyes.items()},
    }


def _mesh(mesh: Mesh) -> Json:
    corners = np.round(mesh.corners, _DIGITS).T.tolist()
    tones = np.round(mesh.tones, 2).tolist()
    return {"corners": corners, "triangles": mesh.triangles.T.tolist(), "tones": tones}


def _eye(eye: Eye) -> Json:
    rays = np.round(eye.rays, _DIGITS).tolist()
    at = np.round(eye.origin_m, _DIGITS).tolist()
    return {"body": eye.body, "at": at, "rays": rays, "reach": eye.reach_m}


def _actor(actor: Actor, replay: Replay) -> Json:
    return {
        "label": actor.label,
        "colour": actor.colour,
        "level": actor.level,
        "motions": {name: _motion(motion) for name, motion in actor.motions.items()},
        "ranges": {
            name: _packed(np.nan_to_num(values / replay.eyes[name].reach_m) * _FAR, "<u2")
            for name, values in actor.ranges.items()
        },
    }


def _motion(motion: Motion) -> Json:
    turns = np.round(motion.orientation_wxyz * _ONE)
    return {"at": _packed(motion.position_m, "<f4"), "turn": _packed(turns, "<i2")}


def _packed(values: Array, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")
