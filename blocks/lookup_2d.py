"""Lookup table with two inputs: bilinear between the points of a grid, held beyond its edges.

    y = (1 - a)(1 - b) z_ij + a (1 - b) z_(i+1)j + (1 - a) b z_i(j+1) + a b z_(i+1)(j+1)
    a = (u_1 - x_i)/(x_(i+1) - x_i),   b = (u_2 - y_j)/(y_(j+1) - y_j),   each kept within 0 ... 1

in   first, second   the signals named second and third         out  out  the value from the table, named first
x, y   points of the first and second input [units of the inputs], strictly increasing, (n,) and (m,)
z      values there [unit of out], (n, m)

The table is block data (``p`` = n, m, x, y, z row by row).  The kinks at the lines of the grid are located, so that no
integration step crosses them; these events are not logged.  Valid for any finite table; a static block.
Source: textbook.
See also: lookup_1d, compressor (a map with its own rules).
"""

from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.block import Block, Floats, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.table import passed, points, same_size

FIRST = 2  # where the points begin in p

# d = segments in x and y: -1 before the first point


def _share(u: float, k: int, n: int, at: int, p: Any) -> float:
    """Return how far ``u`` lies from point ``k`` to the next, 0 or 1 beyond the ends of n points at ``p[at]``."""
    if k < 0:
        return 0.0
    if k >= n - 1:
        return 1.0
    share: float = (u - p[at + k]) / (p[at + k + 1] - p[at + k])
    return share


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    n = int(p[0])
    m = int(p[1])
    a = _share(u[0], int(d[0]), n, FIRST, p)
    b = _share(u[1], int(d[1]), m, FIRST + n, p)
    i = min(max(int(d[0]), 0), n - 2)
    j = min(max(int(d[1]), 0), m - 2)
    at = FIRST + n + m + i * m + j
    near = p[at] + b * (p[at + 1] - p[at])
    far = p[at + m] + b * (p[at + m + 1] - p[at + m])
    y[0] = near + a * (far - near)


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    n = int(p[0])
    m = int(p[1])
    i = int(d[0])
    j = int(d[1])
    g[0] = u[0] - p[FIRST + i + 1] if i < n - 1 else -1.0
    g[1] = p[FIRST + i] - u[0] if i >= 0 else -1.0
    g[2] = u[1] - p[FIRST + n + j + 1] if j < m - 1 else -1.0
    g[3] = p[FIRST + n + j] - u[1] if j >= 0 else -1.0


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    n = int(p[0])
    d[0] = passed(u[0], n, FIRST, p) - 1
    d[1] = passed(u[1], int(p[1]), FIRST + n, p) - 1


class Lookup2D(Block):
    """The value of ``first`` and ``second`` in a table ``z`` (n, m) over the points ``x`` (n,) and ``y`` (m,).

    Raises ``BlockError`` unless x and y strictly increase, all are finite and z has their shape.

    >>> gain = Lookup2D("K", "load", "speed", [0.0, 1.0], [0.0, 10.0], [[1.0, 2.0], [3.0, 8.0]])
    >>> [float(gain.output(0.0, [], [load, 5.0])[0]) for load in (-1.0, 0.0, 0.5, 1.0, 2.0)]
    [1.5, 1.5, 3.5, 5.5, 5.5]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("first"), Port("second"))
    ports_out = (Port("out"),)
    kernels = Kernels(out=_out, zc=_zc, jump=_jump, n_events=4)
    discrete = ("row", "column")

    def __init__(
        self,
        signal: str,
        first: str,
        second: str,
        x: ArrayLike,
        y: ArrayLike,
        z: ArrayLike,
        *,
        unit: str = "",
        name: str = "",
    ) -> None:
        name = name or signal
        rows, columns, values = points(name, "x", x), points(name, "y", y), np.asarray(z, dtype=float)
        shape = (rows.size, columns.size)
        rule = f"one row for each of the {shape[0]} x and one column for each of the {shape[1]} y is needed"
        require(values.shape == shape, name, "z", values.shape, rule, "turn it round or fill it up")
        bad = int(np.count_nonzero(~np.isfinite(values)))
        require(bad == 0, name, "z", f"{bad} values that are no finite numbers", "a table is whole", "fill the gaps")
        super().__init__(
            name=name,
            params={"n": shape[0], "m": shape[1]},
            memory={"row": -1.0, "column": -1.0},
            table=np.concatenate([rows, columns, values.ravel()]),
            inputs=[first, second],
            outputs=signal,
            units={"out": unit},
        )

    def with_params(self, **changes: float) -> Self:
        """Return a copy; raise ``BlockError`` for another size of the table or an unknown name."""
        same_size(self, changes, "n", "m")
        return super().with_params(**changes)

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the segments, shape (2,), in which the present inputs lie."""
        after = np.zeros(2)
        _jump(0.0, x, after, u, self._p_now, after)
        return after
