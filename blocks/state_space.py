"""A linear system of any order with any number of inputs and outputs, continuous or sampled.

    continuous   dx/dt   = A x + B u              y   = C x + D u
    sampled      x_(k+1) = A x_k + B u_k          y_k = C x_k + D u_k      at t_k = k dt, y held until t_(k+1)

in   u  (one input), or u_1 ... u_m      any signals          x  n states [any]
out  y  (one output), or y_1 ... y_q     any signals          dt sampling period [s], 0: continuous
A (n, n), B (n, m), C (q, n), D (q, m)   the matrices; each entry is a parameter: A_1_1 is the first one of A

With n = 0 it is the gain y = D u.  If all of D is zero the outputs do not follow the inputs at once, so the block
breaks algebraic loops, and D has no parameters.  Python-control sees a sampled system as the continuous one of which
it is the sample with a zero-order hold, if there is one; if not (a pole at 0 or on the negative real axis), as its
start output standing still.

Source: the usual textbook form.  Valid for any order that matrices serve; not for improper systems, whose output
holds derivatives of the input.  See also: transfer_function, first_order, second_order.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.kernels import fed_by
from stickslip.blocks.ports import BlockError, Labels, Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite

Floats = NDArray[np.float64]

# p = n, m, q, dt, A, B, C (row by row), then D unless it is zero


def _row(i: int, at: int, length: int, p: Any, v: Any) -> float:
    """Return row ``i`` of the matrix at ``p[at:]`` times the vector ``v``."""
    total = 0.0
    for j in range(length):
        total += p[at + i * length + j] * v[j]
    return total


def _follow(i: int, at: int, length: int, p: Any, v: Any) -> float:
    """Return the same, without what is multiplied by zero: it may not be known yet."""
    total = 0.0
    for j in range(length):
        if p[at + i * length + j] != 0.0:
            total += p[at + i * length + j] * v[j]
    return total


def _strict_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    n, m, q = int(p[0]), int(p[1]), int(p[2])
    for i in range(q):
        y[i] = _row(i, 4 + n * (n + m), n, p, x)


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    n, m, q = int(p[0]), int(p[1]), int(p[2])
    for i in range(q):
        y[i] = _row(i, 4 + n * (n + m), n, p, x) + _follow(i, 4 + n * (n + m + q), m, p, u)


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    n, m = int(p[0]), int(p[1])
    for i in range(n):
        dx[i] = _row(i, 4, n, p, x) + _row(i, 4 + n * n, m, p, u)


# sampled: d = x and behind it room for the next x


def _advance(d: Any, u: Any, p: Any) -> None:
    n, m = int(p[0]), int(p[1])
    for i in range(n):
        d[n + i] = _row(i, 4, n, p, d) + _row(i, 4 + n * n, m, p, u)
    for i in range(n):
        d[i] = d[n + i]


def _strict_step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    _strict_out(t, d, d, u, p, y)
    _advance(d, u, p)


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    _out(t, d, d, u, p, y)
    _advance(d, u, p)


class StateSpace(Block):
    """A linear system from its matrices ``A``, ``B``, ``C``, ``D``, sampled every ``dt`` [s] unless that is 0.

    ``D`` may be left out for zeros; ``start`` (n,) is the state at the start; ``states`` names the states (default
    x_1 ... x_n).  Raises ``BlockError`` for shapes that do not fit together, entries that are not finite, or dt < 0.

    ``start`` [units of the states].

    >>> from stickslip.diagram import drive
    >>> oscillator = StateSpace([[0, 1], [-1, 0]], [[0], [1]], [[1, 0]])      # y(t) = 1 - cos t
    >>> drive(oscillator, 4.0, every=2.0, u=1.0).log["y"].round(4).tolist()
    [0.0, 1.4161, 1.6536]
    >>> halves = StateSpace([[0.5]], [[1.0]], [[1.0]], dt=1.0)                # y_(k+1) = y_k / 2 + u_k
    >>> drive(halves, 3.0, every=1.0, u=1.0).log["y"].tolist()
    [0.0, 1.0, 1.5, 1.75]
    """

    role = Role.PROCESS

    def __init__(
        self, A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike | None = None, dt: float = 0.0, *,
        start: ArrayLike | None = None, states: tuple[str, ...] = (), name: str = "system", inputs: Labels = None,
        outputs: Labels = None, **labels: Any,
    ) -> None:  # fmt: skip
        A, B, C, D = _matrices(A, B, C, D, name)
        n, m, q = len(A), B.shape[1], len(C)
        begin = np.zeros(n) if start is None else np.asarray(start, dtype=float).ravel()
        for what, given in (("start", begin), ("states", states or begin)):
            rule = f"the system has {n} states"
            require(len(given) == n, name, what, list(given), rule, "give one per state")
        self.ports_in, self.ports_out = _ports("u", m), _ports("y", q)
        feeds = fed_by(bool(column.any()) for column in D.T)
        names = states or tuple(f"x_{i + 1}" for i in range(n))
        params = {"n": n, "m": m, "q": q, "dt": dt, **_entries("A", A), **_entries("B", B), **_entries("C", C)}
        params |= _entries("D", D) if feeds else {}
        values = dict(zip(names, begin.tolist(), strict=True))
        if dt:
            self.period_param = "dt"
            self.kernels = Kernels(step=_step if feeds else _strict_step, feeds=bool(feeds))
            held: dict[str, Any] = {"memory": values | {f"next {key}": 0.0 for key in names}, "start_output": C @ begin}
        else:
            self.kernels = Kernels(out=_out if feeds else _strict_out, der=_der, feeds=feeds, linear=True)
            held = {"states": values}
        super().__init__(name=name, params=params, inputs=inputs, outputs=outputs, **held, **labels)

    @staticmethod
    def check(params: Any, name: str) -> None:
        """Raise ``BlockError`` unless all entries are finite and the sizes are as built."""
        finite(params, name, *params)
        entries = [key for key in params if key[1:2] == "_"]
        for size, matrix, axis in (("n", "A", 1), ("m", "B", 2), ("q", "C", 1)):
            built = max((int(key.split("_")[axis]) for key in entries if key[0] == matrix), default=params[size])
            require(params[size] == built, name, size, params[size], f"it was built with {built}", "build another")
        require(params["dt"] >= 0.0, name, "dt", params["dt"], "a sampling period is not negative", "give seconds")

    def matrices(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return A (n, n), B (n, m), C (q, n) and D (q, m)."""
        n, m, q = (int(size) for size in self.p[:3])
        shapes, at, found = ((n, n), (n, m), (q, n), (q, m)), 4, []
        for shape in shapes:
            size = math.prod(shape)
            part = self.p[at : at + size]
            found.append(part.reshape(shape) if len(part) == size else np.zeros(shape))
            at += size
        return found[0], found[1], found[2], found[3]

    def smooth(self) -> Block:
        """Return the continuous system whose zero-order-hold sample this is, of which slopes are taken.

        There is none with a pole at 0 or on the negative axis, as of every FIR filter: if the system is stable its
        gain at rest stands for it, without dynamics.
        """
        if not self.sampled:
            return self
        A, B, C, D = self.matrices()
        n, m = B.shape
        poles = np.linalg.eigvals(A)
        if np.any((np.abs(poles.imag) <= 1e-9 * np.abs(poles)) & (poles.real <= 1e-12)):
            if np.any(np.abs(poles) >= 1.0):
                return super().smooth()
            gain = StateSpace([], [], [], C @ np.linalg.solve(np.eye(n) - A, B) + D, name=self.name)
            return gain.relabelled(self.name, list(self.input_labels), list(self.output_labels))
        from scipy.linalg import logm

        both = np.block([[A, B], [np.zeros((m, n)), np.eye(m)]])
        rate = np.real(logm(both)) / self.period
        return StateSpace(
            rate[:n, :n], rate[:n, n:], C, D, start=self.d0[:n], states=self.memory_names[:n], name=self.name,
            inputs=list(self.input_labels), outputs=list(self.output_labels),
        )  # fmt: skip


def _matrices(
    A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike | None, name: str
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the four matrices with their full shapes; refuse those that do not fit together."""
    a, b, c = (np.atleast_2d(np.asarray(given, dtype=float)) for given in (A, B, C))
    n = 0 if a.size == 0 else len(a)
    if n == 0:
        d = np.atleast_2d(np.asarray(0.0 if D is None else D, dtype=float))
        return np.zeros((0, 0)), np.zeros((0, d.shape[1])), np.zeros((len(d), 0)), d
    b = b.reshape(n, -1) if b.shape[0] == 1 and b.size % n == 0 and n > 1 else b
    d = np.zeros((len(c), b.shape[1])) if D is None else np.atleast_2d(np.asarray(D, dtype=float))
    if a.shape != (n, n) or len(b) != n or c.shape[1] != n or d.shape != (len(c), b.shape[1]):
        raise BlockError(
            f"{name}: A is {a.shape}, B {b.shape}, C {c.shape}, D {d.shape}, but A must be (n, n), B (n, m), C (q, n) "
            "and D (q, m) for n states, m inputs and q outputs; correct the one that does not fit"
        )
    return a, b, c, d


def _entries(matrix: str, values: Floats) -> dict[str, float]:
    """Return the entries by name, row by row."""
    return {f"{matrix}_{i + 1}_{j + 1}": float(value) for (i, j), value in np.ndenumerate(values)}


def _ports(letter: str, count: int) -> tuple[Port, ...]:
    return (Port(letter),) if count == 1 else tuple(Port(f"{letter}_{i + 1}") for i in range(count))
