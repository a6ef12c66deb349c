"""Compressor maps: head and work against corrected flow, as data that a compressor block carries along.

    q   = m (p_ref/p_in) / (m_d n),   n = w/w_d         corrected flow, relative speed [-]
    h   = h_d n^2 psi(q, n)                             head [J/kg]
    e   = h_d n^2 lam(q, n)                             work on the gas [J/kg]; efficiency = psi/lam

CubicMap: one cubic for all speeds (Moore and Greitzer 1986; Gravdahl and Egeland 1999), constant lam = 1/eta
    psi(q) = psi_0 + H (1 + 1.5 (q/W_q - 1) - 0.5 (q/W_q - 1)^3)     q >= 0;  peak at the surge line q_s = 2 W_q
    psi(q) = psi_0 + 2 H (q/W_q)^2                                   q < 0   (reverse flow)
TabulatedMap: measured or design curves at several speeds, see tabulated_map.

The default cubic (psi_0 0.93, H 0.12, W_q 0.28, eta 0.78) [-] is the one of the production plant.
Source: Moore and Greitzer 1986, Gravdahl and Egeland 1999; the thesis prints no map.
Valid for one gas at one suction temperature; not for: guide vanes, Reynolds effects.  See also: compressor.
"""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class CompressorMap(Protocol):
    """The numbers that a compressor reads from its map."""

    def psi(self, q: float, n: float = 1.0) -> float:
        """Return the head coefficient [-]."""

    def work(self, q: float, n: float = 1.0) -> float:
        """Return the work coefficient lam [-]."""

    def surge(self, n: float = 1.0) -> float:
        """Return the corrected flow at the surge line [-]."""

    def named(self) -> dict[str, float]:
        """Return the parameters of a compressor that carries this map."""

    def table(self) -> Floats:
        """Return the numbers behind the parameters."""


# --- cubic: p[8:12] = psi_0, H, W_q, eta -------------------------------------------------------------------


def cubic(q: float, psi_0: float, H: float, W_q: float) -> float:
    """Return psi on the cubic, and on the parabola of reverse flow.

    >>> [round(cubic(q, 0.93, 0.12, 0.28), 4) for q in (-0.28, 0.0, 0.56, 1.0)]
    [1.17, 0.93, 1.17, 0.4927]
    """
    s = q / W_q
    if s < 0.0:
        return psi_0 + 2.0 * H * s * s
    return psi_0 + H * (1.0 + 1.5 * (s - 1.0) - 0.5 * (s - 1.0) ** 3)


@dataclass(frozen=True)
class CubicMap:
    """The cubic map: ``psi_0`` head at no flow, ``H`` half the rise to the peak, ``W_q`` half the surge flow, ``eta``.

    >>> shape = CubicMap()
    >>> shape.surge(), round(shape.psi(1.0), 3), round(shape.psi(1.0) / shape.work(1.0), 3)
    (0.56, 0.493, 0.384)
    """

    psi_0: float = 0.93
    H: float = 0.12
    W_q: float = 0.28
    eta: float = 0.78

    def psi(self, q: float, n: float = 1.0) -> float:
        """Return the head coefficient [-]."""
        return cubic(q, self.psi_0, self.H, self.W_q)

    def work(self, q: float, n: float = 1.0) -> float:
        """Return the work coefficient [-]."""
        return 1.0 / self.eta

    def surge(self, n: float = 1.0) -> float:
        """Return the corrected flow at the surge line [-]."""
        return 2.0 * self.W_q

    def named(self) -> dict[str, float]:
        """Return psi_0, H, W_q, eta by name."""
        return {"psi_0": self.psi_0, "H": self.H, "W_q": self.W_q, "eta": self.eta}

    def table(self) -> Floats:
        """Return nothing: the cubic has no table."""
        return np.zeros(0)


def pressure_ratio(h: float, c_01: float, gamma: float) -> float:
    """Return the pressure ratio that a head ``h`` [J/kg] gives: (max(0.2, 1 + h/cpT))^(1/kappa).

    cpT = c_01^2/(gamma - 1),  kappa = (gamma - 1)/gamma; the floor keeps deep choke finite.
    """
    cpT = c_01 * c_01 / (gamma - 1.0)
    return math.pow(max(0.2, 1.0 + h / cpT), gamma / (gamma - 1.0))


def head_for(ratio: float, c_01: float, gamma: float) -> float:
    """Return the head [J/kg] of a pressure ratio.

    >>> round(pressure_ratio(head_for(3.1, 453.43, 1.3067), 453.43, 1.3067), 9)
    3.1
    """
    return c_01 * c_01 / (gamma - 1.0) * (math.pow(ratio, (gamma - 1.0) / gamma) - 1.0)
