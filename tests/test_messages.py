"""What an engine's process sends: the same comes out, nothing runs, and garbage is refused."""

from __future__ import annotations

import dataclasses
import math
import pickle
import socket
import struct
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simcompare.characterization.behaviour import BounceBehaviour, SpreadAtSpeed, StepLimits
from simcompare.engine.backend import KnownLimit
from simcompare.fitting.tosses.replay import Replayed
from simcompare.fitting.tosses.tosses import Errors
from simcompare.model.audit import AuditRow
from simcompare.model.scenes import scene
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Trajectory
from simcompare.model.tuning import AtSpeed, TuningRow
from simcompare.running.jobs import FAILED, OK, UNSUPPORTED, Facts, Inquiry, Job, Outcome, Reply
from simcompare.running.messages import received, sent
from simcompare.running.wire import BadFrame, receive, send
from simcompare.tuning.statement import Range, Statement, Typed
from tests.array_logs import Evil

BALL = {"mass_kg": 1.0, "inertia_kg_m2": [0.1] * 3, "position_m": [0.0, 0.0, 10.0],
        "shapes": [{"type": "sphere", "radius_m": 0.5}]}  # fmt: skip
JOB = Job("toy", scene("fall", {"ball": BALL}, 0.2, 0.001), Settings(), at="@2ms")

numbers = st.floats(allow_nan=False, allow_infinity=False)
maybe = st.none() | numbers
at_speeds = st.builds(AtSpeed, *[numbers] * 6)
tuples = {"numbers": st.tuples(numbers, numbers), "notes": st.tuples(st.text()),
          "pairs": st.just((("a", "b"),)), "at": st.tuples(at_speeds),
          "checks": st.tuples(at_speeds)}  # fmt: skip
rows = st.builds(AuditRow, st.text(), maybe, st.text(), maybe, maybe, st.text(), st.text())
tunings = st.builds(TuningRow, restitution=numbers, speed_m_s=numbers, step_s=numbers, **tuples)
facts = st.builds(
    Facts,
    st.none() | st.text(),
    st.lists(st.text()).map(tuple),
    st.text(),
    st.tuples(st.builds(KnownLimit, st.text(), st.text())),
)
arrays = st.sampled_from(["<f8", "<f4", "<i8", "|b1"]).map(
    lambda kind: np.arange(12).reshape(4, 3).astype(kind)
)
trajectories = st.builds(
    Trajectory,
    source=st.just(JOB.source),
    contact=st.just(JOB.mode),
    time_s=st.just(np.arange(4.0)),
    signals=st.dictionaries(st.text(), arrays),
    version=st.text(),
    wall_s=st.dictionaries(st.text(), numbers),
    audit=st.tuples(rows),
    notes=st.tuples(st.text()),
    helps=st.tuples(st.text()),
    velocity_offset_s=numbers,
    tuning=st.tuples(tunings),
    lacks=st.dictionaries(st.text(), st.text()),
)
ended = st.builds(Outcome, st.just(JOB), st.just(OK), trajectory=trajectories, facts=facts)
refused = st.builds(
    Outcome, st.just(JOB), st.just(UNSUPPORTED), st.text(), facts=facts, longest_step_s=maybe
)


def through(ended, number=0, most=2**20):
    """What comes out at the other end of a connection."""
    ours, theirs = socket.socketpair()
    with ours, theirs:
        threading.Thread(target=send, args=(theirs, *sent(number, ended))).start()
        frame = receive(ours, lambda: most)
        assert frame is not None
        return received(number, ended.job, *frame)


def plainly(value):
    """A record by its parts, with arrays as their kind, shape and bytes."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, Job | Inquiry):
        return id(value)
    if dataclasses.is_dataclass(value):
        return {f.name: plainly(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, dict):
        return {name: plainly(one) for name, one in value.items()}
    return tuple(map(plainly, value)) if isinstance(value, tuple) else value


@settings(max_examples=60, derandomize=True)
@given(ended | refused)
def test_an_outcome_arrives_as_it_was_sent(outcome):
    assert plainly(through(outcome)) == plainly(outcome)


@dataclasses.dataclass(frozen=True)
class Asks:
    """A question whose answer is of some kind."""

    kind: type

    def __call__(self, backend):
        raise NotImplementedError


SPREAD = SpreadAtSpeed(speed_m_s=1.0, mean=0.5, scatter=0.1, least=0.0, most=1.0, bounced=1.0)
BOUNCES = BounceBehaviour(
    numbers=(1.0, 2.0), phases=(0.0, 0.5), over_phase=(0.4, 0.6), over_speed=(SPREAD,),
    over_step=(), retuned=(), slowest_m_s=0.1, dies_below_m_s=None, hops_at_m_s=0.2,
    too_large=StepLimits(None, 0.01), too_small=StepLimits(0.001, None), gains_above_s=None,
)  # fmt: skip
SPEED = AtSpeed(1.0, 0.5, 0.01, 1e-4, 1e-3, 1e-5)
STATEMENT = Statement(
    0.5, (1.0, 2.0), (Typed("solref", 0.1, "s", True),), (SPEED,), Range(0.1, 3.0), None
)


@pytest.mark.parametrize("answer", [BOUNCES, STATEMENT, Replayed(Errors(1.0, 2.0, 3.0), 0.1)])
def test_an_answer_arrives_as_it_was_sent(answer):
    reply = Reply(Inquiry("toy", Asks(type(answer))), OK, value=answer, version="1.0")
    assert through(reply) == reply
    failed = Reply(reply.job, FAILED, "no licence")
    assert through(failed) == failed


def test_what_is_not_finite_arrives_as_no_number():
    spread = dataclasses.replace(SPREAD, mean=math.inf)
    answer = dataclasses.replace(BOUNCES, over_speed=(spread,))
    reply = Reply(Inquiry("toy", Asks(BounceBehaviour)), OK, value=answer)
    assert math.isnan(through(reply).value.over_speed[0].mean)


def test_large_arrays_are_not_copied_where_they_arrive():
    """All of them lie in the memory into which they were received."""
    signals = {"a": np.ones((1000, 3)), "b": np.ones(1000)}
    made = Trajectory("toy@2ms", np.arange(1000.0), signals, contact=JOB.mode)
    got = through(Outcome(JOB, OK, trajectory=made)).trajectory
    owners = set()
    for array in (got.time_s, *got.signals.values()):
        while isinstance(array.base, np.ndarray):
            array = array.base
        owners.add(id(array.base.obj))
    assert len(owners) == 1


def refusal(data, most=2**20):
    """What is said of bytes that come in."""
    ours, theirs = socket.socketpair()
    with ours, theirs:
        theirs.sendall(data)
        theirs.shutdown(socket.SHUT_WR)
        with pytest.raises(BadFrame) as error:
            receive(ours, lambda: most)
    return str(error.value)


def frame(**parts):
    """A frame's bytes."""
    ours, theirs = socket.socketpair()
    with ours, theirs:
        send(theirs, parts, [np.arange(3.0)])
        return bytearray(ours.recv(10_000))


def test_bytes_that_are_no_frame_are_refused(tmp_path):
    mark = tmp_path / "ran"
    assert "no frame" in refusal(b"hello from an engine\n" * 10)
    assert "no frame" in refusal(pickle.dumps(Evil(mark)).ljust(100, b"."))
    assert not mark.exists()


def test_every_changed_byte_of_a_frame_but_of_its_numbers_is_seen():
    whole = frame(index=1)
    assert len(whole) < 200
    seen = {}
    for i in range(len(whole)):
        data = bytearray(whole)
        data[i] ^= 0x20
        ours, theirs = socket.socketpair()
        with ours, theirs:
            theirs.sendall(data)
            theirs.shutdown(socket.SHUT_WR)
            try:
                seen[i] = receive(ours, lambda: 24)
            except BadFrame:
                seen[i] = BadFrame
    taken = [i for i, found in seen.items() if found not in (None, BadFrame)]
    assert taken == [*range(len(whole) - 32, len(whole) - 8)]


def test_bytes_within_a_frame_are_seen():
    whole = frame(index=1)
    for i in range(1, len(whole) - 1):
        refusal(whole[:i] + b"progress: 10 %\n" * 10 + whole[i:])


def test_what_is_too_large_is_not_read():
    start = struct.Struct("<8s8sQQI").pack(b"\x93simcmp\n", b"12345678", 100, 10 * 2**30, 0)
    assert "at most 1048576" in refusal(start)
    start = struct.Struct("<8s8sQQI").pack(b"\x93simcmp\n", b"12345678", 10 * 2**30, 0, 0)
    assert "at most 1048576" in refusal(start)


def test_half_a_frame_is_the_end():
    ours, theirs = socket.socketpair()
    with ours, theirs:
        theirs.sendall(frame()[:-1])
        theirs.shutdown(socket.SHUT_WR)
        assert receive(ours, lambda: 2**20) is None


@pytest.mark.parametrize("odd", [np.array([object()]), np.array(["text"]), np.array([1j])])
def test_arrays_of_something_else_than_numbers_do_not_leave(odd):
    ours, theirs = socket.socketpair()
    with ours, theirs, pytest.raises(ValueError, match="expected numbers"):
        send(theirs, {}, [odd])


@pytest.mark.parametrize(
    "changes",
    [
        {"number": 1},
        {"status": "fine"},
        {"status": "ok", "reason": None},
        {"reason": None},
        {"reason": 3},
        {"facts": {"mapping": ["x"]}},
        {"longest_step_s": "long"},
        {"motion": {"signals": ["a"]}},
    ],
)
def test_an_answer_of_another_form_is_refused(changes):
    head, arrays = sent(0, Outcome(JOB, FAILED, "no licence"))
    with pytest.raises(ValueError):  # noqa: PT011  (each says it in its own words)
        received(0, JOB, {**head, **changes}, arrays)
