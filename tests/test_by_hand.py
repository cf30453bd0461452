"""Engines with contact values that somebody typed in."""

from __future__ import annotations

import numpy as np
import pytest

import simcompare
from simcompare.cli import console
from simcompare.engine import by_hand
from simcompare.errors import InputError
from simcompare.model.audit import AuditRow
from simcompare.reports.run import runs
from tests.present import INSTALLED

ELASTICITY = {"pymunk.elasticity": 0.9}
SOLREF = {"mujoco.solref.timeconst": 0.02, "mujoco.solref.dampratio": 0.05}


def run(**more):
    return simcompare.run("ball", contact="by hand", seeds=1, **more)


#: what makes each engine bounce, about as a ball of 0.7
BOUNCING = {"mujoco": {"solref.timeconst": 0.02, "solref.dampratio": 0.05}}
#: without which a value does nothing: the width is that over which two values of it change
WITH = {"solimp.width": {"solimp.dmin": 0.5}}
#: engines with values for a contact besides those for a restitution
OTHERS = [
    (engine, one.name)
    for engine in INSTALLED
    for one in by_hand.known(engine)
    if one.tuned is not None
]


def bouncing(engine: str) -> dict[str, float]:
    return BOUNCING.get(engine, {by_hand.known(engine)[0].name: 0.7})


def height(engine: str, own: dict[str, float]) -> tuple[np.ndarray, dict[str, AuditRow]]:
    found = run(engine=engine, own={f"{engine}.{name}": value for name, value in own.items()})
    (source,) = found.record.sources
    moved = runs.nominal(found, engine, "by hand")
    assert moved is not None
    rows = {row.engine_parameter: row for row in source.audit}
    return moved.signals["ball.position_m"][:, 2], rows


def restitution(result, engine: str) -> float:
    score = result.record.whole[engine, "by hand", "restitution"]
    return float(score.value)


def test_engine_runs_with_what_was_typed_and_shows_it_read_back() -> None:
    found = run(engine="pymunk,mujoco", own={**ELASTICITY, **SOLREF})
    rows = {
        (source.name, row.engine_parameter): row.read_value
        for source in found.record.sources
        for row in source.audit
    }
    assert rows["pymunk", "elasticity of ball"] == 0.9
    assert rows["mujoco", "solref[0]"] == 0.02
    assert rows["mujoco", "solref[1]"] == 0.05
    # not what the scenario asks for (0.8), but near what was typed: a bounce depends on its phase
    assert restitution(found, "pymunk") == pytest.approx(0.9, abs=0.02)
    assert {source.contact for source in found.record.sources} == {"by hand"}


def test_values_that_are_not_typed_are_those_of_the_engine_as_it_comes() -> None:
    (source,) = run(engine="mujoco", own={"mujoco.solref.dampratio": 0.05}).record.sources
    held = {row.engine_parameter: row.read_value for row in source.audit}
    assert held["solref[0]"] == 0.02


def test_run_is_repeated_by_its_command_and_fails_for_no_value_by_hand() -> None:
    found = run(engine="pymunk", own=ELASTICITY)
    assert " --own pymunk.elasticity=0.9" in " ".join(found.record.command)
    assert found.exit_code == 0


def test_only_engines_with_values_run_by_hand() -> None:
    found = simcompare.run("ball", engine="pymunk,mujoco", contact="tuned", own=ELASTICITY, seeds=1)
    levels = [(source.name, source.contact) for source in found.record.sources]
    assert levels == [("pymunk", "tuned"), ("pymunk", "by hand"), ("mujoco", "tuned")]


@pytest.mark.parametrize(
    ("own", "said"),
    [
        ({"pymunk.elasticity": 1.5}, "1.5 is not within 0 … 1"),
        ({"pymunk.elasticity": "3 cm"}, "elasticity"),
        ({"pymunk.bounce": 0.5}, "elasticity"),
        ({"mujoco.solref.timeconst": 0.02}, "mujoco is not among the engines that run"),
        ({"nobody.e": 0.5}, "nobody"),
    ],
)
def test_wrong_value_is_refused(own: dict[str, float], said: str) -> None:
    with pytest.raises(InputError) as caught:
        run(engine="pymunk", own=own)
    assert said in str(caught.value)


def test_all_faults_are_told_at_once() -> None:
    with pytest.raises(InputError) as caught:
        run(engine="pymunk", own={"pymunk.elasticity": 2, "pymunk.slip": 1})
    assert len(caught.value.faults) == 2


def test_level_needs_values_and_something_that_bounces() -> None:
    with pytest.raises(InputError, match=r"own pymunk\.elasticity=0\.9"):
        run(engine="pymunk")
    with pytest.raises(InputError, match="nothing in sliding_block has a restitution"):
        simcompare.run("sliding_block", engine="pymunk", own=ELASTICITY)


@pytest.mark.parametrize(("engine", "name"), OTHERS)
def test_other_value_of_a_contact_is_told_and_moves_the_ball(engine: str, name: str) -> None:
    one = next(one for one in by_hand.known(engine) if one.name == name)
    tuned = one.tuned or 0.0
    assert one.min <= one.value <= one.max
    assert one.min <= tuned <= one.max
    typed = max(one.min, one.max, key=lambda bound: abs(bound - tuned))
    base = bouncing(engine) | WITH.get(name, {})
    moved, rows = height(engine, base | {name: typed})
    told = [row for of, row in rows.items() if row.set_value == typed and is_named(name, of)]
    assert told, f"{name} is not in the audit"
    # in single precision a value is read back with seven digits
    assert all(row.read_value in (None, pytest.approx(typed, rel=1e-6)) for row in told)
    usual, rows = height(engine, base)
    assert not [row for of, row in rows.items() if row.set_value == typed and is_named(name, of)]
    n = min(len(moved), len(usual))
    # a slider that shows nothing would be a lie; this is what a picture of 1 m in 1000 px shows
    assert np.abs(moved[:n] - usual[:n]).max() > 1e-4


def is_named(name: str, parameter: str) -> bool:
    """Whether a parameter of the audit is a value, which may be one of a list's."""
    of, _, part = name.partition(".")
    place = {"dmin": "[0]", "dmax": "[1]", "width": "[2]"}.get(part, "")
    return parameter.endswith(f"{of}{place}")


def test_every_other_value_that_is_not_typed_is_that_of_tuned() -> None:
    _, rows = height("box2d", {"contact_hertz": 30})
    assert rows["World.restitution_threshold"].set_value == 0.0
    # and what stands for a restitution is that of the engine as it comes
    assert rows["restitution of ball"].set_value == 0.0


def test_several_values_in_one_option_are_told_apart() -> None:
    with pytest.raises(InputError, match=r"write --own pymunk\.elasticity=0\.9 --own box2d\.r=1"):
        console.pairs(["pymunk.elasticity=0.9, box2d.r=1"], "--own")
    assert console.pairs(["x=0,5"]) == {"x": "0,5"}


def test_numbers_of_a_spring_are_told_as_they_are_typed() -> None:
    typed = by_hand.typed("mujoco", (-2500.0, -5.0))
    # solref's two forms: timeconst = 2/b, dampratio = b/(2√k)
    assert typed == pytest.approx({"solref.timeconst": 0.4, "solref.dampratio": 0.05})
    assert by_hand.typed("pymunk", (0.7,)) == {"elasticity": 0.7}


def test_script_has_what_was_typed() -> None:
    text = simcompare.export("ball", format="script", engine="pymunk", own=ELASTICITY)
    assert "ball_shape.elasticity = 0.9\n" in text
    assert text.startswith('"""Bouncing ball in pymunk')
    assert "with values set by hand" in text
    own = {**ELASTICITY, "pymunk.collision_slop": 0.03}
    text = simcompare.export("ball", format="script", engine="pymunk", own=own)
    assert "space.collision_slop = 0.03\n" in text
    with pytest.raises(InputError, match="leave it out"):
        simcompare.export(
            "ball", format="script", engine="pymunk", own=ELASTICITY, contact="default"
        )
    with pytest.raises(InputError, match="is for the format script"):
        simcompare.export("ball", format="urdf", own=ELASTICITY)


def test_both_forms_of_a_spring_are_the_same_contact() -> None:
    numbers = (-2500.0, -5.0)
    own = {f"mujoco.{name}": v for name, v in by_hand.typed("mujoco", numbers).items()}
    typed = restitution(run(engine="mujoco", own=own), "mujoco")
    (told,) = simcompare.tune(engine="mujoco", numbers=numbers, contact="tuned", speed=4.43)
    assert told.statement is not None
    # the scatter over the phases of a step is 2 %, here it is one phase
    assert typed == pytest.approx(told.statement.restitution, rel=0.03)
