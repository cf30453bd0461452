"""Records of validations, made up for tests of their words."""

from simcompare.reports.validation import answer

FITTED = ("length_m", "damping_N_m_s_rad")


def waveform(parameters="known before", source="north", stream="log", rmse=0.02, **more):
    return {
        "source": source, "stream": stream, "probe": "angle_rad", "unit": "rad", "judged": True,
        "parameters": parameters, "aligned": False, "rmse": rmse, "max_abs": 2 * rmse,
        "nrmse": rmse, **more,
    }  # fmt: skip


def gap(removed=0.0, model_form=0.9, source="north", stream="log", covered=None, **more):
    total = 0.04
    noise = 1 - removed - model_form
    return {
        "source": source, "stream": stream, "probe": "angle_rad", "total": total,
        "remaining": total * (1 - removed) ** 0.5, "model_form": total * model_form**0.5,
        "noise": total * max(noise, 0.0) ** 0.5, "numerical": 0.0, "covered": covered,
        "shares": {"removed": removed, "model_form": model_form, "noise": noise, "numerical": 0.0},
        **more,
    }  # fmt: skip


def value(e_n=0.5, stream="log", **more):
    return {
        "source": "north", "stream": stream, "measure": "mean_period", "e_n": e_n,
        "within_noise": None if e_n is None else abs(e_n) <= 1, "u_val": 1.0, "u_num": 0.1,
        "u_input": 0.9, "u_data": 0.4, "unit": "s", **more,
    }  # fmt: skip


def fit(streams=("id.0",), at_bound=(), **more):
    return {"recording": "swings", "streams": list(streams), "at_bound": list(at_bound),
            "names": list(FITTED), **more}  # fmt: skip


def timing(**more):
    return {
        "source": "north", "stream": "log", "series": "impact_times", "matched": 5, "missed": 1,
        "extra": 0, "rmse_s": 0.002, "intervals": [], **more,
    }  # fmt: skip


def stretches(*names):
    return [{"stream": name} for name in names]


def record(**more):
    rows = [
        {"name": name, "kind": "known", "fitted": 1.0 if more.get("fit") else None}
        for name in FITTED
    ]
    return {
        "recording": "swings", "basis": answer.KNOWN, "fit": None, "parameters": rows,
        "compare": {"angle_rad": {"label": "Angle from hanging"}},
        "cases": [{"stream": "log"}], "waveforms": [waveform()], "gaps": [gap()],
        "values": [value()], "timings": [], "provenance": {"repairs": []}, **more,
    }  # fmt: skip


def held_out(**more):
    return record(
        basis=answer.HELD_OUT, fit=fit(), cases=[{"stream": "vad.0"}],
        waveforms=[waveform(stream="vad.0", rmse=0.04),
                   waveform("fitted", stream="vad.0", rmse=0.01)],
        gaps=[gap(0.75, 0.2, stream="vad.0")], **more,
    )  # fmt: skip


def text(found):
    return "\n".join(answer.sentences(found))
