"""Where the stem stood: as logged, or as the fitted play reconstructs it from OP and PV."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from stickslip.detect.signals.runs import runs
from stickslip.detect.verdict import Verdict
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values
from stickslip.logs.trend import rests

STILL_SHARE = 1e-6  # of OP's travel: a fitted stem that moves less stands
MOVED_SHARE = 0.02  # of OP's travel: OP must move that much while the stem stands, or it is no stick
STICK_SAMPLES_MIN = 3  # samples of a stick
BETTER_RATIO = 1.05  # rms without play over rms with it: below, the fitted stem says nothing


@dataclass(frozen=True, eq=False)
class StemTrend:
    """The stem and OP over time.

    t : (n,) [s]; op, mv : (n,) in the unit of OP and of the stem
    sticks : (k, 2) [s], from where to where the stem stood while OP moved
    logged : whether the stem was logged; else it is what a play makes of OP
    better : how much worse PV is explained without the play (rms without over rms with it) [-], NaN where logged
    """

    t: Values = field(repr=False)
    op: Values = field(repr=False)
    mv: Values = field(repr=False)
    sticks: Values
    logged: bool
    better: float

    @property
    def slips(self) -> Values:
        """When the stem leaves a stick (k,) [s]."""
        return self.sticks[:, 1]

    @property
    def share(self) -> float:
        """Share of the time in which the stem stood while OP moved [-]."""
        span = float(self.t[-1] - self.t[0])
        return float(np.sum(np.diff(self.sticks, axis=1))) / span if span > 0.0 else 0.0


def stem_trend(verdicts: Sequence[Verdict], record: LoopRecord | None = None) -> StemTrend | str:
    """The stem that the methods saw or fitted, the logged one first; a sentence that says why where there is none.

    A stem that ``record`` has logged is taken as it is, whether a method could judge it or not.

    >>> from stickslip.detect.methods import play_fit
    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(200.0)
    >>> stem_trend([play_fit.detect(LoopRecord.from_arrays(t, pv=0 * t + 4, op=50 + np.sin(t / 9)))])[:46]
    'No stem can be reconstructed: PV stays at 4 ov'
    """
    by_name = {verdict.method: verdict for verdict in verdicts}
    seen, fitted = by_name.get("stem_play"), by_name.get("play_fit")
    if seen is not None and len(seen.array("mv")):
        t, op, mv = (seen.array(name) for name in ("t", "u", "mv"))
        n = min(len(t), len(op), len(mv))
        stands = np.c_[seen.array("first"), seen.array("last")] if len(seen.array("first")) else np.empty((0, 2))
        return StemTrend(t[:n], op[:n], mv[:n], _moving(t[:n], op[:n], stands), True, float("nan"))
    if record is not None and record.mv_name is not None and np.isfinite(record.log[record.mv_name][record.good]).any():
        t, op, mv = (values[record.good] for values in (record.t, record.op, record.log[record.mv_name]))
        return StemTrend(t, op, mv, _moving(t, op, _stands(t, mv, float(np.ptp(mv)))), True, float("nan"))
    if fitted is None:
        return "No stem can be reconstructed: the method play_fit did not run."
    if not len(fitted.array("x")):
        return f"No stem can be reconstructed: {fitted.reason}"
    better = fitted.index if fitted.index is not None else float("nan")
    if not better >= BETTER_RATIO:
        return (
            f"No stem is reconstructed: a play predicts PV hardly better from OP than a lag alone (error {better:.2f} "
            f"times as large without play, {BETTER_RATIO:g} needed)."
        )
    t, op, mv = (fitted.array(name) for name in ("t", "u", "x"))
    return StemTrend(t, op, mv, _moving(t, op, _stands(t, mv, float(np.ptp(op)))), False, better)


def _stands(t: Values, mv: Values, travel: float) -> Values:
    """From where to where (k, 2) [s] a stem stands: it moves by next to nothing of the ``travel`` from row to row."""
    first, last = runs(np.abs(np.diff(mv)) <= STILL_SHARE * travel)
    long = last - first >= STICK_SAMPLES_MIN
    return np.column_stack([t[first[long]], t[last[long]]])


def _moving(t: Values, op: Values, stands: Values) -> Values:
    """Those of the stretches (k, 2) [s] in which OP moves; none where it rests, whatever its rounding does."""
    if rests(op):
        return np.empty((0, 2))
    least = MOVED_SHARE * float(np.ptp(op))
    kept = []
    for a, b in stands.tolist():
        inside = op[np.searchsorted(t, a) : np.searchsorted(t, b, side="right")]
        if len(inside) and float(np.ptp(inside)) > least:
            kept.append((a, b))
    return np.array(kept).reshape(-1, 2)
