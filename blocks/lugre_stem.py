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

from stickslip.blocks.block import Kernels
from stickslip.blocks.limits import FREE, HIGH, LOW, MODES
from stickslip.blocks.rules import not_negative, positive
from stickslip.blocks.stem_with_mass import StemWithMass


def _bristle_rate(v: float, z: float, F_c: float, F_s: float, v_s: float, sigma_0: float) -> float:
    """Return dz/dt [travel/s]."""
    g = F_c + (F_s - F_c) * math.exp(-((v / v_s) ** 2))
    return v - sigma_0 * abs(v) * z / g


def _out(x: float) -> float:
    return x


def _der(
    x: float, v: float, z: float, mode: float, OP: float,
    k: float, M: float, F_v: float, F_c: float, F_s: float, v_s: float, sigma_0: float, sigma_1: float,
) -> tuple[float, float, float]:  # fmt: skip
    if mode != FREE:
        return 0.0, 0.0, 0.0
    rate = _bristle_rate(v, z, F_c, F_s, v_s, sigma_0)
    return v, (k * (OP - x) - sigma_0 * z - sigma_1 * rate - F_v * v) / M, rate


def _zc(
    x: float, z: float, mode: float, OP: float, k: float, low: float, high: float, sigma_0: float
) -> tuple[float, float]:
    if mode == FREE:
        return x - high, low - x
    return -mode * (k * (OP - x) - sigma_0 * z), -1.0  # leaves the stop when the spring pulls the bristles back


def _jump(
    event: float, x: float, v: float, z: float, mode: float, low: float, high: float
) -> tuple[float, float, float, float]:
    if mode != FREE:
        return FREE, x, v, z
    at_high = event == 0.0
    return (HIGH if at_high else LOW), (high if at_high else low), 0.0, z


class LuGreStem(StemWithMass):
    """A valve stem with LuGre friction; spring, mass and forces default to the thesis's high stiction.

    ``sigma_0`` [N per travel] and ``sigma_1`` [N s per travel] are stiffness and damping of the bristles, ``v_s``
    [travel/s] the Stribeck speed; F_s, F_c [N] and ``stem`` (k, M, F_v, low, high, start, name and labels) are as in
    ``StickSlip``.  Raises ``BlockError`` for parameters no valve can have.

    >>> from stickslip.diagram import drive
    >>> valve = LuGreStem()
    >>> valve.passive
    True
    >>> slowly = ([0.0, 20.0], [0.0, 0.02])
    >>> drive(valve, 20.0, every=20.0, OP=slowly).log["MV"].round(5).tolist()  # 1050 N bend the bristles
    [0.0, 0.00014]
    """

    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=2)
    modes = MODES
    at_rest = FREE

    def __init__(
        self,
        F_s: float = 2250.0,
        F_c: float = 1250.0,
        *,
        sigma_0: float = 1e7,
        sigma_1: float = 700.0,
        v_s: float = 1e-3,
        name: str = "valve",
        **stem: Any,
    ) -> None:
        own = {"v_s": v_s, "sigma_0": sigma_0, "sigma_1": sigma_1}
        super().__init__(F_s, F_c, own, {"z": 0.0}, name=name, **stem)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless k, M, F_c, v_s, sigma_0 > 0, F_v, sigma_1 >= 0, F_s >= F_c and low < high."""
        StemWithMass.check(params, name)
        positive(params, name, "F_c", "v_s", "sigma_0", remedy="give a positive one")
        not_negative(params, name, "sigma_1")

    def unseen(self) -> str:
        """Return the end stops, unless they are lifted: only the free stem has no modes."""
        return "the end stops" if any(map(math.isfinite, self.limits)) else ""

    @property
    def passive(self) -> bool:
        """Whether friction never gives energy back: F_v >= sigma_1 (F_s/F_c - 1)."""
        F_v, F_c, F_s, sigma_1 = (float(self.p[self.param_index(key)]) for key in ("F_v", "F_c", "F_s", "sigma_1"))
        return F_v >= sigma_1 * (F_s / F_c - 1.0)
