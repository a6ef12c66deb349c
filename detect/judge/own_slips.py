"""Slips of a valve seen in its own PV: what fills or empties a level or a pressure jumps, so that PV bends.

    dPV/dt + a PV = d - b stem        a process with one store; a = 0 where it integrates
    y = dPV/dt, and dPV/dt + a PV     where the process is not known to integrate

The rules are those for slips in another tag (``plantwide.slips``): y jumps each time OP has come back by the same
travel, the way that closes the loop, and stands before. Integral action on a square wave from outside turns OP at its
steps and travels as far between any two; but then the valve answers, and y moves with OP between the steps: called is
nothing where OP tells ``EXPLAINED`` of y there, but for the noise, and by ``MOVED`` of a jump. A loop that follows an
outside wave well keeps y near 0 while OP moves, which looks like standing, and a slip further upstream then steps y at
an even beat. Hence one rule more: a valve that stands for most of OP's travel leaves nothing but its slips to bring PV
back, and these must make up ``MOST`` of the range of y.

Needs PV with little noise: a jump of y shows above ``plantwide.slips.SIGMAS`` of what y does from sample to sample; PV
neither drawn by a historian nor rounded; and OP that moves by less than ``STEP`` of S in a sample, where it slips.
It accuses and never clears.  The idea and the limits are ours.
"""

import numpy as np
from stickslip.detect.plantwide.slips import SIDE_SAMPLES, Jumps, Slips, jumps_of, larger, slips_of
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stem.process_kind import kind_of_tag
from stickslip.logs.arrays import Values
from stickslip.logs.normal import spread_about

EXPLAINED, MOVED = 0.8, 0.15
MOST = 0.33
STANDS = 0.5  # S over OP's travel from which a valve stands for most of it
SMOOTH_PERCENT = 90.0  # % of the samples, whose rate changes least: the others may be slips
SAMPLES = 100  # fewest
STEP = 0.1  # of S, that OP may move in the sample of a slip and the one before, by their medians
SP_STEP = 0.1  # of the range of SP
# Facts of the data behind which PV is a chain of steps, and one of straight lines.
BENT, DRAWN = ("quantised", "stale_data"), "compressed"
IN_RUNS = 0.9  # of the bends of PV that have another beside them: a process bends in curves, a historian at points


def own_slips(loop: Prepared) -> Slips | None:
    """Return the slips that the PV of a loop shows of its own valve; None where none, or OP's span is not known.

    >>> from stickslip.detect.stem.stick import stick
    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(3000.0)
    >>> u = 50 + 5 * np.sin(t / 60) + 2 * np.sin(t / 171)
    >>> level = np.cumsum(50 - stick(u, 4.0, 1.0) + np.sin(t / 100))
    >>> found = own_slips(Prepared(LoopRecord.from_arrays(t, pv=level, op=u, op_span=(0, 100), process="integrating")))
    >>> round(found.S, 1)
    4.0
    """
    grid = loop.whole
    percent = loop.op_percent(1.0)
    if percent is None or len(grid) < SAMPLES or grid.drawn > 0.0 or _bent(loop):
        return None
    op = percent * grid.op
    rate = rate_of(grid.pv)
    store = rate if kind_of_tag(loop.record).integrating else driving(op, grid.pv)
    seen = (rate,) if store is rate else (rate, store)
    for y, jumps in [(x, each) for x in seen for each in (jumps_of(x), larger(jumps_of(x)))]:
        found = slips_of(op, y, jumps, loop.record.pv_name)
        if found is None:
            continue
        step = max(float(np.median(np.abs(np.diff(op)[jumps.at - back]))) for back in (0, 1))
        if step > STEP * found.S or _by_sp(grid.sp, jumps) or _answers(op, store, jumps, found.S):
            continue
        if STANDS * np.ptp(op) >= found.S or np.median(np.abs(jumps.size)) >= MOST * np.ptp(y):
            return found._replace(low=found.low - step, high=found.high + step)
    return None


def _bent(loop: Prepared) -> bool:
    """Return whether PV is rounded, held or drawn by a historian; between two slips a level is straight by itself."""
    found = {fact.code for fact in loop.present}
    if not found.isdisjoint(BENT):
        return True
    if DRAWN not in found:
        return False
    pv = loop.whole.pv
    bend = np.abs(np.diff(pv, 2)) > 1e-6 * np.ptp(pv)
    together = int(np.count_nonzero(bend[1:] & bend[:-1]))
    return together < IN_RUNS * int(np.count_nonzero(bend))


def _by_sp(sp: Values | None, jumps: Jumps) -> bool:
    """Return whether SP (n,) steps within two samples of most ``jumps``: it kicks OP and the pace of PV together."""
    if sp is None or not np.ptp(sp) > 0.0:
        return False
    steps = np.abs(np.diff(sp)) > SP_STEP * np.ptp(sp)
    near = np.clip(jumps.at[:, None] + np.arange(-2, 2), 0, len(steps) - 1)
    return bool(np.mean(steps[near].any(axis=1)) > 0.5)


def _answers(op: Values, y: Values, jumps: Jumps, S: float) -> bool:
    """Return whether y (n,) moves with OP the way of its ``jumps`` while OP comes back for one."""
    at, size = jumps
    agree = np.sign(op[at] - op[at - SIDE_SAMPLES]) * np.sign(size)
    sign = 1.0 if agree.sum() >= 0.0 else -1.0
    at, way = at[agree == sign], sign * np.sign(size[agree == sign])
    moved, followed = [], []
    for a, b, old, new in zip(at[:-1], at[1:], way[:-1], way[1:], strict=True):
        back = slice(a + 1 + int(np.argmax(old * op[a + 1 : b + 1])), b - 1)
        if old != new and len(op[back]) >= SIDE_SAMPLES:
            moved.append(op[back] - np.mean(op[back]))
            followed.append(sign * (y[back] - np.mean(y[back])))
    if not moved:
        return False
    u, v = np.concatenate(moved), np.concatenate(followed)
    steps = np.diff(y)
    noise = 0.5 * spread_about(steps) ** 2
    slope = float(u @ v) / max(float(u @ u), 1e-300)
    left = max(float(v @ v) - noise * len(v), 1e-300)
    return slope * S > MOVED * float(np.median(np.abs(size))) and slope * float(u @ v) > EXPLAINED * left


def rate_of(pv: Values) -> Values:
    """Return how fast pv (n,) changes [unit of PV per sample], at every sample what led to it.

    >>> rate_of(np.array([0.0, 1.0, 3.0])).tolist()
    [1.0, 1.0, 2.0]
    """
    return np.concatenate([pv[1:2] - pv[:1], np.diff(pv)])


def driving(op: Values, pv: Values) -> Values:
    """Return what drives pv (n,) of a process with one store, dPV/dt + a PV [unit of PV per sample].

    Between jumps the rate falls back as PV rises: a is the least-squares slope of its changes on those of PV and OP.

    >>> x = np.where(np.arange(400) % 100 < 50, 1.0, -1.0)
    >>> np.unique(driving(0 * x, np.cumsum(x))).tolist()
    [-1.0, 1.0]
    """
    rate = rate_of(pv)
    bend, moves = np.diff(rate[1:]), np.column_stack([pv[1:-1] - pv[:-2], np.diff(op[1:])])
    smooth = np.abs(bend) <= np.percentile(np.abs(bend), SMOOTH_PERCENT)
    if not np.any(moves[smooth]):
        return rate
    a = -float(np.linalg.lstsq(moves[smooth], bend[smooth], rcond=None)[0][0])
    return rate + min(max(a, 0.0), 1.0) * np.concatenate([pv[:1], pv[:-1]])
