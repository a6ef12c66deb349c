"""Check valve: one way, cracking pressure, located instants."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.check_valve import CheckValve
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.diagram import drive


@given(st.floats(0.0, 1e8), st.floats(0.0, 1e8), st.floats(0.0, 1e5))
def test_never_backwards(p_up, p_down, p_crack):
    m = float(CheckValve(0.1, p_crack=p_crack).output(0.0, [], [p_up, p_down])[0])
    assert m >= 0.0
    if p_up - p_down <= p_crack:
        assert m == 0.0


def test_forward_it_is_a_resistance():
    m = CheckValve(0.06).output(0.0, [], [22.4e5, 22.1e5])[0]
    assert m == pytest.approx(0.06 * math.sqrt(0.3e5), rel=1e-5)  # analytic
    spring = CheckValve(0.06, p_crack=1e4).output(0.0, [], [22.4e5, 22.1e5])[0]
    assert spring == pytest.approx(0.06 * math.sqrt(0.2e5), rel=1e-5)


def test_it_opens_and_shuts_at_its_cracking_pressure():
    flap = CheckValve(0.1, p_crack=5e4)
    run = drive(flap, 10.0, every=0.1, p_up=Sine("p_up", 1e5, 10.0, mean=10e5), p_down=10e5)
    assert [event.after for event in run.events] == ["shut", "open", "shut"]
    # Analytic: sin(2 pi t/10) = 1/2, but for the band of 1e-8 of the pressures.
    assert [event.t for event in run.events] == pytest.approx([0.0, 10.0 / 12.0, 50.0 / 12.0], abs=1e-6)
    assert np.all((run.log["m"] > 0.0) == ((run.log.t > 10.0 / 12.0) & (run.log.t < 50.0 / 12.0)))


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"K = 0.0, but an open check valve passes some flow"):
        CheckValve(0.0)
    with pytest.raises(BlockError, match=r"p_crack = -1.0, but a pressure drop is not negative"):
        CheckValve(1.0, p_crack=-1.0)
