"""Tries the policies of this folder on engines and sensors, and prints the table of the study.

python examples/robot_avoid/study.py
python examples/robot_avoid/study.py --engine mujoco,dart --sensors 0,1,2,4 --episodes 200
"""

import argparse
from pathlib import Path

from simcompare.learning import study

POLICIES = sorted((Path(__file__).parent / "policies").glob("*.npz"))


def percent(share):
    """A share with its interval."""
    return f"{100 * share.mean:.0f} ({100 * share.low:.0f} to {100 * share.high:.0f})"


def table(rows):
    """Lines of Markdown: where it was learnt and tried, and how often what came of it."""
    successes, collisions = (study.over_seeds(rows, of) for of in ("successes", "collisions"))
    heads = ("learnt on", "errors there", "tried on", "errors there", "seeds", "success in %",
             "collisions in %")  # fmt: skip
    yield f"| {' | '.join(heads)} |"
    yield "|---" * len(heads) + "|"
    for place, share in successes.items():
        (engine, errors), tried, there = place
        yield (
            f"| {engine} | {errors:g} | {tried} | {there:g} | {share.seeds} | {percent(share)}"
            f" | {percent(collisions[place])} |"
        )


def main(engines, sensors, episodes):
    """Tries all and prints the table."""
    rows = list(study.try_all("robot_avoid", POLICIES, engines, sensors, episodes))
    print("\n".join(table(rows)))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--engine", default="mujoco")
    parser.add_argument("--sensors", default="0,1,2,4")
    parser.add_argument("--episodes", type=int, default=100)
    asked = parser.parse_args()
    main(asked.engine.split(","), [float(x) for x in asked.sensors.split(",")], asked.episodes)
