"""Primitives of a trend by interval halving: straight and bent pieces, each named by the signs of slope and bend.

    A (0, 0)   B (+, +)   C (+, 0)   D (+, -)   E (-, +)   F (-, 0)   G (-, -)

A constant, then a line, then a parabola is fitted to the interval; the first whose residual is not more than the noise
explains (F test) is taken.  If none is, the interval is halved and tried again; the rest of the signal follows in the
same way.  A parabola whose top lies inside it is two primitives.  Pieces are not forced to meet.

Source: Dash, Maurya, Venkatasubramanian and Rengaswamy 2004, AIChE J. 50:149; the seven primitives are those of
Rengaswamy, Hagglund and Venkatasubramanian 2001, Eng. Appl. Artif. Intell. 14:23.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from stickslip.logs.arrays import Values

NAMES = {(0, 0): "A", (1, 1): "B", (1, 0): "C", (1, -1): "D", (-1, 1): "E", (-1, 0): "F", (-1, -1): "G"}
SHORTEST = 4  # samples, one more than a parabola has coefficients


class Piece(NamedTuple):
    """From sample ``start`` up to, not including, ``stop``, and its letter."""

    start: int
    stop: int
    name: str


@lru_cache(maxsize=4096)
def _basis(n: int) -> Values:
    """Orthonormal constant, line and parabola on n points, (3, n)."""
    x = np.linspace(-1.0, 1.0, n)
    q, _ = np.linalg.qr(np.column_stack([np.ones(n), x, x * x]))
    return np.asarray(q.T * np.sign(q[-1])[:, None])


@lru_cache(maxsize=4096)
def _limit(freedom: int, significance: float) -> float:
    """Largest residual variance over noise variance that noise explains, with the noise variance known."""
    from scipy.special import chdtri

    return float(chdtri(freedom, significance)) / freedom


def primitives(y: Values, noise: float, significance: float = 0.05) -> tuple[Piece, ...]:
    """The primitives of a trend (n,) with white noise of this standard deviation [unit of y], in order.

    >>> up, down = np.linspace(0, 1, 30), np.linspace(1, 0, 30)
    >>> "".join(piece.name for piece in primitives(np.concatenate([up, down]), 0.01))
    'CF'

    Raises ValueError unless the noise is positive.
    """
    if not noise > 0.0:
        raise ValueError(f"noise = {noise}; give the standard deviation of the noise, above 0")
    found: list[Piece] = []
    start, n = 0, len(y)
    while start < n:
        length = n - start
        if length < SHORTEST:
            found.append(Piece(start, n, found[-1].name if found else "A"))
            break
        while True:
            part = y[start : start + length]
            fit = _fit(part, noise, significance)
            if fit is not None or length // 2 < SHORTEST:
                break
            length //= 2
        a = fit if fit is not None else _basis(length)[:2] @ part
        found.extend(_named(a, start, length, noise))
        start += length
    return _merged(found)


def _fit(y: Values, noise: float, significance: float) -> Values | None:
    """Coefficients of the lowest order that fits; None if none does."""
    n = len(y)
    a = _basis(n) @ y
    left = float(y @ y) - np.cumsum(a * a)
    for order in (0, 1, 2):
        freedom = n - order - 1
        if freedom > 0 and left[order] <= freedom * noise**2 * _limit(freedom, significance):
            return np.asarray(a[: order + 1])
    return None


def _named(a: Values, start: int, n: int, noise: float) -> list[Piece]:
    """One piece, or two where a parabola turns inside; a slope or bend below two standard errors is none."""
    basis = _basis(n)
    bend = 0 if len(a) < 3 or abs(a[2]) < 2.0 * noise else int(np.sign(a[2]))
    if bend == 0:
        slope = 0 if len(a) < 2 or abs(a[1]) < 2.0 * noise else int(np.sign(a[1]))
        return [Piece(start, start + n, NAMES[slope, 0])]
    curve = a[:3] @ basis
    top = int(np.argmin(curve) if bend > 0 else np.argmax(curve))
    if SHORTEST // 2 <= top < n - SHORTEST // 2:
        return [Piece(start, start + top, NAMES[-bend, bend]), Piece(start + top, start + n, NAMES[bend, bend])]
    return [Piece(start, start + n, NAMES[1 if curve[-1] > curve[0] else -1, bend])]


def _merged(found: list[Piece]) -> tuple[Piece, ...]:
    """Neighbours of one name joined."""
    out: list[Piece] = []
    for piece in found:
        if out and out[-1].name == piece.name:
            out[-1] = Piece(out[-1].start, piece.stop, piece.name)
        else:
            out.append(piece)
    return tuple(out)
