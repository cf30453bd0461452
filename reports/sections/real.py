"""Sections of a validation: the answer, the gap, the values, the parameters, the recording."""

from __future__ import annotations

from typing import Any

from simcompare import units
from simcompare.reports import numbers, real, runs
from simcompare.reports.figures import style_of
from simcompare.reports.sections.base import Section
from simcompare.results import Run

#: ranges of rows that are named for each repair
_RANGES = 8


class RealAnswer(Section):
    """What was found, in words, and measured and simulated over each other."""

    name, title, template = "answer", "Answer", "real_answer.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Sentences and the overlay of every judged probe."""
        found = real.validation(run)
        return {
            "question": run.record["question"],
            "answer": [*found["sentences"], *_not_run(run)],
            "figures": [real.overlay_figure(run, probe) for probe in real.judged_probes(run)],
            "rows": [_waveform(row) for row in found["waveforms"] if row["judged"]],
        }


def _not_run(run: Run) -> list[str]:
    missing = sorted({row["name"] for row in runs.not_run(run)})
    return [f"Did not run: {', '.join(missing)}; the reasons are below."] if missing else []


def _waveform(row: dict[str, Any]) -> dict[str, Any]:
    unit = units.symbol(row["unit"])

    def percent(value: float | None) -> str:
        return "–" if value is None else f"{numbers.plain(100 * value, 3)} %"

    return {
        "source": row["source"],
        "style": style_of(row["source"]),
        "stream": "" if row["stream"] == "log" else row["stream"],
        "what": runs.measure_words(row["probe"]) + runs.unit_words(unit),
        "parameters": row["parameters"],
        "aligned": "aligned" if row["aligned"] else "as recorded",
        "rmse": numbers.plain(row["rmse"], 3),
        "bias": numbers.plain(row["bias"], 3),
        "largest": numbers.plain(row["max_abs"], 3),
        "nrmse": percent(row["nrmse"]),
        "magnitude": percent(row["magnitude"]),
        "phase": percent(row["phase"]),
        "samples": row["n"],
    }


class Gap(Section):
    """What the gap is made of."""

    name, title, template = "gap", "What the gap is made of", "real_gap.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Figure and table; ``None`` where no gap could be split."""
        figure = real.gap_figure(run)
        if figure is None:
            return None
        return {"figures": [figure], "rows": [_gap(row) for row in real.validation(run)["gaps"]]}


def _gap(row: dict[str, Any]) -> dict[str, Any]:
    low, high = row["model_form_low"], row["model_form_high"]
    return {
        "source": row["source"],
        "style": style_of(row["source"]),
        "stream": "" if row["stream"] == "log" else row["stream"],
        "what": runs.measure_words(row["probe"]) + runs.unit_words(units.symbol(row["unit"])),
        "total": numbers.plain(row["total"], 3),
        "parts": [
            numbers.plain(row[key], 3) for key in ("parameter", "model_form", "numerical", "noise")
        ],
        "interval": f"{numbers.plain(low, 3)} … {numbers.plain(high, 3)}",
        "noise_from": row["noise_from"],
        "cross": row["shares"]["cross"] + row["shares"]["excess"],
    }


class Residuals(Section):
    """What is left over time."""

    name, title, template = "residuals", "What is left", "figures.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """A figure for each judged probe."""
        found = [real.residual_figure(run, probe) for probe in real.judged_probes(run)]
        drawn = [figure for figure in found if figure.panels]
        return {"figures": drawn} if drawn else None


class RealValues(Section):
    """Single values with their uncertainty."""

    name, title, template = "values", "Measured values", "real_values.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Figure of E_n and table; ``None`` where nothing was measured on both."""
        found = real.validation(run)
        if not found["values"]:
            return None
        figure = real.e_n_figure(run)
        return {
            "figures": [] if figure is None else [figure],
            "rows": [_value(row) for row in found["values"]],
            "agreement": [_agreement(row) for row in found["agreement"]],
        }


def _value(row: dict[str, Any]) -> dict[str, Any]:
    return {
        "source": row["source"],
        "style": style_of(row["source"]),
        "stream": "" if row["stream"] == "log" else row["stream"],
        "what": runs.measure_words(row["measure"]) + runs.unit_words(units.symbol(row["unit"])),
        "simulated": numbers.with_u(row["simulated"], row["u_simulated"] or None),
        "measured": numbers.with_u(row["measured"], row["u_data"] or None),
        "error": numbers.plain(row["error"], 3),
        "parts": [numbers.plain(row[key], 2) for key in ("u_num", "u_input", "u_data")],
        "e_n": "–" if row["e_n"] is None else numbers.plain(row["e_n"], 3),
        "within": row["within_noise"],
        "words": row["words"],
    }


def _agreement(row: dict[str, Any]) -> dict[str, Any]:
    return {
        "what": runs.measure_words(row["measure"]),
        "stream": "" if row["stream"] == "log" else row["stream"],
        "engines": len(row["engines"]),
        "ratio": numbers.plain(row["ratio"], 3),
        "expected": f"{numbers.plain(row['low'], 2)} … {numbers.plain(row['high'], 2)}",
        "consistent": row["consistent"],
    }


class Parameters(Section):
    """What was known, what was fitted, and where each number comes from."""

    name, title, template = "parameters", "Parameters", "real_parameters.html"

    def context(self, run: Run) -> dict[str, Any]:
        """The table of all parameters and what single streams gave."""
        found = real.validation(run)
        fit = found["fit"]
        return {
            "rows": [
                {
                    **row,
                    "before": numbers.with_u(row["known"], row["u_known"] or None),
                    "after": numbers.with_u(row["fitted"], row["u_fitted"]),
                }
                for row in found["parameters"]
            ],
            "fit": fit,
            "single": []
            if fit is None
            else [
                {"stream": stream, "values": [numbers.plain(value, 5) for value in values]}
                for stream, values in fit["single"].items()
            ],
            "note": found["note"],
        }


class Source(Section):
    """The recording: where it comes from and all that was done to it."""

    name, title, template = "recording", "The recording", "real_recording.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Provenance, clock, repairs and conversions."""
        found = real.validation(run)
        about = found["provenance"]
        return {
            "about": found["about"],
            "file": about,
            "align": found["align"],
            "alignments": [one for one in found.get("alignments", ()) if one],
            "compare": found["compare"],
            "inputs": found["inputs"],
            "cases": found["cases"],
            "repairs": [{**row, "place": _place(row)} for row in about["repairs"]],
            "conversions": about["conversions"],
        }


def _place(repair: dict[str, Any]) -> str:
    rows = [f"{a}" if a == b else f"{a}–{b}" for a, b in repair["rows"][:_RANGES]]
    more = " …" if len(repair["rows"]) > _RANGES else ""
    where = "/".join(part for part in (repair["stream"], repair["channel"]) if part)
    return f"{where} {', '.join(rows)}{more}".strip()
