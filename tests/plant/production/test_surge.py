"""Surge of the whole plant and of one compressor: with anti-surge control it is avoided, without it is integrated."""

import numpy as np
import pytest

from blocks.sources import Ramp
from plant import simulate
from plant.production import production_plant
from plant.production.build import compressor_2
from plant.production.feed import trip

GAS = 0.016 * 2283.7189819065397  # kg/s at rest


@pytest.mark.parametrize("method", ["auto", "stiff"])
def test_feed_trip_with_anti_surge(method):
    run = simulate(production_plant("B", feed=trip()), 200.0, every=0.01, method=method)
    assert run.ok
    assert run.log["q_2"].min() > 0.56 and run.log["q_3"].min() > 0.56  # right of the surge line all the time
    assert run.log["OP_VRVC2"].max() > 0.1


def test_feed_trip_without_anti_surge():
    run = simulate(production_plant("B", feed=trip(), anti_surge=False), 40.0, every=0.01, method="stiff")
    assert run.ok  # deep surge is integrated, not refused
    assert run.log["m_2"].min() < -5.0
    reversals = int(np.sum(np.diff(np.sign(run.log["m_2"])) != 0))
    assert reversals > 20
    assert run.log["p_out2"].max() < 90e5


def fall(share):
    return {"m_G1": Ramp("m_G1", -share * GAS / 10.0, start=5.0, end=15.0, before=GAS)}


def test_one_compressor_with_anti_surge():
    run = simulate(compressor_2("B"), 60.0, every=0.01, inputs=fall(0.65), method="stiff")
    assert run.ok and run.log["q_2"].min() > 0.56


def test_one_compressor_without_surges_in_a_cycle():
    run = simulate(compressor_2("B", anti_surge=False), 40.0, every=0.005, inputs=fall(0.65), method="stiff")
    assert run.ok
    m, t = run.log["m_2"], run.log.t
    late = t > 20.0
    turns = t[1:][(np.sign(m[1:]) > 0) & (np.sign(m[:-1]) <= 0)]
    periods = np.diff(turns[turns > 20.0])
    assert len(periods) > 10 and periods.std() < 0.05 * periods.mean()  # a limit cycle
    assert m[late].min() < 0.0 < m[late].max()
