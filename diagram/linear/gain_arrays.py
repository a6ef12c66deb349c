"""Relative gain array: how much the gain from one OP to one PV changes when the other loops are closed.

    RGA(s) = G(s) o (G(s)^-1)^T          o element by element;  G from the OPs to the PVs with those loops open

Rows are PVs, columns OPs; each row and column sums to 1.  Pair on elements near 1; a negative steady element means
that the loop turns unstable when the others are opened or closed.  Source: Bristol 1966; Skogestad and Postlethwaite,
Multivariable Feedback Control, 2005, section 3.4.
A level that only integrates has an infinite steady gain; the array stays finite there and is taken as the limit.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from stickslip.logs.shown import Shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Complex = NDArray[np.complex128]
NEAR_ZERO = 1e-4  # of the slowest pole: where the steady limit is taken from, and again at half of it


@dataclass(frozen=True, repr=False)
class Rga(Shown):
    """A relative gain array: ``values`` (n, n) complex, rows ``PVs``, columns ``OPs``, at ``frequency`` [rad/s].

    At frequency 0 the values are real.
    """

    controllers: tuple[str, ...]
    PVs: tuple[str, ...]
    OPs: tuple[str, ...]
    frequency: float
    values: Complex

    @property
    def headline(self) -> str:
        """The result in one line."""
        pairs = ", ".join(f"{PV} by {OP}" for PV, OP in zip(self.PVs, self.OPs, strict=True))
        return f"{pairs} at {self.frequency:g} rad/s; RGA number {self.number:.3g}"

    @property
    def number(self) -> float:
        """RGA number: sum of |RGA - I| [-]; small where loops paired as given do not disturb each other."""
        return float(np.abs(self.values - np.eye(len(self.values))).sum())

    def plot(self) -> "Figure":
        """Return the array as a picture: shades of |RGA| with the numbers."""
        from stickslip.diagram.linear.figures import plot_rga

        return plot_rga(self)


def relative_gains(G: Complex) -> Complex:
    """Return G o (G^-1)^T.

    Raises ``ValueError`` if G is singular: then some OP moves nothing, or two move the same.

    >>> relative_gains(np.array([[2.0, 1.0], [1.0, 1.0]], dtype=complex)).real.round(9).tolist()
    [[2.0, -1.0], [-1.0, 2.0]]
    """
    G = np.asarray(G, dtype=complex)
    rows, columns = np.abs(G).max(axis=1), np.abs(G).max(axis=0)
    if rows.min() == 0.0 or columns.min() == 0.0:
        where = int(np.argmin(columns if columns.min() == 0.0 else rows))
        which = "OP" if columns.min() == 0.0 else "PV"
        raise ValueError(f"{which} number {where + 1} has no gain at all: a valve shut or a controller at its limit?")
    scaled = G / rows[:, None]
    scaled = scaled / np.abs(scaled).max(axis=0)  # the array does not depend on units
    if np.linalg.cond(scaled) > 1e12:
        raise ValueError("the gains are singular: two of these OPs move the PVs alike; leave one out")
    return np.asarray(scaled * np.linalg.inv(scaled).T)
