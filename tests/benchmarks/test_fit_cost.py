"""Processor time of a whole fit of a clip of 20 impacts in air, one engine at a time.

All that the command takes counts: its start, the closed forms, the engine's own process and the
report. The bar is 3 s an engine.
"""

import resource
import subprocess
import sys

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.fitting.bounces.bounce_models import MODELS, bounces

#: a drop from 6 m with heavy drag and a restitution that depends on speed
DROP = {"restitution": 0.9, "exponent": 0.02, "terminal_speed_m_s": 8.0, "drop_height_m": 6.0}
IMPACTS = 20
#: error of an instant [s]
U_S = 1e-5


@pytest.fixture(scope="module")
def intervals(tmp_path_factory):
    """Times between impacts, as a telephone exports them."""
    times = bounces(MODELS["power+drag"], DROP, IMPACTS).impact_s
    heard = times + np.random.default_rng(0).normal(0, U_S, IMPACTS)
    rows = [f"{k + 1},{between:.9f}" for k, between in enumerate(np.diff(heard))]
    path = tmp_path_factory.mktemp("fit") / "intervals.csv"
    path.write_text("\n".join(['"Bounce","Time interval (s)"', *rows]) + "\n", encoding="utf-8")
    return path


def spent_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@pytest.mark.parametrize("engine", engines.names())
def test_processor_time_of_a_fit(benchmark, engine, intervals, tmp_path):
    command = [sys.executable, "-m", "simcompare", "fit", "ball", "--recording", str(intervals),
               "--engine", engine, "--out", str(tmp_path)]  # fmt: skip
    taken = []

    def fit():
        before = spent_s()
        # 2: the engine cannot bounce so at the scenario's step, which is found out as dearly
        assert subprocess.run(command, capture_output=True, check=False).returncode in (0, 2)
        taken.append(spent_s() - before)

    benchmark.group = "fit of 20 impacts in air"
    benchmark.pedantic(fit, rounds=3)
    benchmark.extra_info["processor_s"] = min(taken)
