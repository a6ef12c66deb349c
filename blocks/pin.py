"""Pin: sets a signal right at every logged time and lets the model move it in between.

    s(t) = r(t) + o_k,   t_k <= t < t_(k+1),     o_k = v_k - r(t_k)

in   r  the signal as the model drives it       v_k  its logged value at the time t_k (the timetable)
out  s  the signal set right                    o    the offset in force (both in the unit of r)

The offset is zero until the first time and held after the last.  What holds no longer than to a time before the next
row, as the noise of a sensor that has taken another sample by then, ends there (``until``).  It is the residual of the
model: without a gap it is the noise of a sensor or the rounding of the log.  Where the model drives r through an
integral (a controller), the change from one offset to the next is its one-step error.

Valid for any finite samples at increasing times; they need not be periodic.  Between samples nothing is interpolated.
See also: recorded (a table as a source), ``stickslip.diagram.pins`` (pins behind the drivers of all logged signals).
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Labels, Port, require
from stickslip.blocks.recorded import samples
from stickslip.blocks.role import Role

SOON = 1e-9  # of a row's interval: what ends so near the next row ends there

# p = v in force, NaN where none is; d = o


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = u[0] + d[0]
    y[1] = d[0]


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    known = not math.isnan(p[0])
    d[0] = p[0] - u[0] if known else 0.0
    y[0] = p[0] if known else u[0]
    y[1] = d[0]


class Pin(Block):
    """A signal set right at the times ``t`` [s] to the ``values`` [unit of r] logged there.

    ``until`` (n,) [s]: when each offset ends if that is before the next time; None: none does.
    Raises ``BlockError`` unless t (n,) strictly increases, values (n,) are finite, and until exceeds t.

    >>> pin = Pin([0.0, 1.0], [0.5, 0.7])
    >>> pin.output(0.2, [], [0.4]).tolist(), pin.starting_at(offset=0.1).output(0.2, [], [0.4]).tolist()
    ([0.4, 0.0], [0.5, 0.1])
    """

    role = Role.DISTURBANCE
    ports_in = (Port("r"),)
    ports_out = (Port("s"), Port("offset"))
    kernels = Kernels(out=_out, step=_step, linear=True)

    def __init__(
        self,
        t: ArrayLike,
        values: ArrayLike,
        *,
        until: ArrayLike | None = None,
        name: str = "pin",
        inputs: Labels = None,
        outputs: Labels = None,
        units: Mapping[str, str] | None = None,
        spans: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:
        times, recorded, self.clock = samples(name, t, values)
        if until is not None:
            ends = np.asarray(until, dtype=float)
            later = ends.shape == times.shape and bool(np.all(ends > times))
            require(later, name, "until", until, "an offset ends behind its row", "give one later time for each")
            early = np.flatnonzero(ends[:-1] < times[1:] - SOON * np.diff(times))
            times = np.insert(times, early + 1, ends[early])
            recorded = np.insert(recorded, early + 1, np.nan)
        super().__init__(
            name=name,
            params={},
            memory={"offset": 0.0},
            timetable=np.column_stack([times, recorded]),
            inputs=inputs,
            outputs=outputs,
            units=units,
            spans=spans,
        )
