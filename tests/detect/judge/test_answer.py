"""The calibrated answer: refusals first, then the stem, then the model; a claim has a size."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.cases.stories import EXPORTS
from stickslip.detect import diagnose
from stickslip.detect.judge.actions import CAUSES, confirming_steps
from stickslip.detect.judge.answer import LEVEL, Amount, answer, next_step
from stickslip.detect.judge.features import features
from stickslip.detect.judge.model import FILE, PLACE, SEEN, Model, calibrated
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stem.stick import stick
from stickslip.logs import LoopRecord, read_loop
from stickslip.logs.two_digits import rounded

from ..likelihood.loops import run

RNG = np.random.default_rng(0)
T = np.arange(800.0)


@pytest.fixture(scope="module")
def sticky():
    return read_loop(EXPORTS / "FIC101_pi_export.csv")


def test_a_sticky_valve_is_told_with_size_cause_and_action(sticky):
    found = answer(Prepared(sticky))
    assert found.word == "stiction" and found.probability >= calibrated().accuse
    assert found.S.low < found.S.value < found.S.high and found.S.unit == "% of OP"
    assert found.J.value <= found.S.value and found.J.low <= found.J.value <= found.J.high
    assert next(iter(found.causes)) == "stiction"
    for piece in ("valve maintenance", "To confirm", f"steps of {rounded(found.S.value / 4):g} %"):
        assert piece in found.action
    # S of the example's valve is 5 % of OP, by how it was made
    assert found.S.low <= 5.0 <= found.S.high


@pytest.mark.parametrize(("J", "seed"), [(0.0, 40), (4.0, 44), (2.0, 5)])
def test_s_is_stated_as_narrowly_as_the_likelihood_supports(J, seed):
    op, pv = run(S=4.0, J=J, seed=seed)
    loop = Prepared(LoopRecord.from_arrays(np.arange(2000.0), pv=pv, op=op, op_span=(0.0, 100.0)))
    S = answer(loop).S
    assert loop.dead_travel.without_best > 40.0
    assert S.low <= 4.0 <= S.high < 2.5 * S.low  # it was 4.9 times whatever the record showed


def test_causes_sum_to_one_and_agree_with_the_probability(sticky):
    found = answer(Prepared(sticky))
    assert sum(found.causes.values()) == pytest.approx(1.0)
    assert found.causes["stiction"] == found.probability
    assert set(found.causes) == set(CAUSES)


@pytest.mark.parametrize(
    "pv, op, piece",
    [
        (0 * T + 4, 50 + np.sin(T / 9), "PV stays at 4"),
        (np.sin(T / 9), 0 * T + 50, "OP stays at 50"),
        (np.where(T < 700, np.nan, 1.0), 50 + np.sin(T / 9), "missing"),
    ],
)
def test_a_record_that_shows_nothing_is_refused_without_a_probability(pv, op, piece):
    found = answer(Prepared(LoopRecord.from_arrays(T, pv=pv, op=op, sp=0 * T)))
    assert found.word == "not_applicable" and found.probability is None and not found.causes
    assert piece in found.reason


def test_too_few_samples_are_refused():
    found = answer(Prepared(LoopRecord.from_arrays(T[:80], pv=np.sin(T[:80] / 5), op=50 + np.cos(T[:80] / 5))))
    assert found.word == "not_applicable" and "80 samples" in found.reason


def test_a_one_way_drift_settles_nothing():
    found = answer(Prepared(LoopRecord.from_arrays(T, pv=RNG.normal(size=800), op=20 + T / 20, sp=0 * T)))
    assert found.word == "inconclusive" and "load ramp" in found.reason


@pytest.mark.parametrize(
    "pv, op",
    [
        (RNG.normal(size=800), 50 + RNG.normal(size=800)),  # noise that is not correlated
        (np.sin(T / 30), 50 + np.sin(T / 11)),  # waves that have nothing to do with each other
    ],
)
def test_uncorrelated_signals_clear_nothing_and_accuse_nothing(pv, op):
    said = answer(Prepared(LoopRecord.from_arrays(T, pv=pv, op=op, sp=0 * T))).word
    assert said in ("inconclusive", "not_applicable")  # white noise has no five samples a period


def test_no_stiction_is_a_claim_with_a_size():
    # PI of unit gain on a fast lag, driven by set-point moves: PV follows OP through many turns without any stick
    sp = np.convolve(RNG.normal(size=1600), np.ones(40) / 15, mode="valid")[:1500] * 6
    x = integral = 0.0
    pv, op = np.empty(1500), np.empty(1500)
    for k in range(1500):
        e = sp[k] - x
        integral += 0.5 * e / 12
        op[k] = 50 + 0.5 * e + integral
        pv[k] = x
        x += (1.2 * (op[k] - 50) - x) / 10
    pv += 0.01 * np.random.default_rng(1).normal(size=1500)
    found = answer(Prepared(LoopRecord.from_arrays(np.arange(1500.0), pv=pv, op=op, sp=sp)))
    assert found.word in ("no_stiction", "inconclusive") and found.probability < 0.5
    if found.word == "no_stiction":
        size, unit = found.limit
        assert f"S is below {rounded(size):g} {unit}" in found.reason
        assert 0 < size <= 0.5 * np.ptp(op)


def test_the_stem_answers_where_it_is_logged(sticky):
    t = np.arange(3000.0)
    op = 50 + 6 * np.sin(t / 60) + np.sin(t / 171)
    pv = np.random.default_rng(5).normal(size=3000)
    for mv, word in ((stick(op, 4.0, 2.0, 0.0), "stiction"), (op - 0.0, "no_stiction")):
        found = answer(Prepared(LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t, mv=mv)))
        assert found.word == word and found.probability is None
        assert "not from PV" in found.reason
        if word == "stiction":
            assert found.S.value == pytest.approx(4.0, rel=0.1)  # analytic
            assert found.J.value == pytest.approx(2.0, rel=0.15)  # analytic
            assert "log the stem" not in found.action


def test_pv_at_the_end_of_its_span_settles_nothing(sticky):
    low = float(np.nanpercentile(sticky.pv, 40))
    high = float(np.nanmax(sticky.pv)) + 1.0
    limited = replace(sticky, log=replace(sticky.log, spans={**sticky.log.spans, sticky.pv_name: (low, high)}))
    found = answer(Prepared(limited))
    assert found.word == "inconclusive" and "end of its span" in found.reason


def test_sizes_follow_the_unit_of_op_and_nothing_else_does(sticky):
    good = sticky.good
    t, pv, op = sticky.t[good], sticky.pv[good], sticky.op[good]
    sp = sticky.sp[good]
    plain = answer(Prepared(LoopRecord.from_arrays(t, pv=pv, op=op, sp=sp)))
    volts = answer(Prepared(LoopRecord.from_arrays(t, pv=pv, op=op / 25, sp=sp, op_span=(0.0, 4.0))))
    unknown = answer(Prepared(LoopRecord.from_arrays(t, pv=pv, op=op / 25, sp=sp, op_span=None)))
    assert plain.word == volts.word == unknown.word
    assert volts.probability == pytest.approx(plain.probability, abs=0.02)
    assert volts.S.value == pytest.approx(plain.S.value, rel=0.05) and volts.S.unit == "% of OP"
    assert unknown.S.value == pytest.approx(plain.S.value / 25, rel=0.05) and "unit of OP" in unknown.S.unit


def test_the_diagnosis_says_the_same(sticky):
    found, said = answer(Prepared(sticky)), diagnose(sticky).to_dict()
    assert said["verdict"] == found.word and said["probability"] == found.probability
    assert said["amount"]["S"] == found.S.to_dict() and set(said["amount"]["J"]) == {"value", "low", "high", "unit"}
    assert "methods that could look" in said["reason"] and said["action"] == found.action


def test_the_file_is_small_open_and_names_every_feature(sticky):
    assert FILE.stat().st_size < 2e6
    model = Model.read(FILE)  # plain JSON
    assert {*SEEN, *PLACE, *(f"network_{kind}" for kind in model.kinds)} <= set(features(Prepared(sticky)))
    assert 0.5 < model.accuse < 1.0 and 0.0 < model.clear < 0.3
    assert {"stiction", *model.kinds.values()} == set(CAUSES)


def test_a_file_of_another_kind_is_refused(tmp_path):
    file = tmp_path / "other.json"
    file.write_text('{"schema": "something/9"}', encoding="utf-8")
    with pytest.raises(ValueError, match=r"holds no stickslip.*calibration train"):
        Model.read(file)


def test_steps_follow_the_size():
    assert "steps of 0.25 %" in confirming_steps("stiction", 1.0, "% of OP")
    assert "{" not in "".join(confirming_steps(cause, 2.0, "% of OP") for cause in CAUSES)


def test_a_healthy_loop_is_told_in_a_plain_sentence():
    S = Amount(1.0, 0.5, 2.0, "% of OP")
    assert next_step({"healthy": 0.95, "stiction": 0.05}, S, False) == "Nothing needs to be done."
    settling = next_step({"healthy": 0.5, "stiction": 0.16}, S, False, settled=False, doubted=True)
    assert settling.startswith(
        "Nothing at the valve yet. To settle it: log the stem position, or put the loop in manual"
    )
    said = next_step({"sensor": 0.95, "stiction": 0.05}, S, False)
    assert "(instrument technician). To confirm: compare" in said
    for one in CAUSES.values():  # a test has somebody who makes it
        assert bool(one.owner) == bool(one.test)


def test_a_stem_that_never_moves_is_told_with_the_least_size():
    t = np.arange(1200.0)
    op = 50.0 + 2.0 * np.sin(t / 30)
    pv = 5.0 + np.sin(t / 200)
    stem = np.full(1200, 48.0)
    found = answer(Prepared(LoopRecord.from_arrays(t, pv=pv, op=op, mv=stem, op_span=(0, 100))))
    assert found.word == "stiction"
    assert "S + J above 4 % of OP" in found.reason and "A dead transmitter of the stem would look" in found.reason
    far = 50.0 + 10.0 * (op - 50.0)
    wide = answer(Prepared(LoopRecord.from_arrays(t, pv=pv, op=far, mv=stem, op_span=(0, 100))))
    assert wide.word == "inconclusive" and "its transmitter may be dead" in wide.reason
    moved = np.where(t > 600, 48.5, 48.0)
    assert (
        "never moves"
        not in answer(Prepared(LoopRecord.from_arrays(t, pv=pv, op=op, mv=moved, op_span=(0, 100)))).reason
    )


class Sure:
    """The calibrated model with a probability that is given."""

    def __init__(self, probability):
        self.model, self.probability = calibrated(), probability

    def __getattr__(self, name):
        return getattr(self.model, name)

    def judge(self, found):
        said = self.model.judge(found)
        return replace(said, causes=said.causes | {"stiction": self.probability})


@pytest.mark.parametrize("process, word", [("integrating", "inconclusive"), ("self_regulating", "stiction")])
def test_in_a_process_that_integrates_stiction_is_called_from_a_higher_probability_on(sticky, process, word):
    """There a deadband without jump makes the loop cycle, too, and the model has not seen that."""
    loop = Prepared(replace(sticky, process=process))
    found = answer(loop, Sure(0.5 * (calibrated().accuse + LEVEL)))
    assert found.word == word
    assert ("a deadband without jump makes a loop cycle" in found.reason) == (word == "inconclusive")
    assert answer(loop, Sure(0.999)).word == "stiction"


def test_stiction_needs_more_where_the_records_own_likelihood_speaks_against_it(sticky):
    """Between the two limits a record is called whose dead travel does not lose ten nats, and left open else."""
    model = calibrated()
    between = Sure(0.5 * (model.accuse + model.contested))
    assert model.accuse < model.contested < 1.0
    assert answer(Prepared(sticky), between).word == "stiction"
    op, pv = run(S=0.0, seed=3)
    loop = Prepared(LoopRecord.from_arrays(np.arange(2000.0), pv=pv, op=op, op_span=(0.0, 100.0)))
    assert loop.dead_travel.gain < -10.0
    found = answer(loop, between)
    assert found.word == "inconclusive" and f"{100.0 * model.contested:.0f} % and more" in found.reason
    assert answer(loop, Sure(0.5 * (model.contested + 1.0))).word == "stiction"
