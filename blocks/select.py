"""Selectors: the lowest or the highest of some signals, for override and constraint control.

    low select    y = min(u_1, ..., u_n)              high select    y = max(u_1, ..., u_n)

in   the signals named, of one unit               out  out  the one selected, named first

The mode is the signal that is selected; each hand-over is located and logged under its name.  Signals that agree to a
millionth of a millionth hand nothing over.  A controller that is not selected winds up unless it tracks the output.
Valid for two or more signals; a static block.
Source: textbook, for example Seborg, Edgar and Mellichamp, Process Dynamics and Control, 2nd ed. 2004, chapter 16
(selective control).
See also: switch, saturation.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Floats, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role

TIE = 1e-12

# p = n, sign: +1 the lowest, -1 the highest;   d = the input selected


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = u[int(d[0])]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    now = u[int(d[0])]
    for i in range(int(p[0])):
        g[i] = p[1] * (now - u[i]) - TIE * (abs(now) + abs(u[i]))


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    best = 0
    for i in range(1, int(p[0])):
        if p[1] * u[i] < p[1] * u[best]:
            best = i
    d[0] = best


class MinSelect(Block):
    """The lowest of ``sources``; raises ``BlockError`` for less than two.

    >>> OP = MinSelect("OP", ["OP_flow", "OP_pressure"])
    >>> float(OP.output(0.0, [], [0.6, 0.4])[0])
    0.4
    """

    role = Role.ARITHMETIC
    discrete = ("selected",)
    ports_out = (Port("out"),)
    sign = 1.0

    def __init__(self, signal: str, sources: Sequence[str], *, unit: str = "", name: str = "") -> None:
        name, n = name or signal, len(sources)
        require(n >= 2, name, "sources", list(sources), "there are two or more to select from", "name them")
        self.ports_in = tuple(Port(source) for source in sources)
        self.one_unit = (*sources, "out")
        self.modes = {source: float(i) for i, source in enumerate(sources)}
        self.kernels = Kernels(out=_out, zc=_zc, jump=_jump, n_events=n, linear=True)
        units = dict.fromkeys(sources, unit) | {"out": unit}
        params = {"n": n, "sign": self.sign}
        super().__init__(name=name, params=params, memory={"selected": 0.0}, outputs=signal, units=units)

    def check(self, params: Mapping[str, float], name: str) -> None:  # type: ignore[override]
        """Raise ``BlockError`` unless ``n`` and ``sign`` are as built."""
        n = len(self.ports_in)
        require(params["n"] == n, name, "n", params["n"], f"the selector has {n} inputs", "make another")
        require(params["sign"] == self.sign, name, "sign", params["sign"], "it is as built", "use the other selector")

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the input selected, shape (1,), at the present inputs."""
        return np.array([float(np.argmin(self.sign * np.asarray(u)))])


class MaxSelect(MinSelect):
    """The highest of ``sources``; raises ``BlockError`` for less than two.

    >>> hottest = MaxSelect("T_max", ["T_1", "T_2", "T_3"])
    >>> float(hottest.output(0.0, [], [350.0, 420.0, 390.0])[0])
    420.0
    """

    sign = -1.0
