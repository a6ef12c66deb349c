"""Which samples has a historian drawn, and which lie on a straight line because the loop was there?

    b(k) = x(k) less the line through x(k-1) and x(k+1)         the bend of a sample; drawn below 1e-6 of the swing

A line that a historian draws is straight but for rounding, so that its bends have no order.  The bends of a smooth
curve, however faint, have one sign and change little from one sample to the next: it is not drawn.

Nor is anything drawn where the controller worked on these very samples.  Between two of them

    dOP = K_p (de + e dt/T_i)         e the mean of the two

and the part of e makes a curve of OP where PV is a line, and a line of OP where PV is a curve of one shape only.  Lines
drawn into either lose it.  K_p, K_p/T_i and a constant are fitted by least squares to the samples at which OP moves,
and again to the half that fits best; half of what is left there must be below 1e-3 of the standard deviation of the
part of e.  A controller without that part never shows it.  The limits are ours.
"""

import numpy as np
from stickslip.detect.signals.smoothing import noise_std
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Mask, Values

STRAIGHT_SHARE = 1e-6  # of the swing
LEFT_SHARE = 1e-3  # of the standard deviation of the integral part
MOVES_MIN = 20  # moves of OP that a fit needs
SILENT_SHARE = 1e-5  # of the standard deviation of PV: a transmitter's noise is larger


def drawn(t: Values, x: Values) -> Mask:
    """True where a sample but the first and the last lies on a drawn line or is held, (n - 2,), n >= 3.

    >>> t = np.arange(100.0)
    >>> float(drawn(t, np.exp(-t / 5))[60:].mean()), float(drawn(t, np.interp(t, t[::9], np.sin(t[::9]))).mean()) > 0.8
    (0.0, True)
    """
    bend, curved = _bends(t, x)
    return (np.abs(bend) < STRAIGHT_SHARE * np.ptp(x)) & ~curved


def free_of_noise(t: Values, x: Values) -> bool:
    """Whether a signal (n,) curves smoothly from sample to sample, as a simulation without noise gives it."""
    return len(x) > 7 and bool(_bends(t, x)[1].mean() > 0.5) and noise_std(t, x) < SILENT_SHARE * float(np.std(x))


def controlled_as_logged(record: LoopRecord) -> bool:
    """Whether the logged OP follows from the logged samples of PV by a PI controller."""
    kept = record.kept
    t, op = record.t[kept], record.op[kept]
    e = -record.pv[kept] if record.e is None else record.e[kept]
    moves = np.diff(op) != 0.0
    dt, middle = np.diff(t)[moves], 0.5 * (e[1:] + e[:-1])[moves]
    if len(dt) < MOVES_MIN:
        return False
    X, y = np.column_stack([np.diff(e)[moves], middle * dt, dt]), np.diff(op)[moves]
    fit = np.linalg.lstsq(X, y, rcond=None)[0]
    off = np.abs(y - X @ fit)
    best = off <= np.median(off)
    fit = np.linalg.lstsq(X[best], y[best], rcond=None)[0]
    left = float(np.median(np.abs(y - X @ fit)))
    return left < LEFT_SHARE * float(np.std(fit[1] * X[:, 1]))


def _bends(t: Values, x: Values) -> tuple[Values, Mask]:
    """How far each sample lies off the line between its neighbours, and where that bend has their sign and size."""
    bend = np.diff(x)[:-1] - (x[2:] - x[:-2]) * (np.diff(t)[:-1] / (t[2:] - t[:-2]))
    here = np.where(bend == 0.0, np.nan, bend)
    around = [np.concatenate([bend[:1], bend[:-1]]) / here, np.concatenate([bend[1:], bend[-1:]]) / here]
    return bend, np.all([(beside >= 0.5) & (beside <= 2.0) for beside in around], axis=0)
