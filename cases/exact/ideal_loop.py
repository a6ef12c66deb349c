"""The ideal loop with a sticking stem, solved exactly as a hybrid automaton.

No integrator is involved: the loop is piecewise linear, so each mode has a closed form and only the event
times need a root finder. State (y, z, x, v) = (PV, integral part of OP, stem position, stem velocity), with

    e = SP - y,   OP = K_p e + z,   dz/dt = K_p / T_i e,   dy/dt = a y + b x,

where (a, b) = (-1/tau, K/tau) for the lag K/(tau s + 1) (eq. 6.2) and (0, K/tau) for the integrator
K/(tau s) (eq. 7.4). The stem obeys M dv/dt = k (OP - x) - friction (eqs. 4.4-4.5), in two modes:

* stuck: v = 0 while |k (OP - x)| <= F_s; y, z in ``stuck_mode``;
* slip in direction s = +-1: friction = s F_c + F_v v, until v returns to 0; see ``slip_mode``.

The state is continuous over both events. Written independently of every other simulator of this project.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.cases.exact.parameters import IDEAL_HIGH, ExactLoop, ExactLoopError
from stickslip.cases.exact.slip_mode import SlipMode
from stickslip.cases.exact.stuck_mode import StuckMode

Array = NDArray[np.float64]

_EVENT_LIMIT = 100_000


@dataclass(frozen=True)
class StemEvent:
    """One mode change of the stem: time [s], kind 'slip' or 'stick', direction of the slip (+1 or -1), OP, MV."""

    t: float
    kind: str
    direction: int
    OP: float
    MV: float


@dataclass(frozen=True)
class ExactRun:
    """Exact signals at the log times, each of shape (n,), and the events in order; ``v`` in full travels per s."""

    t: Array
    SP: Array
    PV: Array
    OP: Array
    MV: Array
    v: Array
    z: Array
    e: Array
    events: tuple[StemEvent, ...]


def exact_run(loop: ExactLoop = IDEAL_HIGH) -> ExactRun:
    """Solve the loop exactly, with the signals at i * log_interval for i = 0 .. round(duration / log_interval).

    Event times are accurate to about 1e-13 relative to the length of the mode they end; the signals to about
    1e-13 (tests/cases/test_exact_precision.py measures both in 50-digit arithmetic).

    Raises ExactLoopError when two eigenvalues of the slipping loop coincide, or after 100 000 events.

    >>> run = exact_run(ExactLoop(duration=60.0))
    >>> [(round(event.t, 3), event.kind) for event in run.events]
    [(0.0, 'slip'), (0.088, 'stick'), (57.531, 'slip'), (57.6, 'stick')]
    >>> run.PV.shape
    (601,)
    """
    rows = round(loop.duration / loop.log_interval) + 1
    t_log: Array = np.arange(rows, dtype=np.float64) * loop.log_interval
    t_end = float(t_log[-1])
    signals = np.empty((4, t_log.size))
    state = np.array([loop.PV_0, loop.z_0, loop.x_0, 0.0])
    events: list[StemEvent] = []
    t, direction, logged = 0.0, 0, 0

    while logged < t_log.size:
        left = t_end - t
        mode = StuckMode(loop, state) if direction == 0 else SlipMode(loop, state, direction)
        dwell = mode.dwell(left)
        last = t_log.size if dwell is None else int(np.searchsorted(t_log, t + dwell, side="right"))
        signals[:, logged:last] = mode.at(t_log[logged:last] - t)
        logged = last
        if dwell is None:
            break
        state = mode.at(np.array([dwell]))[:, 0]
        state[3] = 0.0  # both events happen at v = 0 exactly
        t += dwell
        OP = loop.K_p * (loop.SP - state[0]) + state[1]
        if direction == 0:
            kind, direction = "slip", int(np.sign(OP - state[2]))
            shown = direction
        else:
            kind, shown, direction = "stick", direction, 0
        events.append(StemEvent(float(t), kind, shown, float(OP), float(state[2])))
        if len(events) > _EVENT_LIMIT:
            raise ExactLoopError(f"more than {_EVENT_LIMIT} events by t = {t} s; shorten the duration")

    y, z, x, v = signals
    e = loop.SP - y
    return ExactRun(
        t=t_log,
        SP=np.full_like(t_log, loop.SP),
        PV=y,
        OP=loop.K_p * e + z,
        MV=x,
        v=v,
        z=z,
        e=e,
        events=tuple(events),
    )
