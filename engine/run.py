"""Run one component from start to end: arrays in, log rows and events out."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from stickslip.engine import layout as at
from stickslip.engine.cache import engine
from stickslip.engine.callback import raise_kept
from stickslip.engine.entry import advance_to
from stickslip.engine.flat import FlatBlock, Floats, Ints
from stickslip.engine.hosted import Hosts
from stickslip.engine.status import Status
from stickslip.engine.table import Component

METHODS = {"auto": 0, "explicit": 1, "stiff": 2}
EVENT_BUFFER = 1024  # events
_PAUSE = 5000  # steps after which the run comes back to Python


@dataclass(frozen=True)
class Settings:
    """How to integrate: relative and absolute tolerance, method ("auto", "explicit", "stiff"), step budget.

    ``max_step`` [s]: None bounds the steps only where functions of the time need it (``stickslip.engine.probing``).
    """

    rtol: float = 1e-6
    atol: float = 1e-9
    method: str = "auto"
    max_steps: int = 20_000_000
    max_step: float | None = None


@dataclass(frozen=True)
class Outcome:
    """The result of one component: log rows (signals x times), events (t, block, from, to), status, end."""

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
    I, W = component.I.copy(), component.W.copy()
    I[at.ENGINE] = engine()
    W[at.RTOL], W[at.ATOL], W[at.T] = settings.rtol, settings.atol, t0
    I[at.METHOD_WISH] = METHODS[settings.method]
    I[at.MAX_STEPS] = settings.max_steps
    W[at.SEEN] = seen
    W[at.LONGEST] = np.inf if settings.max_step is None else settings.max_step
    return I, W


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

    Every few thousand steps the run comes back to Python, tells ``on_progress`` the time reached, and can be
    interrupted, by Ctrl-C or by a ``KeyboardInterrupt`` from ``on_progress``; what is simulated so far is then kept.
    """
    log = np.empty((len(component.columns), len(times)))
    buffer = np.empty((EVENT_BUFFER + 2 * int(I[at.MAX_CHAIN] + I[at.N_EVENTS]), 4))
    events: list[Floats] = []
    hosts = Hosts(component, blocks, W) if component.hosted else None
    try:
        while True:
            target = min(t_end, hosts.next_due(W)) if hosts else t_end
            hosted = hosts is not None and target == hosts.next_due(W)
            I[at.HOLD] = hosted
            I[at.PAUSE_AT] = I[at.STEPS] + _PAUSE
            status = Status(advance_to(I, W, buffer, times, log, target, not hosted))
            events.append(buffer[: I[at.EV_COUNT]].copy())
            I[at.EV_COUNT] = 0
            raise_kept()
            if on_progress is not None and (status is Status.PAUSED or (status is Status.OK and target >= t_end)):
                on_progress(float(W[at.T]))
            if hosts is not None and hosted and status is Status.OK:
                hosts.sample(I, W, buffer)
            elif status is not Status.PAUSED:
                break
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
    log[:, int(I[at.ROW]) :] = np.nan
    return Outcome(log, np.concatenate(events), status, float(W[at.T]), int(I[at.ROW]), I, W)
