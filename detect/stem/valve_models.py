"""Where a sticky stem would stand for every OP, for many sizes of stiction side by side: Kano 2004 and He 2007.

    Kano    stuck: holds until OP has gone more than S back from where it stopped, or more than J onwards;
            moving: MV = OP - d (S - J) / 2 in direction d; it sticks where OP stops or turns
    He      c = r + change of OP; |c| > f_S: MV moves by c - sign(c) f_D, r = sign(c) f_D; else r = c
            f_S = (S + J) / 2,    f_D = (S - J) / 2

S is the change of OP that a reversal needs, J the slip jump, 0 <= J <= S; S = J = 0 is the ideal valve. He's
stem sticks again at every sample, Kano's only where OP stops: on a ramp He's goes in steps of J.

Source: Kano, Maruta, Kugemoto and Shimizu 2004, IFAC DYCOPS; He, Wang, Pottmann and Qin 2007, Ind. Eng. Chem. Res.
46:4549. ``blocks/kano_valve.py`` and ``blocks/he_valve.py`` are the same for simulation; detectors load no simulator.
"""

from collections.abc import Callable, Mapping

import numpy as np
from stickslip.logs.arrays import Values


def kano(u: Values, S: Values, J: Values, way: float = 1.0) -> Values:
    """Stem positions (m, n) of Kano's valve for OP u (n,) and S, J (m,), all in the unit of OP.

    OP comes from the direction ``way`` (1 up, -1 down) and has just moved the stem along.  Written by f_S and f_D,
    which comes to the same: a stem that moves stays f_D behind OP, one that is stuck slips when OP is f_S away.

    >>> kano(np.array([7.0, 9.0, 4.0, 2.0, 1.0]), np.array([6.0]), np.array([2.0]))[0].tolist()
    [5.0, 7.0, 7.0, 4.0, 3.0]
    """
    from stickslip.detect.stem.kernels import kano_stems

    least = 1e-9 * max(float(np.ptp(u)), 1e-300)  # rounding is no move
    x = np.empty((len(S), len(u)))
    kano_stems(u, S, J, way, least, x)
    return x


def he(u: Values, S: Values, J: Values, way: float = 1.0) -> Values:
    """Stem positions (m, n) of He's valve for OP u (n,) and S, J (m,), all in the unit of OP; ``way`` as in ``kano``.

    >>> he(np.array([7.0, 9.0, 4.0, 2.0, 0.0]), np.array([6.0]), np.array([2.0]))[0].tolist()
    [5.0, 5.0, 5.0, 5.0, 2.0]
    """
    from stickslip.detect.stem.kernels import he_stems

    x = np.empty((len(S), len(u)))
    he_stems(u, S, J, way, x)
    return x


VALVES: Mapping[str, Callable[[Values, Values, Values, float], Values]] = {"he": he, "kano": kano}
