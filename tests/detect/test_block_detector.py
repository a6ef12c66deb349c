"""A detector in the loop says exactly what it says on the logged samples, and python-control can see the diagram."""

from types import SimpleNamespace

import control as ct
import numpy as np
import pytest
from stickslip.blocks import PI, BlockError, FirstOrder, SampledSensor, Step, StickSlip, Sum
from stickslip.cases import find
from stickslip.detect.blocks import DetectorBlock
from stickslip.detect.methods import area_ratio, harmonics, play_fit, stem_play
from stickslip.detect.oscillation import acf_crossings as oscillation
from stickslip.detect.oscillation import hagglund1995
from stickslip.detect.stream import LoopFacts, Sample
from stickslip.detect.words import WORDS
from stickslip.diagram import WiringError, simulate, wire
from stickslip.logs import LoopRecord

EVERY = 40


def loop_with(*more, measured="PV"):
    """The loop of all tests; what gives SP is among ``more``."""
    return wire(
        [
            PI(K_p=0.6, T_i=8.0, start_op=0.42, inputs={"PV": measured}),
            StickSlip.from_bands(S=0.06, J=0.03, start=0.40),
            FirstOrder(K=1.3, tau=5.0, theta=1.0, start=0.52),
            *more,
        ]
    )


def sticky_loop(*more):
    return loop_with(Step("SP", 0.55), SampledSensor(dt=1.0, sd=0.0008, seed=11), *more, measured="PV_m")


@pytest.fixture(scope="module")
def log():
    block = DetectorBlock(area_ratio, dt=1.0, verdict_every=EVERY, inputs={"PV": "PV_m"})
    run = simulate(sticky_loop(block), 900.0, every=1.0)
    assert run.ok, run.hint
    return run.log


def test_equals_the_streaming_method_on_the_same_samples(log):
    p = area_ratio.Params()
    state = area_ratio.init(p, LoopFacts(name="area_ratio", process="self_regulating", op_span=(0.0, 1.0)))
    index, verdict, said = [], [], (np.nan, 0.0)
    for k, t in enumerate(log.t.tolist()):
        sample = Sample(pv=log["PV_m"][k], op=log["OP"][k], sp=log["SP"][k])
        state = area_ratio.update(p, state, t, sample)
        if (k + 1) % EVERY == 0:
            v = area_ratio.verdict(p, state)
            said = (np.nan if v.index is None else v.index, WORDS[v.verdict].number)
        index.append(said[0])
        verdict.append(said[1])
    np.testing.assert_array_equal(log["index"], index)
    np.testing.assert_array_equal(log["verdict"], verdict)


def test_equals_the_batch_method_when_the_last_verdict_falls(log):
    taken = len(log.t) // EVERY * EVERY
    head = slice(0, taken)
    record = LoopRecord.from_arrays(
        log.t[head], pv=log["PV_m"][head], op=log["OP"][head], sp=log["SP"][head], op_span=(0.0, 1.0),
        process="self_regulating",
    )  # fmt: skip
    batch = area_ratio.detect(record)
    assert batch.verdict == "stiction"
    assert log["verdict"][-1] == WORDS["stiction"].number
    assert log["index"][-1] == pytest.approx(batch.index, rel=1e-12)


def test_it_waits_for_cycles_before_it_speaks(log):
    speaks = np.flatnonzero(log["verdict"] == WORDS["stiction"].number)
    assert log["verdict"][0] == WORDS["not_applicable"].number and np.isnan(log["index"][0])
    assert 100 < log.t[speaks[0]] < 600
    assert np.all(np.isnan(log["index"]) == (log["verdict"] == WORDS["not_applicable"].number))


def test_watching_changes_nothing(log):
    alone = simulate(sticky_loop(), 900.0, every=1.0).log
    for name in ("PV", "OP"):
        # Watching puts steps at the sampling times, which the sensor has anyway.
        np.testing.assert_allclose(log[name][:120], alone[name][:120], rtol=0, atol=1e-4)


def test_python_control_sees_the_diagram():
    block = DetectorBlock(area_ratio, dt=1.0)
    loop = wire([Step("SP", 0.5), PI(K_p=0.4, T_i=10.0, outputs="OP"), FirstOrder(K=3.0, tau=10.0, inputs="OP"), block])
    assert isinstance(loop, ct.InterconnectedSystem)
    t = np.linspace(0.0, 40.0, 41)
    theirs = ct.input_output_response(loop, t, 0.0, loop.x0)
    ours = simulate(loop, 40.0, every=1.0).log
    rows = {name: theirs.outputs[i] for i, name in enumerate(loop.output_labels)}
    np.testing.assert_allclose(rows["PV"], ours["PV"], rtol=0, atol=1e-3)
    np.testing.assert_array_equal(rows["verdict"], ours["verdict"])


def loop_that_steps_aside(feedback):
    """The set point moves when the detector speaks."""
    return loop_with(Step("SP_given", 0.55), *feedback, DetectorBlock(area_ratio, dt=1.0, verdict_every=EVERY))


def test_it_can_be_fed_back_through_a_lag():
    lag = FirstOrder(K=1.0, tau=2.0, inputs="verdict", outputs="seen", name="lag")
    run = simulate(loop_that_steps_aside([lag, Sum("SP", {"SP_given": 1.0, "seen": 0.02})]), 900.0, every=1.0)
    assert run.ok
    verdict = run.log["verdict"]
    first = int(np.argmax(verdict > 0.0))
    assert first > 100
    assert np.all(run.log["SP"][:first] == 0.55)
    moved = 0.55 + 0.02 * verdict[first]  # analytic: 10 lags later, with the next verdict still to come
    assert run.log["SP"][first + 20] == pytest.approx(moved, abs=1e-5)


def test_fed_back_at_once_it_is_an_algebraic_loop():
    with pytest.raises(WiringError, match=r"algebraic loop.*verdict.*lag"):
        loop_that_steps_aside([Sum("SP", {"SP_given": 1.0, "verdict": 0.02})])


def method_that_streams(how):
    """A card alone, which says whether the method streams."""
    return SimpleNamespace(CARD=SimpleNamespace(name="x", streams=how, kind="detector", stream_note="It is not told."))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"dt": 0.0}, r"dt = 0\.0.*give seconds"),
        ({"dt": -1.0}, r"dt = -1\.0"),
        ({"dt": float("nan")}, r"dt = nan"),
        ({"dt": 1.0, "verdict_every": 0}, r"verdict_every = 0.*1 or more"),
        ({"dt": 1.0, "process": "runaway"}, r"process = 'runaway'.*self_regulating"),
        ({"dt": 1.0, "method": np}, "no detector.*area_ratio"),
        ({"dt": 1.0, "method": method_that_streams("no")}, r"x: .*does not stream.*It is not told.*diagnose\(run.log"),
        ({"dt": 1.0, "method": method_that_streams("exact")}, r"x: .*It has no Params"),
        ({"dt": 1.0, "method": stem_play}, r"stem_play: .*not the stem position"),
        ({"dt": 1.0, "method": hagglund1995}, r"hagglund1995: .*It is an oscillation detector"),
        ({"dt": 1.0, "method": oscillation}, r"acf_crossings: .*does not stream"),
    ],
    ids=lambda value: str(value)[:40],
)
def test_refusals(options, words):
    with pytest.raises(BlockError, match=words):
        DetectorBlock(**({"method": area_ratio} | options))


@pytest.mark.parametrize("method", [harmonics, play_fit], ids=lambda method: method.CARD.name)
def test_any_method_that_streams_can_be_wired(method):
    """Pooled or in a window: the block says at the end what batch says of the samples, which fit the window."""
    block = DetectorBlock(method, dt=1.0, verdict_every=300, inputs={"PV": "PV_m"})
    log = simulate(sticky_loop(block), 899.0, every=1.0).log
    record = LoopRecord.from_arrays(
        log.t, pv=log["PV_m"], op=log["OP"], sp=log["SP"], op_span=(0.0, 1.0), process="self_regulating"
    )
    batch = method.detect(record)
    assert len(log.t) == 900 and log["verdict"][-1] == WORDS[batch.verdict].number
    assert log["index"][-1] == pytest.approx(batch.index, rel=1e-9)


@pytest.mark.parametrize(("method", "word"), [(area_ratio, "stiction"), (play_fit, "inconclusive")])
def test_python_control_gets_the_offline_verdict_in_the_thesis_loop(method, word):
    loop = wire([*find("ideal_high").build().blocks, DetectorBlock(method, dt=1.0, verdict_every=100)])
    ours = simulate(loop, 600.0, every=1.0).log
    theirs = ct.input_output_response(loop, ours.t, 0, loop.x0, solve_ivp_method="LSODA")
    rows = {name: theirs.outputs[i] for i, name in enumerate(loop.output_labels)}
    head = slice(0, 600)  # the last verdict falls at sample 600
    seen = LoopRecord.from_arrays(
        ours.t[head], pv=rows["PV"][head], op=rows["OP"][head], sp=rows["SP"][head], op_span=(0.0, 1.0),
        process="self_regulating",
    )  # fmt: skip
    offline = method.detect(seen)
    assert offline.verdict == word
    assert rows["verdict"][-1] == ours["verdict"][-1] == WORDS[word].number
    assert rows["index"][-1] == pytest.approx(offline.index, rel=1e-9)
