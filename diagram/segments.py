"""Take a diagram apart at its logged signals: the pieces that a log tells apart.

Two blocks are in one segment if a signal that is not logged goes from one to the other, or to a third that is in it.
What happens between two blocks of a segment no log of these signals can tell.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic

from stickslip.blocks.arguments import texts
from stickslip.diagram.changes import listed, part, rebuilt
from stickslip.diagram.cuts import check_known, cut
from stickslip.diagram.wired import D, Wired


@dataclass(frozen=True, repr=False)
class Segment(Generic[D]):
    """A maximal piece between logged signals.

    ``blocks`` the names of its blocks; ``reads`` the logged signals and open inputs that come from outside;
    ``drives`` the logged signals that it drives.
    ``diagram`` the piece alone: open inputs ``reads``, outputs ``drives`` in this order (all signals if it drives no
    logged one).  A logged signal that it both drives and reads is cut there: the output bears its block's name.
    """

    blocks: tuple[str, ...]
    reads: tuple[str, ...]
    drives: tuple[str, ...]
    diagram: D

    def __repr__(self) -> str:
        reads, drives = (", ".join(names) or "nothing" for names in (self.reads, self.drives))
        return f"<Segment {', '.join(self.blocks)}: reads {reads}, drives {drives}>"


def segments(diagram: D, logged: str | Iterable[str]) -> tuple[Segment[D], ...]:
    """Return the segments between logged signals, in the order of the blocks: see ``Diagram.segments``."""
    known = texts(diagram.name, "logged", logged if isinstance(logged, str) else listed(logged))
    for signal in known:
        check_known(diagram, signal)
    return tuple(_segment(diagram, blocks, known, k) for k, blocks in enumerate(_joined(diagram, known), start=1))


def _joined(diagram: Wired, logged: Iterable[str]) -> list[tuple[str, ...]]:
    """Return the names of blocks that signals other than the logged ones join, in the order of the diagram."""
    neighbours: dict[int, set[int]] = {b: set() for b in range(len(diagram.blocks))}
    for b, block in enumerate(diagram.blocks):
        for signal in block.input_labels:
            if signal in diagram.driven and signal not in logged:
                driver = diagram.driven[signal][0]
                neighbours[b].add(driver)
                neighbours[driver].add(b)
    groups = []
    left = list(neighbours)
    while left:
        waiting = left[:1]
        group = set(waiting)
        while waiting:
            new = neighbours[waiting.pop()] - group
            group |= new
            waiting += new
        groups.append(tuple(diagram.blocks[b].name for b in left if b in group))
        left = [b for b in left if b not in group]
    return groups


def _segment(diagram: D, blocks: tuple[str, ...], logged: tuple[str, ...], k: int) -> Segment[D]:
    piece = part(diagram, blocks, f"segment_{k}")
    drives = [signal for signal in diagram.signals if signal in piece.driven and signal in logged]
    read = {signal for block in piece.blocks for signal in block.input_labels}
    opened = cut(piece, [signal for signal in drives if signal in read])
    outputs = [opened.signals[piece.signals.index(signal)] for signal in drives]  # a cut keeps their order
    opened = rebuilt(opened, opened.blocks, opened.open_inputs, outputs or None)
    return Segment(blocks, opened.open_inputs, tuple(drives), opened)
