"""Records of validations, made up for tests of their words."""

from simcompare.comparison.events import Interval
from simcompare.inference.plan import ClockPlan
from simcompare.model.recording import Provenance
from simcompare.reports.validation import answer
from simcompare.results.records.validation import (
    HELD_OUT,
    KNOWN,
    CalibrationRecord,
    ComparedProbe,
    GapRecord,
    ParameterRecord,
    ProbeRecord,
    SegmentRecord,
    TimingRecord,
    Validation,
    ValueRecord,
    WaveformRecord,
)
from simcompare.statistics.gap import Shares

FIT = ("length_m", "damping_N_m_s_rad")
LOG = Provenance("swings.csv", "", 0, "text", "0", "lenient")


def waveform(parameters=KNOWN, source="north", stream="log", rmse=0.02, **more):
    known = {
        "n": 100, "masked": 0, "bias": 0.0, "rmse": rmse, "mae": rmse, "max_abs": 2 * rmse, "at": 0,
        "nrmse": rmse, "normaliser": "", "fit_percent": None, "magnitude": None, "phase": None,
        "combined": None, "probe": "angle_rad", "unit": "rad", "judged": True, "aligned": False,
    }  # fmt: skip
    return WaveformRecord(parameters=parameters, source=source, stream=stream, **(known | more))


def gap(removed=0.0, model_form=0.9, source="north", stream="log", covered=None, **more):
    total = 0.04
    noise = 1 - removed - model_form
    known = {
        "n": 100, "total": total, "parameter": 0.0, "remaining": total * (1 - removed) ** 0.5,
        "model_form": total * model_form**0.5, "model_form_low": 0.0, "model_form_high": 0.0,
        "numerical": 0.0, "noise": total * max(noise, 0.0) ** 0.5, "noise_from": "stated",
        "cross": 0.0, "correlation": 0.0, "excess": 0.0, "clipped": False, "block": 1, "draws": 0,
        "shares": Shares(0.0, model_form, 0.0, noise, 0.0, 0.0, removed),
        "probe": "angle_rad", "unit": "rad",
    }  # fmt: skip
    return GapRecord(source=source, stream=stream, covered=covered, **(known | more))


def value(e_n=0.5, stream="log", **more):
    known = {
        "simulated": 1.0, "measured": 1.0, "u_num": 0.1, "u_input": 0.9, "u_data": 0.4,
        "error": 0.0, "u_val": 1.0, "zeta": None, "source": "north", "measure": "mean_period",
        "within_noise": None if e_n is None else abs(e_n) <= 1, "probe": "angle_rad", "unit": "s",
        "u_simulated": 0.9,
    }  # fmt: skip
    return ValueRecord(e_n=e_n, stream=stream, **(known | more))


def fit(streams=("id.0",), at_bound=(), rms=0.0, r=0.0, **more):
    known = {"recording": "swings", "chosen_knowing": False, "how": "", "single": {}}
    return CalibrationRecord(
        names=FIT, streams=tuple(streams), rms=rms, correlation=((1.0, r), (r, 1.0)),
        at_bound=tuple(at_bound), **(known | more),
    )  # fmt: skip


def timing(e_n=(), **more):
    known = {
        "source": "north", "stream": "log", "series": "impact_times", "matched": 5, "missed": 1,
        "extra": 0, "bias_s": 0.0, "rmse_s": 0.002, "max_abs_s": 0.0, "times_s": (),
        "measured_s": (),
    }  # fmt: skip
    intervals = [Interval(k, 1.0, 1.0, None, None, None, one) for k, one in enumerate(e_n, start=1)]
    return TimingRecord(intervals=tuple(intervals), **(known | more))


def segment(stream="log", u=None, **more):
    probes = {} if u is None else {"angle_rad": ProbeRecord(100, 0, 0, u, "stated")}
    return SegmentRecord(stream, **({"start_s": 0.0, "duration_s": 6.0, "probes": probes} | more))


def parameter(name, kind="known", fitted=None):
    return ParameterRecord(name, "", kind, None, None, fitted, None, "")


def compared(label):
    return ComparedProbe("channel", label, "rad")


def record(**more):
    found = {
        "recording": "swings", "about": {}, "provenance": LOG, "basis": KNOWN, "fit": None,
        "align": ClockPlan(), "inputs": {},
        "parameters": [parameter(n, fitted=1.0 if more.get("fit") else None) for n in FIT],
        "compare": {"angle_rad": compared("Angle from hanging")},
        "cases": [segment()], "waveforms": [waveform()], "gaps": [gap()], "values": [value()],
    }  # fmt: skip
    rows = {k: tuple(v) if isinstance(v, list) else v for k, v in (found | more).items()}
    return Validation(**rows)


def held_out(**more):
    found = {
        "basis": HELD_OUT, "fit": fit(), "cases": [segment("vad.0")],
        "waveforms": [waveform(stream="vad.0", rmse=0.04),
                      waveform("fitted", stream="vad.0", rmse=0.01)],
        "gaps": [gap(0.75, 0.2, stream="vad.0")],
    }  # fmt: skip
    return record(**(found | more))


def text(found):
    return "\n".join(answer.sentences(found))
