"""Run one component from start to end: arrays in, log rows and events out."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engine import layout as at
from engine.advance import advance
from engine.cache import ensure_compiled
from engine.events import open_instant, take_sample
from engine.status import Status
from engine.sweep import refresh, resolution
from engine.table import Component, FlatBlock, Floats, Ints

METHODS = {"auto": 0, "explicit": 1, "stiff": 2}
_EVENT_BUFFER = 1024


@dataclass(frozen=True)
class Settings:
    """How to integrate: relative and absolute tolerance, method ("auto", "explicit", "stiff"), step budget."""

    rtol: float = 1e-6
    atol: float = 1e-9
    method: str = "auto"
    max_steps: int = 20_000_000


@dataclass(frozen=True)
class Outcome:
    """What came out of one component: log rows (signals x times), events (t, block, from, to), status, end."""

    log: Floats
    events: Floats
    status: Status
    t: float
    rows: int
    I: Ints
    W: Floats


def prepare(component: Component, settings: Settings, t0: float, seen: float = -np.inf) -> tuple[Ints, Floats]:
    """Return fresh arrays of a component, ready to start at ``t0`` [s].

    ``seen``: samples up to this time [s] have been taken before, by the run that this one continues.
    """
    ensure_compiled()
    I, W = component.I.copy(), component.W.copy()
    W[at.RTOL], W[at.ATOL], W[at.T] = settings.rtol, settings.atol, t0
    I[at.METHOD_WISH] = METHODS[settings.method]
    I[at.MAX_STEPS] = settings.max_steps
    W[at.SEEN] = seen
    return I, W


def _samples_before(t0: float, offset: float, period: float) -> int:
    """Return how many sampling instants lie before ``t0``."""
    return max(0, int(np.ceil((t0 - offset) / period - 1e-9)))


def run(
    component: Component,
    blocks: tuple[FlatBlock, ...],
    I: Ints,
    W: Floats,
    times: Floats,
    t_end: float,
    on_progress: Callable[[float], None] | None = None,
) -> Outcome:
    """Advance a prepared component to ``t_end`` and return its log at ``times``, its events and its status.

    With ``on_progress`` the run comes back to Python every hundredth of its span, so that it can be watched
    and interrupted (what is simulated so far is then kept).
    """
    log = np.empty((len(component.columns), len(times)))
    buffer = np.empty((_EVENT_BUFFER + 2 * int(I[at.MAX_CHAIN] + I[at.N_EVENTS]), 4))
    events: list[Floats] = []
    hosts = _Hosts(component, blocks, W) if component.hosted else None
    t0 = float(W[at.T])
    stops = [t_end] if on_progress is None else list(np.linspace(t0, t_end, 101)[1:])
    status = Status.OK
    try:
        for stop in stops:
            while status is Status.OK:
                target = min(stop, hosts.next_due(W)) if hosts else stop
                hosted = hosts is not None and target == hosts.next_due(W)
                I[at.HOLD] = hosted
                last = target >= t_end and not hosted
                code = Status(advance(I, W, buffer, times, log, target, last))
                events.append(buffer[: I[at.EV_COUNT]].copy())
                I[at.EV_COUNT] = 0
                if code is Status.EVENTS_FULL:
                    continue
                status = code
                if hosts is not None and hosted and status is Status.OK:
                    hosts.sample(I, W)
                    continue
                break
            if status is not Status.OK:
                break
            if on_progress is not None:
                on_progress(stop)
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
    log[:, int(I[at.ROW]) :] = np.nan
    return Outcome(log, np.concatenate(events), status, float(W[at.T]), int(I[at.ROW]), I, W)


class _Hosts:
    """The blocks of one component that run in Python, with the states of this run."""

    def __init__(self, component: Component, blocks: tuple[FlatBlock, ...], W: Floats) -> None:
        self.rows = {b: at.H + component.blocks.index(b) * at.R for b in component.hosted}
        self.blocks = blocks
        self.component = component
        self.taken = dict.fromkeys(component.hosted, 0)
        for b in component.hosted:
            self.taken[b] = _samples_before(float(W[at.T]), self._due(b, W), self._p(b, W)[blocks[b].period_at])
            if self._due(b, W) <= W[at.SEEN] + resolution(W[at.T]):
                self.taken[b] += 1
        self.states = {b: blocks[b].host.init(self._p(b, W)) for b in component.hosted}

    def _p(self, b: int, W: Floats) -> Floats:
        start = self.component.params[b]
        return W[start : start + len(self.blocks[b].p)]

    def _due(self, b: int, W: Floats) -> float:
        block, p = self.blocks[b], self._p(b, W)
        offset = p[block.offset_at] if block.offset_at >= 0 else 0.0
        return float(offset + self.taken[b] * p[block.period_at])

    def next_due(self, W: Floats) -> float:
        return min(self._due(b, W) for b in self.rows)

    def sample(self, I: Ints, W: Floats) -> None:
        """Take all samples of the present instant in flow order, compiled and hosted ones alike."""
        now = self.next_due(W)
        open_instant(I, W)
        hosted = {row: b for b, row in self.rows.items()}
        for row in range(at.H, at.H + at.R * int(I[at.N_BLOCKS]), at.R):
            if row not in hosted:
                take_sample(I, W, row)
                continue
            b = hosted[row]
            if self._due(b, W) > now + resolution(now):
                continue
            refresh(I, W, now)
            wires = I[I[row + at.WIRES] : I[row + at.WIRES] + I[row + at.NU]]
            u = W[I[at.O_S] + wires]
            self.states[b], y = self.blocks[b].host.step(now, self.states[b], u, self._p(b, W))
            first = I[at.O_S] + I[row + at.Y]
            W[first : first + I[row + at.NY]] = y
            self.taken[b] += 1
        I[at.FRESH] = 2
