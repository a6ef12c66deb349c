"""Poles with what they are made of: participation factors of the states.

    A v = p v,   w A = p w,   w v = 1          share of state k in pole p: |w_k v_k| over the sum

Shares do not depend on units (Perez-Arriaga, Verghese and Schweppe 1982).  A state that nothing moves, such as the
integrator of a controller at its limit, is an exact zero of its own: marked as held, not as a slow mode.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
SHARE = 0.1  # least share of a state that is named with a pole


@dataclass(frozen=True)
class Pole:
    """A pole ``value`` [1/s], the states that make it with their shares, largest first, and whether it is held."""

    value: complex
    states: tuple[tuple[str, float], ...]
    held: bool = False

    @property
    def time_constant(self) -> float:
        """1/|Re| [s]; inf on the imaginary axis."""
        return 1.0 / abs(self.value.real) if self.value.real else float("inf")

    @property
    def frequency(self) -> float:
        """Magnitude [rad/s]."""
        return abs(self.value)

    @property
    def damping(self) -> float:
        """-Re/|p| [-]: 1 for a real stable pole, negative for an unstable one; 0 at zero."""
        return -self.value.real / abs(self.value) if self.value else 0.0

    def made_of(self, share: float = SHARE) -> str:
        """Return the names of the states with at least that share, the first in any case."""
        named = [name for name, part in self.states if part >= share] or [self.states[0][0]]
        return ", ".join(named)


def poles_of(A: Floats, states: Sequence[str], sizes: Floats, held: Sequence[str] = ()) -> tuple[Pole, ...]:
    """Return the poles of ``A`` from fast to slow, a complex pair as its upper one; ``sizes`` scale the states.

    >>> A = np.array([[-2.0, 0.0], [1.0, -0.5]])
    >>> [(round(pole.value.real, 9), pole.made_of()) for pole in poles_of(A, ["a", "b"], np.ones(2))]
    [(-2.0, 'a'), (-0.5, 'b')]
    """
    from scipy.linalg import eig

    free = np.array([name not in held for name in states], dtype=bool)
    inner = [name for name, moves in zip(states, free, strict=True) if moves]
    found = [Pole(0j, ((name, 1.0),), held=True) for name in states if name in held]
    if inner:
        scaled = A[np.ix_(free, free)] * sizes[free] / sizes[free, None]
        values, left, right = eig(scaled, left=True, right=True)
        for i, value in enumerate(values):
            if value.imag < 0.0:
                continue
            parts = np.abs(left[:, i].conj() * right[:, i])
            parts = parts / parts.sum()
            order = np.argsort(-parts, kind="stable")
            found.append(Pole(complex(value), tuple((inner[k], float(parts[k])) for k in order)))
    return tuple(sorted(found, key=lambda pole: -abs(pole.value)))


def table(poles: Sequence[Pole]) -> list[tuple[str, str, str, str]]:
    """Return rows of words: pole [1/s], time constant [s], damping [-], states.

    >>> table(poles_of(np.array([[-0.1]]), ["process[PV]"], np.ones(1)))
    [('-0.1', '10', '1', 'process[PV]')]
    """
    rows = []
    for pole in poles:
        p = pole.value
        said = f"{p.real:.4g}" if p.imag == 0.0 else f"{p.real:.4g} ± {p.imag:.4g}j"
        if pole.held:
            rows.append(("0", "held", "", pole.made_of()))
        else:
            rows.append((said, f"{pole.time_constant:.4g}", f"{pole.damping:.3g}", pole.made_of()))
    return rows
