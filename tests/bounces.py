"""What tests of fits share: measured drops whose truth is known."""

import numpy as np

from simcompare.fitting.bounces import arcs, records
from simcompare.fitting.bounces.bounce_models import MODELS, bounces, height_at
from simcompare.fitting.bounces.identifiability import identifiability
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.reading import from_times
from simcompare.model.recording import Channel, Clock, Event, Provenance, Recording, Stream
from simcompare.reports.fit import answer, form_words, identifiability_words
from simcompare.results.records.fit_parts import finite

TRUTH = {"restitution": 0.85, "drop_height_m": 1.0, "release_time_s": 0.3}
#: a table-tennis ball in air
TERMINAL = 8.644
IN_AIR = {**TRUTH, "terminal_speed_m_s": TERMINAL}


def times_of(values=TRUTH, count=7, model="power"):
    """Exact impact times."""
    return bounces(MODELS[model], values, count).impact_s


def heard(values=TRUTH, count=7, u_s=1e-4, seed=0, model="power") -> Impacts:
    """Impact times with noise."""
    noise = np.random.default_rng(seed).normal(0, u_s, count)
    return from_times(times_of(values, count, model) + noise, u_s)[0]


def filmed_samples(values=TRUTH, fps=30, u_m=3e-3, seconds=3.0, seed=0, floor=0.123):
    """Times and heights of a video: in the hand until the release, then bouncing."""
    generator = np.random.default_rng(seed)
    whole = {**values, "floor_m": floor}
    time = np.arange(0, seconds, 1 / fps) + generator.uniform(0, 1 / fps)
    found = bounces(MODELS["power"], whole, 40)
    # after the last bounce the ball lies on the floor
    height = np.fmax(height_at(found, whole, time, np.searchsorted(found.impact_s, time)), floor)
    height = np.where(time < values["release_time_s"], values["drop_height_m"] + floor, height)
    return time, height + generator.normal(0, u_m, len(time))


def filmed(values=TRUTH, u_m=3e-3, stated=True, **more) -> Impacts:
    """Height against time with noise, cut into flights."""
    time, height = filmed_samples(values, u_m=u_m, **more)
    return arcs.from_heights(time, height, u_m if stated else None)


def drop_words(drop):
    """What a report says was left out of a drop."""
    return answer.dropped(records.drop_of(drop))


def warnings_of(fit):
    """What a report says that the reader of a fit must know."""
    return form_words.warnings(finite(records.form_of(fit)))


def choice_words(choice):
    """What a report says of closed forms."""
    return form_words.choice(
        finite(records.choice_of(choice)), finite(records.form_of(choice.best))
    )


def known_words(fit):
    """What a report says that the data can tell."""
    filmed = any(drop.track for drop in fit.problem.drops)
    recorded = "video track" if filmed else "sound"
    return identifiability_words.of_bounces(identifiability(fit), fit.problem.priors, recorded)


def recording(streams=None, events=(), file="log.csv") -> Recording:
    """A recording of channels {stream: (times, {channel: (values, unit, u)})} and events."""
    made = {
        name: Stream(
            np.asarray(times, dtype=float),
            {c: Channel(np.asarray(v, dtype=float), unit, u=u) for c, (v, unit, u) in held.items()},
            Clock("test"),
        )
        for name, (times, held) in (streams or {}).items()
    }
    about = Provenance(file, "0" * 64, 1, "csv", "0", "repair")
    return Recording(made, about, tuple(Event(n, t, "log", u) for n, t, u in events))
