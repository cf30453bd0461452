"""One request a verb: the command that it writes asks the same again."""

import pytest

from simcompare.verbs.request import FitRequest, RunRequest, ValidateRequest, options


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (RunRequest(scenario="ball"), "run ball --engine all"),
        (
            RunRequest(
                scenario="ball",
                engine="pymunk",
                contact=("tuned",),
                set={"drop_height": "30cm"},
                seeds=3,
            ),
            "run ball --engine pymunk --set drop_height=30cm --contact tuned --seeds 3",
        ),
        (
            RunRequest(scenario="ball", engine="pymunk", step=(1e-3, "2ms")),
            "run ball --engine pymunk --step 0.001s,2ms",
        ),
        (
            FitRequest(
                scenario="ball",
                engine="pymunk",
                recordings=("a.wav", "b.csv"),
                unknowns=("scale", "clock_skew"),
                priors={"drop_height_m": (1.0, 0.002)},
                u_time_s=1e-3,
                fixed={"gravity": "9.81"},
            ),
            "fit ball --engine pymunk --recording a.wav --recording b.csv"
            " --unknown scale,clock_skew"
            " --fix gravity=9.81 --prior drop_height_m=1.0:0.002 --u-time 0.001s",
        ),
        (
            ValidateRequest(
                scenario="ball", engine="pymunk", recording="x.csv", streams=("a", "b"), strict=True
            ),
            "validate ball --engine pymunk --recording x.csv --streams a,b --strict",
        ),
    ],
)
def test_a_command_names_what_is_no_default(request_, words):
    assert request_.command() == ("simcompare", *words.split())


def test_options_are_those_of_the_command_line():
    import typer
    from typer.testing import CliRunner

    from simcompare.cli import fit, run, validate

    for function, kind in (
        (run.run, RunRequest),
        (fit.fit, FitRequest),
        (validate.validate, ValidateRequest),
    ):
        app = typer.Typer(rich_markup_mode=None)
        app.command()(function)
        shown = CliRunner().invoke(app, ["--help"]).output
        for name, option in options(kind).items():
            assert option.flag in shown, name
