"""The parts into which logged controller outputs cut a diagram, for a filter made of it.

    ruled    controllers and what is between logged signals and their output: a log drives each of them alone
    fed      what follows from logged controller outputs and from planned sources alone: valves, mostly
    rest     all other blocks on the way to a measurement: the process, driven by what ``fed`` gives

A controller that reads what is not logged (the flow through a compressor) is in none of the three: its output is
logged, so the others do without it, and it is not judged.
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from stickslip.blocks.noise import Seeded
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.records.record import Record

PASSING = (Role.CONTROLLER, Role.SOURCE, Role.ARITHMETIC, Role.FILTER)  # blocks that may be on the way to an OP


@dataclass(frozen=True)
class Parts:
    """Names of the blocks of each part, in the diagram's order, and its signals.

    ``known`` logged outputs of controllers, and logged inputs; ``given`` the signals that ``fed`` gives to ``rest``;
    ``measured`` the logged signals of ``rest``; ``judged`` the logged outputs of ``ruled``.
    """

    ruled: tuple[str, ...]
    fed: tuple[str, ...]
    rest: tuple[str, ...]
    known: tuple[str, ...]
    given: tuple[str, ...]
    measured: tuple[str, ...]
    judged: tuple[str, ...]


def parts(diagram: Diagram, record: Record, loads: Collection[str] = ()) -> Parts:
    """Return the parts of a diagram between the signals of a record.

    ``loads`` signals that nobody measures: a silent diagram gives their mean, but they belong to the process.

    >>> import numpy as np
    >>> from stickslip.logs import Log
    >>> from stickslip.plant.loops import self_regulating_loop
    >>> loop = self_regulating_loop()
    >>> t = np.arange(30.0)
    >>> found = parts(loop, Record(Log(t, {"OP": t, "PV": t}), (), ("OP", "PV")))
    >>> found.ruled, found.fed, found.rest, found.given
    (('SP', 'controller'), ('valve', 'process'), (), ())
    """
    logged = {*record.played, *record.pinned}
    drivers = {s: diagram.blocks[b].name for s, (b, _) in diagram.driven.items()}
    outputs = [s for s in record.pinned if s in drivers and diagram[drivers[s]].role is Role.CONTROLLER]
    known = (*outputs, *record.played)
    behind = {s: ancestors(diagram, [s], stop=logged) for s in outputs}
    judged = tuple(s for s, found in behind.items() if all(diagram[name].role in PASSING for name in found))
    ruled = {name for s in judged for name in behind[s]}
    measured = tuple(s for s in record.pinned if s in drivers and s not in outputs)
    process = ancestors(diagram, measured, stop=set(known), through=True)
    fed = _fed(diagram, process, known, loads)
    rest = [b.name for b in diagram.blocks if b.name in process and b.name not in fed]
    driven_here = {s for name in fed for s in map(str, diagram[name].output_labels)} | set(known)
    read = dict.fromkeys(s for name in rest for s in map(str, diagram[name].input_labels))
    return Parts(
        tuple(b.name for b in diagram.blocks if b.name in ruled),
        tuple(b.name for b in diagram.blocks if b.name in fed),
        tuple(rest),
        known,
        tuple(s for s in read if s in driven_here),
        measured,
        judged,
    )


def ancestors(diagram: Diagram, signals: Iterable[str], stop: set[str], through: bool = False) -> set[str]:
    """Return the blocks that drive signals, and those that drive what these read, as far as signals to ``stop`` at.

    ``through``: also behind the signals asked for, where they are read on the way.
    """
    found: set[str] = set()
    waiting = list(signals)
    asked = set(waiting)
    while waiting:
        signal = waiting.pop()
        if signal not in diagram.driven:
            continue
        block = diagram.blocks[diagram.driven[signal][0]]
        if block.name not in found:
            found.add(block.name)
            waiting += [s for s in map(str, block.input_labels) if s not in stop or (through and s in asked)]
    return found


def _fed(diagram: Diagram, process: set[str], known: Iterable[str], loads: Collection[str]) -> set[str]:
    """Return the blocks of a process that follow from known signals and planned sources alone."""
    have = set(known)
    fed: set[str] = set()
    while True:
        new = [
            block
            for block in diagram.blocks
            if block.name in process and block.name not in fed
            and not isinstance(block, Seeded) and not any(str(s) in loads for s in block.output_labels)
            and all(s in have for s in map(str, block.input_labels))
        ]  # fmt: skip
        if not new:
            return fed
        fed |= {block.name for block in new}
        have |= {str(s) for block in new for s in block.output_labels}
