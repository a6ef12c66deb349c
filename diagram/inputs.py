"""Close the open inputs of a diagram with signals."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from stickslip.blocks.arguments import by_name
from stickslip.blocks.block import Block
from stickslip.blocks.ports import nearest
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.sources import Constant
from stickslip.diagram.changes import rebuilt
from stickslip.diagram.playback import Playback, held, is_table
from stickslip.diagram.wired import D, Wired
from stickslip.diagram.wiring import WiringError
from stickslip.logs import Log

Inputs = Mapping[str, Any] | Log | Playback | Any  # or a frame of pandas or polars


def source(signal: str, given: Any, name: str = "", unit: str = "") -> Block:
    """Return a source of ``signal`` [``unit``]: from a number, arrays ``(t, values)``, a log, or a source block.

    Raises ``WiringError`` for anything else.
    """
    name = name or signal
    if isinstance(given, Block):
        if given.ports_in or len(given.ports_out) != 1:
            raise WiringError(f"block '{given.name}' cannot drive input '{signal}': it must be a source of one signal")
        return given.relabelled(name, [], [signal])
    if isinstance(given, tuple) and len(given) == 2:
        return Recorded(signal, *given, name=name)
    if isinstance(given, int | float | np.floating | np.integer):
        return Constant(signal, float(given), name=name)
    if is_table(given) or isinstance(given, Mapping):
        given = held(given)
    if isinstance(given, Playback):
        return given.block(name, signal, unit)
    raise WiringError(
        f"input '{signal}' was given {type(given).__name__}; "
        "give a number, a pair (t, values), a log, or a source block"
    )


def source_name(diagram: Wired, signal: str) -> str:
    """Return the name of the block that drives an open input: that of the signal, unless a block has it."""
    return f"{signal}:given" if any(block.name == signal for block in diagram.blocks) else signal


def by_signal(diagram: Wired, inputs: Inputs) -> Mapping[str, Any]:
    """Return what drives each input by name; of a log or table as a whole, every column that is an open input.

    Raises ``WiringError`` if no column is one, ``BlockError`` for what has no names.
    """
    table = is_table(inputs) or (isinstance(inputs, Mapping) and "time" in inputs and "time" not in diagram.open_inputs)
    whole = held(inputs) if table else inputs
    if not isinstance(whole, Playback):
        return by_name("simulate", "inputs", whole, {"SP": 0.5})
    if whole.signal:
        raise WiringError(
            f"inputs = the signal '{whole.signal}' alone does not say which input it drives; "
            f"give e.g. inputs={{'{(*diagram.open_inputs, 'PV')[0]}': held(log, '{whole.signal}')}}"
        )
    found = {signal: replace(whole, signal=signal) for signal in diagram.open_inputs if signal in whole.log}
    if not found:
        raise WiringError(
            f"the log has {', '.join(whole.log.names) or 'no signals'}, but the diagram's open inputs are "
            f"{', '.join(diagram.open_inputs) or 'none'}; log.renamed({{...}}) gives its signals other names, "
            "diagram.cut(...) opens those that blocks drive"
        )
    return found


def close(diagram: D, inputs: Inputs) -> D:
    """Return the diagram with the named inputs driven, or with all that a log has.

    Raises ``WiringError`` for an input that is not open, or as ``source`` does.
    """
    given = by_signal(diagram, inputs)
    for signal in given:
        if signal not in diagram.open_inputs:
            raise WiringError(f"the diagram has no open input '{signal}'; {nearest(signal, list(diagram.open_inputs))}")
    sources = [
        source(signal, what, source_name(diagram, signal), diagram.input_units[signal])
        for signal, what in given.items()
    ]
    still_open = [s for s in diagram.open_inputs if s not in given]
    return rebuilt(diagram, [*sources, *diagram.blocks], still_open, diagram.declared_outputs)
