"""Integrator with reset: a totaliser, a timer, a batch counter.

    dy/dt = rate u;    y = to   at the instant at which reset rises above threshold

in   in       any signal, named second            reset  the signal that resets, named third
out  out      the integral, named first
rate          [unit of out per s and unit of in]  threshold  [unit of reset]      to  y after a reset [unit of out]
start         y at the start [unit of out]

Only a rise resets: reset must fall below the threshold before the next one counts.  Each rise is located and logged
(modes "armed" and "reset").  The output does not depend on the inputs within an instant, so it may reset itself.
Python-control's state is the integral without resets; what they take off is kept beside it (``seen_modes``).  There a
reset that follows the output at once through another block is an algebraic loop; one straight from it is not.
Valid for any signals.  Source: textbook.
See also: integrator (a process), switch.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Floats, Kernels
from stickslip.blocks.ports import Port
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite
from stickslip.blocks.seen_modes import Call

ARMED, RESET = 0.0, 1.0

# p = rate, threshold, to


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = x[0]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    dx[0] = p[0] * u[0]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    g[0] = u[1] - p[1] if d[0] == ARMED else p[1] - u[1]


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    if d[0] == ARMED:
        x[0] = p[2]
        d[0] = RESET
    else:
        d[0] = ARMED


class ResetIntegrator(Block):
    """The integral of ``source``, set to ``to`` when ``reset`` rises above ``threshold``.

    Raises ``BlockError`` unless all are finite.

    >>> from stickslip.blocks import Staircase
    >>> from stickslip.diagram import drive
    >>> total = ResetIntegrator("V", "F", "new_batch")
    >>> new = Staircase("new_batch", [0.0, 1.0, 0.0], at=[0.0, 2.5, 2.6])
    >>> drive(total, 4.0, every=1.0, F=2.0, new_batch=new).log["V"].round(6).tolist()
    [0.0, 2.0, 4.0, 1.0, 3.0]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("in"), Port("reset"))
    ports_out = (Port("out"),)
    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=1, feeds=False, jumps=True, linear=True)
    modes = {"armed": ARMED, "reset": RESET}
    remembers = True

    def __init__(
        self,
        signal: str,
        source: str,
        reset: str,
        *,
        rate: float = 1.0,
        threshold: float = 0.5,
        to: float = 0.0,
        start: float = 0.0,
        unit: str = "",
        name: str = "",
    ) -> None:
        super().__init__(
            name=name or signal,
            params={"rate": rate, "threshold": threshold, "to": to},
            states={"y": start},
            memory={"mode": ARMED},
            inputs=[source, reset],
            outputs=signal,
            units={"out": unit},
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless all are finite."""
        finite(params, name, *params)

    def seen_after(self, before: Call | None, x: Floats, u: Floats) -> Floats:
        """Return the mode and what the resets so far have taken off the integral ``x``, shape (2,)."""
        mode, off = (self.d0[0], 0.0) if before is None else before.memory
        _, threshold, to = self._p_now
        itself = self.input_labels[1] == self.output_labels[0]
        now = x[0] - off if itself else u[1]
        if mode == RESET or now <= threshold:
            return np.array([RESET if mode == RESET and now >= threshold else ARMED, off])
        at = x[0]
        if before is not None:
            was = before.x[0] - off if itself else before.u[1]
            at -= (now - threshold) / (now - was) * (x[0] - before.x[0])
        return np.array([RESET, at - to])

    def out_with(self, t: float, x: Floats, u: Floats, memory: Floats) -> Floats:
        """Return the integral ``x`` less what the resets have taken off."""
        return np.array([x[0] - memory[1]])
