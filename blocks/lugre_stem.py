"""The stem of a control valve with LuGre friction: bristles that bend, slip and are dragged along.

    M dv/dt = k (OP - x) - F,   dx/dt = v
    dz/dt = v - sigma_0 |v| z/g(v)                                          (1)
    g(v)  = F_c + (F_s - F_c) exp(-(v/v_s)^2)                               (2)
    F     = sigma_0 z + sigma_1 dz/dt + F_v v                               (3)

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
x    position [fraction of travel]     v  speed [travel/s]     z  mean deflection of the bristles [travel]
k    spring, and actuator force per unit of OP [N per travel], > 0     M    moving mass [kg, one travel = 1 m], > 0
F_v  viscous friction [N s per travel], >= 0         F_c, F_s  Coulomb and static friction [N], F_s >= F_c > 0
v_s  Stribeck speed [travel/s], > 0                  sigma_0  stiffness of the bristles [N per travel], > 0
sigma_1  damping of the bristles [N s per travel], >= 0
low, high  end stops [fraction of travel]; -inf and inf lift them; start  position at the start [fraction of travel]

There is no stuck mode: before it breaks away the stem gives way elastically by F/sigma_0 (presliding), and its
breakaway force depends on how fast OP rises, F_s for slow ones.  In steady sliding F = g(v) sgn v + F_v v, the Stribeck
curve.  As sigma_0 -> inf and v_s -> 0 it becomes the stick-slip stem.  The right sides are continuous (|v| has only
a kink), so nothing is switched; only the end stops are modes.  A stem held by a stop keeps its bristles bent.

Friction takes energy at any speed if F_v >= sigma_1 (F_s/F_c - 1), and is then passive; above that sigma_1 it may give
some back in quick reversals (``passive`` says which).  Stiff: sqrt(sigma_0/M) is some thousand rad/s.  Slow forces
far below F_s let it creep a little in the long run, a known trait of the model.
Valid for a spring-opposed actuator without positioner.

Source: Canudas de Wit, Olsson, Astrom and Lischinsky, IEEE Trans. Automatic Control 40(3), 1995, pp. 419-425, eqs. 1 to
4; passivity: Barabanov and Ortega, IEEE Trans. Automatic Control 45(4), 2000, pp. 830-832.
See also: stick_slip, stribeck_stem.
"""

import math
from collections.abc import Mapping
from typing import Any

from blocks.block import Block, Kernels
from blocks.limits import FREE, HIGH, LOW, MODES
from blocks.ports import Port
from blocks.quasi_static_stem import check_stops, started_between
from blocks.role import Role
from blocks.rules import not_negative, positive
from blocks.stick_slip import check_friction

# p = k, M, F_v, F_c, F_s, low, high, v_s, sigma_0, sigma_1;   x = x, v, z


def _bristle_rate(v: float, z: float, p: Any) -> float:
    """Return dz/dt [travel/s]."""
    g = p[3] + (p[4] - p[3]) * math.exp(-((v / p[7]) ** 2))
    rate: float = v - p[8] * abs(v) * z / g
    return rate


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = x[0]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    if d[0] != FREE:
        dx[0] = 0.0
        dx[1] = 0.0
        dx[2] = 0.0
    else:
        dx[0] = x[1]
        dx[2] = _bristle_rate(x[1], x[2], p)
        dx[1] = (p[0] * (u[0] - x[0]) - p[8] * x[2] - p[9] * dx[2] - p[2] * x[1]) / p[1]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    if d[0] == FREE:
        g[0] = x[0] - p[6]
        g[1] = p[5] - x[0]
    else:  # leaves the stop when the spring pulls the bristles back
        g[0] = -d[0] * (p[0] * (u[0] - x[0]) - p[8] * x[2])
        g[1] = -1.0


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    if d[0] != FREE:
        d[0] = FREE
    else:
        d[0] = HIGH if k[0] == 0.0 else LOW
        x[0] = p[6] if d[0] == HIGH else p[5]
        x[1] = 0.0


class LuGreStem(Block):
    """A valve stem with LuGre friction; spring, mass and forces default to the thesis's high stiction.

    ``sigma_0`` [N per travel] and ``sigma_1`` [N s per travel] are stiffness and damping of the bristles, ``v_s``
    [travel/s] the Stribeck speed.  Raises ``BlockError`` for parameters no valve can have.

    >>> from diagram import drive
    >>> valve = LuGreStem()
    >>> valve.passive
    True
    >>> slowly = ([0.0, 20.0], [0.0, 0.02])
    >>> drive(valve, 20.0, every=20.0, OP=slowly).log["MV"].round(5).tolist()  # 1050 N bend the bristles
    [0.0, 0.00014]
    """

    role = Role.VALVE
    ports_in = (Port("OP"),)
    ports_out = (Port("MV"),)
    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=2, feeds=False)
    modes = MODES

    def __init__(
        self,
        F_s: float = 2250.0,
        F_c: float = 1250.0,
        *,
        sigma_0: float = 1e7,
        sigma_1: float = 700.0,
        v_s: float = 1e-3,
        k: float = 52500.0,
        M: float = 1.36,
        F_v: float = 612.0,
        low: float = 0.0,
        high: float = 1.0,
        start: float = 0.0,
        name: str = "valve",
        **labels: Any,
    ) -> None:
        started_between(low, high, start, name)
        forces = {"k": k, "M": M, "F_v": F_v, "F_c": F_c, "F_s": F_s}
        super().__init__(
            name=name,
            params=forces | {"low": low, "high": high, "v_s": v_s, "sigma_0": sigma_0, "sigma_1": sigma_1},
            states={"x": start, "v": 0.0, "z": 0.0},
            memory={"mode": FREE},
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless k, M, F_c, v_s, sigma_0 > 0, F_v, sigma_1 >= 0, F_s >= F_c and low < high."""
        positive(params, name, "k", "M", "F_c", "v_s", "sigma_0", remedy="give a positive one")
        not_negative(params, name, "F_v", "sigma_1")
        check_friction(params, name)
        check_stops(params, name)

    @property
    def passive(self) -> bool:
        """Whether friction never gives energy back: F_v >= sigma_1 (F_s/F_c - 1)."""
        F_v, F_c, F_s, sigma_1 = (float(self.p[self.param_index(key)]) for key in ("F_v", "F_c", "F_s", "sigma_1"))
        return F_v >= sigma_1 * (F_s / F_c - 1.0)
