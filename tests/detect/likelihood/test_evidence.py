"""The likelihood of stems: known dead travel comes back, rivals are not accused, days add up."""

import numpy as np
import pytest
from scipy import stats
from stickslip.calibration.crossed.drawing import draw
from stickslip.calibration.crossed.history import seen
from stickslip.detect.likelihood.kernels import explained_by
from stickslip.detect.likelihood.pooled import evidence_of
from stickslip.detect.likelihood.regression import lines
from stickslip.detect.likelihood.rows import rows_of
from stickslip.detect.likelihood.stems import MOVES, _repeated, stems_of
from stickslip.detect.likelihood.words import said
from stickslip.detect.prepare.prepared import Prepared

from .loops import run
from .scanned import level


def evidence(**how):
    return evidence_of([stems_of(*run(**how))])


def test_the_likelihood_is_that_of_students_t():  # oracle: scipy's density
    rng = np.random.default_rng(3)
    X = np.column_stack([np.ones(300), rng.normal(size=300)])
    y = X @ [1.0, 2.0] + 0.3 * rng.standard_t(4, size=300)
    found = lines(X[None], y, 4.0, 1e-6, 40)
    best = stats.t.logpdf(y - X @ found.b[0], 4.0, scale=0.3)
    fitted = stats.t.fit(y - X @ found.b[0], fdf=4.0, floc=0.0)
    assert found.total[0] == pytest.approx(stats.t.logpdf(y - X @ found.b[0], *fitted).sum(), abs=0.05)
    assert found.total[0] >= best.sum() - 1e-6
    off = y - X @ (found.b[0] + [0.05, 0.0])
    assert found.total[0] > stats.t.logpdf(off, 4.0, scale=fitted[2]).sum()  # the largest


def test_a_stem_that_never_moves_explains_nothing():  # analytic: the constant beside it explains all that it could
    rng = np.random.default_rng(7)
    stems, left = np.repeat(rng.uniform(0.0, 100.0, (200, 1)), 300, axis=1), np.empty((200, 1))
    w, target = rng.uniform(0.3, 1.0, 290), rng.normal(size=290)
    constant = (w / np.linalg.norm(w))[None]
    explained_by(stems, np.arange(10, 300), 2, w, constant, target - constant[0] * (constant[0] @ target), left)
    assert np.abs(left).max() < 1e-3 * (target @ target)


def test_rows_leave_out_what_was_not_measured():
    t = np.arange(2000.0)
    op, pv = np.sin(t / 30), np.cos(t / 30) + 0.01 * np.random.default_rng(1).normal(size=2000)
    free = rows_of(op, pv)
    op[500:700], pv[500:700] = op[500], pv[500]
    held = rows_of(op, pv)
    assert free.q == 3 and free.used.all()  # analytic: 94 samples between turns, 25 wanted
    assert np.sum(~held.used) == pytest.approx(199 / held.q, abs=2)
    assert rows_of(op, 0 * pv) is None


@pytest.mark.parametrize(("S", "J"), [(2.0, 0.0), (4.0, 0.0), (3.0, 1.5), (4.0, 4.0)])
def test_known_dead_travel_comes_back(S, J):
    found = evidence(S=S, J=J, seed=int(10 * S + J), moves=2.0)
    assert found.accuses and not found.clears
    assert pytest.approx(S, rel=0.12) == found.S and found.low <= S * 1.05 and found.high >= S * 0.95
    assert found.turns >= 10 and found.gain > found.without_best > 10.0
    assert f"S of {found.S:.2g} % of OP" in said(found, True)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_stick_is_not_excluded_where_the_controller_scans_ten_times_a_row(seed):
    stuck, sound = (stems_of(*level(S, S / 3.0, seed=seed)) for S in (3.0, 0.03))
    found = evidence_of([stuck])
    assert found.excluded > 3.0 and not found.clears  # without the moves all from 0.32 on lose 20 to 40 nats
    beside, none = (evidence_of([one.beside_moves]) for one in (stuck, sound))
    assert beside.gain > 10.0 and beside.low < 3.0 < 1.5 * beside.high
    assert none.gain < 0.0 and not none.accuses


def test_what_moves_tell_twice_is_paid_for_once():  # analytic: three values of OP hold two of its moves
    found, n = stems_of(*run(seed=3)), len(stems_of(*run(seed=3)).base)
    rank = np.linalg.matrix_rank(np.concatenate([
        found.beside_moves.base, found._inputs(found.rows.input(found.rows.op), 1, found.order[1])[0]
    ], axis=1))  # fmt: skip
    a, b = found.order
    assert found.beside_moves.base.shape == (n, 2 + a + MOVES)
    assert rank == 2 + a + MOVES + b - _repeated(MOVES, 1, b)


def test_a_jump_is_told_only_where_it_gains():
    assert evidence(S=4.0, J=0.0, seed=40).J == 0.0
    jumps = evidence(S=4.0, J=4.0, seed=44)
    assert jumps.J > 2.0 and jumps.jump > 5.0


RIVALS = {
    "sound": {},
    "a large wave on the load": {"wave": 12.0, "moves": 0.0},
    "no set point moves": {"moves": 0.0, "wave": 6.0},
    "a sensor with hysteresis": {"hysteresis": 1.5},
    "a bent characteristic": {"bend": 0.02, "wave": 6.0},
    "another answer each way": {"up": 1.6},
    "a long dead time": {"dead": 14, "K_p": 0.25, "T_i": 20.0},
    "a one-way drift": {"ramp": 0.02, "moves": 0.0, "wave": 0.0},
}


@pytest.mark.parametrize("rival", RIVALS)
@pytest.mark.parametrize("seed", [1, 2])
def test_no_rival_is_called_dead_travel(rival, seed):
    assert not evidence(**RIVALS[rival], seed=seed).accuses


@pytest.mark.parametrize("rival", ["a sensor with hysteresis", "a one-way drift"])
def test_what_is_no_straight_line_or_never_turns_clears_nothing(rival):
    assert not evidence(**RIVALS[rival], seed=1).clears


def test_what_bends_is_not_said_to_be_excluded():
    found = evidence(**RIVALS["a sensor with hysteresis"], seed=1)
    assert found.bent > 0.0 and not found.better
    assert "nothing is cleared" in said(found, True) and "excluded" not in said(found, True)


def test_a_sound_loop_earns_its_clearing():
    found = evidence(seed=1, moves=3.0)
    assert found.clears and found.loss >= 10.0 and 0.15 * found.travel == pytest.approx(found.claim)
    assert f"from {found.claim:.2g} % of OP on is excluded by at least" in said(found, True)


def test_no_stick_is_cleared_of_what_it_is_said_not_to_have():
    for seed, share in enumerate((0.15, 0.25, 0.4, 0.8)):
        op, _ = run(seed=seed)
        travel = float(np.subtract(*np.percentile(op, [98, 2])))
        found = evidence(S=share * travel, J=0.5 * share * travel, seed=seed)
        assert not (found.clears and found.claim <= share * travel)


@pytest.mark.parametrize("number", [536, 828])  # stems that stick behind a positioner, cleared before
def test_nothing_is_cleared_where_a_stick_beats_the_rivals_at_one_delay(number):
    made = seen(draw(number + 1, 21)[number])
    assert made.drawn.kind == "sticks" and made.travel < 1.0 / 0.15  # OP over S
    found = Prepared(made.record).dead_travel
    assert found.excluded <= 0.2 * found.travel and found.bent <= 0.0  # all else would clear it
    assert found.unpaid > 0.0 and not found.clears
    assert "at one delay dead travel of some size fits PV better" in said(found, percent=True)


def test_too_few_samples_say_nothing():
    op, pv = run(S=3.0, seed=1, period=40.0)
    found = evidence_of([stems_of(op[::5], pv[::5])])
    assert found.between < 10.0 and not found.accuses and not found.clears
    assert "too few" in said(found, True)


WEAK = {"S": 2.0, "noise": 0.16, "n": 700}


def test_weak_days_that_agree_are_found():
    days = [stems_of(*run(**WEAK, seed=seed)) for seed in range(8)]
    alone = [evidence_of([day]) for day in days]
    assert sum(one.accuses for one in alone) < 4
    together = evidence_of(days)
    assert together.accuses and together.gain > max(one.gain for one in alone)
    assert pytest.approx(2.0, rel=0.25) == together.S and len(together.days) == 8
    assert together.agreeing >= 5 and f"in {together.agreeing} of 8 records" in said(together, True)


def test_one_odd_day_is_not_a_sticky_valve():
    odd = stems_of(*run(**{**WEAK, "noise": 0.05}, seed=3))
    assert evidence_of([odd]).accuses
    sound = [stems_of(*run(**{**WEAK, "S": 0.0}, seed=seed)) for seed in range(10, 16)]
    assert not evidence_of([odd, *sound]).accuses


def test_the_order_of_days_does_not_matter():
    days = [stems_of(*run(**WEAK, seed=seed)) for seed in range(3)]
    first, then = evidence_of(days), evidence_of(days[::-1])
    assert (first.gain, first.S, first.turns) == pytest.approx((then.gain, then.S, then.turns))


def test_nothing_to_judge():
    with pytest.raises(ValueError, match="records is empty"):
        evidence_of([])
    assert stems_of(np.zeros(500), np.zeros(500)) is None


@pytest.mark.parametrize("how", [{"S": 4.0, "moves": 2.0}, {"S": 4.0, "moves": 0.0, "wave": 12.0, "noise": 1.0}])
def test_what_a_stick_gains_is_against_a_straight_line(how):
    found = evidence(**how, seed=5)
    assert found.bent >= found.gain - 1.0  # rivals that bend may gain more


def test_noise_alone_has_no_bend():
    rng = np.random.default_rng(8)
    op = np.cumsum(rng.normal(size=2000)) % 7.0
    found = evidence_of([stems_of(op, rng.normal(size=2000))])
    assert abs(found.bent) < 30.0
