"""Changed copies of a diagram: other values, other blocks, parts of it, another name.

Each change returns a new diagram with the open inputs, declared outputs, parameters, start values and past of the old
one, as far as they still fit.  See also: ``cuts``, which changes what reads what.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import control as ct
import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.arguments import by_name, text, texts
from stickslip.blocks.block import Block
from stickslip.blocks.control_system import as_block
from stickslip.blocks.ports import nearest, number
from stickslip.diagram.wired import D, Wired
from stickslip.diagram.wiring import WiringError


def rebuilt(
    diagram: D,
    blocks: Sequence[Block],
    inputs: Sequence[str],
    outputs: Sequence[str] | None,
    name: str | None = None,
) -> D:
    """Return a diagram of these blocks that goes on with the past of the old one; everything is checked afresh."""
    return type(diagram)(blocks, inputs, outputs, diagram.name if name is None else name).with_past(diagram.past)


def blocks_with_params(diagram: Wired, values: Mapping[str, float]) -> list[Block]:
    """Return the blocks with other parameters: see ``Diagram.with_params``."""
    return _changed(diagram, by_name(diagram.name, "params", values, {"valve.F_s": 1750.0}), "with_params")


def blocks_starting_at(diagram: Wired, values: Mapping[str, float]) -> list[Block]:
    """Return the blocks with other start values: see ``Diagram.starting_at``."""
    for key, value in by_name(diagram.name, "start", values, {"process.PV": 0.5}).items():
        if not math.isfinite(number("start", key, value)):
            raise WiringError(f"'{key}' is to start at {float(value):g}, but it must be finite; give a number")
    return _changed(diagram, values, "starting_at")


def blocks_with_tolerances(diagram: Wired, shares: Mapping[str, float]) -> list[Block]:
    """Return the blocks with tolerances of their parameters: see ``Diagram.with_tolerances``."""
    return _changed(diagram, by_name(diagram.name, "tolerances", shares, {"process.K": 0.05}), "with_tolerances")


def _changed(diagram: Wired, values: Mapping[str, float], change: str) -> list[Block]:
    grouped: dict[int, dict[str, float]] = {}
    for key, value in values.items():
        name, _, what = key.rpartition(".")
        if not name:
            raise WiringError(f"'{key}' does not say which block; write 'block.name', e.g. 'valve.F_s'")
        grouped.setdefault(diagram.block_index(name), {})[what] = value
    blocks = list(diagram.blocks)
    for b, group in grouped.items():
        blocks[b] = getattr(blocks[b], change)(**group)
    return blocks


def blocks_in_mode(diagram: Wired, modes: str | Mapping[str, str]) -> list[Block]:
    """Return the blocks in a mode: see ``Diagram.in_mode``."""
    if isinstance(modes, str):
        having = {block.name: modes for block in diagram.blocks if modes in block.modes}
        if not having:
            known = sorted({m for block in diagram.blocks for m in block.modes})
            raise WiringError(f"no block of the diagram has a mode '{modes}'; {nearest(modes, known)}")
        modes = having
    changed = list(diagram.blocks)
    for name, mode in by_name(diagram.name, "modes", modes, {"valve": "ideal"}).items():
        b = diagram.block_index(name)
        changed[b] = changed[b].in_mode(mode)
    return changed


def start_values(diagram: Wired, x: ArrayLike) -> dict[str, float]:
    """Return a state vector of python-control as start values by name: see ``Diagram.at_state``."""
    given = [number("at_state", "x", value) for value in np.ravel(x).tolist()]
    if len(given) != diagram.nstates:
        raise WiringError(
            f"{len(given)} values are given, but python-control counts {diagram.nstates} states: "
            f"{', '.join(diagram.state_labels)}; give one value for each"
        )
    values = dict(zip(diagram.state_labels, given, strict=True))
    return {
        f"{block.name}.{state}": values[label]
        for block in diagram.blocks
        for state in (*block.state_names, *block.memory_names)
        if (label := f"{block.name}[{state}]") in values
    }


def replaced(diagram: D, name: str, block: Block | ct.InputOutputSystem) -> D:
    """Return the diagram with one block replaced: see ``Diagram.replace``."""
    if isinstance(block, type(diagram)) or not isinstance(block, ct.InputOutputSystem):
        raise WiringError(
            f"'{name}' cannot be replaced by {type(block).__name__}: it is no block; take the old blocks out with "
            "without(), and wire() a diagram in their place"
        )
    block = as_block(block)
    b = diagram.block_index(name)
    old = diagram.blocks[b]
    if len(block.ports_in) != len(old.ports_in) or len(block.ports_out) != len(old.ports_out):
        raise WiringError(
            f"block '{name}' has {len(old.ports_in)} inputs and {len(old.ports_out)} outputs, its replacement "
            f"'{block.name}' {len(block.ports_in)} and {len(block.ports_out)}; they must agree"
        )
    kept = {key: share for key, share in old.tolerances.items() if key in block.param_names}
    block = block.with_tolerances(**{**kept, **block.tolerances})
    new = block.relabelled(name, list(old.input_labels), list(old.output_labels))
    past = diagram.past
    if past is not None and new.sampled:
        new = new.holding(old.y0) if old.sampled else new  # until the next sample
        past = past if old.sampled else past.without(name)
    blocks = [*diagram.blocks[:b], new, *diagram.blocks[b + 1 :]]
    return rebuilt(diagram, blocks, diagram.open_inputs, diagram.declared_outputs).with_past(past)


def part(diagram: D, names: Iterable[str], name: str) -> D:
    """Return the named blocks as a diagram of their own: see ``Diagram.part``."""
    kept = [diagram[n] for n in texts(diagram.name, "names", names if isinstance(names, str) else listed(names))]
    driven = {s for block in kept for s in block.output_labels}
    inputs = dict.fromkeys(s for block in kept for s in block.input_labels if s not in driven)
    outputs = [s for s in diagram.declared_outputs or () if s in driven]
    return rebuilt(diagram, kept, list(inputs), outputs or None, name)


def without(diagram: D, names: Iterable[str]) -> D:
    """Return the diagram without some blocks: see ``Diagram.without``."""
    gone = {signal for n in names for signal in diagram[n].input_labels}
    kept = [block for block in diagram.blocks if block.name not in names]
    idle = gone - {signal for block in kept for signal in block.input_labels}
    return part(diagram, [b.name for b in kept if b.ports_in or not idle.issuperset(b.output_labels)], diagram.name)


def named(diagram: D, name: str, inputs: Mapping[str, str]) -> D:
    """Return the diagram under another name, its open inputs relabelled: see ``Diagram.named``."""
    for key, signal in inputs.items():
        text(diagram.name, key, signal)
        if key not in diagram.open_inputs:
            known = nearest(key, list(diagram.open_inputs))
            raise WiringError(f"diagram '{diagram.name}' has no open input '{key}'; {known}")
    blocks = [
        block.relabelled(block.name, [inputs.get(s, s) for s in block.input_labels], list(block.output_labels))
        for block in diagram.blocks
    ]
    opened = list(dict.fromkeys(inputs.get(s, s) for s in diagram.open_inputs))
    return rebuilt(diagram, blocks, opened, diagram.declared_outputs, name)


def nested_blocks(diagram: Wired) -> list[Block]:
    """Return the blocks as they appear inside another diagram: names and signals behind ``name/``."""
    prefix = f"{diagram.name}/"
    return [
        block.relabelled(
            prefix + block.name,
            [prefix + s if s in diagram.driven else s for s in block.input_labels],
            [prefix + s for s in block.output_labels],
        )
        for block in diagram.blocks
    ]


def listed(items: Any) -> list[Any]:
    """Return what is given in a list or the like as a list.

    Raises ``WiringError`` for a text and for a single system.
    """
    if isinstance(items, Iterable) and not isinstance(items, str | ct.InputOutputSystem):
        return list(items)
    raise WiringError(f"{items!r:.60} is no list; give several things as one, e.g. [valve, process]")
