"""Whether the set point swings with the loop's period: then PV follows it, and what moves SP is where to look."""

import math

from stickslip.logs import LoopRecord
from stickslip.logs.oscillation import following
from stickslip.logs.trend import rests

SWINGS_SHARE = 0.3  # of SP's variance at the period: a set point that is stepped now and then has less


def set_point_words(record: LoopRecord, period: float) -> str:
    """Return what follows what where SP swings with the ``period`` [s] of the loop; "" where it does not.

    >>> import numpy as np
    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(600.0)
    >>> sp, pv = 50.0 + np.sin(2.0 * np.pi * t / 60.0), 50.0 + 0.5 * np.sin(2.0 * np.pi * (t - 8.0) / 60.0)
    >>> set_point_words(LoopRecord.from_arrays(t, pv=pv, op=pv, sp=sp), 60.0)
    'SP swings by itself with a period of 60 s; PV follows 8 s later, 0.5 times as far. Look at what moves SP.'
    """
    good = record.good
    if record.sp_name is None or not math.isfinite(period) or good.sum() < 3:
        return ""
    sp = record.log[record.sp_name][good]
    if rests(sp):
        return ""
    found = following(record.t[good], sp, record.pv[good], period)
    if not found.share > SWINGS_SHARE:
        return ""
    return (
        f"SP swings by itself with a period of {period:.3g} s; PV follows {found.lag:.2g} s later, "
        f"{found.gain:.2g} times as far. Look at what moves SP."
    )
