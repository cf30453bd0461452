"""``simcompare tune``."""

from __future__ import annotations

import typer

from simcompare.cli import complete, console, ending
from simcompare.errors import InputError


def tune(
    context: typer.Context,
    scenario: str = typer.Argument(
        None, help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    restitution: str = typer.Option(None, help="What is wanted, in place of a scenario."),
    speed: str = typer.Option(
        None, help="Speed of the impact, such as 2 or 0.5..4 in m/s (0.5..4; a scenario's own)."
    ),
    step: str = typer.Option(None, help="The engine's step, such as 2ms (1ms; a scenario's own)."),
    engine: str = typer.Option(
        "all", help="'all' or names with commas.", autocompletion=complete.engines
    ),
    mass: str = typer.Option(None, help="Mass of the ball (0.1kg)."),
    radius: str = typer.Option(None, help="Radius of the ball (50mm)."),
    within: str = typer.Option("1%", help="How far the mean may be off where the numbers hold."),
    scatter: str = typer.Option(
        None, help="Largest scatter over the phases of the step (2%): the stiffest contact."
    ),
    depth: str = typer.Option(
        None, help="Largest penetration, such as 5mm: the contact that scatters least."
    ),
    numbers: str = typer.Option(
        None,
        help="What one engine is given, whose restitution is wanted; also by its own name for it.",
    ),
    contact: str = typer.Option(
        None,
        help="All else in the engine: 'tuned', or 'coefficients', the engine as it comes (tuned;"
        " both for numbers that are given).",
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="A parameter of the scenario."
    ),
    preset: str = typer.Option(None, help="Its named set of parameters."),
    snippet: bool = typer.Option(False, "--snippet", help="Print only the lines to copy."),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one engine, in seconds."),
) -> None:
    """Find the numbers that give engines a restitution."""
    from simcompare.cli import tune_tables
    from simcompare.model.plain import plain
    from simcompare.running.jobs import exit_code_of
    from simcompare.tuning import typed_numbers
    from simcompare.verbs import tune as verb

    name, options = _own_options(scenario, context.args)
    typed = typed_numbers.numbers_of(options, engine)
    if numbers is not None:
        if typed:
            raise InputError("--numbers", [f"and --{next(iter(options))} are the same; give one"])
        typed = typed_numbers.read_numbers(numbers, "--numbers")
    with console.progress_bar("tune") as progress:
        rows = verb.tune(
            name, engine=engine, restitution=restitution, speed=speed, step=step, mass=mass,
            radius=radius, within=within, scatter=scatter, depth=depth, numbers=typed,
            contact=contact, set=console.pairs(settings), preset=preset, time_limit_s=time_limit,
            progress=progress,
        )  # fmt: skip
    show = tune_tables.show_snippets if snippet else tune_tables.show
    # numbers that cannot be had are the answer, where another step or speed has them
    code = exit_code_of([row.status for row in rows], engine, out_of_reach=True)
    ending.finish(
        lambda: {"answers": [plain(row) for row in rows]},
        lambda: show(rows),
        code,
        as_json=as_json,
    )


def _own_options(first: str | None, rest: list[str]) -> tuple[str | None, dict[str, str]]:
    """The scenario, and options that are called as an engine calls its numbers.

    Args:
        first: the first word that the parser could not place; it takes it for the scenario.
        rest: all others, in order.
    """
    words = [*rest] if first is None else [first, *rest]
    scenario, options = None, dict[str, str]()
    while words:
        word = words.pop(0)
        name, equals, text = word.lstrip("-").partition("=")
        if word.startswith("--"):
            has_text = not equals and words and not words[0].startswith("--")
            options[name] = words.pop(0) if has_text else text
        elif scenario is None and not word.startswith("-"):
            scenario = word
        else:
            raise InputError("tune", [f"{word!r} is one word too many"])
    return scenario, options
