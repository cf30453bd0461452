"""A window of any length is judged: no step has to divide it."""

import math

import numpy as np
import pytest
import yaml

import simcompare
from simcompare.errors import InputError
from simcompare.hardware.recordings import registry
from simcompare.inference import plan as plans
from simcompare.inference import sources
from simcompare.inference.compared_values import compared_values
from simcompare.inference.evaluated import evaluate
from simcompare.inference.reference_model import model_of, whole_steps_s
from simcompare.inference.segment_reader import segments_of
from simcompare.inference.simulated import BEST, DOUBLE, FOURFOLD, NOMINAL, Engine, of_probes
from simcompare.inference.simulated import scenes as scenes_of
from simcompare.scenarios import catalogue
from simcompare.validation.signals import gaps, spread, waveforms
from tests import validated

#: recording, scenario and the length about which windows are tried [s]
RECORDED = [
    ("pendulum_torque_limited_sac", "pendulum_torque", 4.5),
    ("pendulum_torque_limited", "pendulum_torque", 2.7),
    ("pendulum_free_swing", "pendulum", 1.49),
    ("pendulum_double_free_swing", "pendulum_double", 1.2),
    ("servo_pendulum_xl330", "pendulum_servo", 3.3),
    ("motor_step_esp32", "motor_step", 1.7),
    ("odometry_plaza", "odometry", 33.0),
    ("robot_labyrinth_exchanged", "odometry", 11.0),
    ("imu_broad_translation", "imu_rest", 1.1),
]


def plan_of(source, scenario):
    return plans.checked(
        plans.choose(source.plans, scenario), catalogue.load(scenario).resolve(), source.plans
    )


def of_length(plan, length_s):
    window = plan.window.model_copy(update={"duration_s": float(length_s)})
    return plan.model_copy(update={"window": window})


def engine_of(model, segment):
    """The reference as an engine that is run with every step that a validation wants."""
    scenes = scenes_of(model, segment, None, None)
    runs = {
        (0, variant): of_probes(scene, model.truth(scene), segment.watched)
        for variant, scene in scenes.items()
    }
    return Engine("made", (), runs | {(0, NOMINAL): runs[0, BEST]})


def numbers_of(source, scenario, length_s):
    """Every number that a validation of the window prints."""
    model = model_of(catalogue.load(scenario))
    plan = of_length(plan_of(source, scenario), length_s)
    (segment, *_) = segments_of(model.file, plan, source.recording, plan.streams, {})
    one = evaluate(model, plan, segment, None, None)
    engine = engine_of(model, segment)
    assert {DOUBLE, FOURFOLD} <= {variant for _, variant in engine.runs}
    for row in waveforms(engine, 0, one, plan, fitted=False):
        yield from (row.rmse, row.max_abs)
    for row in gaps(engine, 0, one, plan):
        yield row.total
    for row in compared_values(engine, 0, one):
        yield from (row.error, row.u_num, row.u_data)
    yield from (row.size for row in spread([engine, engine], 0, one))


@pytest.mark.parametrize(("name", "scenario", "about_s"), RECORDED)
def test_a_window_of_any_length_is_judged(name, scenario, about_s):
    if registry.place(name) is None:
        pytest.skip(f"{name} is not on this machine")
    source = sources.find(name)
    step_s = catalogue.load(scenario).resolve().world.step_s
    # remainders of all steps; the longest is four of the scenario
    for length_s in about_s + step_s * np.arange(0, 4, 0.7):
        found = list(numbers_of(source, scenario, length_s))
        assert found
        assert np.isfinite(found).all(), length_s


def test_engines_are_judged_where_no_step_divides_the_window(tmp_path):
    made = validated.make(tmp_path)
    tree = yaml.safe_load((made / "known.yaml").read_text())
    for length_s in (3.018, 3.019, 3.0195):  # the longest step is 4 ms
        tree["validate"][0]["window"] = {"duration_s": length_s}
        (made / "window.yaml").write_text(yaml.safe_dump(tree))
        found = simcompare.validate(
            "pendulum", recording=made / "swing.csv", mapping=made / "window.yaml", engine="pymunk"
        )
        (row,) = found.record.validation.waveforms
        assert (row.n, row.masked) == (math.floor(length_s / 0.01) + 1, 0)


def test_a_window_without_samples_is_one_sentence(tmp_path):
    made = validated.make(tmp_path)
    tree = yaml.safe_load((made / "known.yaml").read_text())
    tree["validate"][0]["window"] = {"duration_s": 0.02}
    (made / "window.yaml").write_text(yaml.safe_dump(tree))
    with pytest.raises(InputError, match=r"make duration_s of window: .* longer"):
        simcompare.validate(
            "pendulum", recording=made / "swing.csv", mapping=made / "window.yaml", engine="pymunk"
        )


def test_whole_steps_reach_the_end_and_are_no_longer_than_a_step_more():
    generator = np.random.default_rng(0)
    for duration_s in generator.uniform(0.01, 100, 2000):
        for step_s in (0.001, 0.002, 0.008, 1 / 240, 1 / 3):
            found = whole_steps_s(duration_s, step_s)
            assert duration_s <= found < duration_s + 2 * step_s
            assert round(found / step_s) * step_s >= duration_s
