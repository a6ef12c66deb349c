"""The segment of a diagram, between logged signals, in which a gap lies that no effect explains."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.role import Role
from stickslip.gap.records.given import Held

NO_PLACE = (Role.ARITHMETIC, Role.HISTORIAN, Role.SOURCE)
# times the largest excess of a measurement, from which on that of an output is the controller's: a scan that no row has
# shows in the output alone
ONE_SCAN, SEVERAL_SCANS = 3.0, 6.0
ABNORMAL = 0.03  # excess of the mean square of a signal's innovations from which on its segment is wrong


def abnormal_segment(
    held: Held, judged: NDArray[np.float64], changing: Sequence[str] | None = None, several: bool = False
) -> tuple[str, ...]:
    """Return the blocks between logged signals where the gap lies, those at which an effect can be.

    The innovations of a measurement, (rows, signals), are wrong only if what drives it is; those of the controller's
    output, given the measurement, only if the controller is, or the measurement is not what it has seen.  ``changing``
    signals feel how others have moved since the last row, by default outputs of controllers; where ``several`` scans
    lie between two rows, what is not logged of a measurement shows in these outputs.
    """
    excess = np.abs(np.nanmean(judged**2, axis=0) - 1.0)
    acting = np.array([s in (held.ops if changing is None else changing) for s in held.signals])
    k = int(np.argmax(excess))
    times = SEVERAL_SCANS if several else ONE_SCAN
    least = max(times * excess[~acting].max(), ABNORMAL) if not acting.all() else 0.0
    if changing is not None:  # the level of a measurement is wrong only if what drives it is
        least = np.inf if not acting.all() and excess[~acting].max() > ABNORMAL else 0.0
    if acting.any() and excess[acting].max() < least:
        k = int(np.flatnonzero(~acting)[np.argmax(excess[~acting])])
    quiet = held.quiet
    driver = quiet.blocks[quiet.driven[held.signals[k]][0]].name
    logged = [s for s in held.record.log.names if s in quiet.signals]
    blocks = next(one.blocks for one in quiet.segments(logged) if driver in one.blocks)
    places = tuple(name for name in blocks if quiet[name].role not in NO_PLACE and ":" not in name)
    return places or (driver,)
