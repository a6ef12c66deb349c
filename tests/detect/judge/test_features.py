"""Features against closed forms, and their indifference to unit, offset, sign and time scale."""

import math

import numpy as np
import pytest
from stickslip.detect.judge.features import MOST_NATS, features
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord


def closed_loop(
    n=1500, S=0.0, J=0.0, K=2.0, tau=12.0, K_p=0.8, T_i=8.0, noise=0.0, load=None, sp=None, seed=0,
):  # fmt: skip
    """Time, SP, PV, OP by plain Python: PI, the valve of Kano et al. 2004, a first-order lag; one sample a second."""
    rng = np.random.default_rng(seed)
    load = np.zeros(n) if load is None else load
    sp = np.zeros(n) if sp is None else sp
    noisy = noise * rng.normal(size=n)
    op, pv = np.empty(n), np.empty(n)
    integral = x = stem = stopped = before = 0.0
    stuck, way = True, 1.0
    for k in range(n):
        pv[k] = x + load[k] + noisy[k]
        e = sp[k] - pv[k]
        integral += K_p * e / T_i
        u = K_p * e + integral
        if not stuck and (u - before) * way <= 0.0:
            stopped, stuck = before, True
        if stuck:
            if -way * (u - stopped) > S:
                way, stuck = -way, False
            elif way * (u - stopped) > J:
                stuck = False
        if not stuck:
            stem = u - way * (S - J) / 2.0
        before = u
        x += (K * stem - x) / tau
        op[k] = u
    return np.arange(float(n)), sp, pv, op


def sticky(n=1500, S=5.0, J=3.0, noise=0.02, seed=0):
    """A cycle of a sticky valve, started by a step of the load."""
    load = np.full(n, 4.0)
    load[:20] = 0.0
    return closed_loop(n, S, J, noise=noise, load=load, seed=seed)


def record(t, sp, pv, op, **more):
    """The same as a record, OP about 50 %."""
    return LoopRecord.from_arrays(t, pv=pv, op=50.0 + op, sp=sp, **more)


T, SP, PV, OP = sticky()


def of(t, sp, pv, op, **more):
    return features(Prepared(LoopRecord.from_arrays(t, pv=pv, op=op, sp=sp, **more)))


@pytest.fixture(scope="module")
def base():
    """The features of the sticky loop."""
    return of(T, SP, PV, 50 + OP)


SIZES_AND_ODDS = ("network_S", "network_J", "network_sticky")


def read(found):
    """Return features with the network's log probabilities of kinds as probabilities: e-6 or e-7 is the same answer."""
    kinds = [name for name in found if name.startswith("network_") and name not in SIZES_AND_ODDS]
    return {**found, **{name: math.exp(found[name]) for name in kinds}}


def differing(found, tolerance, base):
    assert list(found) == list(base)
    base = read(base)
    return {
        name: (base[name], value)
        for name, value in read(found).items()
        if not (math.isnan(value) and math.isnan(base[name]))
        and abs(value - base[name]) > tolerance * (1 + abs(base[name]))
    }


@pytest.mark.parametrize(
    "same, tolerance",
    [
        (lambda: of(T, SP, PV, 500 + 20 * OP, op_span=None), 0.02),
        (lambda: of(T, 300 + 0.01 * SP, 300 + 0.01 * PV, 50 + OP), 0.02),
        (lambda: of(60 * T, SP, PV, 50 + OP), 2e-3),
        (lambda: of(T, -SP, -PV, 50 + OP), 2e-3),  # process gain and controller of the other sign
        (lambda: of(T, SP, PV, 50 - OP), 0.15),  # half waves begin with a rising crossing, so one comes or goes
    ],
    ids=["unit of OP", "unit of PV", "time", "gain", "action"],
)
def test_no_unit_offset_or_sign_is_left(same, tolerance, base):
    apart = differing(same(), tolerance, base)
    assert {name for name in apart if name.startswith("network_")} == set()
    # sizes are tried on a grid in the unit of OP, whose steps lie elsewhere in another unit
    found = same()
    assert found["dead_travel"] == pytest.approx(base["dead_travel"], rel=0.2, abs=2.0)
    assert found["samples"] == pytest.approx(base["samples"], abs=0.01)
    assert found["turns"] == pytest.approx(base["turns"], abs=0.01)


def test_nats_end_where_more_of_them_tell_no_more(base):
    assert base["dead_travel"] == MOST_NATS


def test_a_record_that_cannot_be_weighed_has_no_gain_of_dead_travel():
    kept = np.append(np.arange(0, len(T), 12), len(T) - 1)  # straight lines, as a historian draws them
    found = of(T, SP, np.interp(T, T[kept], PV[kept]), np.interp(T, T[kept], 50 + OP[kept]))
    assert math.isnan(found["dead_travel"])


def test_too_little_gives_no_features():
    t = np.arange(200.0)
    assert of(t, 0 * t, np.sin(t), 0 * t + 50) is None
    assert of(t[:30], 0 * t[:30], np.sin(t[:30]), 50 + np.cos(t[:30])) is None


def test_an_op_that_moves_in_the_last_samples_alone_gives_no_features():
    op = np.full(307, 25.0)
    op[-6:] = 26.0  # fewer than a block of the thinned record
    record = LoopRecord.from_arrays(np.arange(307.0), pv=np.sin(np.arange(307.0) / 9), op=op, sp=np.zeros(307))
    assert features(Prepared(record)) is None


def test_hopeless_records_give_numbers_or_nan_and_no_warning():
    rng = np.random.default_rng(0)
    t = np.arange(400.0)
    for pv, op in (
        (rng.normal(size=400), rng.normal(size=400)),
        (t, t),
        (np.where(t == 200, 1.0, 0.0), np.where(t > 300, 1.0, 0.0)),
        (np.round(np.sin(t / 9)), np.round(np.cos(t / 9))),
    ):
        found = of(t, 0 * t, pv, 50 + op)
        assert found is None or all(math.isnan(x) or math.isfinite(x) for x in found.values())


def test_a_sticky_loop_and_a_healthy_one_differ_where_they_must(base):
    rng = np.random.default_rng(2)
    load = np.convolve(rng.normal(size=1600), np.ones(60) / 20, mode="valid")[:1500]
    healthy = features(Prepared(record(*closed_loop(load=load, noise=0.02))))
    assert base["dead_travel"] > 10.0 > 0.0 > healthy["dead_travel"]
    assert base["network_sticky"] > healthy["network_sticky"] + 2.0
