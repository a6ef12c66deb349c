"""Run one component from start to end: arrays in, log rows and events out."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engine import layout as at
from engine.advance import advance
from engine.cache import ensure_compiled
from engine.status import Status
from engine.sweep import refresh
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


def prepare(component: Component, settings: Settings, t0: float) -> tuple[Ints, Floats]:
    """Return fresh arrays of a component, ready to start at ``t0`` [s]."""
    ensure_compiled()
    I, W = component.I.copy(), component.W.copy()
    W[at.RTOL], W[at.ATOL], W[at.T] = settings.rtol, settings.atol, t0
    I[at.METHOD_WISH] = METHODS[settings.method]
    I[at.MAX_STEPS] = settings.max_steps
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
    log = np.full((len(component.columns), len(times)), np.nan)
    buffer = np.empty((_EVENT_BUFFER + 2 * int(I[at.N_EVENTS]), 4))
    events: list[Floats] = []
    hosts = _Hosts(component, blocks, W) if component.hosted else None
    t0 = float(W[at.T])
    for row in range(at.H, at.H + int(I[at.N_BLOCKS]) * at.R, at.R):
        if I[row + at.KIND] == at.SAMPLED:
            I[row + at.COUNT] = _samples_before(t0, W[I[row + at.OFFSET]], W[I[row + at.PERIOD]])
    stops = [t_end] if on_progress is None else list(np.linspace(t0, t_end, 101)[1:])
    status = Status.OK
    try:
        for stop in stops:
            while status is Status.OK:
                target = min(stop, hosts.next_due(W)) if hosts else stop
                last = target >= t_end and not (hosts and hosts.next_due(W) <= t_end)
                code = Status(advance(I, W, buffer, times, log, target, last))
                events.append(buffer[: I[at.EV_COUNT]].copy())
                I[at.EV_COUNT] = 0
                if code is Status.EVENTS_FULL:
                    continue
                status = code
                if hosts and status is Status.OK and target == hosts.next_due(W):
                    hosts.sample(I, W)
                    continue
                break
            if status is not Status.OK:
                break
            if on_progress is not None:
                on_progress(stop)
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
    return Outcome(log, np.concatenate(events), status, float(W[at.T]), int(I[at.ROW]), I, W)


class _Hosts:
    """The blocks of one component that run in Python, with the states of this run."""

    def __init__(self, component: Component, blocks: tuple[FlatBlock, ...], W: Floats) -> None:
        self.rows = {b: at.H + component.blocks.index(b) * at.R for b in component.hosted}
        self.blocks = blocks
        self.component = component
        self.taken = dict.fromkeys(component.hosted, 0)
        self.states = {b: blocks[b].host.init(self._p(b, W)) for b in component.hosted}
        for b in component.hosted:
            self.taken[b] = _samples_before(float(W[at.T]), self._due(b, W), self._p(b, W)[blocks[b].period_at])

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
        """Run every hosted block that is due now and ask the engine to look at this instant again."""
        now = self.next_due(W)
        W[at.T_LEFT] = np.inf
        for b, row in self.rows.items():
            if self._due(b, W) > now:
                continue
            refresh(I, W, now)
            wires = I[I[row + at.WIRES] : I[row + at.WIRES] + I[row + at.NU]]
            u = W[I[at.O_S] + wires]
            self.states[b], y = self.blocks[b].host.step(now, self.states[b], u, self._p(b, W))
            first = I[at.O_S] + I[row + at.Y]
            W[first : first + I[row + at.NY]] = y
            self.taken[b] += 1
        I[at.FRESH] = 1
