"""The slopes of a diagram at a point: each block alone, then joined exactly.

    one block     dx/dt = A x + B u,   y = C x + D u            differences in its own few variables
    all blocks    s = y + v,   u = M s                          s signals, v what is added to them, M the wiring
                  s = (I - D M)^-1 (C x + v)                    exists: no algebraic loops

Differences of single blocks are accurate to some 1e-10, because each variable is stepped in proportion to its own
size; differences of a whole diagram (``ct.linearize``) mix Pa with fractions and keep three or four digits.
Where a block has a kink at the point (a valve just shut, a controller just at its limit) the steeper side counts.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.wiring import flow_order

Floats = NDArray[np.float64]
STEP = 2e-5  # relative; central differences of two steps, extrapolated
SMALLEST = 1e-6  # absolute step of a variable at zero
KINK = 1e-4  # relative difference of the slopes to both sides from which they count as two


@dataclass(frozen=True)
class Slopes:
    """A diagram near a point: states ``x`` (n,), signals ``s`` (m,) and the slopes between them.

    ``A`` (n, n), ``B`` (n, inputs), ``C`` (m, n), ``D`` (m, inputs), ``M`` (inputs, m); ``rates`` dx/dt (n,);
    ``kinks`` the blocks whose two sides differ there.  Signals are the driven ones, then the open inputs.
    """

    diagram: Diagram
    states: tuple[str, ...]
    signals: tuple[str, ...]
    x: Floats
    s: Floats
    rates: Floats
    A: Floats
    B: Floats
    C: Floats
    D: Floats
    M: Floats
    kinks: tuple[str, ...]

    @property
    def idle(self) -> frozenset[str]:
        """The states of blocks that have a place for a lag and none in it: they are the states of nothing."""
        return frozenset(
            f"{block.name}[{name}]"
            for block in (seen.smooth() for seen in self.diagram.blocks)
            if block.lag_param and block.params[block.lag_param] == 0.0
            for name in block.state_names
        )

    def joined(self, cut: Sequence[str] = ()) -> tuple[Floats, Floats, Floats, Floats]:
        """Return A, B, C, D of the whole diagram, from what is added to every signal to every signal.

        Of a signal in ``cut`` the readers see only what is added, and the output only what its block gives.
        """
        passes = np.ones(len(self.signals))
        passes[[self.signals.index(name) for name in cut]] = 0.0
        DM, BM = self.D @ self.M, self.B @ self.M
        closed = np.linalg.inv(np.eye(len(self.signals)) - DM * passes)
        C, D = closed @ self.C, closed @ DM
        return self.A + (BM * passes) @ C, BM + (BM * passes) @ D, C, D + np.diag(passes)


def slopes(diagram: Diagram, t: float = 0.0) -> Slopes:
    """Return the slopes of a diagram where it starts; see the module.

    Raises ``ValueError`` if its signals are not finite there, or ``t`` is no time.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> found = slopes(self_regulating_loop().in_mode("ideal"))
    >>> found.states
    ('controller[z]', 'valve[x]', 'valve[v]', 'process[PV]')
    >>> round(float(found.A[3, 3]), 9)
    -0.1
    """
    check_time(t)
    x = diagram.x0
    signals = (*diagram.signals, *diagram.open_inputs)
    place = {name: i for i, name in enumerate(signals)}
    blocks: list[Block] = [block.as_it_starts() for block in diagram.syslist]
    s = _signals(diagram, blocks, place, x, t)
    if not np.all(np.isfinite(s)):
        why = [block.trouble() for block in diagram.blocks if block.trouble()]
        raise ValueError(
            f"'{diagram.name}' has no slopes where it starts: {', '.join(why) or 'signals are not finite'}, e.g. "
            f"{signals[int(np.argmin(np.isfinite(s)))]} = {s[~np.isfinite(s)][0]}; start it elsewhere"
        )
    n, m, inputs = len(x), len(signals), sum(len(block.ports_in) for block in blocks)
    A, B = np.zeros((n, n)), np.zeros((n, inputs))
    C, D = np.zeros((m, n)), np.zeros((m, inputs))
    M, rates, kinks = np.zeros((inputs, m)), np.zeros(n), []
    state, port = 0, 0
    for block, seen in zip(blocks, diagram.blocks, strict=True):
        X = slice(state, state + len(block.seen_states()))
        U = slice(port, port + len(block.ports_in))
        Y = [place[label] for label in seen.output_labels]
        at_in = [place[label] for label in seen.input_labels]
        M[np.arange(U.start, U.stop), at_in] = 1.0
        base, slope, kinked = _of_block(block, x[X], s[at_in], t)
        k = X.stop - X.start
        rates[X] = base[:k]
        A[X, X], B[X, U] = slope[:k, :k], slope[:k, k:]
        C[Y, X], D[Y, U] = slope[k:, :k], slope[k:, k:]
        if kinked:
            kinks.append(block.name)
        state, port = X.stop, U.stop
    return Slopes(diagram, tuple(diagram.state_labels), signals, x, s, rates, A, B, C, D, M, tuple(kinks))


def check_time(t: float) -> None:
    """Refuse a time that is none."""
    if not np.isfinite(t):
        raise ValueError(f"t = {t!r}, but sources stand still at a finite time; give seconds")


def _signals(diagram: Diagram, blocks: Sequence[Block], place: dict[str, int], x: Floats, t: float) -> Floats:
    """Return the values of all signals, block by block in the order of signal flow; open inputs stand at 0."""
    s = np.zeros(len(place))
    starts = np.cumsum([0, *(len(block.seen_states()) for block in blocks)])
    for b in _evaluation_order(diagram):
        seen = diagram.blocks[b]
        u = s[[place[label] for label in seen.input_labels]]
        y = blocks[b].output(t, x[starts[b] : starts[b + 1]], u)
        s[[place[label] for label in seen.output_labels]] = y
    return s


def _evaluation_order(diagram: Diagram) -> list[int]:
    """Return the blocks so that what acts at once comes after what it reads (sampled blocks are seen smooth)."""
    return flow_order([block.smooth() for block in diagram.blocks], diagram.driven)


def _of_block(block: Block, x: Floats, u: Floats, t: float) -> tuple[Floats, Floats, bool]:
    """Return (rates, outputs), their slopes over (states, inputs), and whether some slope has two sides."""
    k = len(x)

    def f(z: Floats) -> Floats:
        return np.concatenate([block.dynamics(t, z[:k], z[k:]), block.output(t, z[:k], z[k:])])

    z = np.concatenate([x, u])
    base = f(z)
    slope = np.zeros((len(base), len(z)))
    kinked = False
    for j in range(len(z)):
        step = max(STEP * abs(z[j]), SMALLEST)
        middle, rise, fall = _sides(f, z, j, step, base)
        finer, near_rise, near_fall = _sides(f, z, j, 0.5 * step, base)
        gap = np.abs(near_rise - near_fall)
        steeper = np.where(np.abs(near_rise) >= np.abs(near_fall), near_rise, near_fall)
        two = (gap > KINK * np.abs(steeper)) & (gap > 0.75 * np.abs(rise - fall))  # curvature would halve the gap
        kinked = kinked or bool(np.any(two))
        slope[:, j] = np.where(two, steeper, (4.0 * finer - middle) / 3.0)
    return base, slope, kinked


def _sides(
    f: Callable[[Floats], Floats], z: Floats, j: int, step: float, base: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return the slopes over ``z[j]`` across, above and below the point."""
    up, down = z.copy(), z.copy()
    up[j] += step
    down[j] -= step
    above, below = f(up), f(down)
    return (above - below) / (up[j] - down[j]), (above - base) / (up[j] - z[j]), (base - below) / (z[j] - down[j])
