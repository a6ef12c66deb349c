"""A process compiled as an observer: its own equations from row to row, set right by a filter's gain at each.

Whatever drives it becomes an input that is written row by row; a load that nobody measures is a state of its own, added
to the signal that it moves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.sources import Ramp
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.variants import variants_of
from stickslip.engine.observing import observed, slopes_at
from stickslip.engine.run import Settings, prepare
from stickslip.engine.snapshot import Snapshot
from stickslip.engine.table import Component
from stickslip.logs.arrays import Values

LEAST = 1e-3  # size of a state that starts at less
LOST = 1e3  # sizes at the start beyond which a process has run away
AGAIN, FEW = 100, 10  # rows after which slopes are taken again; where they change, and where a process runs away
SINGLE = 1 / 9  # of the rows, at most, are followed one by one: a transient, not a model that is far from the log
GONE = 0.05  # share of the rows from which a process has run away, after which it is followed no further
SAME = 0.5  # share by which the slopes of a state's rate may change meanwhile
PLACED = 3  # steps to a state that shows a row
TIED = "observer:tied"


@dataclass(frozen=True, eq=False)
class Observer:
    """A process between two rows: ``diagram`` with every input closed, its ``component``; ``read`` which inputs it
    reads, ``into``, ``loaded``, ``shown`` the places of these, of loads and of what is measured; ``states`` by name,
    loads behind them, and their ``start``; ``decay`` of the loads [1/s].
    """

    diagram: Diagram
    component: Component
    read: NDArray[np.int64]
    into: NDArray[np.int64]
    loaded: NDArray[np.int64]
    shown: NDArray[np.int64]
    states: tuple[str, ...]
    start: Values
    decay: Values

    def residuals(
        self, params: Mapping[str, ArrayLike], u: Values, y: Values, K: Values, which: NDArray[np.int64],
        start: Mapping[str, float], back: Mapping[str, Values], dt: float,
    ) -> Values:  # fmt: skip
        """Return what each row shows beyond its prediction, (runs, rows, outputs); NaN from where a run fails.

        ``params`` block.name -> one value a run; ``u`` (runs, 3, rows, inputs) inputs as ``driven`` gives them;
        ``y`` (runs, rows, outputs); ``K`` (kinds, states, outputs), ``which`` (rows,) of them; ``start`` state ->
        value; ``back`` state -> how far it moves for each output to move by one, (outputs,); ``dt`` [s] between rows.
        """
        out = np.full(y.shape, np.nan)
        if self.diagram.plan().delays:  # what a dead time holds is not in the states
            return out
        given = {key: np.broadcast_to(np.asarray(v, dtype=float), len(u)) for key, v in params.items()}
        many = variants_of(self.diagram, given, None, None, np.zeros(len(u)))
        places, columns = many.places(self.diagram.plan(), self.component)
        first = np.array([start.get(name, value) for name, value in zip(self.states, self.start, strict=True)])
        M = np.array([back.get(name, np.zeros(y.shape[2])) for name in self.states])
        I, W = prepare(self.component, Settings(), 0.0)
        now = Snapshot(self.component, I, W)
        self.diagram.plan().fill(now, self.diagram.blocks)
        for k in range(len(u)):
            now.put(places, many.table[k, columns])
            out[k] = self._one(I, W, u[k][..., self.read], y[k], K, which, first.copy(), M, dt)
        return out

    def _one(
        self, I: NDArray[np.int64], W: Values, u: Values, y: Values, K: Values, which: NDArray[np.int64], z: Values,
        M: Values, dt: float,
    ) -> Values:  # fmt: skip
        """Return what one run leaves, from a state near ``z`` that shows the first row."""
        e, start, far = np.full(y.shape, np.nan), z.copy(), np.maximum(np.abs(z), 1.0)
        here, off = np.ascontiguousarray(u[0]), np.concatenate([u[2, 1:], np.zeros((1, u.shape[2]))])
        begins, ends = here + 2.0 * off, np.concatenate([u[1, 1:], u[0, -1:]])  # what is fast feels the end alone

        none = np.zeros((len(z), len(z)))
        single = gone = 0

        def placed(k: int) -> None:
            """Move the state to where it shows a row, as little as that takes."""
            for _ in range(PLACED):
                seen = z.copy()
                row = slice(k, k + 1)
                off = observed(
                    I, W, self.into, self.loaded, self.shown, here[row], begins[row], ends[row], y[row], K, which[row],
                    self.decay, none, none, none, seen,
                )[0]  # fmt: skip
                if not np.isfinite(off[np.isfinite(y[k])]).all():
                    return
                z[:] += M @ np.nan_to_num(off)

        seen_at, seen_z, seen_J = -1, z, none

        def slopes(k: int) -> Values:
            """Return the slopes of the rates where the process is at a row."""
            nonlocal seen_at, seen_z, seen_J
            if k != seen_at or not np.array_equal(z, seen_z):
                size = np.maximum(np.abs(z), LEAST)
                seen_J = slopes_at(I, W, self.into, self.loaded, here[k], self.decay, z, size)
                seen_at, seen_z = k, z.copy()
            return seen_J

        def went(part: slice) -> bool:
            """Write what some rows leave; return whether the process kept near its path and its slopes."""
            J, size = slopes(part.start), np.maximum(np.abs(z), LEAST)
            if not np.isfinite(J).all():
                return False
            with np.errstate(over="ignore", invalid="ignore"):
                P_1, P_2 = (dt * size[:, None] * phi / size for phi in phis(dt * J * size / size[:, None]))
                e[part] = observed(
                    I, W, self.into, self.loaded, self.shown, here[part], begins[part], ends[part], y[part], K,
                    which[part], self.decay, J, P_1, P_2, z,
                )  # fmt: skip
            if lost():
                return False
            other = (slopes(min(part.stop, len(y) - 1)) - J) * size
            return bool((np.abs(other).sum(axis=1) <= SAME * np.abs(J * size).sum(axis=1)).all())

        def lost() -> bool:
            """Return whether the process has run away."""
            return not (np.abs(z) < LOST * far).all()

        def follow(part: slice, steps: Sequence[int]) -> None:
            """Write what some rows leave, in parts so short that the slopes hold in each."""
            nonlocal single, gone
            before = z.copy()
            if gone > GONE * len(y) or went(part):
                return
            if steps and single < SINGLE * len(y):
                single += part.stop - part.start if steps[0] == 1 else 0
                z[:] = before
                for shorter in parted(part.start, part.stop, steps[0]):
                    follow(shorter, steps[1:])
            elif lost():
                e[part], z[:] = np.nan, start
                gone += part.stop - part.start
                placed(min(part.stop, len(y) - 1))

        placed(0)
        for part in parted(0, len(y), AGAIN):
            follow(part, (FEW, 1))
        return e


def parted(first: int, behind: int, rows: int) -> list[slice]:
    """Return slices of so many rows.

    >>> parted(0, 5, 2)
    [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    return [slice(k, min(k + rows, behind)) for k in range(first, behind, rows)]


def phis(A: Values) -> tuple[Values, Values]:
    """Return phi_1(A) = (e^A - 1)/A and phi_2(A) = (e^A - 1 - A)/A^2, by their series for A/2^s and doubling.

    >>> one, two = phis(np.array([[-1000.0]]))
    >>> round(float(one[0, 0]), 9), round(float(two[0, 0]), 9)
    (0.001, 0.000999)
    """
    n = len(A)
    s = max(0, int(np.ceil(np.log2(max(float(np.abs(A).sum(axis=1).max()), 1e-300)))) + 3)
    Z = A / 2.0**s
    unit = np.eye(n)
    one, two = unit, 0.5 * unit
    term = unit
    for k in range(1, 10):
        term = term @ Z / k
        one = one + term / (k + 1)
        two = two + term / ((k + 1) * (k + 2))
    whole = unit + Z @ one
    for _ in range(s):
        two = 0.25 * (one @ one + 2.0 * two)
        one = 0.5 * (one + whole @ one)
        whole = whole @ whole
    return one, two


def observer(piece: Diagram, given: Sequence[str], measured: Sequence[str], loads: Mapping[str, float]) -> Observer:
    """Return the observer of a process; ``given`` its inputs, ``loads`` signal -> correlation time [s]."""
    blocks = [
        block.relabelled(
            block.name,
            list(block.input_labels),
            [_alone(s) if s in loads else s for s in map(str, block.output_labels)],
        )
        for block in piece.blocks
    ]
    sums = [Sum(s, {_alone(s): 1.0, _load(s): 1.0}, name=f"{s}:observed") for s in loads]
    tie = Sum(TIED, dict.fromkeys(measured, 0.0), name=TIED)  # one component of all that is measured, in any units
    sources = [Ramp(s, 0.0, name=f"{s}:written") for s in (*given, *map(_load, loads))]
    closed = wire([*sources, *blocks, *sums, tie], outputs=[TIED])
    place = {s: i for i, s in enumerate(closed.signals)}
    plan = closed.plan()
    component = next(one for one in plan.components if closed.block_index(TIED) in one.blocks)
    order = sorted(
        (component.states[b], b) for b in component.blocks if b < len(closed.blocks) and len(closed.blocks[b].x0)
    )
    inside = [closed.blocks[b] for _, b in order]
    read = [j for j, s in enumerate(given) if closed.block_index(f"{s}:written") in component.params]
    return Observer(
        closed,
        component,
        np.array(read, dtype=np.int64),
        np.array([_written(closed, component, given[j]) for j in read], dtype=np.int64),
        np.array([_written(closed, component, _load(s)) for s in loads], dtype=np.int64),
        np.array([component.signals[place[s]] for s in measured], dtype=np.int64),
        (*(f"{block.name}[{name}]" for block in inside for name in block.state_names), *map(load_state, loads)),
        np.concatenate([*(block.x0 for block in inside), np.zeros(len(loads))]),
        np.array([1.0 / time for time in loads.values()]),
    )


def load_state(signal: str) -> str:
    """Return the name of the state that a load is."""
    return f"{signal}[load]"


def _written(closed: Diagram, component: Component, signal: str) -> int:
    """Return where the value of a signal that is written stands."""
    b = closed.block_index(f"{signal}:written")
    return component.params[b] + closed.blocks[b].param_index("before")


def _alone(signal: str) -> str:
    return f"{signal}:alone"


def _load(signal: str) -> str:
    return f"{signal}:observed:load"  # no name that a change of a diagram gives to a signal
