"""How long a step may be beside blocks whose functions follow the time in a way that nothing but their values tells.

An error estimate sees a function at a few instants of a step; what comes and goes between them is strode over.  So
such functions f(t, x, u) are evaluated before the run, at t_k spread over it (golden ratio, ``LOOKS`` of them), at the
start values with u = 0 and at start values + 1 with u = 1.  Half of the anchors are spread evenly, the other half lie
where neighbours differ most.  With d doubled from span / 2^20 on, as long as at every anchor

    |f(t - d) - 2 f(t) + f(t + d)| / 2  <=  0.004 (max f - min f) + rounding

the bound is 2 d of the last d that passes: period/50 to period/25 of a sine.  If the first fails, d is halved instead.
What is the same at all t_k has no bound.  Neither has what is a straight line, or passes at all d up to a quarter of
the span.  What gives no numbers at either point, or passes for no d, has the bound span / 1000, and is ``guessed``.

Limits: what lasts less than span / 256 may lie between the anchors, and what is below 0.4 % of the range is not seen;
near jumps the bound is as short as the nearest anchor is close, so it costs steps that nothing needs.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from stickslip.engine import layout as at
from stickslip.engine.call import call, pointer_to
from stickslip.engine.callback import pardoned
from stickslip.engine.flat import Floats, Ints
from stickslip.engine.table import Component
from stickslip.logs.compiled import njit

LOOKS = 256
EACH = 32  # anchors spread evenly, and as many where the function bends most
GOLDEN = 0.6180339887498949
BEND = 0.004  # of the range
ROUNDING = 1e-12  # of the largest value
FIRST, LAST = 2.0**-20, 2.0**-32  # of the span: where d begins, and where halving it ends
GUESS = 1e-3  # of the span

Values = Callable[[Floats], Floats]


class Bound(NamedTuple):
    """The largest step [s] that a block allows; ``guessed`` if its values do not tell."""

    block: int
    step: float
    guessed: bool


def bound_steps(component: Component, I: Ints, W: Floats, t_end: float) -> tuple[Bound, ...]:
    """Bound the steps of a component that is ready to start by what its functions of the time do up to ``t_end`` [s].

    Returns the bounds of its blocks, without those that need none.
    """
    t0, found = float(W[at.T]), []
    for b in component.unforeseen if t_end > t0 else ():
        step, guessed = longest(_values(component, b, I, W), t0, t_end)
        if step < np.inf:
            found.append(Bound(b, step, guessed))
            W[at.LONGEST] = min(W[at.LONGEST], step)
    return tuple(found)


def longest(values: Values, t0: float, t_end: float) -> tuple[float, bool]:
    """Return the largest step [s] beside functions of the time, and whether it is guessed.

    ``values`` gives them at times (n,) as (n, 2 points x functions); see the module docstring.

    >>> step, guessed = longest(lambda t: np.sin(2 * np.pi * t / 10.0)[:, None] * np.ones(2), 0.0, 1000.0)
    >>> round(10.0 / step), guessed
    (41, False)
    """
    span = t_end - t0
    t = np.sort(t0 + span * ((np.arange(LOOKS) + 0.5) * GOLDEN % 1.0))
    f = values(t)
    known = np.isfinite(f).all(axis=0)
    guess = span * GUESS if not known.reshape(2, -1).any(axis=0).all() else np.inf
    size, extent = np.abs(f[:, known]).max(axis=0, initial=0.0), np.ptp(f[:, known], axis=0)
    moves = extent > ROUNDING * size
    if not moves.any():
        return guess, guess < np.inf
    columns = np.flatnonzero(known)[moves]
    allowed = BEND * extent[moves] + ROUNDING * size[moves]
    f = f[:, columns]
    bends = (np.abs(f[:-2] - 2.0 * f[1:-1] + f[2:]) / extent[moves]).max(axis=1)
    chosen = np.union1d(np.arange(LOOKS // EACH // 2, LOOKS, LOOKS // EACH), 1 + np.argsort(-bends)[:EACH])
    t, f = t[chosen], f[chosen]

    def passes(d: float) -> bool:
        inside = (t - d >= t0) & (t + d <= t_end)
        beside = values(np.concatenate([t[inside] - d, t[inside] + d]))[:, columns]
        before, behind = np.split(beside, 2)
        return bool((np.abs(before - 2.0 * f[inside] + behind) <= 2.0 * allowed).all())

    d = FIRST * span
    if passes(d):
        while d <= 0.125 * span and passes(2.0 * d):
            d *= 2.0
        step = 2.0 * d if d <= 0.125 * span else np.inf
    else:
        while d >= LAST * span and not passes(d):
            d *= 0.5
        if d < LAST * span:
            guess = span * GUESS
        step = 2.0 * d if d >= LAST * span else np.inf
    return min(step, guess), guess < step


def _values(component: Component, b: int, I: Ints, W: Floats) -> Values:
    """Return what gives the outputs and the rates of a block at times, at the two points."""
    row = at.H + component.blocks.index(b) * at.R
    nx, nd, nu, ny = (int(I[row + slot]) for slot in (at.NX, at.ND, at.NU, at.NY))
    kept = [(component.states[b], nx), (component.memory[b], nd), (component.params[b], component.unforeseen[b])]
    x, d, p = (W[start : start + n] for start, n in kept)
    places = np.cumsum([0, nx, nd, 2 * nu, len(p)])
    kernels = [(int(I[row + slot]), n) for slot, n in ((at.A_OUT, ny), (at.A_DER, nx)) if I[row + slot] and n]

    def values(t: Floats) -> Floats:
        columns = []
        for shift in (0.0, 1.0):
            for kernel, n in kernels:
                numbers = np.concatenate([x + shift, d, np.full(nu, shift), np.zeros(nu), p, np.zeros(n)])
                columns.append(np.full((len(t), n), np.nan))
                with pardoned():
                    _evaluate(kernel, t, numbers, *places.tolist(), columns[-1])
        return np.concatenate(columns, axis=1)

    return values


@njit(cache=True, error_model="numpy")
def _evaluate(kernel, times, numbers, x, d, u, p, out, rows):  # type: ignore[no-untyped-def]
    """Write what a kernel gives at each time into ``rows``; its arguments stand in ``numbers``, its answer behind."""
    base = pointer_to(numbers)
    for k in range(len(times)):
        call(kernel, times[k], base, x, d, u, p, out)
        for i in range(rows.shape[1]):
            rows[k, i] = numbers[out + i]
