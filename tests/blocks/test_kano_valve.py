"""Kano's valve: a second transcription of the state machine as oracle, the compiled run, misuse."""

import numpy as np
import pytest
from stickslip.blocks.kano_valve import KanoValve
from stickslip.blocks.ports import BlockError
from stickslip.diagram import drive

from tests.blocks.test_valves_agree import sampled


def published(op, S, J, us, m):
    """Independent transcription of the state machine, for OP inside its span and a known first direction."""
    stuck, direction, before, out = True, 1, us, []
    for u in op:
        if not stuck and (u - before) * direction <= 0:
            us, stuck = before, True
        if stuck and -direction * (u - us) > S:
            direction, stuck = -direction, False
        elif stuck and direction * (u - us) > J:
            stuck = False
        if not stuck:
            m = u - direction * (S - J) / 2
        before = u
        out.append(m)
    return np.array(out)


def test_follows_the_published_state_machine():
    rng = np.random.default_rng(11)
    smooth = np.cumsum(np.cumsum(rng.normal(0, 0.05, 3000)))
    op = 50 + 40 * np.sin(smooth / np.abs(smooth).max() * 12)
    op[::7] = op[np.maximum(np.arange(0, 3000, 7) - 1, 0)]  # OP stands still now and then
    ours = sampled(KanoValve(6.0, 2.0, 1.0, low=0.0, high=100.0, start=50.0), op)
    theirs = published(op, 6.0, 2.0, 50.0, 50.0)
    first = np.flatnonzero(np.diff(ours) < 0)[0] + 1  # once it has moved down, both know where they are
    np.testing.assert_allclose(ours[first:], theirs[first:], atol=1e-9)


def test_stops_and_the_way_back():
    op = [0.5, 0.9, 1.0, 1.2, 0.97, 0.955, 0.9]
    mv = sampled(KanoValve(0.06, 0.02, 1.0, start=0.5), op)
    np.testing.assert_allclose(mv, [0.5, 0.88, 1.0, 1.0, 1.0, 0.975, 0.92])  # analytic: off the stop at f_s = 0.04


def test_sampled_more_slowly_than_op_moves():
    run = drive(KanoValve(0.06, 0.02, 2.0, start=0.5), 5.0, every=1.0, OP=([0.0, 5.0], [0.5, 1.0]))
    np.testing.assert_allclose(run.log["MV"], [0.5, 0.5, 0.68, 0.68, 0.88, 0.88])  # analytic: OP - f_d, held


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"S = 6.0, but 0 <= S <= 1.0 is needed.*with OP in percent give high=100"):
        KanoValve(6.0, 2.0, 1.0)
    with pytest.raises(BlockError, match=r"J = 0.2, but 0 <= J <= S = 0.1"):
        KanoValve(0.1, 0.2, 1.0)
    with pytest.raises(BlockError, match=r"dt = -1.0"):
        KanoValve(0.1, 0.1, -1.0)
    with pytest.raises(BlockError, match=r"high = -1.0"):
        KanoValve(0.1, 0.1, 1.0, high=-1.0)
