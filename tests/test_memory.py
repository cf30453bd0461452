"""More repeats or samples than a machine can hold are refused before any is made."""

import pytest

from simcompare.comparison import memory
from simcompare.comparison.repeats import at_steps, repeats_of
from simcompare.errors import InputError
from simcompare.scenarios import catalogue


@pytest.fixture(autouse=True)
def machine(monkeypatch):
    monkeypatch.setattr(memory, "total", lambda: 10**9)


def fault_of(count, sources=1, step_s=None, name="ball"):
    with pytest.raises(InputError) as fault:
        repeats_of(catalogue.load(name), {}, None, step_s, count, sources)
    return str(fault.value)


def test_as_many_repeats_as_are_named_do_fit():
    most = int(fault_of(10**6, 4).rpartition("at most ")[2].split()[0])
    assert len(repeats_of(catalogue.load("ball"), {}, None, None, most, 4)) == most
    assert f"--seeds: {most + 1} repeats of 4106 samples" in fault_of(most + 1, 4)


def test_where_not_one_fits_the_step_is_the_cure():
    assert fault_of(None, 20, 1e-6, "robot").endswith("use a longer --step or fewer engines")


def test_a_count_in_a_scenario_is_held_against_it_too(write):
    path = write(
        "many.yaml", f"extends: {catalogue.load('ball').path}\ndither: {{count: 99999999999}}\n"
    )
    with pytest.raises(InputError, match="ball: 99999999999 repeats of"):
        repeats_of(catalogue.load(str(path)), {}, None, None, None)


def test_many_steps_are_counted_together_before_any_is_made():
    steps_s = [1e-6 * i for i in range(1, 3000)]
    with pytest.raises(InputError) as fault:
        at_steps(catalogue.load("ball"), {}, None, steps_s, None, 1)
    assert str(fault.value).startswith("--step: 9 repeats of 35235584 samples at 2999 steps need ")
    assert str(fault.value).endswith("; use fewer or longer steps, or fewer engines")
