"""Branches of a replay: at each sample that does not fit, other modes of one block are tried from the sample before.

A stem that sticks leaves no trace in a log without MV: a model pinned to it may have the stem stuck where it slides,
and is wrong until the next slip.  The next sample shows it, because a pin has to move further than noise or rounding
lets it (``changes``, ``offsets``); then each mode is tried over that one interval, and the best is kept if it explains
the sample much better.  Nothing but a mode is ever changed: a stem that slides stands where OP holds it, a stem that
sticks stays where it is, so a model without a gap to its log is left alone.

The default share, 0.2, was chosen on sixteen replays of a flow loop with noise whose stem started at a wrong place.  It
stood wrong in 33 % of the samples without branches and in 22 % with them (a share of 0.5, which keeps more wrong modes
that explain a little, gave 25 %); in five of the sixteen branches made it worse, by 1 to 7 %.  What shows only after
two samples or more is not undone.  ``patience`` saves time where no mode helps, and finds a lost stem later: of four
starts at wrong places two are found after 322 instead of 185 samples with 2 or 4, one never sooner than a plain replay
with 8.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.arguments import by_name
from stickslip.blocks.block import Block
from stickslip.blocks.declared import FREE_MODE
from stickslip.blocks.ports import nearest, number
from stickslip.diagram.wiring import WiringError
from stickslip.engine.branching import Branching, Kept

if TYPE_CHECKING:
    from stickslip.diagram.wired import Wired

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Branches:
    """When to try other modes of ``block``: ``modes`` by name, all but "ideal" unless named.

    ``changes``: pinned signal -> by how much its offset may change from one sample to the next before others are tried
    [unit of the signal]: behind a controller, five times its one-step error without a gap.  ``offsets``: pinned signal
    -> how large its offset may be, for a signal that knows no error of its own, as a stem's position.  ``share``: a
    mode is kept if the worst of them falls below this share of what it was.  ``patience``: after samples at which no
    mode has helped, 1, 2, 4, ... and at most so many go by until modes are tried again; a run whose sizes are wrong is
    wrong at every sample, and costs six times as much with every one tried.  ``back``: how many samples further back a
    mode may have been wrong, where a lag or a dead time lets it show late: two for a lag of 2 s and a sample a second.
    """

    block: str
    modes: tuple[str, ...] = ()
    changes: Mapping[str, float] = field(default_factory=dict)
    offsets: Mapping[str, float] = field(default_factory=dict)
    share: float = 0.2
    patience: int = 1
    back: int = 0


@dataclass(frozen=True)
class Taken:
    """A branch that was kept: from the time ``t`` [s] on, up to the next sample, ``block`` was put into ``mode``.

    ``held``: whether it was kept in it until then.  ``before``, ``after``: the worst pin, in shares of its limit, on
    the run's own branch and on this one.
    """

    t: float
    block: str
    mode: str
    held: bool
    before: float
    after: float


def branching(diagram: "Wired", branches: Branches, t0: float, t_end: float) -> Branching:
    """Return what the engine has to know of the branches of a run from ``t0`` to ``t_end`` [s].

    Raises ``WiringError`` for an unknown block, mode or pin, and ``ValueError`` for a limit that is not positive.
    """
    b = diagram.block_index(branches.block)
    block = diagram.blocks[b]
    if not (isinstance(branches.back, int) and branches.back >= 0):
        raise ValueError(f"back = {branches.back!r}, but it is a number of samples; give 0 or more")
    known = [mode for mode in block.modes if mode != FREE_MODE]
    if not known or block.sampled:
        raise WiringError(f"block '{block.name}' has no modes to try; name a continuous valve with friction")
    for mode in branches.modes:
        if mode not in block.modes:
            raise WiringError(f"block '{block.name}' has no mode '{mode}'; {nearest(mode, list(block.modes))}")
    watched = {**branches.changes, **branches.offsets}
    if not watched:
        raise ValueError("no pin tells which branch is right; give changes={'OP': ...} or offsets={'MV': ...}")
    by_name("Branches", "changes", branches.changes, {"OP": 1e-4})
    by_name("Branches", "offsets", branches.offsets, {"MV": 1e-3})
    pins = [_pin(diagram, signal) for signal in watched]
    limits = [number("Branches", f"limit of {signal}", limit) for signal, limit in watched.items()]
    if not (all(0.0 < limit < np.inf for limit in limits) and 0.0 < branches.share < 1.0):
        raise ValueError(
            f"limits {dict(watched)!r}, share = {branches.share!r}, but limits are positive and a share lies between "
            "0 and 1; give what a pin moves without a gap, and e.g. 0.5"
        )
    if not (isinstance(branches.patience, int) and branches.patience >= 1):
        raise ValueError(f"patience = {branches.patience!r}, but it is a number of samples; give 1 or more")
    return Branching(
        block=b,
        modes=tuple(block.modes[mode] for mode in branches.modes or known),
        stops=_stops([diagram.blocks[pin] for pin in pins], t0, t_end),
        pins=tuple(pins),
        limits=tuple(limits),
        change=tuple(signal in branches.changes for signal in watched),
        share=float(branches.share),
        patience=branches.patience,
        back=branches.back,
    )


def _pin(diagram: "Wired", signal: str) -> int:
    """Return the number of the pin behind the driver of a signal."""
    for b, block in enumerate(diagram.blocks):
        if block.timetable is not None and f"{signal}:offset" in block.output_labels:
            return b
    pins = [s.removesuffix(":offset") for s in diagram.signals if s.endswith(":offset")]
    raise WiringError(f"'{signal}' is not pinned; {nearest(signal, pins)}; diagram.pinned(log) makes pins")


def times_of_rows(pin: Block) -> Floats:
    """Return the times [s] of the rows that a pin holds a signal to; where an offset only ends there is no row."""
    assert pin.timetable is not None
    times: Floats = pin.timetable[np.isfinite(pin.timetable[:, 1]), 0]
    return times


def _stops(pins: list[Block], t0: float, t_end: float) -> Floats:
    """Return the times of all samples of the pins, from the start to the end of the run, both included."""
    listed = np.concatenate([times_of_rows(pin) for pin in pins])
    return np.unique(np.concatenate([[t0], listed[(listed > t0) & (listed < t_end)], [t_end]]))


def taken(diagram: "Wired", given: Branching, kept: Kept) -> tuple[Taken, ...]:
    """Return the branches that were kept, in order of time."""
    block = diagram.blocks[given.block]
    names = {value: name for name, value in block.modes.items()}
    return tuple(
        Taken(
            float(given.stops[k - 1]),
            block.name,
            names[float(kept.mode[k])],
            bool(kept.held[k]),
            *map(float, kept.measures[k]),
        )
        for k in np.flatnonzero(np.isfinite(kept.mode))
    )
