"""Tries the policies of this folder on engines and sensors: the table of the study, and its curves.

python examples/robot_avoid/study.py --processes 2 --figure curves.png
python examples/robot_avoid/study.py --engine mujoco,dart --sensors 0,1 --episodes 20
"""

import argparse
import functools
import multiprocessing
import sys
from pathlib import Path

from simcompare.learning import study

POLICIES = sorted((Path(__file__).parent / "policies").glob("*.npz"))
#: engine step of the trials, the one that the policies were learnt with
STEP_S = 0.01
#: colours that colour-blind people can tell apart (Okabe and Ito), and what else tells them apart
LOOKS = (
    ("#0072B2", "o", "-"), ("#D55E00", "s", "--"), ("#009E73", "^", "-."),
    ("#CC79A7", "D", ":"), ("#000000", "v", (0, (5, 1))), ("#E69F00", "P", (0, (1, 1))),
)  # fmt: skip


def tried(engines, sensors, episodes, file):
    """Rows of one policy."""
    return list(study.try_all("robot_avoid", [file], engines, sensors, episodes, STEP_S))


def each(one, files, processes):
    """Results for files, in their order."""
    if processes == 1:
        yield from map(one, files)
        return
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        yield from pool.imap(one, files)


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
        (engine, errors), where, there = place
        yield (
            f"| {engine} | {errors:g} | {where} | {there:g} | {share.seeds} | {percent(share)}"
            f" | {percent(collisions[place])} |"
        )


def draw(rows, file):
    """Curves of success and of collisions over the errors of the sensor, a column an engine."""
    from matplotlib.figure import Figure

    engines = list(dict.fromkeys(row.engine for row in rows))
    figure = Figure(figsize=(4.2 * len(engines) + 1.5, 6), layout="constrained")
    axes = figure.subplots(2, len(engines), sharex=True, sharey=True, squeeze=False)
    for line, (what, label) in zip(
        axes, (("successes", "success in %"), ("collisions", "collisions in %")), strict=True
    ):
        shares = study.over_seeds(rows, what)
        learnt = list(dict.fromkeys(place[0] for place in shares))
        line[0].set_ylabel(label)
        for plot, engine in zip(line, engines, strict=True):
            for k, (one, (color, marker, dashes)) in enumerate(zip(learnt, LOOKS, strict=False)):
                found = [(at, s) for (who, where, at), s in shares.items()
                         if (who, where) == (one, engine)]  # fmt: skip
                # side by side, so that bars do not hide each other
                at = [x + 0.04 * (k - (len(learnt) - 1) / 2) for x, _ in found]
                mean = [100 * s.mean for _, s in found]
                bars = [[100 * max(s.mean - s.low, 0) for _, s in found],
                        [100 * max(s.high - s.mean, 0) for _, s in found]]  # fmt: skip
                name = f"{one[0]}, errors {one[1]:g}"
                plot.errorbar(at, mean, bars, color=color, marker=marker, linestyle=dashes,
                              capsize=3, label=name)  # fmt: skip
            plot.grid(alpha=0.3)
    for plot, engine in zip(axes[0], engines, strict=True):
        plot.set_title(f"tried on {engine}")
    for plot in axes[-1]:
        plot.set_xlabel("errors of the sensor (0: none, 1: data sheet)")
    axes[0][0].set_ylim(-2, 102)
    handles, names = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, names, title="learnt on", loc="outside right upper")
    figure.savefig(file, dpi=150)


def main(engines, sensors, episodes, processes=1, figure=None):
    """Tries all, prints the table, and draws the curves."""
    one, rows = functools.partial(tried, engines, sensors, episodes), []
    for file, found in zip(POLICIES, each(one, POLICIES, processes), strict=True):
        print(f"{file.name}: {len(found)} rows", file=sys.stderr)
        rows += found
    print("\n".join(table(rows)))
    if figure is not None:
        draw(rows, figure)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--engine", default="mujoco,pybullet")
    parser.add_argument("--sensors", default="0,0.5,1,2,4")
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--figure", type=Path)
    asked = parser.parse_args()
    numbers = [float(x) for x in asked.sensors.split(",")]
    main(asked.engine.split(","), numbers, asked.episodes, asked.processes, asked.figure)
