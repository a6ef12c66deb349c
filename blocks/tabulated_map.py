"""A compressor map from curves: measured, or read off the maker's design sheet, at one or several speeds.

    q   = V/V_d/n,   n = N/N_d                          corrected flow, relative speed [-]
    psi = h/(h_d n^2),   lam = psi/efficiency           head and work coefficients [-]

V     inlet volume flow, N speed, h head of the curves, in any units: V_d, N_d, h_d is a point of the curves, in the
      same units, where q = n = psi = 1.  A compressor says with m_d, p_ref, w_d and h_d what that point is in SI units:
      the same curves serve machines of any size.

Between surge (first point of a curve) and choke (last point) psi and lam are monotone cubics in
(q - q_s)/(q_c - q_s), linear in n between the curves; n is held at the outermost curves.  Left of surge runs the cubic
of compressor_map through the surge point, with valley psi_0 = ``valley`` times psi(q_s), and lam held; right of choke
psi goes on straight.

Source: monotone cubics of Fritsch and Carlson 1980 (scipy's PCHIP); the branch left of surge, which no maker prints,
as in Moore and Greitzer 1986.  Valid for one gas at one suction temperature; not for: guide vanes, Reynolds effects,
curves that rise and fall left of their first point.  See also: compressor_map, compressor.
"""

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.compressor_map import cubic
from stickslip.blocks.ports import BlockError, require

Floats = NDArray[np.float64]
Curves = Mapping[float, tuple[ArrayLike, ArrayLike]]
POINTS = 33  # per speed
TABLE = 11  # where the table stands in p of a compressor, see stickslip.blocks.compressor

# p[8:11] = speeds, points, valley; p[11:] = n, q_s, q_c (k each), then psi, psi', lam, lam' (k x N each)


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
    if not r < 1.0:  # NaN too, which has no place between the values
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
    """A map from curves; make one with ``read`` (CSV files) or ``from_curves`` (arrays).

    ``speeds`` relative, increasing (k,); ``q_s``, ``q_c`` corrected flow at surge and choke (k,); ``heads`` and
    ``works`` psi and lam at equal distances between surge and choke (k, N); ``valley`` psi_0/psi(q_s) [-]; ``point``
    speed, flow and head where q = n = psi = 1, in units of the curves: what w_d, m_d and h_d of a compressor come from.

    >>> head = {9000.0: ([10.0, 14.0, 18.0], [81.0, 72.0, 50.0]), 10000.0: ([11.0, 15.0, 20.0], [100.0, 90.0, 60.0])}
    >>> shape = TabulatedMap.from_curves(head, 0.78, speed=10000.0, flow=15.0)
    >>> round(shape.psi(1.0), 3), round(shape.surge(1.0), 4), round(shape.psi(1.0) / shape.work(1.0), 9)
    (1.0, 0.7333, 0.78)
    """

    speeds: Floats
    q_s: Floats
    q_c: Floats
    heads: Floats
    works: Floats
    valley: float = 0.8
    point: tuple[float, float, float] = (1.0, 1.0, 1.0)

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
        cls, head: Curves, efficiency: Curves | float, *, speed: float | None = None, flow: float | None = None,
        head_at: float | None = None, valley: float = 0.8,
    ) -> "TabulatedMap":  # fmt: skip
        """Return the map of curves ``{speed: (flows, values)}``, scaled so that q = n = psi = 1 at the point given.

        ``efficiency`` is a number, or curves that may be read at other flows; where they do not overlap, the nearest
        efficiency holds.  The point is given by ``speed`` (default: the fastest curve), ``flow`` (inlet volume flow;
        default: halfway between surge and choke there) and ``head_at`` (default: the head there), in the units of the
        curves.  The first point of each head curve is taken as surge, the last as choke.
        Raises ``BlockError`` for missing speeds, curves of less than two points, flows that do not increase, a head
        that rises at choke, or an efficiency read at wholly other flows.
        """
        from scipy.interpolate import PchipInterpolator

        require(bool(head), "map", "head", head, "a map needs a curve", "give {speed: (flows, heads)}")
        heads = {one: _curve(*head[one], "head", one) for one in sorted(head)}
        for one, (_, h) in heads.items():
            rule = f"head falls towards choke, and goes on so beyond, but the curve at speed {one:g} ends rising"
            require(bool(h[-1] < h[-2]), "map", "head", h.tolist(), rule, "check the columns: speed, flow, head")
        speed = max(heads) if speed is None else float(speed)
        if flow is None or head_at is None:
            require(speed in heads, "map", "speed", speed, f"there are curves at {', '.join(f'{s:g}' for s in heads)}",
                    "give one of these speeds, or both flow= and head_at=")  # fmt: skip
            V, h = heads[speed]
            flow = 0.5 * float(V[0] + V[-1]) if flow is None else float(flow)
            rule = f"the curve at speed {speed:g} goes from {V[0]:g} to {V[-1]:g}"
            require(V[0] <= flow <= V[-1], "map", "flow", flow, rule, "give a flow between, or head_at= too")
            head_at = float(PchipInterpolator(V, h)(flow)) if head_at is None else float(head_at)
        for key, value in (("speed", speed), ("flow", flow), ("head_at", head_at)):
            require(0.0 < value < np.inf, "map", key, value, "it must be positive and finite", "in units of the curves")
        rows_head, rows_work, surge, choke = [], [], [], []
        for one, (V, h) in heads.items():
            n = one / speed
            grid = np.linspace(V[0], V[-1], POINTS)
            psi = PchipInterpolator(V, h)(grid) / head_at / n**2
            rows_head.append(psi)
            rows_work.append(psi / _efficiency(efficiency, one, grid))
            surge.append(V[0] / flow / n)
            choke.append(V[-1] / flow / n)
        return cls(
            np.array(list(heads)) / speed, np.array(surge), np.array(choke), np.array(rows_head), np.array(rows_work),
            valley, (speed, flow, head_at),
        )  # fmt: skip

    @classmethod
    def read(
        cls, head: Path | str, efficiency: Path | str | float, *, speed: float | None = None, flow: float | None = None,
        head_at: float | None = None, valley: float = 0.8,
    ) -> "TabulatedMap":  # fmt: skip
        """Return the map of CSV files with the columns speed, inlet flow, value, under any header.

        ``efficiency`` is a second file, or a number; the rest is as in ``from_curves``.
        Raises ``BlockError`` for rows that are not three numbers, ``OSError`` for files that cannot be opened.
        """
        share = read_curves(efficiency) if isinstance(efficiency, str | Path) else float(efficiency)
        return cls.from_curves(read_curves(head), share, speed=speed, flow=flow, head_at=head_at, valley=valley)

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
    V, y = np.atleast_1d(np.asarray(flow, dtype=float)), np.atleast_1d(np.asarray(value, dtype=float))
    finite = bool(np.all(np.isfinite(V)) and np.all(np.isfinite(y)))
    if not finite or len(V) < 2 or len(V) != len(y) or np.any(np.diff(V) <= 0.0) or np.any(y <= 0.0):
        raise BlockError(
            f"map: the {what} curve at speed {speed} has {len(V)} flows and {len(y)} values, but at least two points "
            "of increasing flow and positive value, all finite, are needed; sort it, and drop repeated points"
        )
    return V, y


def _slopes(values: Floats) -> Floats:
    """Return the slopes of the monotone cubics over r = 0 ... 1."""
    from scipy.interpolate import PchipInterpolator

    r = np.linspace(0.0, 1.0, values.shape[1])
    return np.array([PchipInterpolator(r, row).derivative()(r) for row in values])


def _efficiency(given: Curves | float, speed: float, flows: Floats) -> Floats:
    """Return the efficiency [-] at the flows of a head curve."""
    from scipy.interpolate import PchipInterpolator

    if not isinstance(given, Mapping):
        require(0.0 < given <= 1.0, "map", "efficiency", given, "it is a fraction", "give 0.78, not percent")
        return np.full(len(flows), float(given))
    if speed not in given:
        raise BlockError(f"map: no efficiency curve at speed {speed}, but each head curve needs one; add it")
    V, eta = _curve(*given[speed], "efficiency", speed)
    rule = f"the head curve at speed {speed:g} goes from {flows[0]:g} to {flows[-1]:g}"
    require(bool(V[0] <= flows[-1] and flows[0] <= V[-1]), "map", "efficiency", (float(V[0]), float(V[-1])), rule,
            "give flows in one unit")  # fmt: skip
    require(bool(eta.max() <= 1.0), "map", "efficiency", float(eta.max()), "it is a fraction", "divide percent by 100")
    return np.asarray(PchipInterpolator(V, eta)(np.clip(flows, V[0], V[-1])))


def read_curves(path: Path | str) -> dict[float, tuple[Floats, Floats]]:
    """Return ``{speed: (flows, values)}`` from a CSV file, flows in increasing order; its first line may be a header.

    Raises ``BlockError`` for a row that is not three finite numbers, a point given twice with two values, a file
    without a row or that is no text; ``OSError`` for one that cannot be opened.
    """
    found: dict[float, dict[float, float]] = {}
    try:
        lines = Path(path).read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise BlockError(f"{path} is not UTF-8 text; save it as CSV, UTF-8") from None
    for line, row in enumerate(csv.reader(lines)):
        if not row:
            continue
        try:
            speed, flow, value = (float(cell) for cell in row)
        except ValueError:
            if line == 0:
                continue
            speed = flow = value = math.nan
        if not (math.isfinite(speed) and math.isfinite(flow) and math.isfinite(value)):
            raise BlockError(
                f"{path}, line {line + 1}: {row!r} is not speed, flow, value; give three numbers a row, between commas"
            )
        before = found.setdefault(speed, {}).setdefault(flow, value)
        if before != value:
            raise BlockError(
                f"{path}, line {line + 1}: at speed {speed:g} and flow {flow:g} stood {before:g}, now {value:g}; "
                "keep one of them"
            )
    if not found:
        raise BlockError(f"{path} has no row of three numbers; give speed, flow, value")
    return {
        speed: (np.array(sorted(curve)), np.array([curve[V] for V in sorted(curve)]))
        for speed, curve in sorted(found.items())
    }
