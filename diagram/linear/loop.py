"""One loop opened at its controller's output: loop transfer, crossover, margins.

    L(s) = - (what the controller gives)/(what the valve is given)          closed loop: 1 + L = 0

All other loops stay closed.  Crossovers: |L| = 1.  Phase margin: 180 degrees + phase there, the smallest; delay margin:
phase margin over frequency.  Gain margin: 1/|L| where L crosses the negative real axis.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import control as ct
import numpy as np
from numpy.typing import NDArray
from stickslip.logs.shown import Shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]
PER_DECADE = 120


@dataclass(frozen=True, repr=False)
class Loop(Shown):
    """The loop of ``controller``, from ``PV`` to ``OP``; ``L`` is a state space named from OP to OP."""

    controller: str
    PV: str
    OP: str
    L: ct.StateSpace

    @property
    def headline(self) -> str:
        """The result in one line."""
        return f"{self.controller}, from {self.PV} to {self.OP}"

    def __call__(self, omega: float) -> complex:
        """Return L at the frequency ``omega`` [rad/s]."""
        return complex(self.L(1j * omega))

    @cached_property
    def omega(self) -> Floats:
        """Frequencies [rad/s] from a decade below the slowest to a decade above the fastest pole."""
        sizes = np.abs(self.L.poles())
        sizes = sizes[sizes > 1e-12 * sizes.max(initial=1e-300)] if sizes.size else np.ones(1)
        low, high = (sizes.min() / 10.0, sizes.max() * 10.0) if sizes.size else (1e-3, 1e3)
        low, high = self._reaching(low, -1.0), self._reaching(high, 1.0)
        return np.geomspace(low, high, int(PER_DECADE * np.log10(high / low)) + 1)

    def _reaching(self, omega: float, way: float) -> float:
        """Return ``omega`` moved on by decades until a falling |L| is above 1 (down) or below 1 (up)."""
        for _ in range(6):
            here, on = abs(self(omega)), abs(self(omega * 10.0**way))
            if (way > 0.0 and (here < 1.0 or on > 0.5 * here)) or (way < 0.0 and (here > 1.0 or on < 2.0 * here)):
                break
            omega *= 10.0**way
        return omega

    @cached_property
    def response(self) -> NDArray[np.complex128]:
        """L at ``omega``."""
        return np.asarray(ct.frequency_response(self.L, self.omega).complex).ravel()

    @cached_property
    def phase(self) -> Floats:
        """Phase at ``omega`` [degrees], continuous, between -360 and 0 at the lowest frequency."""
        phase = np.degrees(np.unwrap(np.angle(self.response)))
        return np.asarray(phase - 360.0 * np.ceil((phase[0] - 1e-6) / 360.0))

    @cached_property
    def crossovers(self) -> tuple[float, ...]:
        """Frequencies where |L| = 1 [rad/s]."""
        return self._roots(lambda w: float(np.log(abs(self(w)))), np.log(np.abs(self.response)))

    @property
    def crossover(self) -> float:
        """The highest crossover [rad/s]; nan if |L| never crosses 1."""
        return max(self.crossovers, default=float("nan"))

    @property
    def phase_margin(self) -> float:
        """Smallest phase margin [degrees]; inf without crossover."""
        return min((self._margin_at(w) for w in self.crossovers), default=float("inf"))

    @property
    def delay_margin(self) -> float:
        """Smallest dead time [s] that would make the loop unstable; inf without crossover."""
        lags = [np.radians(self._margin_at(w) % 360.0) / w for w in self.crossovers]
        return float(min(lags, default=float("inf")))

    @cached_property
    def phase_crossovers(self) -> tuple[float, ...]:
        """Frequencies where L crosses the negative real axis [rad/s]."""
        found = self._roots(lambda w: self(w).imag, self.response.imag)
        return tuple(w for w in found if self(w).real < 0.0)

    @property
    def gain_margin(self) -> float:
        """Smallest factor above 1 on the gain that makes the loop unstable; inf if there is none."""
        return min((g for g in self._gains() if g > 1.0), default=float("inf"))

    @property
    def gain_reduction(self) -> float:
        """Largest factor below 1 on the gain that makes the loop unstable; 0 if there is none."""
        return max((g for g in self._gains() if g < 1.0), default=0.0)

    def plot(self) -> "Figure":
        """Return the Bode plot with crossover and margins."""
        from stickslip.diagram.linear.figures import plot_loops

        return plot_loops([self])

    def _margin_at(self, omega: float) -> float:
        margin = 180.0 + float(np.degrees(np.angle(self(omega))))
        return margin - 360.0 if margin > 180.0 else margin

    def _gains(self) -> list[float]:
        return [1.0 / abs(self(w)) for w in self.phase_crossovers]

    def _roots(self, f: Callable[[float], float], values: Floats) -> tuple[float, ...]:
        """Return the frequencies at which ``f`` changes sign."""
        from scipy.optimize import brentq

        at = np.flatnonzero((values[:-1] < 0.0) != (values[1:] < 0.0))
        return tuple(float(brentq(f, self.omega[i], self.omega[i + 1], xtol=1e-14, rtol=1e-13)) for i in at)
