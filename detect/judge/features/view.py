"""The view of a record for the features: time, OP and PV in units of their own.

    thinned    blocks of k samples are averaged, so that 12 to 24 are left from one turn of OP to the next
    time       counted in turns: the mean time between two turns of OP by more than 0.3 of its range
    u, y, e    OP, PV, SP - PV, each over its own robust scale; y and e turned so that the process gain is positive
    recent     of a long record the last part, as the simulated ones are no longer: see ``stem.recent``

Nothing that is left has a unit: no amplitude, interval, period or offset of the record can be read from it.
Samples at which PV and OP both stand still to the bit are stale collection and are left out where they are many.
"""

from dataclasses import dataclass

import numpy as np
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stem.controller import controller_sign
from stickslip.detect.stem.process_kind import kind_of_tag
from stickslip.detect.stem.recent import LONGEST, blocks, recent, samples_per_turn
from stickslip.logs.arrays import Values

FINE, COARSE = 24.0, 12.0  # points between two turns, wanted and least
POINTS = 900  # beyond these the thinning goes down to COARSE
STALE_SHARE = 0.05  # share of stale samples from which on they are left out


@dataclass(frozen=True, eq=False)
class View:
    """One record as the features see it.

    u, y, e : (n,) [-], thinned
    turn : points between two turns [-]; block : samples of the grid in a point [-]
    travel : range of OP but for 1 % on either side, in units of u [-]
    integrating : whether the process is known to integrate; None where nothing is known
    op_scale : one unit of u [unit of OP]
    seconds : length of what is looked at [s]
    """

    u: Values
    y: Values
    e: Values
    turn: float
    block: int
    travel: float
    integrating: bool | None
    op_scale: float
    seconds: float

    def __len__(self) -> int:
        return len(self.u)


def view_of(loop: Prepared) -> View | None:
    """The view on a record; None where fewer than 40 samples are left, or OP or PV does not move.

    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(1000.0)
    >>> v = view_of(Prepared(LoopRecord.from_arrays(t, pv=np.sin(t / 16), op=50 - np.cos(t / 16), sp=0 * t)))
    >>> v.block, round(v.turn), len(v)
    (2, 25, 500)
    """
    loop = loop.with_stale  # held samples are taken out below without cutting the record at each
    grid = loop.whole
    if len(grid) < 40:
        return None
    last = slice(recent(grid.op, LONGEST), None)
    op, pv, e = grid.op[last], grid.pv[last], grid.e[last]
    still = np.concatenate([[False], (np.diff(op) == 0.0) & (np.diff(pv) == 0.0)])
    if float(np.mean(still)) > STALE_SHARE and np.sum(~still) >= 40:
        op, pv, e = op[~still], pv[~still], e[~still]
    u_scale, y_scale = _scale(op), _scale(pv)
    if not (u_scale > 0.0 and y_scale > 0.0):
        return None
    sign = controller_sign(op, e)
    u = (op - np.median(op)) / u_scale
    y = sign * (pv - np.median(pv)) / y_scale
    error = sign * e / y_scale
    span = float(np.subtract(*np.percentile(u, (99, 1)))) or float(np.ptp(u))
    turn = samples_per_turn(u, span)
    n = len(u)
    k = max(1, int(min(turn / COARSE, max(turn / FINE, n / POINTS))))
    thinned, followed = blocks(u, k), blocks(y, k)
    if np.ptp(thinned) == 0.0 or np.ptp(followed) == 0.0:  # what moves is in the last samples, too few for a block
        return None
    return View(
        u=thinned, y=followed, e=blocks(error, k), turn=max(turn / k, 2.0), block=k, travel=span,
        integrating=kind_of_tag(loop.record).integrating, op_scale=u_scale,
        seconds=float(grid.t[-1] - grid.t[last][0]),
    )  # fmt: skip


def _scale(x: Values) -> float:
    """The spread of a signal: half of the width that holds nine tenths of it, or the standard deviation."""
    least = 1e-9 * float(np.max(np.abs(x)))
    if np.ptp(x) <= least:
        return 0.0
    half = 0.5 * float(np.subtract(*np.percentile(x, (95, 5))))
    return half if half > least else float(np.std(x))
