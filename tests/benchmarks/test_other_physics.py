"""The loops that the verdict is judged by away from home: their valves, what the draw gives away, their figures."""

import math

import numpy as np
import pytest
from stickslip.calibration.crossed.drawing import draw
from stickslip.calibration.crossed.history import seen
from stickslip.calibration.crossed.labelled import truth_of
from stickslip.calibration.crossed.loops import DRIVERS, run
from stickslip.calibration.crossed.stems import GAIN, JUMPLESS, LAWS, moved
from stickslip.calibration.crossed.tuning import tuned

from benchmarks.other_physics.ceiling import gain
from benchmarks.other_physics.judging import judged, runs
from benchmarks.other_physics.scoring import LEAK, by_chance, figures, leaks

S, J = 6.0, 2.0


def along_a_triangle(law, S=S, J=J, positioner=0):
    """How far OP is ahead of the stem on a slow triangle, (n,), after a first cycle."""
    s, h = np.zeros(8), 0.01
    if law in ("kano", "backlash_and_stick"):
        s[1] = s[3] = 1.0
    t = np.arange(0.0, 240.0, h)
    op = 20.0 * (2.0 * np.abs((t / 60.0) % 2.0 - 1.0) - 1.0) - 20.0
    ahead = np.empty(len(t))
    for k, u in enumerate(op.tolist()):
        moved(s, u, h, LAWS.index(law), S, J, 0.02, 0.0001, positioner)
        ahead[k] = u - s[0]
    return ahead[len(t) // 2 :]


@pytest.mark.parametrize("law", LAWS)
def test_a_stem_gives_way_where_friction_says(law):  # analytic: f_s = (S + J) / 2, of play S / 2
    ahead = along_a_triangle(law, J=0.0 if law in JUMPLESS else J)
    widest = 0.5 * S if law in JUMPLESS else 0.5 * (S + J)
    if law == "backlash_and_stick":
        widest = 0.25 * S + 0.5 * (0.5 * S + J)  # play of the linkage, and the stick behind it
    assert np.max(ahead) == pytest.approx(widest, rel=0.06)
    assert np.min(ahead) == pytest.approx(-widest, rel=0.06)


@pytest.mark.parametrize("law", LAWS)
def test_a_sound_valve_follows(law):
    assert np.max(np.abs(along_a_triangle(law, S=0.06, J=0.02))) < 0.15


def test_a_positioner_leaves_the_dead_travel_that_was_drawn():  # analytic: f_s and f_d over 1 + its gain
    ahead = along_a_triangle("he", positioner=2)
    assert np.max(ahead) == pytest.approx(0.5 * (S + J / (1.0 + GAIN)), rel=0.03)


def test_nothing_that_is_drawn_tells_which_loops_stick():
    drawn = draw(6000, 1)
    leaked = leaks([one.attributes() for one in drawn], np.array([one.sticks for one in drawn]))
    assert len(leaked) > 50
    assert {name: value for name, value in leaked.items() if abs(value - 0.5) > LEAK} == {}


def test_a_valve_that_stands_leaves_pv_to_what_else_moves_it():
    """In all drives; another gain of the controller moves OP, and not PV (analytic)."""
    standing = [d for d in draw(600, 9) if d.stands]
    assert {d.driver for d in standing} == set(DRIVERS)
    for d in standing[:12]:
        made = tuned(d)
        first, second = (np.zeros((4, made.numbers.steps // made.every)) for _ in range(2))
        for share, out in ((1.0, first), (0.5, second)):
            run(np.random.default_rng(d.seed), made.numbers._replace(K_p=share * made.numbers.K_p), made.every, out)
        assert np.array_equal(first[1], second[1]) and not np.array_equal(first[2], second[2]) and not first[3].any()
        truth = truth_of(seen(d))
        assert d.kind == "stands" and truth.cause == "dead_loop" and math.isnan(truth.S) and truth.op_range > 0.0


def test_a_leak_is_found():
    assert leaks([{"noise": 0.1}, {"noise": 0.2}], np.array([False, True]))["noise"] == 1.0


def test_loops_are_the_same_again_and_finite():
    for one in draw(24, 9):
        made, again = seen(one), seen(one)
        assert np.isfinite(made.record.pv).all() and (made.record.pv == again.record.pv).all()
        assert made.record.op.min() >= 0.0 and made.record.op.max() <= 100.0


def test_a_row_is_judged_and_scored():
    rows = [judged(run) for run in runs(2, 4)]
    assert {"kind", "word", "p", "S", "shows"} <= set(rows[0])
    rows = [{"kind": kind, "word": "inconclusive", "p": p} for kind, p in (("sticks", 0.9), ("sound", 0.2))] * 20
    assert figures(rows)["auc"] == 1.0 and figures(rows)["found"] == 1.0 and figures(rows)["cleared"] == 0.0


def test_probabilities_that_are_right_err_by_chance_alone():  # analytic: mean of |N(0, 0.25 / n)| is 0.4 / sqrt(n)
    assert by_chance(np.full(400, 0.5)) == pytest.approx(0.4 / 20.0, rel=0.2)


def test_the_true_stem_tells_a_loop_that_shows_it():
    sticks = [d for d in draw(12, 4) if d.kind == "sticks" and seen(d).shows]
    gains = [gain(d) for d in sticks]
    assert max(gains) > 20.0
