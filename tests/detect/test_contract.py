"""What every method must do, asked of each of METHODS."""

import importlib
import pkgutil
from dataclasses import replace

import numpy as np
import pytest
import stickslip.detect.methods
import stickslip.detect.oscillation
from stickslip.detect import GATES, METHODS
from stickslip.detect.window_twin import WINDOW, twin_of
from stickslip.logs import LoopRecord

from tests.detect.one_by_one import replay

# The loop in which a method can see a sticky valve at all, where its card asks for a special one.
SEEN_IN = {
    "bicoherence": {"n": 6000, "walk": 0.01, "R": 10.0},  # blind on symmetric waves and on exact repetition
    "hagglund2011": {"tau": 1.0, "K_p": 0.2, "T_i": 5.0},  # a process fast against the half period
    "harmonics": {"load": 50.85},  # unequal half waves have a second harmonic
    "relay_fit": {"load": 50.85},  # half waves of a relay are symmetric
    "surrogates": {"n": 9000, "walk": 0.03},  # so is this one, and it wants twelve cycles
    ("surrogates", "integrating"): {"n": 9000, "walk": 0.01},  # a load moves a level more
}


def seen(sticky, method, process, **more):
    name = method.CARD.name
    return sticky(process, **{**more, **SEEN_IN.get((name, process), SEEN_IN.get(name, {}))})


by_name = pytest.mark.parametrize("method", METHODS, ids=lambda m: m.CARD.name)


def test_every_card_is_listed():
    rooms = (stickslip.detect.methods, stickslip.detect.oscillation)
    pages = [
        importlib.import_module(f"{room.__name__}.{m.name}")
        for room in rooms
        for m in pkgutil.iter_modules(room.__path__)
    ]
    with_card = {page.__name__ for page in pages if hasattr(page, "CARD")}
    assert with_card == {m.__name__ for m in (*METHODS, *GATES)}
    assert all(m.CARD.kind == "detector" for m in METHODS)
    assert all(m.CARD.kind == "gate" for m in GATES)


@pytest.mark.parametrize("page", [*METHODS, *GATES], ids=lambda m: m.CARD.name)
def test_card_is_complete(page):
    card = page.CARD
    assert page.__name__ in (f"stickslip.detect.methods.{card.name}", f"stickslip.detect.oscillation.{card.name}")
    assert card.title and card.source and card.finds and card.assumes and card.pros and card.cons
    assert set(card.signals) <= {"SP", "PV", "OP", "MV"}
    assert card.index[0] < card.index[1]


def noise(seed):
    rng = np.random.default_rng(seed)
    return rng.normal(size=1000)


def awkward(loop):
    t = np.arange(1000.0)
    e = np.sin(t / 8)
    holes = e.copy()
    holes[(t % 100) < 85] = np.nan
    stuck_op = LoopRecord.from_arrays(t, pv=30 - e, op=np.full(1000, 42.0), sp=np.full(1000, 30.0))
    at_limit = LoopRecord.from_arrays(t, pv=30 - e, op=np.where(e > 0, 100.0, 60.0), sp=np.full(1000, 30.0))
    return {
        "three rows": loop(t[:3], e[:3]),
        "one row": loop(t[:1], e[:1]),
        "two cycles": loop(t[:100], e[:100]),
        "flat PV": loop(t, 0 * e),
        "OP never moves": stuck_op,
        "OP at its limit": at_limit,
        "gappy": loop(t, holes),
        "all missing": loop(t, np.full(1000, np.nan)),
        "manual": loop(t, e, mode=np.zeros(1000)),
    }


@by_name
def test_record_is_untouched(method, wave, loop):
    t = np.arange(1000.0)
    record = loop(t, wave("exponential", t))
    before = {name: values.copy() for name, values in record.log.signals.items()}
    method.detect(record)
    assert all((record.log[name] == values).all() for name, values in before.items())


@by_name
def test_silent_on_noise(method, loop):
    t = np.arange(1000.0)
    assert all(method.detect(loop(t, noise(seed))).verdict != "stiction" for seed in range(40))


@by_name
def test_silent_on_a_sine(method, wave, loop):
    t = np.arange(2000.0)
    for period in (23.0, 50.0, 173.0):
        for share in (0.0, 0.2):
            e = wave("sine", t, period) + share * np.random.default_rng(1).normal(size=2000)
            assert method.detect(loop(t, e)).verdict != "stiction"


@by_name
@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
def test_finds_a_strong_stick_and_slip(method, process, sticky):
    if process not in method.CARD.process:
        assert method.detect(sticky(process)).code == "wrong_process_type"
        return
    for noise in (0.02, 0.1):
        v = method.detect(seen(sticky, method, process, noise=noise))
        if method.CARD.accuses:
            assert v.verdict == "stiction", v.reason
        else:
            assert v.verdict == "inconclusive" and v.index > v.threshold, v.reason
        assert method.CARD.index[0] <= v.index <= method.CARD.index[1]
        if v.amount_percent_op is not None:
            assert 3.0 < v.amount_percent_op < 9.0  # S = 6 %


@by_name
@pytest.mark.parametrize("case", list(awkward(lambda t, e, **k: None)))
def test_abstains_on_awkward_data(method, loop, case):
    v = method.detect(awkward(loop)[case])
    assert v.verdict == "not_applicable"
    assert v.index is None
    assert v.reason.endswith(".")


@by_name
def test_the_card_says_how_it_streams(method):
    own = all(hasattr(method, part) for part in ("init", "update", "verdict"))
    pools = hasattr(method, "remember") and hasattr(method, "recall")
    says = method.CARD.streams
    assert says == ("exact" if own else "pooled" if pools else says if says in ("window", "no") else "neither")
    if says in ("window", "no"):  # a twin of its own is owed, or a sentence why there is none
        assert method.CARD.stream_note.endswith(".") and len(method.CARD.stream_note.split()) > 8
    else:
        assert not method.CARD.stream_note


@by_name
def test_stream_agrees_with_batch(method, sticky):
    if method.CARD.streams == "no":
        pytest.skip("does not stream")
    record = replace(seen(sticky, method, method.CARD.process[0], noise=0.1, n=6000), mv_name=None)  # no stream has it
    p, twin = method.Params(), twin_of(method)
    said = twin.verdict(p, replay(twin, record, p))
    if method.CARD.streams == "window":  # that of batch on the last samples
        record = last_of(record, WINDOW // 2 + (len(record) - WINDOW) % (WINDOW // 2))
    batch = method.detect(record, p)
    assert said.verdict == batch.verdict, (said.reason, batch.reason)
    near = max(method.CARD.stream_bound, 1e-9)
    assert said.index == (None if batch.index is None else pytest.approx(batch.index, rel=near, abs=near))


def last_of(record, last):
    """The last samples of a record."""
    return LoopRecord.from_arrays(
        record.t[-last:], pv=record.pv[-last:], op=record.op[-last:], sp=record.sp[-last:], process=record.process,
        op_span=record.op_span, name=record.name,
    )  # fmt: skip


@by_name
def test_a_stream_never_accuses_noise_or_a_sine(method, loop, wave):
    if method.CARD.streams == "no":
        pytest.skip("does not stream")
    p, twin, t = method.Params(), twin_of(method), np.arange(4500.0)
    for e in (np.random.default_rng(5).normal(size=4500), wave("sine", t, 47.0) + 0.1 * noise(1).repeat(5)[:4500]):
        assert twin.verdict(p, replay(twin, loop(t, e), p)).verdict != "stiction"


@by_name
def test_picture_shows_something(method, loop, sticky):
    for record in (seen(sticky, method, method.CARD.process[0], noise=0.1), loop(np.arange(1000.0), np.zeros(1000))):
        figure = method.detect(record).plot()
        figure.canvas.draw()
        assert figure.axes


@by_name
def test_same_answer_twice(method, wave, loop):
    t = np.arange(1000.0)
    record = loop(t, wave("exponential", t) + 0.1 * noise(0))
    assert method.detect(record).to_dict() == method.detect(record).to_dict()
