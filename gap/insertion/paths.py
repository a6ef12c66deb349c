"""Paths of signals through a place: where an effect has to be put in.

Behind a block may stand blocks that other effects have put in (``valve:stiction``); what the place gives
is what comes out behind the last of them.
"""

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram

PASSING = (Role.ARITHMETIC, Role.FILTER)  # what a signal goes through on its way from a source to a process
ONLOOKERS = (Role.HISTORIAN, Role.DETECTOR)


def given(diagram: Diagram, place: str) -> str:
    """Return the signal that a place gives, behind all effects that are there.

    >>> from stickslip.blocks import QuasiStaticStem
    >>> from stickslip.plant.loops import self_regulating_loop
    >>> loop = self_regulating_loop()
    >>> given(loop, "valve"), given(loop.insert("MV", QuasiStaticStem(name="valve:stiction")), "valve")
    ('MV', 'MV')
    """
    signal = moved_by(diagram[place])
    behind = next((b for b in diagram.blocks if signal in b.input_labels and b.name.startswith(f"{place}:")), None)
    while behind is not None and len(behind.output_labels) == 1:
        signal = str(behind.output_labels[0])
        behind = next((b for b in diagram.blocks if signal in b.input_labels and b.name.startswith(f"{place}:")), None)
    return signal


def command(block: Block) -> str | None:
    """Return the signal that a valve follows: the only one that enters it, or its OP; None if it is not clear.

    >>> from stickslip.blocks import Equations
    >>> law = Equations("valve", out=lambda OP, dP: OP * dP**0.5, inputs=["OP", "dP"], outputs="flow")
    >>> command(law.with_role("valve", OP="OP", MV="flow"))
    'OP'
    """
    if len(block.input_labels) == 1:
        return str(block.input_labels[0])
    signal, stem = block.loop_signal("OP"), block.loop_signal("MV")
    entered = list(map(str, block.input_labels))
    return signal if signal in entered and stem not in entered else None  # a positioner reads its stem


def moved_by(block: Block) -> str:
    """Return the signal that a block gives: of several that which plays MV, or the first."""
    given, stem = list(map(str, block.output_labels)), block.loop_signal("MV")
    return stem if block.role is Role.VALVE and stem in given else given[0]


def users(diagram: Diagram, signal: str) -> tuple[str, ...]:
    """Return the blocks that read a signal to do something with it: historians and detectors only look on."""
    return tuple(b.name for b in diagram.blocks if signal in b.input_labels and b.role not in ONLOOKERS)


def measured(diagram: Diagram, sensor: Block) -> str | None:
    """Return the signal that a sensor measures: the only one it reads, or the one from no source; None if unclear."""
    if len(sensor.input_labels) == 1:
        return str(sensor.input_labels[0])
    driven = diagram.driven
    found = [
        str(signal)
        for signal in sensor.input_labels
        if signal not in driven or not diagram.blocks[driven[signal][0]].role.drives
    ]
    return found[0] if len(found) == 1 else None


def noise_of(diagram: Diagram, sensor: Block) -> str | None:
    """Return the block that draws a sensor's noise, which has a standard deviation ``sd``: itself, or one it reads."""
    read = [diagram.blocks[diagram.driven[s][0]] for s in sensor.input_labels if s in diagram.driven]
    found = [b.name for b in [sensor, *(b for b in read if b.role.drives)] if b.params.get("sd", 0.0) > 0.0]
    return found[0] if len(found) == 1 else None


def made_of(diagram: Diagram, signal: str) -> list[str]:
    """Return a signal and those that it is made of, nearest first, back to a controller; sources are left out.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> made_of(self_regulating_loop(), "MV")
    ['MV', 'OP']
    """
    found = [signal]
    for one in found:
        if one in diagram.driven:
            driver = diagram.blocks[diagram.driven[one][0]]
            if driver.role is not Role.CONTROLLER:
                found += [str(s) for s in driver.input_labels if s not in found and not _of_source(diagram, str(s))]
    return found


def _of_source(diagram: Diagram, signal: str) -> bool:
    return signal in diagram.driven and diagram.blocks[diagram.driven[signal][0]].role.drives


def reaches_process(diagram: Diagram, block: Block) -> bool:
    """Return whether what a block gives enters a process, directly or through sums and filters."""
    waiting, seen = list(block.output_labels), set()
    while waiting:
        signal = waiting.pop()
        seen.add(signal)
        for reader in diagram.blocks:
            if signal in reader.input_labels:
                if reader.role is Role.PROCESS:
                    return True
                if reader.role in PASSING:
                    waiting += [s for s in reader.output_labels if s not in seen]
    return False
