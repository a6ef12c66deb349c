"""The control loops of a diagram by their signals: each controller with its SP, PV, OP and the stem that follows OP."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.logs import LoopSignals
from stickslip.logs.tags import measurement_in, process_of


def loops_of(blocks: Iterable[Block], units: Mapping[str, str] | None = None) -> dict[str, LoopSignals]:
    """Return name of the controller -> its signals, for every controller with a PV and an OP.

    ``units`` (signal -> unit) tell what is measured, and with it the kind of process: levels integrate.

    >>> from stickslip.blocks import PI, QuasiStaticStem
    >>> loops_of([PI(1.0, 10.0, name="FIC1"), QuasiStaticStem(0.02, 0.01)])["FIC1"].parts
    {'sp': 'SP', 'pv': 'PV', 'op': 'OP', 'mv': 'MV'}
    """
    everything = tuple(blocks)
    stems = {
        block.loop_signal("OP"): block.loop_signal("MV")
        for block in everything
        if block.role is Role.VALVE and block.loop_signal("MV") is not None
    }
    found = {}
    for block in everything:
        pv, op = block.loop_signal("PV"), block.loop_signal("OP")
        if block.role is not Role.CONTROLLER or pv is None or op is None:
            continue
        measured = measurement_in((units or {}).get(pv) or "")
        found[block.name] = LoopSignals(
            pv, op, block.loop_signal("SP"), stems.get(op), process=process_of(measured), measurement=measured
        )
    slaves = {loop.sp: name for name, loop in found.items() if loop.sp is not None}
    return {name: replace(loop, master_of=slaves.get(loop.op, "")) for name, loop in found.items()}
