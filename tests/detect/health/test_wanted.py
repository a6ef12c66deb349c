"""Each condition on the data stands once, in words, and contradicts no other."""

import numpy as np
from stickslip.detect.evidence import correlation
from stickslip.detect.health.wanted import met
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord


def level(n=4000, **more):
    """A level under a P controller of its own: PV answers OP late, OP answers PV at once."""
    rng = np.random.default_rng(1)
    load = np.convolve(rng.normal(size=n + 200), np.ones(200) / 40.0, "valid")[:n]
    pv, integral, rows = 55.0, 41.0, []
    for k in range(n):
        integral += 0.02 * (55.0 - pv)
        op = integral + 2.0 * (55.0 - pv)
        pv += 0.02 * (op - 41.0 + load[k])
        rows.append((pv, op))
    y, u = np.array(rows).T
    return LoopRecord.from_arrays(10.0 * np.arange(n), pv=y, op=u, sp=np.full(n, 55.0), **more)


def test_every_condition_stands_once():
    found = met(Prepared(level()).health)
    assert len({one.wanted for one in found}) == len(found)
    assert not any("_" in one.wanted for one in found)


def test_a_time_in_order_is_not_called_beyond_reason():
    found = {one.wanted: one for one in met(Prepared(level()).health)}
    there = found["PV, OP and SP are there"]
    assert there.met and "plant" not in there.found and "time reaches" not in there.found


def test_what_the_record_does_not_tell_is_not_called_in_order():
    rest = LoopRecord.from_arrays(np.arange(500.0), pv=np.random.default_rng(0).normal(size=500), op=50 + np.zeros(500))
    found = {one.wanted: one for one in met(Prepared(rest).health)}
    assert found["the record holds enough cycles"].met is None
    assert found["SP stands still"].met is None
    assert found["the controller works in automatic"].met is False
    assert found["the controller works in automatic"].found.count("OP") == 2, "only what fails is said"


def test_one_lag_of_pv_behind_op():
    loop = Prepared(level())
    [fact] = [one for one in met(loop.health) if one.wanted == "PV follows OP"]
    lag = correlation(loop).lag
    assert fact.met and lag > 0.0 and "samples" not in fact.found
    said = float(fact.found.removeprefix("PV follows OP by ").removesuffix(" s."))
    assert abs(said - lag) <= 0.5 * loop.whole.dt + 0.005 * lag
