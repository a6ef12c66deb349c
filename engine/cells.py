"""Run cells that are joined by links from start to end: arrays in, log rows and events out, as ``run`` for one."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.engine import layout as at
from stickslip.engine.advance import OK, PAUSED
from stickslip.engine.callback import raise_kept
from stickslip.engine.flat import Floats, Ints
from stickslip.engine.run import Outcome
from stickslip.engine.status import Status
from stickslip.engine.table import Component
from stickslip.engine.windows import CELL_LOG, advance_windows, look_around

FIRST_WINDOW = 1e-3  # share of the run
EVENT_ROOM = 64  # events of one cell in one window


@dataclass(frozen=True)
class Link:
    """A signal handed over: cell and block (number in the cell) that records it, cell and block that replays it."""

    origin: int
    recorder: int
    reader: int
    replayer: int


def run_windows(
    components: Sequence[Component],
    links: Sequence[Link],
    arrays: Sequence[tuple[Ints, Floats]],
    times: Floats,
    t_end: float,
    on_progress: Callable[[float], None] | None = None,
) -> list[Outcome]:
    """Advance prepared cells together to ``t_end`` and return what came out of each, as ``run.run`` does.

    Without success all have the status TIGHT, and are to be run as one component.
    """
    ordered = sorted(links, key=lambda link: link.origin)
    leaving = Counter(link.origin for link in ordered)
    cells = np.zeros((len(components) + 1, 4), dtype=np.int64)
    for c, (component, (I, W)) in enumerate(zip(components, arrays, strict=True)):
        cells[c + 1] = cells[c] + [len(I), len(W), len(component.columns), leaving[c]]
    table = np.array([[at.H + k.recorder * at.R, k.reader, at.H + k.replayer * at.R] for k in ordered], dtype=np.int64)
    ints, floats = np.concatenate([I for I, _ in arrays]), np.concatenate([W for _, W in arrays])
    log = np.empty((int(cells[-1, CELL_LOG]), len(times)))
    room = EVENT_ROOM + max(int(I[at.MAX_CHAIN] + 2 * I[at.N_EVENTS]) for I, _ in arrays) + 8
    own, common = np.empty((len(components), room, 4)), np.empty((2 * len(components) * room, 4))
    lines, state = np.zeros((len(ordered), 2)), np.array([FIRST_WINDOW * (t_end - float(floats[at.T])), 0.0])
    events: list[Floats] = []
    look_around(ints, floats, cells, table, lines)
    try:
        while True:
            code, written = advance_windows(ints, floats, cells, table, lines, state, own, common, times, log, t_end)
            events.append(common[:written].copy())
            raise_kept()
            status = Status.TIGHT if code not in (OK, PAUSED) else Status(code)
            if on_progress is not None and status is not Status.TIGHT:
                on_progress(float(floats[at.T]))
            if status is not Status.PAUSED:
                break
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
    outcomes = []
    for c in range(len(components)):
        (i, w, row), (i_end, w_end, row_end) = cells[c, :3], cells[c + 1, :3]
        I, W = ints[i:i_end], floats[w:w_end]
        log[row:row_end, int(I[at.ROW]) :] = np.nan
        outcomes.append(Outcome(log[row:row_end], np.zeros((0, 4)), status, float(W[at.T]), int(I[at.ROW]), I, W))
    return [replace(outcomes[0], events=np.concatenate(events)), *outcomes[1:]]
