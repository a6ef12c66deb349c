"""Lookup table with one input: straight lines between given points.

    y = y_k + (y_(k+1) - y_k) (u - x_k)/(x_(k+1) - x_k)          for x_k <= u <= x_(k+1)
    beyond the ends   y = y_1 or y_n (beyond = "hold"), or the end lines go on (beyond = "extend")

in   in  any signal, named second          out  out  the value from the table, named first
x    points of the input [unit of in], strictly increasing          y    values there [unit of out]

The table is block data (``p`` = n, extend, x_1 ... x_n, y_1 ... y_n).  The kink at each point is located, so that no
integration step crosses it; these events are not logged.  With many points that the input sweeps through, each costs
a few steps.  Valid for any finite table; a static block.  Source: textbook.
See also: lookup_2d, recorded (a table over time), characteristic (laws of valves).
"""

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.block import Floats, Kernels
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.ports import BlockError, nearest, require
from stickslip.blocks.role import Role
from stickslip.blocks.table import passed, points, same_size

BEYOND = {"hold": 0.0, "extend": 1.0}
FIRST = 2  # where the points begin in p


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    n = int(p[0])
    k = int(d[0])
    if p[1] > 0.0:
        k = min(max(k, 0), n - 2)
    if k < 0 or k == n - 1:
        y[0] = p[FIRST + n + max(k, 0)]
    else:
        share = (u[0] - p[2 + k]) / (p[3 + k] - p[2 + k])
        y[0] = p[FIRST + n + k] + share * (p[3 + n + k] - p[FIRST + n + k])


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    k = int(d[0])
    g[0] = u[0] - p[3 + k] if k < int(p[0]) - 1 else -1.0
    g[1] = p[2 + k] - u[0] if k >= 0 else -1.0


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    d[0] = passed(u[0], int(p[0]), FIRST, p) - 1


class Lookup1D(OneToOne):
    """The value of ``source`` in a table of the points ``x`` (n,) and the values ``y`` (n,), n >= 2.

    ``beyond``: "hold" or "extend".  Raises ``BlockError`` unless x strictly increases, all are finite and as many.

    >>> flow = Lookup1D("F", "MV", [0.0, 0.5, 1.0], [0.0, 0.2, 1.0])
    >>> [round(float(flow.output(0.0, [], [MV])[0]), 6) for MV in (-0.1, 0.25, 0.5, 0.75, 2.0)]
    [0.0, 0.1, 0.2, 0.6, 1.0]
    """

    role = Role.ARITHMETIC
    kernels = Kernels(out=_out, zc=_zc, jump=_jump, n_events=2)
    discrete = ("segment",)

    def __init__(
        self,
        signal: str,
        source: str,
        x: ArrayLike,
        y: ArrayLike,
        *,
        beyond: str = "hold",
        unit: str = "",
        name: str = "",
    ) -> None:
        name = name or signal
        if beyond not in BEYOND:
            raise BlockError(f"{name}: beyond = {beyond!r}; {nearest(str(beyond), list(BEYOND))}")
        at, values = points(name, "x", x), np.asarray(y, dtype=float)
        rule = values.shape == at.shape and bool(np.all(np.isfinite(values)))
        require(rule, name, "y", f"{values.size} numbers", f"each of the {at.size} points needs a finite value",
                "give as many values as points")  # fmt: skip
        super().__init__(
            signal,
            source,
            {"n": at.size, "extend": BEYOND[beyond]},
            memory={"segment": -1.0},
            table=np.concatenate([at, values]),
            unit=unit,
            name=name,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless ``extend`` is 0 or 1."""
        extend = float(params["extend"])
        require(extend in (0.0, 1.0), name, "extend", extend, "it is 0 (hold) or 1 (extend)", "give one of them")

    def with_params(self, **changes: float) -> Self:
        """Return a copy with ``extend`` (1 or 0) changed; the table stays.

        Raises ``BlockError`` for another length of the table or an unknown name.
        """
        same_size(self, changes, "n")
        return super().with_params(**changes)

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the segment, shape (1,), in which the present input lies."""
        return np.array([passed(u[0], int(self._p_now[0]), FIRST, self._p_now) - 1.0])
