"""Parameters of the ideal loop with a sticking stem, and the thesis's named settings of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


class ExactLoopError(ValueError):
    """The exact solution does not cover these parameters."""


@dataclass(frozen=True)
class ExactLoop:
    """Parameters of the ideal loop; the defaults are the thesis's high stiction loop, from rest, SP 0 -> 0.5.

    Process K/(tau s + 1), or K/(tau s) if ``integrating``; ``tau``, ``T_i`` [s]; ``M`` [kg], ``k`` [N per full travel],
    ``F_v`` [N s per full travel], ``F_c``, ``F_s`` [N]; ``SP``, ``PV_0``, ``z_0``, ``x_0`` are the reference and the
    state at t = 0, with the stem at rest; ``duration``, ``log_interval`` [s].

    Raises ExactLoopError for parameters out of range. Source: eqs. 4.4-4.5, 6.2, 7.4, table A.1.

    >>> round(ExactLoop().J, 4), round(ExactLoop().S, 4)
    (0.019, 0.0667)
    """

    K: float = 3.0
    tau: float = 10.0
    integrating: bool = False
    K_p: float = 0.4
    T_i: float = 10.0
    M: float = 1.36
    k: float = 52500.0
    F_v: float = 612.0
    F_c: float = 1250.0
    F_s: float = 2250.0
    SP: float = 0.5
    PV_0: float = 0.0
    z_0: float = 0.0
    x_0: float = 0.0
    duration: float = 600.0
    log_interval: float = 0.1

    def __post_init__(self) -> None:
        for name in ("K", "tau", "K_p", "T_i", "M", "k", "F_v", "F_c", "duration", "log_interval"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise ExactLoopError(f"{name} = {value!r} must be positive and finite; give {name} > 0")
        for name in ("F_s", "SP", "PV_0", "z_0", "x_0"):
            value = getattr(self, name)
            if not np.isfinite(value):
                raise ExactLoopError(f"{name} = {value!r} must be finite; give a number")
        if self.F_s < self.F_c:
            raise ExactLoopError(f"F_s = {self.F_s!r} must not be below F_c = {self.F_c!r}; raise F_s")

    @property
    def a(self) -> float:
        """Process pole [1/s]: -1/tau, or 0 for the integrating process."""
        return 0.0 if self.integrating else -1.0 / self.tau

    @property
    def b(self) -> float:
        """Process input gain K/tau [1/s]."""
        return self.K / self.tau

    @property
    def K_i(self) -> float:
        """Integral gain K_p/T_i [1/s]."""
        return self.K_p / self.T_i

    @property
    def f_c(self) -> float:
        """Coulomb friction F_c/k as a fraction of travel."""
        return self.F_c / self.k

    @property
    def f_s(self) -> float:
        """Static friction F_s/k as a fraction of travel."""
        return self.F_s / self.k

    @property
    def J(self) -> float:
        """Slip jump (F_s - F_c)/k, fraction of travel."""
        return (self.F_s - self.F_c) / self.k

    @property
    def S(self) -> float:
        """OP travel between opposite slips, (F_s + F_c)/k, fraction of travel."""
        return (self.F_s + self.F_c) / self.k

    @property
    def x_rest(self) -> float:
        """Stem position that holds PV = SP at rest: SP/K, or 0 for the integrating process."""
        return -self.a * self.SP / self.b


IDEAL_HIGH = ExactLoop()
"""High stiction (F_s 2250 N), r = 0.5: the symmetric cycle, reached from rest."""

IDEAL_NORMAL = ExactLoop(F_s=1750.0, SP=3.0 / 7.0)
"""Normal stiction (F_s 1750 N); 3/7 is the reference that gives the symmetric cycle from rest."""

IDEAL_HALF_GAIN = ExactLoop(K_p=0.2)
"""High stiction at half the controller gain; from rest it does not cycle, use `symmetric_start`."""

INTEGRATOR_HIGH = ExactLoop(integrating=True, K_p=0.2, T_i=400.0, SP=0.0, x_0=1000.0 / 52500.0 / 2.0, duration=2000.0)
"""Integrating process 3/(10 s) with 0.2 (400 s + 1)/(400 s), high stiction, started amid a symmetric cycle."""
