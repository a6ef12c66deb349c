"""Compressor maps: head and work against corrected flow, as data that a compressor block carries along.

    q   = m (p_ref/p_in) / (m_d n),   n = w/w_d         corrected flow, relative speed [-]
    h   = h_d n^2 psi(q, n)                             head [J/kg]
    e   = h_d n^2 lam(q, n)                             work on the gas [J/kg]; efficiency = psi/lam

CubicMap: one cubic for all speeds (Moore and Greitzer 1986; Gravdahl and Egeland 1999), constant lam = 1/eta
    psi(q) = psi_0 + H (1 + 1.5 (q/W_q - 1) - 0.5 (q/W_q - 1)^3)     q >= 0;  peak at the surge line q_s = 2 W_q
    psi(q) = psi_0 + 2 H (q/W_q)^2                                   q < 0   (reverse flow)
TabulatedMap: measured or design curves at several speeds.  Between surge and choke psi and lam are monotone cubics
in (q - q_s)/(q_c - q_s), linear in n between the curves, n held at the outermost curves.  Left of surge the cubic
above through the surge point, with valley psi_0 = ``valley`` times psi(q_s), and lam held; right of choke straight.

The default cubic (psi_0 0.93, H 0.12, W_q 0.28, eta 0.78) is the one of the production plant; the thesis prints no map.
Valid for one gas at one suction temperature; not for: guide vanes, Reynolds effects.  See also: compressor.
"""

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocks.ports import BlockError, require

Floats = NDArray[np.float64]
Curves = Mapping[float, tuple[ArrayLike, ArrayLike]]
POINTS = 33  # per speed
TABLE = 11  # where the table stands in p of a compressor, see blocks.compressor


class CompressorMap(Protocol):
    """What a compressor asks of its map."""

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


# --- table: p[8:11] = speeds, points, valley; p[11:] = n, q_s, q_c (k each), then psi, psi', lam, lam' (k x N each)


def lower_curve(n: float, p: Any) -> int:
    """Return which curve lies next below the relative speed ``n`` (the last but one at most)."""
    i = 0
    while i < int(p[8]) - 2 and n >= p[TABLE + i + 1]:
        i += 1
    return i


def upper_share(n: float, i: int, p: Any) -> float:
    """Return the weight of curve ``i + 1`` in the interpolation, 0 ... 1."""
    if int(p[8]) < 2:
        return 0.0
    share: float = (n - p[TABLE + i]) / (p[TABLE + i + 1] - p[TABLE + i])
    return min(max(share, 0.0), 1.0)


def edge(n: float, which: int, p: Any) -> float:
    """Return the surge flow (``which`` = 1) or the choke flow (2) at relative speed ``n``."""
    i = lower_curve(n, p)
    share = upper_share(n, i, p)
    at = TABLE + which * int(p[8]) + i
    low: float = p[at]
    return low if share == 0.0 else low + share * (p[at + 1] - low)


def hermite(r: float, at: int, slopes: int, N: int, p: Any) -> float:
    """Return the cubic through the values at ``p[at:]`` with the slopes at ``p[slopes:]``, straight beyond r = 1."""
    step = 1.0 / (N - 1)
    if r >= 1.0:
        last: float = p[at + N - 1] + (r - 1.0) * p[slopes + N - 1]
        return last
    j = min(int(r / step), N - 2)
    s = r / step - j
    value: float = (
        p[at + j] * (1.0 + 2.0 * s) * (1.0 - s) ** 2
        + p[at + j + 1] * s * s * (3.0 - 2.0 * s)
        + step * s * (1.0 - s) * (p[slopes + j] * (1.0 - s) - p[slopes + j + 1] * s)
    )
    return value


def blended(r: float, n: float, which: int, p: Any) -> float:
    """Return psi (``which`` = 0) or lam (2) at the place ``r`` >= 0 between surge (0) and choke (1)."""
    k = int(p[8])
    N = int(p[9])
    i = lower_curve(n, p)
    share = upper_share(n, i, p)
    at = TABLE + 3 * k + which * k * N + i * N
    value = hermite(r, at, at + k * N, N, p)
    if share > 0.0:
        value += share * (hermite(r, at + N, at + N + k * N, N, p) - value)
    return value


def tabulated(q: float, n: float, p: Any) -> float:
    """Return psi of a tabulated map."""
    q_s = edge(n, 1, p)
    if q >= q_s:
        return blended((q - q_s) / (edge(n, 2, p) - q_s), n, 0, p)
    top = blended(0.0, n, 0, p)
    return cubic(q, p[10] * top, 0.5 * (1.0 - p[10]) * top, 0.5 * q_s)


def tabulated_work(q: float, n: float, p: Any) -> float:
    """Return lam of a tabulated map; beyond surge and choke it is held."""
    q_s = edge(n, 1, p)
    r = (q - q_s) / (edge(n, 2, p) - q_s)
    return blended(min(max(r, 0.0), 1.0), n, 2, p)


@dataclass(frozen=True, eq=False)
class TabulatedMap:
    """A map from curves; make one with ``from_curves`` or ``from_files``.

    ``speeds`` relative, increasing (k,); ``q_s``, ``q_c`` corrected flow at surge and choke (k,); ``heads`` and
    ``works`` psi and lam at equal distances between surge and choke (k, N); ``valley`` psi_0/psi(q_s) [-].
    """

    speeds: Floats
    q_s: Floats
    q_c: Floats
    heads: Floats
    works: Floats
    valley: float = 0.8

    def __post_init__(self) -> None:
        """Check that speeds increase, flows are in order and there are at least two points per curve."""
        rising = len(self.speeds) > 0 and self.speeds[0] > 0.0 and bool(np.all(np.diff(self.speeds) > 0.0))
        require(rising, "map", "speeds", self.speeds.tolist(), "speeds are positive and increase", "sort the curves")
        ordered = bool(np.all(self.q_s > 0.0)) and bool(np.all(self.q_c > self.q_s))
        require(ordered, "map", "q_c", self.q_c.tolist(), "0 < surge flow < choke flow", "check the flow column")
        shape = (len(self.speeds), self.heads.shape[-1])
        alike = self.heads.shape == self.works.shape == shape and shape[1] >= 2
        require(alike, "map", "heads", self.heads.shape, "one row per speed, two points or more", "check the curves")
        require(0.0 < self.valley <= 1.0, "map", "valley", self.valley, "a share of the surge head", "give 0.8 or so")

    @classmethod
    def from_curves(
        cls, head: Curves, efficiency: Curves, *, speed: float, flow: float, head_at: float, valley: float = 0.8
    ) -> "TabulatedMap":
        """Return the map of curves ``{speed: (flows, values)}``, scaled so that q = n = psi = 1 at the point given.

        ``head`` and ``efficiency`` may be read at different flows; where they do not overlap, the nearest efficiency
        holds.  ``speed``, ``flow`` (inlet volume flow) and ``head_at`` are in the units of the curves.  The first
        point of each head curve is taken as surge, the last as choke.
        Raises ``BlockError`` for missing speeds, curves of less than two points, or flows that do not increase.
        """
        from scipy.interpolate import PchipInterpolator

        rows_head, rows_work, surge, choke = [], [], [], []
        speeds = sorted(head)
        for one in speeds:
            if one not in efficiency:
                raise BlockError(f"map: no efficiency curve at speed {one}, but each head curve needs one; add it")
            V, h = _curve(*head[one], "head", one)
            V_eta, eta = _curve(*efficiency[one], "efficiency", one)
            n = one / speed
            grid = np.linspace(V[0], V[-1], POINTS)
            psi = PchipInterpolator(V, h)(grid) / head_at / n**2
            share = PchipInterpolator(V_eta, eta)(np.clip(grid, V_eta[0], V_eta[-1]))
            rows_head.append(psi)
            rows_work.append(psi / share)
            surge.append(V[0] / flow / n)
            choke.append(V[-1] / flow / n)
        return cls(
            np.array(speeds) / speed, np.array(surge), np.array(choke), np.array(rows_head), np.array(rows_work), valley
        )

    @classmethod
    def from_files(
        cls, head: Path | str, efficiency: Path | str, *, speed: float, flow: float, head_at: float, valley: float = 0.8
    ) -> "TabulatedMap":
        """Return the map of two CSV files with the columns speed, inlet flow, value, under any header."""
        curves = read_curves(head), read_curves(efficiency)
        return cls.from_curves(*curves, speed=speed, flow=flow, head_at=head_at, valley=valley)

    def psi(self, q: float, n: float = 1.0) -> float:
        """Return the head coefficient [-]."""
        return float(tabulated(q, n, self._as_p()))

    def work(self, q: float, n: float = 1.0) -> float:
        """Return the work coefficient [-]."""
        return float(tabulated_work(q, n, self._as_p()))

    def surge(self, n: float = 1.0) -> float:
        """Return the corrected flow at the surge line [-]."""
        return float(edge(n, 1, self._as_p()))

    def named(self) -> dict[str, float]:
        """Return the number of speeds and points and the valley, by name."""
        return {"speeds": len(self.speeds), "points": self.heads.shape[1], "valley": self.valley}

    def table(self) -> Floats:
        """Return speeds, edges, psi and lam with their slopes, one after the other."""
        parts = [self.speeds, self.q_s, self.q_c]
        for values in (self.heads, self.works):
            parts += [values.ravel(), _slopes(values).ravel()]
        return np.concatenate(parts)

    def _as_p(self) -> Floats:
        """Return the numbers where the kernels look for them."""
        return np.concatenate([np.zeros(8), list(self.named().values()), self.table()])


def _curve(flow: ArrayLike, value: ArrayLike, what: str, speed: float) -> tuple[Floats, Floats]:
    V, y = np.asarray(flow, dtype=float), np.asarray(value, dtype=float)
    if len(V) < 2 or len(V) != len(y) or np.any(np.diff(V) <= 0.0) or not np.all(np.isfinite(y)) or np.any(y <= 0.0):
        raise BlockError(
            f"map: the {what} curve at speed {speed} has {len(V)} flows and {len(y)} values, but at least two points "
            "of increasing flow and positive value are needed; sort it, and drop repeated points"
        )
    return V, y


def _slopes(values: Floats) -> Floats:
    """Return the slopes of the monotone cubics over r = 0 ... 1."""
    from scipy.interpolate import PchipInterpolator

    r = np.linspace(0.0, 1.0, values.shape[1])
    return np.array([PchipInterpolator(r, row).derivative()(r) for row in values])


def read_curves(path: Path | str) -> dict[float, tuple[Floats, Floats]]:
    """Return ``{speed: (flows, values)}`` from a CSV file with one header line, flows in increasing order.

    Raises ``BlockError`` for a row that is not three numbers.
    """
    found: dict[float, dict[float, float]] = {}
    with open(path, newline="") as file:
        for line, row in enumerate(csv.reader(file)):
            if line == 0 or not row:
                continue
            try:
                speed, flow, value = (float(cell) for cell in row)
            except ValueError:
                raise BlockError(
                    f"{path}, line {line + 1}: {row!r} is not speed, flow, value; give three numbers a row"
                ) from None
            found.setdefault(speed, {})[flow] = value
    return {
        speed: (np.array(sorted(curve)), np.array([curve[V] for V in sorted(curve)]))
        for speed, curve in sorted(found.items())
    }


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
