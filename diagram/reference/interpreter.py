"""A diagram at one instant, interpreted: signals, rates, events, samples and dead times in plain Python.

Used by ``integration`` only.  Every rule of a run is stated here a second time, independently of ``engine``.
"""

import bisect
import itertools
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.reference.deciding import deciding

Floats = NDArray[np.float64]
IMPULSE = 1e12  # rate that stands for a jump
NO_JUMP = 1e-11  # relative size of a jump that is rounding
GENERATIONS = 12  # how often a breakpoint is followed through dead times
NODES = 0.5 - 0.5 * np.cos(np.pi * np.arange(9) / 8.0)  # Chebyshev points of the second kind on 0 .. 1
WEIGHTS = np.array([0.5, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 0.5])


class Interpreter:
    """The moving state of one reference run; ``t`` [s] and ``x`` (n_states,) are the present."""

    def __init__(self, diagram: Diagram, t0: float) -> None:
        self.blocks = diagram.blocks
        self.order = diagram.order
        number = {signal: i for i, signal in enumerate(diagram.signals)}
        self.wires = [np.array([number[s] for s in block.input_labels], dtype=int) for block in self.blocks]
        self.places = [np.array([number[s] for s in block.output_labels], dtype=int) for block in self.blocks]
        self.s = np.zeros(len(number))
        self.checked = np.ones(len(number), dtype=bool)
        self.d = [block.d0.copy() for block in self.blocks]
        self.hosted = [
            None if block.host is None else block.host.init(block.p) for block in self.blocks
        ]  # the states of what runs in Python anyway
        starts = np.cumsum([0, *(len(block.x0) for block in self.blocks)])
        self.states = [slice(a, b) for a, b in itertools.pairwise(starts)]
        self.n_states = int(starts[-1])
        flowing = [(b, self.blocks[b].kernels) for b in self.order if not self.blocks[b].sampled]
        fixed = [block.p if block.timetable is None else None for block in self.blocks]
        self.putting_out = [
            (b, kernels.out, self.states[b], fixed[b], self.places[b], len(self.places[b]))
            for b, kernels in flowing
            if kernels.out is not None
        ]
        self.moving = [(b, k.der, self.states[b]) for b, k in flowing if k.der is not None and len(self.blocks[b].x0)]
        self.x: Floats = np.concatenate([block.x0 for block in self.blocks]) if self.blocks else np.zeros(0)
        self.t = t0
        self.t_left = math.nextafter(t0, -math.inf)  # sources are not looked at beyond
        self.taken: dict[int, int] = {}
        self.dead: dict[int, tuple[float, float]] = {}  # block -> dead time, value before the start
        for b, block in enumerate(self.blocks):
            if block.sampled:
                self.s[self.places[b]] = block.y0
                offset = block.p[block.param_index(block.offset_param)] if block.offset_param else 0.0
                self.taken[b] = max(0, math.ceil((t0 - offset) / block.period - 1e-9))
                self.checked[self.places[b]] = block.host is None
            elif block.takes_samples:
                self.taken[b] = int(np.sum(block.timetable[:, 0] < t0 - self.rounding(t0)))  # type: ignore[index]
            if block.dead_time > 0.0:
                self.dead[b] = block.dead_time, block.value_before
        self.thetas = [theta for theta, _ in self.dead.values()]
        self.pieces: list[tuple[float, float, dict[int, Floats]]] = []  # start, end, block -> inputs at the nodes
        self.leaving: dict[int, list[float]] = {b: [] for b in self.dead}  # when each piece begins to leave [s]
        self.pending: list[tuple[float, int]] = []  # breakpoints still to leave a dead time
        self.n_events = [0 if block.sampled else block.kernels.n_events for block in self.blocks]
        self.most = 20 + 10 * sum(self.n_events)  # transitions at one instant
        self.chain = 0
        self.n_fired = 0
        self.n_rates = 0
        self.events: list[tuple[float, int, float, float]] = []  # t, block, value of the mode before and after
        self.above = deciding(self.blocks, self.wires, self.places, set(self.dead))
        self._enter_breaks(t0, 0)
        self.first = True  # nothing went before the first instant, so nothing can have jumped
        self.shown = {  # block that looks at slopes -> its inputs when it was last shown a jump
            b: self.s[wires].copy()
            for b, wires in enumerate(self.wires)
            if self.n_events[b] and self.blocks[b].kernels.rates
        }
        self.moved: set[int] = set()  # of them those that were shown one at this instant

    @staticmethod
    def rounding(t: float) -> float:
        """Return the time difference [s] that is none at ``t``."""
        return 8.0 * math.ulp(max(1.0, abs(t)))

    def _p(self, b: int, t: float) -> Floats:
        """Return the parameters of a block and the row of its timetable that is in force at ``t`` [s]."""
        block = self.blocks[b]
        if block.timetable is None:
            return block.p
        t += self.rounding(t) if math.isinf(self.t_left) else 0.0  # instants that differ by rounding are one
        row = bisect.bisect_right(block.timetable[:, 0], t) - 1
        values = block.timetable[max(row, 0), 1:]
        return np.concatenate([block.p[: len(block.p) - len(values)], values])

    # --- signals, rates, event functions ------------------------------------------------------------------
    def _input(self, b: int, t: float) -> Floats:
        if b not in self.dead:
            now: Floats = self.s[self.wires[b]]
            return now
        theta, before = self.dead[b]
        k = bisect.bisect_right(self.leaving[b], t) - 1
        if k < 0:
            return np.full(len(self.wires[b]), before)
        start, end, values = self.pieces[k]
        if len(values[b]) == 1:
            return np.asarray(values[b][0])
        gap = (t - theta - start) / (end - start) - NODES
        near = np.abs(gap) < 1e-14
        if near.any():
            return np.asarray(values[b][np.argmax(near)])
        weights = WEIGHTS / gap
        return np.asarray(weights @ values[b] / weights.sum())

    def signals_at(self, t: float, x: Floats) -> Floats:
        """Compute all signals for state ``x`` at ``t`` [s]; returns ``self.s``."""
        t = min(t, self.t_left)
        s, d, of, dead = self.s, self.d, self.wires, self.dead
        for b, out, states, p, places, n in self.putting_out:
            y = np.zeros(n)
            u = self._input(b, t) if b in dead else s[of[b]]
            out(t, x[states], d[b], u, self._p(b, t) if p is None else p, y)
            s[places] = y
        return s

    def rates(self, t: float, x: Floats) -> Floats:
        """Return dx/dt (n_states,)."""
        self.n_rates += 1
        x = np.array(x, dtype=float)
        self.signals_at(t, x)
        t = min(t, self.t_left)
        rates = np.zeros(self.n_states)
        for b, der, place in self.moving:
            der(t, x[place], self.d[b], self._input(b, t), self._p(b, t), rates[place])
        return rates

    def event_values(self, t: float, x: Floats) -> Floats:
        """Return all event functions, block after block."""
        if not any(self.n_events):
            return np.zeros(0)
        slopes = self._signal_rates(t, x) if self.shown else np.zeros(len(self.signals_at(t, x)))
        t = min(t, self.t_left)
        values = []
        for b, n in enumerate(self.n_events):
            if n:
                values.append(self._zc(b, t, x, self._input(b, t), slopes[self.wires[b]]))
        return np.concatenate(values)

    def _signal_rates(self, t: float, x: Floats) -> Floats:
        """Return the rates of change of all signals at ``t`` [s]; leaves the signals of that time behind."""
        f = self.rates(t, x)
        now = self.s.copy()
        shift = 1e-8 * max(1.0, abs(t))
        shift = shift if t + shift <= self.t_left else -shift
        slopes = np.asarray((self.signals_at(t + shift, x + shift * f) - now) / shift)
        self.s[:] = now
        return slopes

    def _zc(self, b: int, t: float, x: Floats, u: Floats, slopes: Floats) -> Floats:
        block = self.blocks[b]
        g = np.zeros(self.n_events[b])
        if block.kernels.zc is not None:
            block.kernels.zc(t, x[self.states[b]], self.d[b], np.concatenate([u, slopes]), block.p, g)
        return g

    # --- instants -----------------------------------------------------------------------------------------
    def settle(self) -> bool:
        """Do all that happens at the present instant; return False if transitions never end."""
        self.t_left = math.inf
        for b in self.taken:
            if not self.blocks[b].kernels.feeds and self.blocks[b].host is None and self._is_due(b):
                keep = self.d[b].copy()  # it puts out what it knows already
                self._step(b)
                self.d[b] = keep
        done = self._calm()
        if self.first:
            self._keep_inputs()
        done = done and self._transitions()
        self.first = False
        return done

    def _calm(self) -> bool:
        """Let blocks act one by one, of all that are restless first that which no other restless one is above."""
        while self.chain <= self.most:
            self.signals_at(self.t, self.x)
            restless = [b for b in self.order if self._is_restless(b)]
            if not restless:
                return True
            first = [b for b in restless if all(self.above[b, a] for a in restless if self.above[a, b])]
            b = next((b for b in first if self.blocks[b].kernels.feeds), first[0])  # the others are in a ring with it
            if self._has_jumped(b):
                self._show_jump(b)
            elif (event := self._event_now(b)) is not None:
                self._fire(b, event, self._input(b, self.t).copy(), np.zeros(len(self.wires[b])))
            else:
                self._step(b)
                self.taken[b] += 1
        return False

    def _is_restless(self, b: int) -> bool:
        """Return whether a block would act, if what it reads stayed: see a jump, change its mode, take a sample."""
        return self._has_jumped(b) or self._event_now(b) is not None or (b in self.taken and self._is_due(b))

    def _event_now(self, b: int) -> int | None:
        """Return the event of a block that is positive at its inputs, whose slopes count for nothing here."""
        if not self.n_events[b] or (b in self.shown and not (self.first or b in self.moved)):
            return None
        u = self._input(b, self.t)
        positive = np.flatnonzero(self._zc(b, self.t, self.x, u, np.zeros(len(u))) > 0.0)
        return int(positive[0]) if positive.size else None

    def _is_due(self, b: int) -> bool:
        return self._due(b) <= self.t + self.rounding(self.t)

    def _transitions(self) -> bool:
        """Carry out what slopes demand, and what follows in rings."""
        while self.chain <= self.most:
            self.signals_at(self.t, self.x)
            fired = self.n_fired
            for b in [b for b in self.shown if self._has_jumped(b)]:
                self._show_jump(b)
            if self.n_fired > fired:
                continue
            if not self._fire_positive():
                self.signals_at(self.t, self.x)
                self.moved.clear()
                return True
        return False

    def arrive(self, t: float, x: Floats, fired: bool) -> None:
        """Move to the end of a stretch; fire what is positive there, seen from the left."""
        if t - self.t > 1e-12 * max(1.0, abs(t)):
            self.chain = 0
        self.t, self.x = t, np.array(x, dtype=float)
        self.signals_at(t, self.x)
        self._keep_inputs()
        if fired:
            self._fire_positive()
            self._enter_breaks(t, 0)

    def _fire_positive(self) -> bool:
        values = self.event_values(self.t, self.x)
        slopes = self._signal_rates(self.t, self.x) if self.shown else np.zeros(len(self.s))
        inputs = [self._input(b, min(self.t, self.t_left)).copy() for b in range(len(self.blocks))]
        fired, k = False, 0
        for b, n in enumerate(self.n_events):
            positive = np.flatnonzero(values[k : k + n] > 0.0)
            k += n
            if positive.size:
                self._fire(b, int(positive[0]), inputs[b], slopes[self.wires[b]])
                fired = True
        return fired

    def _keep_inputs(self) -> None:
        """Keep what the blocks that look at slopes read, to know a jump by."""
        for b in self.shown:
            self.shown[b] = self.s[self.wires[b]].copy()

    def _has_jumped(self, b: int) -> bool:
        return b in self.shown and not self.first and bool(self._jump(b).any())

    def _jump(self, b: int) -> Floats:
        now = self.s[self.wires[b]]
        jump = np.asarray(now - self.shown[b])
        jump[np.abs(jump) <= NO_JUMP * (1.0 + np.abs(now))] = 0.0
        return jump

    def _show_jump(self, b: int) -> None:
        """Let a block react to a jump of its inputs: an impulse at their old values."""
        u, impulse = self.shown[b], IMPULSE * self._jump(b)
        self.shown[b] = self.s[self.wires[b]].copy()
        self.moved.add(b)
        positive = np.flatnonzero(self._zc(b, self.t, self.x, u, impulse) > 0.0)
        if positive.size:
            self._fire(b, int(positive[0]), u, impulse)

    def _fire(self, b: int, event: int, u: Floats, slopes: Floats) -> None:
        block = self.blocks[b]
        before = block.modes and float(self.d[b][0])
        part = self.x[self.states[b]].copy()
        if block.kernels.jump is not None:
            which = np.zeros(max(1, self.n_events[b]))
            which[0] = event
            block.kernels.jump(self.t, part, self.d[b], np.concatenate([u, slopes]), block.p, which)
        self.x[self.states[b]] = part
        self.n_fired += 1
        self.chain += 1
        if block.modes and self.d[b][0] != before:
            self.events.append((self.t, b, float(before), float(self.d[b][0])))  # type: ignore[arg-type]

    def _due(self, b: int) -> float:
        block = self.blocks[b]
        if block.timetable is not None:
            return float(block.timetable[self.taken[b], 0]) if self.taken[b] < len(block.timetable) else math.inf
        offset = block.p[block.param_index(block.offset_param)] if block.offset_param else 0.0
        return float(offset + self.taken[b] * block.period)

    def _step(self, b: int) -> None:
        block, u = self.blocks[b], self._input(b, self.t)
        y = np.zeros(len(self.places[b]))
        if block.host is not None:
            self.hosted[b], y = block.host.step(self.t, self.hosted[b], u, block.p)  # type: ignore[assignment]
        elif block.kernels.step is not None:
            block.kernels.step(self.t, block.x0, self.d[b], u, self._p(b, self.t), y)
        self.s[self.places[b]] = y

    # --- what lies ahead and behind -----------------------------------------------------------------------
    def next_stop(self, t_end: float) -> tuple[float, float]:
        """Return (next instant not to be stepped over, largest step [s]); sets the left limit."""
        marks = [(t_end, 0)] + [(self._due(b), 0) for b in self.taken]
        for block in self.blocks:
            if block.timetable is not None:
                ahead = block.timetable[:, 0] > self.t + self.rounding(self.t)
                marks += [(float(at), 0) for at in block.timetable[ahead, 0][:1]]
        largest = math.inf
        for b, block in enumerate(self.blocks):
            if block.kernels.next_time is not None and not block.sampled:
                out = np.array([math.inf, math.inf])
                block.kernels.next_time(self.t, block.x0, self.d[b], self._input(b, self.t), block.p, out)
                marks.append((float(out[0]) if out[0] > self.t else math.inf, 0))
                largest = min(largest, float(out[1]))
        self.pending = [(t, generation) for t, generation in self.pending if t > self.t]
        marks += self.pending
        first = min(t for t, _ in marks)
        together = [mark for mark in marks if mark[0] <= first + self.rounding(first)]
        stop = max(t for t, _ in together)
        self.t_left = math.nextafter(first, -math.inf)
        self._enter_breaks(stop, min(generation for _, generation in together))
        return stop, largest

    def _enter_breaks(self, t: float, generation: int) -> None:
        """Note when what happens at ``t`` will leave the dead times."""
        if generation < GENERATIONS:
            self.pending += [(t + theta, generation + 1) for theta, _ in self.dead.values()]

    def remember(self, t: float, t_new: float, state_at: Callable[[float], Floats]) -> None:
        """Keep what entered the dead times from ``t`` to ``t_new``."""
        if not self.dead or t_new <= t:
            return
        values = np.array([self.signals_at(t + part * (t_new - t), state_at(t + part * (t_new - t))).copy()
                           for part in NODES])  # fmt: skip
        entered = {}
        for b, (theta, _) in self.dead.items():
            read = values[:, self.wires[b]]
            entered[b] = read if np.ptp(read, axis=0).any() else read[:1]  # what stands still is not rounded
            self.leaving[b].append(t + theta)
        self.pieces.append((t, t_new, entered))
