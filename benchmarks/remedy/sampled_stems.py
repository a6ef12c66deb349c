"""Stems that move at a scan, from their equations: what their papers write for sampled OP.

    s[0] stem   s[1] 1 while it stands   s[3] way (-1, 0, 1)   s[4] OP where it came to stand   s[5] OP before

Sources: M. A. A. S. Choudhury et al., Control Eng. Pract. 13:641, 2005; A. Stenman et al., J. Chemometrics 17:529,
2003; S.-L. Chen et al., ISA Trans. 47:428, 2008 (two layers).
"""

import math
from typing import Any

from stickslip.logs.compiled import njit

CHOUDHURY, STENMAN, CHEN = -2, -3, -4


@njit(cache=True)  # type: ignore[untyped-decorator]
def at_scan(s: Any, op: float, law: int, S: float, J: float) -> None:
    """Move the stem by one scan."""
    f_d = 0.5 * (S - J)
    if law == STENMAN:  # stands within d of OP, then goes all the way
        if abs(op - s[0]) > S:
            s[0] = op
        return
    way = 0.0 if op == s[5] else math.copysign(1.0, op - s[5])
    if law == CHOUDHURY:
        if way != s[3] and s[1] == 0.0:  # it turns or stops
            s[1], s[4] = 1.0, s[5]
        if s[1] == 1.0:
            gone = op - s[4]
            if gone * s[3] < 0.0 and abs(gone) > S:
                s[1], s[3] = 0.0, -s[3]
            elif gone * s[3] >= 0.0 and abs(gone) > J:
                s[1] = 0.0
                s[3] = math.copysign(1.0, gone)
        if s[1] == 0.0:
            s[0] = op - s[3] * f_d
    else:
        force = op - s[0]
        if s[1] == 0.0 and way * s[3] < 0.0:
            s[1] = 1.0
        if s[1] == 1.0 and abs(force) > 0.5 * (S + J):
            s[1], s[3] = 0.0, math.copysign(1.0, force)
        if s[1] == 0.0 and s[3] != 0.0:
            s[0] = op - s[3] * f_d
    s[5] = op
