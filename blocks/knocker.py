"""Knocker: short pulses on top of OP that keep a sticky stem from standing still (Hagglund 2002).

    OP = OP_c + u_k,   u_k = a sgn(OP_c - OP_c at the last pulse)   for ``width`` every ``period``, else 0

in   OP_c  output of the controller [unit of OP]        out  OP  to the valve [unit of OP]
a    height of a pulse [unit of OP]: S/2 to S, so that pulse and offset together beat the friction; 0 switches it off
period  time from one pulse to the next [s]: 2 to 5 scans        width  length of a pulse [s]: 1 or 2 scans, < period
dt   scan [s]; both times are rounded to whole scans, at least one

A stem that stands S/2 beside OP moves within one period, so that PV swings less and faster.  The price is travel: the
stem moves several times a minute.
Not for: valves whose packing or positioner is worn by travel, where air is short, a quick process (PV shows each
pulse), a valve with a positioner that integrates (it fights the pulses).  It has no sense without stick.
Source: T. Hagglund, A friction compensator for pneumatic control valves, J. Process Control 12 (2002) 897-904.
See also: constant_reinforcement (no pulses, less travel), two_move (stands still).
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_scan, not_negative, positive


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    a, dt = p[0], p[3]  # d: OP_c at the last pulse, its way, scans since it began
    period = max(round(p[1] / dt), 1.0)
    d[2] += 1.0
    if d[2] >= period:
        d[1] = (1.0 if u[0] > d[0] else -1.0) if u[0] != d[0] else 0.0
        d[0] = u[0]
        d[2] = 0.0
    y[0] = u[0] + (a * d[1] if d[2] < max(round(p[2] / dt), 1.0) else 0.0)


class Knocker(Block):
    """Pulses of ``a`` [unit of OP], ``width`` [s] long, every ``period`` [s], on the way that OP_c goes.

    ``start``: OP_c before the first scan [unit of OP]; ``offset``: first scan [s].
    Raises ``BlockError`` unless a >= 0, 0 < width < period and dt > 0.

    >>> from stickslip.diagram import drive
    >>> knocker = Knocker(a=0.03, period=3.0, width=1.0, dt=1.0)
    >>> drive(knocker, 6.0, every=1.0, OP_c=([0.0, 6.0], [0.0, 0.6])).log["OP"].round(3).tolist()
    [0.0, 0.1, 0.23, 0.3, 0.4, 0.53, 0.6]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("OP_c"),)
    ports_out = (Port("OP"),)
    kernels = Kernels(step=_step)
    discrete = ("way", "since")
    period_param = "dt"
    offset_param = "offset"

    def __init__(
        self,
        a: float,
        period: float,
        width: float,
        dt: float,
        *,
        offset: float = 0.0,
        start: float = 0.0,
        name: str = "knocker",
        **labels: Any,
    ) -> None:
        super().__init__(
            name=name,
            params={"a": a, "period": period, "width": width, "dt": dt, "offset": offset},
            memory={"OP_p": start, "way": 0.0, "since": 0.0},
            start_output=start,
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless a >= 0, 0 < width < period and dt > 0."""
        check_scan(params, name)
        not_negative(params, name, "a")
        positive(params, name, "period", "width", remedy="give seconds")
        period, width = float(params["period"]), float(params["width"])
        require(width < period, name, "width", width, f"a pulse ends before the next, after {period}", "shorten it")
