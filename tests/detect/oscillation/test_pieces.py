"""A record that starts far off, or comes from a step of SP, is read from where it stays."""

import numpy as np
import pytest
from stickslip.cases import find
from stickslip.detect.oscillation.pieces import run_in
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord

T = np.arange(600.0)
CYCLE = np.sin(2 * np.pi * T / 120)  # five cycles


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_way_to_the_set_point_is_left_out(way):
    start = 20.0 * np.exp(-T / 8.0)
    e = way * (start + CYCLE)
    k = run_in(e)
    assert (
        abs(start[k] + CYCLE[k]) <= 1.2 < abs(start[k - 1] + CYCLE[k - 1])
    )  # analytic: 1 and a tenth of the swing of 2
    assert run_in(way * (1.0 * np.exp(-T / 8.0) + CYCLE)) == run_in(e[k:]) == 0


def test_noise_drift_and_short_pieces_stay_whole():
    rng = np.random.default_rng(0)
    assert all(run_in(rng.normal(size=n)) == 0 for n in (0, 1, 2, 3, 50, 3000))
    assert run_in(T / 600.0) == run_in(np.zeros(90)) == 0


def test_the_cycle_behind_it_is_found():
    """In e from 20 the cycle of 1 was drowned: the autocorrelation never came through zero."""
    pv = 50.0 + 20.0 * np.exp(-T / 8.0) + CYCLE
    loop = Prepared(LoopRecord.from_arrays(T, pv=pv, op=50 + CYCLE, sp=0 * T + 50.0))
    assert loop.gate.oscillating and loop.gate.period == pytest.approx(120.0, rel=0.02)  # analytic


def test_the_ideal_loop_of_the_thesis_cycles():
    loop = Prepared(find("ideal_high").loop())
    assert loop.gate.oscillating and 4.8 < loop.gate.cycles < 5.1
