"""Choudhury's valve: where it differs from Kano's by definition, and misuse."""

import numpy as np
import pytest
from stickslip.blocks.choudhury_valve import ChoudhuryValve
from stickslip.blocks.kano_valve import KanoValve
from stickslip.blocks.ports import BlockError

from tests.blocks.test_valves_agree import sampled


def test_s_begins_anew_at_every_turn_and_kanos_does_not():
    op = [0.5, 0.6, 0.57, 0.58, 0.535, 0.515]
    # analytic, by hand, S = 0.06: both slip to 0.6 - 0.02 and stick at u = 0.6; after the turn at 0.58 Choudhury
    # counts from there (needs 0.52), Kano from 0.6 (needs 0.54)
    np.testing.assert_allclose(
        sampled(ChoudhuryValve(0.06, 0.02, 1.0, start=0.5), op), [0.5, 0.58, 0.58, 0.58, 0.58, 0.535]
    )
    np.testing.assert_allclose(
        sampled(KanoValve(0.06, 0.02, 1.0, start=0.5), op), [0.5, 0.58, 0.58, 0.58, 0.555, 0.535]
    )


def test_stands_still_then_needs_J():
    op = [0.5, 0.6, 0.6, 0.615, 0.625]
    mv = sampled(ChoudhuryValve(0.06, 0.02, 1.0, start=0.5), op)
    np.testing.assert_allclose(mv, [0.5, 0.58, 0.58, 0.58, 0.605])  # analytic: 0.015 < J < 0.025


def test_stops_and_the_way_back():
    op = [0.5, 0.9, 1.0, 1.2, 0.97, 0.955, 0.9]
    mv = sampled(ChoudhuryValve(0.06, 0.02, 1.0, start=0.5), op)
    np.testing.assert_allclose(mv, [0.5, 0.88, 1.0, 1.0, 1.0, 0.975, 0.92])  # analytic: off the stop at f_s = 0.04


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"S = 6.0, but 0 <= S <= 1.0 is needed"):
        ChoudhuryValve(6.0, 2.0, 1.0)
    with pytest.raises(BlockError, match=r"J = 0.2, but 0 <= J <= S = 0.1"):
        ChoudhuryValve(0.1, 0.2, 1.0)
