"""Two moves that bring a sticky stem to where it should rest, and then leave it alone.

    following   OP = OP_c + b;  over each full wave of e = SP - PV beyond +-band/2 the mean of OP is u_s
    first move  OP = u_s +- S      after ``cycles`` waves, for ``pause`` seconds: the stem slips past its place
    second move OP = u_s -+ (S - J)/2   it slips back and rests at u_s, and OP stays
    released    where |e| > band after another ``pause``:  b = OP - OP_c, so that nothing jumps, and OP follows again

in   OP_c  output of the controller [unit of OP]   SP, PV [one unit]        out  OP  to the valve [unit of OP]
S, J    of the stem [unit of OP]           band    error that ends the rest [unit of PV], above the noise; inf: off
pause   time for PV to see a move [s]      cycles  waves that are waited for [-]      dt  scan [s]

The first move goes the way that OP went last.  The mean of OP over a wave is where the stem should rest because the
stem stands as far above OP as below it.
Not for: loads that move within a few periods (the loop is open while the stem rests), processes that integrate (the
place where they rest is a point, so they drift off), a J that is not known well.
Source: R. Srinivasan, R. Rengaswamy, Approaches for efficient stiction compensation in process control valves, Comput.
Chem. Eng. 32 (2008) 218-229, with two moves that the plant does not have to be known for, as in M. A. S. L. Cuadros,
C. J. Munaro, S. Munareto, Ind. Eng. Chem. Res. 51 (2012) 5465-5476; waves, release and b are ours.
See also: knocker, constant_reinforcement.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_scan, not_negative, positive

FOLLOWING, FIRST, RESTING = 0.0, 1.0, 2.0


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    S, J, band, dt = p[0], p[1], p[2], p[5]
    mode, b, side, total, count, waves, left, way, out = d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7], d[8]
    e = u[1] - u[2]
    if mode != FOLLOWING:
        left -= dt
    if mode == RESTING and left <= 0.0 and abs(e) > band:
        mode, b, side, total, count, waves = FOLLOWING, out - u[0], 0.0, 0.0, 0.0, 0.0
    if mode == FIRST and left <= 0.0:
        mode = RESTING
        out -= way * (S + 0.5 * (S - J))
        left = p[3]
    elif mode == FOLLOWING:
        before, out = out, u[0] + b
        if out != before:
            way = 1.0 if out > before else -1.0
        if side > 0.0:
            total += out
            count += 1.0
        if e < -0.5 * band and side == 1.0:
            side = 2.0
        elif e > 0.5 * band and side != 1.0:  # a wave begins where e rises out of the band
            if side == 2.0:
                waves += 1.0
            if waves >= p[4] and count > 0.0:
                mode = FIRST
                out = total / count + way * S
                left = p[3]
            side, total, count = 1.0, 0.0, 0.0
    d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7], d[8] = mode, b, side, total, count, waves, left, way, out
    y[0] = out


class TwoMove(Block):
    """Moves of a stem with ``S`` and ``J`` [unit of OP] to its place, and rest while the error is within ``band``.

    ``start``: OP_c before the first scan [unit of OP]; ``offset``: first scan [s].
    Raises ``BlockError`` unless 0 <= J <= S, band > 0, pause > 0, cycles >= 1 and dt > 0.

    >>> import numpy as np
    >>> from stickslip.diagram import drive
    >>> t = np.arange(0.0, 60.0)
    >>> moves = TwoMove(S=0.06, J=0.02, band=0.1, pause=5.0, dt=1.0)
    >>> wave = np.sin(t / 3.0)
    >>> run = drive(moves, 59.0, every=1.0, OP_c=(t, 0.5 + 0.05 * wave), SP=(t, 0.2 * wave * (t < 45)), PV=0.0)
    >>> sorted(set(run.log["OP"][-12:].round(3).tolist()))  # at rest (S - J)/2 below or above 0.5
    [0.48]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("OP_c"), Port("SP"), Port("PV"))
    ports_out = (Port("OP"),)
    kernels = Kernels(step=_step)
    period_param = "dt"
    offset_param = "offset"

    def __init__(
        self,
        S: float,
        J: float,
        band: float,
        pause: float,
        dt: float,
        *,
        cycles: float = 2.0,
        offset: float = 0.0,
        start: float = 0.0,
        name: str = "two_move",
        **labels: Any,
    ) -> None:
        memory = dict.fromkeys(("mode", "b", "side", "sum", "count", "waves", "left", "way"), 0.0)
        super().__init__(
            name=name,
            params={"S": S, "J": J, "band": band, "pause": pause, "cycles": cycles, "dt": dt, "offset": offset},
            memory=memory | {"OP": start},
            start_output=start,
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless 0 <= J <= S, band > 0, pause > 0, cycles >= 1 and dt > 0."""
        check_scan(params, name)
        not_negative(params, name, "S")
        S, J, band, cycles = (float(params[key]) for key in ("S", "J", "band", "cycles"))
        require(0.0 <= J <= S, name, "J", J, f"0 <= J <= S = {S} is needed", "a jump is part of S; lower J or raise S")
        require(band > 0.0, name, "band", band, "it must be positive", "give twice the noise, or inf for no moves")
        positive(params, name, "pause", remedy="give seconds")
        require(1.0 <= cycles < math.inf, name, "cycles", cycles, "at least one wave is waited for", "give 2")
