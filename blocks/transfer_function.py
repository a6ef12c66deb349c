"""A transfer function of any order, continuous or sampled.

    continuous   G(s) = (b_m s^m + ... + b_1 s + b_0) / (a_n s^n + ... + a_1 s + a_0)          m <= n
    sampled      G(z) = (b_m z^m + ... + b_0) / (a_n z^n + ... + a_0)     at t_k = k dt, y held until t_(k+1)

in   u  any signal        out  y  any signal        dt  sampling period [s], 0: continuous
num  b_m, ..., b_0 and den a_n, ..., a_0, highest power first as python-control writes them.  The parameters are
     called by their power: a_0, a_1, ..., b_0, b_1, ...

With  a_n z^(n) + ... + a_0 z = u  and  y = b_n z^(n) + ... + b_0 z  the states are z and its derivatives (sampled: z
and its later values), x_1 = c z, x_2 = c z'/w, ...  The rate w [1/s] and the factor c are taken from den so that all
states are about as large as u; they do not change G.  With m < n the output does not follow the input at once.  How
python-control sees a sampled one: see state_space.

Source: the usual controller form.  Valid for orders up to about ten, above which coefficients say little about poles;
not for m > n, nor for dead time (dead_time).  See also: state_space, first_order, second_order.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import BlockError, Labels, Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite
from stickslip.blocks.state_space import StateSpace

Floats = NDArray[np.float64]

# p = n, dt, w, c, a_0 ... a_n, b_0 ... b_(n-1), then b_n unless it is zero


def _highest(x: Any, u: Any, p: Any) -> float:
    """Return what follows the last state: c z^(n) / w^n."""
    n = int(p[0])
    total = p[3] * u[0]
    power = 1.0
    for i in range(n):
        total -= p[4 + i] * power * x[i]
        power *= p[2]
    value: float = total / (p[4 + n] * power)
    return value


def _lower(x: Any, p: Any) -> float:
    """Return y less the part of b_n."""
    n = int(p[0])
    total = 0.0
    power = 1.0 / p[3]
    for i in range(n):
        total += p[5 + n + i] * power * x[i]
        power *= p[2]
    return total


def _strict_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = _lower(x, p)


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    n = int(p[0])
    y[0] = _lower(x, p) + p[5 + 2 * n] * math.pow(p[2], float(n)) / p[3] * _highest(x, u, p)


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    n = int(p[0])
    for i in range(n - 1):
        dx[i] = p[2] * x[i + 1]
    dx[n - 1] = p[2] * _highest(x, u, p)


def _advance(d: Any, u: Any, p: Any) -> None:
    n = int(p[0])
    last = _highest(d, u, p)
    for i in range(n - 1):
        d[i] = d[i + 1]
    if n > 0:
        d[n - 1] = last


def _strict_step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    _strict_out(t, d, d, u, p, y)
    _advance(d, u, p)


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    _out(t, d, d, u, p, y)
    _advance(d, u, p)


class TransferFunction(Block):
    """A transfer function from its coefficients ``num`` and ``den``, sampled every ``dt`` [s] unless that is 0.

    ``start`` is the output at which it begins at rest.  Raises ``BlockError`` if it is improper, for coefficients that
    are not finite, a leading zero of den, dt < 0, or a start that it cannot rest at.

    >>> from stickslip.diagram import drive
    >>> lag = TransferFunction([3.0], [10.0, 1.0])                 # 3 (1 - exp(-t/10))
    >>> drive(lag, 20.0, every=10.0, u=1.0).log["y"].round(4).tolist()
    [0.0, 1.8964, 2.594]
    >>> TransferFunction([1.0, 0.0], [1.0])
    Traceback (most recent call last):
    ...
    stickslip.blocks.ports.BlockError: system: num has degree 1 and den 0, but an improper transfer function answers
    with \
derivatives of its input; give den at least the degree of num, for example with a filter 1/(s T_f + 1)
    """

    role = Role.PROCESS
    ports_in = (Port("u"),)
    ports_out = (Port("y"),)

    def __init__(
        self, num: ArrayLike, den: ArrayLike, dt: float = 0.0, *, start: float = 0.0, name: str = "system",
        inputs: Labels = None, outputs: Labels = None, **labels: Any,
    ) -> None:  # fmt: skip
        b, a = coefficients(num, den, name)
        n = len(a) - 1
        w, c = _scales(a) if not dt else (1.0, 1.0)
        params = {"n": n, "dt": dt, "w": w, "c": c}
        params |= {f"a_{i}": float(value) for i, value in enumerate(a)}
        params |= {f"b_{i}": float(value) for i, value in enumerate(b) if i < n or value}
        feeds = len(b) > n and bool(b[n])
        z = _rest(a, b, bool(dt), start, name)
        values = {f"x_{i + 1}": c * z if dt or i == 0 else 0.0 for i in range(n)}
        if dt:
            self.period_param = "dt"
            self.kernels = Kernels(step=_step if feeds else _strict_step, feeds=feeds)
            held: dict[str, Any] = {"memory": values, "start_output": start}
        else:
            self.kernels = Kernels(out=_out if feeds else _strict_out, der=_der, feeds=feeds, linear=True)
            held = {"states": values}
        super().__init__(name=name, params=params, inputs=inputs, outputs=outputs, **held, **labels)

    @staticmethod
    def check(params: Any, name: str) -> None:
        """Raise ``BlockError`` unless the coefficients are finite, a_n is not 0 and the order is as built."""
        finite(params, name, *reversed(params))  # the coefficients first: w and c follow from them
        n = sum(key.startswith("a_") for key in params) - 1
        require(params["n"] == n, name, "n", params["n"], f"it was built with order {n}", "build another")
        last = params[f"a_{n}"]
        require(last != 0.0, name, f"a_{n}", last, "the first coefficient of den is not 0", "leave it out")
        for key in ("w", "c"):
            require(params[key] != 0.0, name, key, params[key], "a scale of the states is not 0", "leave it as it is")
        require(params["dt"] >= 0.0, name, "dt", params["dt"], "a sampling period is not negative", "give seconds")

    def matrices(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return A (n, n), B (n, 1), C (1, n) and D (1, 1) of its states."""
        n, w, c = int(self.p[0]), float(self.p[2]), float(self.p[3])
        powers = w ** np.arange(n + 1)
        a, b = self.p[4 : 5 + n] * powers, np.zeros(n + 1)
        b[: len(self.p) - 5 - n] = self.p[5 + n :]
        b *= powers / c
        step = 1.0 if self.sampled else w
        A = step * np.eye(n, k=1)
        if n:
            A[-1] = -step * a[:-1] / a[-1]
        B = np.zeros((n, 1))
        B[-1:] = step * c / a[-1]
        C = (b[:-1] - b[-1] * a[:-1] / a[-1])[None, :]
        return A, B, C, np.array([[b[-1] * c / a[-1]]])

    def smooth(self) -> Block:
        """Return the continuous system whose zero-order-hold sample this is, which python-control sees."""
        if not self.sampled:
            return self
        twin = StateSpace(
            *self.matrices(), self.period, start=self.d0, states=self.memory_names, name=self.name,
            inputs=list(self.input_labels), outputs=list(self.output_labels),
        )  # fmt: skip
        return twin.holding(self.y0).smooth()


def coefficients(num: ArrayLike, den: ArrayLike, name: str) -> tuple[Floats, Floats]:
    """Return b_0 ... b_m and a_0 ... a_n, lowest power first, leading zeros dropped; b as long as a at least.

    Raises ``BlockError`` if den is zero or num has the higher degree.
    """
    b, a = (np.trim_zeros(np.atleast_1d(np.asarray(given, dtype=float)).ravel(), "f")[::-1] for given in (num, den))
    require(len(a) > 0, name, "den", den, "a denominator is not zero", "give its coefficients, highest power first")
    if len(b) > len(a):
        raise BlockError(
            f"{name}: num has degree {len(b) - 1} and den {len(a) - 1}, but an improper transfer function answers with "
            "derivatives of its input; give den at least the degree of num, for example with a filter 1/(s T_f + 1)"
        )
    return np.pad(b, (0, len(a) - len(b))), a


def _scales(a: Floats) -> tuple[float, float]:
    """Return the rate w [1/s] and the factor c that make the states about as large as the input."""
    k, n = int(np.flatnonzero(a)[0]), len(a) - 1
    w = abs(float(a[k] / a[n])) ** (1.0 / (n - k)) if k < n else 1.0
    return w, float(a[k]) * w**k


def _rest(a: Floats, b: Floats, sampled: bool, start: float, name: str) -> float:
    """Return the z at which the output rests at ``start``."""
    if start == 0.0:
        return 0.0
    gain = float(b.sum() if sampled else b[0])
    rule = "it rests at 0 only" if len(a) > 1 else "a gain has no state"
    require(gain != 0.0 and len(a) > 1 and math.isfinite(start), name, "start", start, rule, "leave start= out")
    return start / gain
