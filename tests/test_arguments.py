"""Arguments that make no sense are refused with one error of ours."""

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import simcompare
from simcompare.arguments import checked, fits, words
from simcompare.errors import InputError


@pytest.mark.parametrize(
    ("value", "hint"),
    [
        ("a", str),
        (np.int64(3), int),
        (np.float32(0.5), float),
        (3, float),
        (None, int | None),
        (Path("a"), str | Path),
        (["a"], str | Sequence[str]),
        (np.array(["a"]), Sequence[str]),
        (pd.Index(["a"]), Sequence[str]),
        ({"a": "1m", "b": 2}, Mapping[str, str | float]),
        ((1.0, 0.1), tuple[float, float]),
        (print, Callable[[str], None]),
    ],
)
def test_what_fits(value, hint):
    assert fits(value, hint)


@pytest.mark.parametrize(
    ("value", "hint", "expected"),
    [
        ("3", int | None, "a whole number"),
        (2.5, int, "a whole number"),
        (True, int, "a whole number"),
        (1, bool, "True or False"),
        ("ab", Sequence[str], "a list of text"),
        ([1], str | Sequence[str], "text or a list of text"),
        ({1: 1}, Mapping[str, float], "a dictionary of names with a number"),
        ({"a": None}, Mapping[str, str | float], "a dictionary of names with text or a number"),
        ((1.0,), tuple[float, float], "2 of a number"),
        (3, Callable[[str], None], "a function"),
        (3, str | Path | None, "text or a path"),
    ],
)
def test_what_does_not_fit_is_told_in_words(value, hint, expected):
    assert not fits(value, hint)
    assert words(hint) == expected


def test_all_faults_are_told_at_once():
    def bounce(height: float, *, times: int | None = None) -> None:
        """Bounces."""

    with pytest.raises(InputError) as caught:
        checked(bounce)("high", times="3")
    assert str(caught.value) == (
        "bounce: 2 faults\n"
        "  - height='high': expected a number\n"
        "  - times='3': expected a whole number"
    )
    assert checked(bounce).__doc__ == "Bounces."


@pytest.mark.parametrize(
    ("given", "fault"),
    [
        ({"engines": "pymunk"}, "run: no argument is called 'engines'; did you mean engine"),
        ({"recordings": ["a"], "fix": {}}, "fit: no argument is called 'fix'; did you mean fixed"),
        ({}, "fit: missing a required argument: 'recordings'"),
    ],
)
def test_arguments_that_there_are_not_and_that_are_missing(given, fault):
    with pytest.raises(InputError) as caught:
        getattr(simcompare, fault.partition(":")[0])("ball", **given)
    assert str(caught.value).startswith(fault)


@pytest.mark.parametrize(
    "verb", ["run", "fit", "validate", "tune", "characterize", "control", "estimate"]
)
def test_verbs_refuse_arguments_of_another_type(verb):
    with pytest.raises(InputError, match=f"^{verb}: .*engine=3"):
        getattr(simcompare, verb)(
            *{"control": ["ball", print], "validate": ["ball"], "estimate": ["ball"]}.get(verb, []),
            engine=3,
            **{"fit": {"recordings": ["a"]}, "validate": {"recording": "a"}}.get(verb, {}),
        )


@pytest.mark.parametrize("engine", ["pymunk,box2d", ["pymunk", "box2d"], ("pymunk", "box2d")])
@pytest.mark.engines("pymunk", "box2d")
def test_engines_are_a_list_or_a_text_with_commas(engine):
    run = simcompare.run("ball", engine=engine, seeds=1, contact="default")
    assert run.record.engines_asked == "pymunk,box2d"
    assert [*run.table().index][:2] == ["pymunk", "box2d"]


def test_a_scenario_is_a_path_too():
    place = Path(simcompare.__file__).parent / "scenarios" / "ball"
    run = simcompare.run(place, engine="pymunk", seeds=1, contact="default")
    assert run.record.command[:3] == ("simcompare", "run", str(place))
    assert simcompare.show(place).name == "ball"


def test_one_recording_needs_no_list():
    table = Path(__file__).parent.parent / "examples" / "my_ball.csv"
    fit = simcompare.fit("ball", recordings=table, engine="pymunk")
    assert fit.record.recording_asked == (str(table),)
    assert fit.record.command[-2:] == ("--recording", str(table))


def test_numbers_of_numpy_are_numbers():
    run = simcompare.run(
        "ball", engine="pymunk", contact="default", seeds=np.int64(1), step=np.float64(0.001),
        set={"drop_height": np.float32(0.5)},
    )  # fmt: skip
    assert run.record.parameters["drop_height_m"] == 0.5
    assert run.record.command[7:] == (
        "--step", "0.001s", "--contact", "default", "--seeds", "1",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("verb", "given", "words"),
    [
        ("run", {"scenario": "ball", "step": "5"}, "step: a bare number is in seconds, and 5 s is"),
        ("run", {"scenario": "ball", "seeds": 0}, "seeds: 0 is not a number of repeats"),
        ("run", {"scenario": "ball", "time_limit_s": -1.0}, "time_limit_s: -1 s is not a time"),
        ("run", {"scenario": "ball", "assist": "none", "contact": "tuned"}, "name it in contact"),
        ("fit", {"recordings": []}, "recordings: no recording is given"),
        ("fit", {"recordings": ["a"], "u_time_s": -1.0},
         "u_time_s: -1 s is no uncertainty of an instant"),
        ("tune", {"restitution": "0,8"}, "restitution: '0,8' has a decimal comma; write 0.8"),
        ("validate", {"scenario": "ball", "recording": "pendulum_free_swing"},
         "simcompare validate ball --recording pendulum_free_swing --template --out ball_map.yaml"),
    ],
)  # fmt: skip
def test_errors_name_the_arguments_and_commands_keep_their_options(verb, given, words):
    with pytest.raises(InputError) as caught:
        getattr(simcompare, verb)(**given)
    assert words in str(caught.value)


def test_the_command_line_is_told_its_options(call):
    assert "--step: a bare number" in call("run", "ball", "--step", "5")[2]


@pytest.mark.engines("pymunk")
def test_methods_of_results_refuse_arguments_of_another_type():
    run = simcompare.run("ball", engine="pymunk", contact="default", seeds=1)
    for method, name in ((run.table, "measure"), (run.samples, "engine"), (run.plot, "name")):
        for wrong in (1, []):
            with pytest.raises(InputError, match=rf"{name}={re.escape(str(wrong))}: expected text"):
                method(wrong)
    with pytest.raises(InputError, match="too many positional arguments"):
        simcompare.list(1)


def test_the_commonest_slips_are_told_their_cure():
    with pytest.raises(InputError, match="'mujoco' needs a name, such as engine='mujoco'"):
        simcompare.run("ball", "mujoco")
    with pytest.raises(InputError, match=r"is given as set={'drop_height': '1m'}"):
        simcompare.run("ball", drop_height="1m")
