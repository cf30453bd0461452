"""Which parameter of a scenario plays which part in a fit: names are the scenario's own."""

import pytest

import simcompare
from simcompare.errors import InputError
from simcompare.fitting.bounces.roles import roles_of
from simcompare.scenarios import catalogue
from tests.present import INSTALLED
from tests.test_fitting import E, stopwatch


def ball_text():
    return catalogue.load("ball").path.read_text(encoding="utf-8")


def renamed(folder, **names):
    """A copy of the ball whose parameters have other names, without a reference."""
    text = ball_text().replace("name: ball\n", "name: own_ball\n")
    for old, new in names.items():
        for before, after in (
            (f"\n  {old}:\n", f"\n  {new}:\n"),
            (f"\n    {old}:\n", f"\n    {new}:\n"), (f": {old}\n", f": {new}\n"),
            (f", {old},", f", {new},"),
        ):  # fmt: skip
            text = text.replace(before, after)
        head, world, rest = text.partition("\nworld:\n")
        head = head.replace(f"{{{old}: ", f"{{{new}: ").replace(f" {old}: ", f" {new}: ")
        rest = rest.replace(f"parameter: {old}", f"parameter: {new}")
        # inside of expressions only
        parts = rest.split("${")
        parts[1:] = [p.partition("}")[0].replace(old, new) + p[p.index("}") :] for p in parts[1:]]
        text = head + world + "${".join(parts)
    path = folder / "own_ball.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("assist", ["none", "all"])
def test_a_ball_with_other_names_is_fitted_on_every_engine(tmp_path, assist):
    path = renamed(tmp_path, radius_m="ball_radius_m", drop_height_m="fall_m",
                   gravity_m_s2="pull_m_s2", mass_kg="weight_kg")  # fmt: skip
    drop = stopwatch(tmp_path / "drop.csv")
    run = simcompare.fit(str(path), recordings=[drop], assist=assist, out=tmp_path / "runs")
    rows = {source.name: source for source in run.record.fit.sources}
    for source in map(rows.get, INSTALLED):
        assert source.status == "ok", source.reason
        assert source.effective["restitution"].value == pytest.approx(E, rel=0.01)
    again = simcompare.run(str(path), engine="pymunk", contact=str(run.folder), seeds=1)
    assert again.record.sources[0].status == "ok"
    high = simcompare.run(str(path), engine="pymunk", contact=str(run.folder), seeds=1,
                          set={"fall": 3})  # fmt: skip
    assert any("the fit saw" in text for text in high.record.cautions)


def test_drag_is_given_through_the_roles(tmp_path):
    path = renamed(tmp_path, radius_m="ball_radius_m", mass_kg="weight_kg")
    file = catalogue.load(str(path))
    roles = roles_of(file, {name: p.value for name, p in file.parameters.items()})
    values = roles.values({"restitution": 0.8, "drop_height_m": 1.0, "terminal_speed_m_s": 8.644})
    assert values["drag_coefficient"] == pytest.approx(0.47, rel=0.01)
    fixed, priors = roles_of(file, values).known({}, {})
    assert fixed == {}
    speed = priors["terminal_speed_m_s"]
    assert speed.value == pytest.approx(8.644, rel=1e-9)
    # half of 20 %/√3 of drag, and little of radius and mass
    assert speed.u / speed.value == pytest.approx(0.1 / 3**0.5, rel=0.01)


def test_a_scene_without_gravity_and_drag_has_the_gravity_of_its_world(tmp_path):
    text = ball_text().replace("name: ball\n", "name: own_ball\n")
    for line in ("  gravity: gravity_m_s2\n", "  drag: drag_coefficient\n"):
        text = text.replace(line, "")
    path = tmp_path / "own_ball.yaml"
    path.write_text(text.replace("{value: 9.80665,", "{value: 9.81,"), encoding="utf-8")
    file = catalogue.load(str(path))
    roles = roles_of(file, {name: p.value for name, p in file.parameters.items()})
    assert roles.known({}, {}) == ({"gravity_m_s2": 9.81}, {})
    assert roles.values({"terminal_speed_m_s": 8.0})["drag_coefficient"] == 0
    drop = stopwatch(tmp_path / "drop.csv")
    run = simcompare.fit(str(path), recordings=[drop], engine="pymunk")
    assert run.record.fit.closed_form.fixed["gravity_m_s2"] == 9.81
    with pytest.raises(InputError, match="no parameter of it"):
        simcompare.fit(str(path), recordings=[drop], engine="pymunk", fixed={"gravity": 9.7})


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("height: drop_height_m", "height: drop_hight_m", "did you mean drop_height_m"),
        ("  height: drop_height_m\n", "", "fit.height: is missing and needed for by: bounces"),
        ("  mass: mass_kg\n", "", "fit.mass: is missing and needed for drag"),
        ("  radius: radius_m\n", "  radius: mass_kg\n", "'mass_kg' is in kg; expected a parameter"),
        ("  radius: radius_m\n", "  radius: drop_height_m\n", "is the height already"),
        ("  radius: radius_m\n", "  raduis: radius_m\n", "raduis"),
        ("by: bounces", "by: waveform", "only fits by: bounces have this"),
    ],
)
def test_a_wrong_role_is_one_clear_fault(tmp_path, old, new, message):
    path = tmp_path / "ball.yaml"
    assert old in ball_text()
    path.write_text(ball_text().replace(old, new), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        catalogue.load(str(path))
    assert message in str(caught.value)
    assert str(path) in str(caught.value)
    assert "line " in str(caught.value)


def test_all_wrong_roles_are_told_at_once(tmp_path):
    path = tmp_path / "ball.yaml"
    text = (
        ball_text()
        .replace("height: drop_height_m", "height: a")
        .replace("  mass: mass_kg", "  mass: b")
    )
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        catalogue.load(str(path))
    assert len(caught.value.faults) == 2


def test_settings_of_what_is_sought_are_refused_by_their_own_names(tmp_path):
    path = renamed(tmp_path, drop_height_m="fall_m")
    drop = stopwatch(tmp_path / "drop.csv")
    with pytest.raises(InputError, match=r"fall_m belongs to the bounce.*as drop_height_m"):
        simcompare.fit(str(path), recordings=[drop], engine="pymunk", set={"fall": 1})
