"""Does a tag show that the valve answers: stems of known S in, S out; linear valves are cleared."""

import numpy as np
import pytest
from stickslip.detect.plantwide.answers import answer_of
from stickslip.detect.stem.stick import stick

T = np.arange(2500.0)
OP = 50 + 6 * np.sin(T / 25) + 2 * np.sin(T / 61)


@pytest.mark.parametrize("S, J", [(3.0, 0.0), (4.0, 2.0), (6.0, 6.0), (9.0, 4.5)])
def test_a_tag_that_moves_with_the_stem_tells_S(S, J):
    rng = np.random.default_rng(0)
    found = answer_of(OP, {"flow": -7 * stick(OP, S, J) + 0.5 * rng.normal(size=len(T)), "else": np.sin(T / 17)})
    assert (found.tag, found.follows) == ("flow", None)
    assert pytest.approx(S, abs=0.5 * np.ptp(OP) * 0.05 + 0.2) == found.S  # the grid of S is 5 % of OP's travel
    assert found.gain > np.log(4.0)


def test_a_valve_that_answers_is_cleared_although_another_tag_lags():
    lagging = 50 + 6 * np.sin(T / 25 - 0.6) + 2 * np.sin(T / 61 - 0.3)
    found = answer_of(OP, {"flow": 3 * OP - 40, "level": lagging})
    assert found.follows == "flow" and found.gain == 0.0
    alone = answer_of(OP, {"level": lagging})
    assert alone.follows is None and alone.gain > 0.0  # which is why a gain is no verdict


@pytest.mark.parametrize("change", [lambda x: -x, lambda x: 40 * x - 3, lambda x: x + 0.01 * T])
def test_sign_scale_offset_and_drift_of_a_tag_change_nothing(change):
    flow = stick(OP, 5.0, 2.0)
    before, after = answer_of(OP, {"f": flow}), answer_of(OP, {"f": change(flow)})
    assert (after.S, after.tag) == (before.S, before.tag)
    assert after.gain == pytest.approx(before.gain, rel=1e-6)


def test_nothing_to_ask():
    assert answer_of(np.full(100, 50.0), {"f": T[:100]}).tag is None
    assert answer_of(OP, {}).tag is None
    assert answer_of(OP, {"still": 0 * T}) == (None, 0.0, 0.0, 0.0, None)
    assert answer_of(50 + 0.1 * (OP - 50), {"f": stick(50 + 0.1 * (OP - 50), 0.6, 0.2)}).gain == 0.0  # below S_MIN
