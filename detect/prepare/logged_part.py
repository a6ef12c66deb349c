"""Of a record that is logged for less than half of its time, the part in one piece: that can be judged by itself."""

from dataclasses import replace
from datetime import timedelta

import numpy as np
from stickslip.detect.signals.gaps import bridgeable, split
from stickslip.logs import LoopRecord

LOGGED_SHARE = 0.5  # of the samples; a record with more is judged as it is
SAMPLES_MIN = 100  # of a piece worth judging


def logged_part(record: LoopRecord) -> LoopRecord:
    """The longest piece without a long gap, with a note.

    That is the record itself where it is logged, or where no piece is long and moves.

    >>> import numpy as np
    >>> t = np.arange(1000.0)
    >>> part = logged_part(LoopRecord.from_arrays(t, pv=np.sin(t), op=np.where(t < 300, np.cos(t), np.nan)))
    >>> len(part), part.log.notes[-1]
    (300, 'PV and OP are logged together in 30 % of the time; judged is one piece of 300 samples, from 0 s on.')
    """
    share = float(record.good.mean()) if len(record) else 1.0
    if share >= LOGGED_SHARE:
        return record
    longest = max(split(record, bridgeable(record, 0.0)), key=len, default=np.empty(0, dtype=np.int64))
    if len(longest) < SAMPLES_MIN or min(np.ptp(record.pv[longest]), np.ptp(record.op[longest])) == 0.0:
        return record  # where nothing moves, that most is missing says more
    part = record.log.samples(int(longest[0]), int(longest[-1]) + 1)
    since, start = float(record.t[longest[0]]), record.log.start
    clock = f"{since:g} s" if start is None else f"{start + timedelta(seconds=since):%Y-%m-%d %H:%M:%S}"
    names = "PV and OP" if record.sp_name is None else "PV, OP and SP"
    note = (
        f"{names} are logged together in {100.0 * share:.0f} % of the time; judged is one piece of "
        f"{len(longest)} samples, from {clock} on."
    )
    return replace(record, log=replace(part, notes=(*part.notes, note)))
