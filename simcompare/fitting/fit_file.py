"""A stored fit, to be used again: each engine with its own fitted parameters."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from simcompare.errors import InputError
from simcompare.scenario import Scenario
from simcompare.scenario_file import ScenarioFile

#: contact level of engines with parameters from a fit
FITTED = "fitted"
FILE = "fit.json"
#: unknowns of a fit that belong to one drop, and not to the ball and the floor
_OF_A_DROP = ("drop_height_m", "release_time_s", "floor_m", "clock_skew", "scale")
#: by how much a speed may leave the fitted range before it is told
_MARGIN = 1.05


@dataclass(frozen=True)
class FitFile:
    """What fit.json holds of use for another run.

    Attributes:
        path: the file.
        scenario: name of the scenario that was fitted.
        given: parameters of the scenario that were not fitted.
        closed: parameters of the closed form.
        engines: engine -> its own parameters.
        speed_m_s: slowest and fastest impact that was fitted.
        step_s: time between samples that was fitted with.
    """

    path: Path
    scenario: str
    given: Mapping[str, float]
    closed: Mapping[str, float]
    engines: Mapping[str, Mapping[str, float]]
    speed_m_s: tuple[float, float]
    step_s: float

    def base(self, file: ScenarioFile) -> dict[str, float]:
        """Parameters of the scenario as the closed form has them.

        Raises:
            InputError: the fit is of another scenario.
        """
        if file.name != self.scenario:
            raise InputError(
                str(self.path), [f"is a fit of {self.scenario}, not of {file.name}; fit that first"]
            )
        return _known({**self.given, **self.closed}, file)

    def of_engine(self, engine: str, file: ScenarioFile) -> dict[str, float] | None:
        """What an engine must be given, ``None`` where it was not fitted."""
        own = self.engines.get(engine)
        return None if own is None else _known(own, file)

    def cautions(self, scene: Scenario) -> list[str]:
        """What lies outside of the range in which the fit is valid, one sentence each."""
        said = []
        height = scene.parameters.get("drop_height_m")
        gravity = scene.parameters.get("gravity_m_s2", 9.80665)
        if height is not None:
            speed = math.sqrt(2 * gravity * height)
            if speed > _MARGIN * self.speed_m_s[1]:
                said.append(
                    f"The first impact is at up to {speed:.2f} m/s; the fit saw"
                    f" {self.speed_m_s[0]:.2f} to {self.speed_m_s[1]:.2f} m/s."
                )
        if not math.isclose(scene.world.step_s, self.step_s, rel_tol=1e-6):
            said.append(
                f"The time between samples is {scene.world.step_s:g} s; the engines were fitted"
                f" with {self.step_s:g} s."
            )
        return said


def _known(values: Mapping[str, float], file: ScenarioFile) -> dict[str, float]:
    names = set(file.parameters) - set(_OF_A_DROP)
    return {name: value for name, value in values.items() if name in names}


def contact_values(path: Path) -> str:
    """What each engine's own contact parameters were in the fit, as text to copy from.

    Raises:
        InputError: the file is no fit.
    """
    fit = read(path)
    tree = json.loads(path.read_text(encoding="utf-8"))
    lines = [
        f"# {fit.scenario}, fitted at {fit.speed_m_s[0]:.2f} to {fit.speed_m_s[1]:.2f} m/s"
        f" with {fit.step_s:g} s between samples"
    ]
    for source in tree["sources"]:
        rows = [row for row in source.get("native", ()) if row["read_value"] is not None]
        lines += [
            f"{source['name']}: {row['engine_parameter']} = {row['read_value']:.9g}"
            + ("" if row["unit"] in ("", "1") else f" {row['unit']}")
            for row in rows
        ]
    return "\n".join(lines) + "\n"


def find(text: str) -> Path | None:
    """The fit that a text names: the file, or the folder of the run that made it."""
    path = Path(text)
    try:
        if path.is_dir() and (path / FILE).is_file():
            return path / FILE
        return path if path.suffix == ".json" else None
    except OSError:  # a name too long for the file system
        return None


def read(path: Path) -> FitFile:
    """Reads fit.json.

    Raises:
        InputError: there is none, or it is damaged.
    """
    try:
        tree = json.loads(path.read_text(encoding="utf-8"))
        if tree.get("by") == "waveform":
            raise InputError(
                str(path), ["is a fit of signals over time; give its parameters with --set"]
            )
        known = tree["run_with"]
        engines = {
            name: {n: float(v) for n, v in own.items()} for name, own in known["engines"].items()
        }
        values = {n: float(v) for n, v in known["closed"].items()}
        low, high = tree["valid"]["speed_m_s"]
        return FitFile(
            path, str(tree["scenario"]), {n: float(v) for n, v in tree["given"].items()},
            values, engines, (float(low), float(high)), float(tree["valid"]["step_s"]),
        )  # fmt: skip
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            str(path),
            [f"is no fit ({type(error).__name__}: {error}); expected a fit.json of simcompare fit"],
        ) from None
