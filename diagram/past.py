"""Signals still under way at the end of a run, in dead times and samples, so that a diagram can go on from there.

It goes by the names of blocks, not by their places: whatever is changed in a diagram, what still fits goes on.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.blocks.block import Block
from stickslip.diagram.wiring import WiringError
from stickslip.engine.flat import Floats
from stickslip.engine.snapshot import Snapshot

Place = tuple[str, int]  # block, number of the input
Flats = Mapping[int, tuple[int, ...]]  # block -> the flat dead times in front of it


@dataclass(frozen=True)
class UnderWay:
    """The content of the dead time of one input: length [s] and records, oldest first, as the engine keeps them."""

    theta: float
    records: Floats


@dataclass(frozen=True)
class Past:
    """The end of a run: time ``t`` [s], content of dead times, and which blocks have taken their sample.

    Part of ``run.final`` as ``Diagram.past``; ``Diagram.with_past`` gives a diagram another, or none.
    """

    t: float
    delays: Mapping[Place, UnderWay]
    sampled: frozenset[str]

    @staticmethod
    def of(blocks: Sequence[Block], flats: Flats, ends: Iterable[Snapshot]) -> "Past":
        """Collect what the components leave behind; ``flats``: the flat dead times in front of each block."""
        place, ends = _places(blocks, flats), tuple(ends)
        delays = {place[f]: UnderWay(theta, records) for end in ends for f, theta, records in end.delays()}
        sampled = frozenset(block.name for block in blocks if block.takes_samples)
        return Past(min(end.t for end in ends), delays, sampled)

    def put_back(self, blocks: Sequence[Block], flats: Flats, run: Snapshot) -> None:
        """Fill the dead times of a component that is about to start, and let new blocks take their first sample."""
        inside = {f: place for f, place in _places(blocks, flats).items() if f in run.component.params}
        run.fill_delays({f: self.delays[place].records for f, place in inside.items()})
        run.sample_first({b for b, block in enumerate(blocks) if block.name not in self.sampled})

    @property
    def records(self) -> int:
        """Length of the longest history."""
        return max((len(delay.records) for delay in self.delays.values()), default=0)

    def inside(self, name: str) -> "Past":
        """Return the past of a diagram that is nested under ``name``."""
        return Past(
            self.t,
            {(f"{name}/{block}", j): delay for (block, j), delay in self.delays.items()},
            frozenset(f"{name}/{block}" for block in self.sampled),
        )

    def without(self, *names: str) -> "Past":
        """Return the past of a diagram some of whose blocks are new in it."""
        delays = {place: delay for place, delay in self.delays.items() if place[0] not in names}
        return replace(self, delays=delays, sampled=self.sampled.difference(names))


def together(pasts: Iterable[Past]) -> Past | None:
    """Return the past of diagrams that are joined, or None if none of them has one.

    Raises ``WiringError`` if their runs ended at different times.
    """
    given = list(pasts)
    if not given:
        return None
    ends = sorted({past.t for past in given})
    if len(ends) > 1:
        raise WiringError(
            f"the diagrams go on from runs that ended at {ends[0]:g} and {ends[-1]:g} s, but one diagram has one time; "
            "let the runs end together, or start afresh with diagram.with_past(None)"
        )
    delays = {place: delay for past in given for place, delay in past.delays.items()}
    return Past(ends[0], delays, frozenset().union(*(past.sampled for past in given)))


def resumed(past: Past | None, blocks: Sequence[Block], t0: float) -> Past | None:
    """Return the past with which a run of a diagram's blocks from ``t0`` [s] goes on, None if it starts afresh.

    Raises ``ValueError`` if something under way would be lost without a word: a run that starts at another time than
    the one before ended, or a dead time that is new, or longer than the one before.
    """
    if past is None:
        return None
    dead = {block.name: block for block in blocks if block.dead_time > 0.0}
    sampled = [block.name for block in blocks if block.takes_samples and block.name in past.sampled]
    afresh = "start afresh with diagram.with_past(None)"
    if abs(t0 - past.t) > 4.0 * float(np.spacing(max(1.0, abs(t0)))):
        if kept := [*(name for name in dead if (name, 0) in past.delays), *sampled]:
            raise ValueError(
                f"t0 = {t0!r}, but the diagram goes on from a run that ended at {past.t!r} s, with signals and samples "
                f"under way in {', '.join(kept[:4])}{', ...' if len(kept) > 4 else ''}; give t0={past.t!r}, or {afresh}"
            )
        return None
    for name, block in dead.items():
        known = past.delays[name, 0].theta if (name, 0) in past.delays else 0.0
        if block.dead_time > known:
            raise ValueError(
                f"{name}: the dead time is {block.dead_time:g} s, but the run before kept {known:g} s of its input; "
                f"give at most that, or {afresh}"
            )
    return past


def _places(blocks: Sequence[Block], flats: Flats) -> dict[int, Place]:
    """Return which input of which block each flat dead time delays."""
    return {f: (blocks[b].name, j) for b, of_block in flats.items() for j, f in enumerate(of_block)}
