"""Change what reads what: cut signals open, put a block into a signal's path, let a block read another signal.

The readers of a signal keep its name.  What is parted from them, the output of the block that drives it, goes on
under the signal's name followed by the block's: ``PV:sensor`` is PV as the block ``sensor`` gives it.

Everything is a changed copy: open inputs, declared outputs, parameters, start values and past are kept.
See also: ``segments``, which takes a diagram apart between logged signals.
"""

from collections.abc import Iterable, Mapping, Sequence

import control as ct
from stickslip.blocks.arguments import text, texts
from stickslip.blocks.block import Block
from stickslip.blocks.control_system import as_block
from stickslip.blocks.ports import nearest
from stickslip.diagram.changes import listed, nested_blocks, rebuilt
from stickslip.diagram.past import together
from stickslip.diagram.wired import D, Wired
from stickslip.diagram.wiring import WiringError


def cut(diagram: D, signals: str | Iterable[str]) -> D:
    """Return the diagram with signals cut open: see ``Diagram.cut``."""
    wanted = texts(diagram.name, "signals", signals if isinstance(signals, str) else listed(signals))
    read = {signal for block in diagram.blocks for signal in block.input_labels}
    parted: dict[str, str] = {}
    for signal in wanted:
        check_known(diagram, signal)
        if signal not in read:
            raise WiringError(
                f"no block reads '{signal}', so there is nothing to cut; leave it out, a run logs it as it is driven"
            )
        if signal in diagram.driven:
            parted[signal] = _parted(diagram, signal)
    blocks = [_relabelled(block, {}, parted) for block in (_with_units(b, diagram, parted) for b in diagram.blocks)]
    outputs = diagram.declared_outputs and [parted.get(s, s) for s in diagram.declared_outputs]
    return rebuilt(diagram, blocks, [*diagram.open_inputs, *parted], outputs)


def inserted(
    diagram: D,
    signal: str,
    block: Block | Wired | ct.InputOutputSystem,
    readers: str | Iterable[str] | None,
    inputs: Sequence[str],
) -> D:
    """Return the diagram with a block in a signal's path: see ``Diagram.insert``."""
    check_known(diagram, signal)
    if isinstance(block, type(diagram)):
        new, past = nested_blocks(block), block.past and block.past.inside(block.name)
        way_in = _way("input", signal, block, block.open_inputs)
        way_out = f"{block.name}/{_way('output', signal, block, block.chosen_outputs)}"
    else:
        block = as_block(block)
        new, past = [block], None
        way_in = _way("input", signal, block, block.input_labels)
        way_out = _way("output", signal, block, block.output_labels)
    if readers is None and signal in diagram.driven:  # whoever reads the signal, a log included, reads the new one
        before, after = _parted(diagram, signal), signal
        blocks = [_relabelled(b, {}, {signal: before}) for b in diagram.blocks]
    else:
        before, after = signal, _free(diagram, signal, block.name)
        names = _readers(diagram, signal, readers)
        blocks = [_relabelled(b, {signal: after}, {}) if b.name in names else b for b in diagram.blocks]
    # Behind the old ones: random numbers go by a block's place in the list.
    blocks += [_relabelled(b, {way_in: before}, {way_out: after}) for b in new]
    opened = [*diagram.open_inputs, *(s for s in texts(diagram.name, "inputs", inputs))]
    changed = rebuilt(diagram, blocks, list(dict.fromkeys(opened)), diagram.declared_outputs)
    kept = diagram.past and diagram.past.without(*(b.name for b in new))
    return changed.with_past(together(p for p in (kept, past) if p is not None))


def rewired(diagram: D, name: str, port: str, signal: str, inputs: Sequence[str]) -> D:
    """Return the diagram with an input of a block reading another signal: see ``Diagram.rewire``."""
    b, block = diagram.block_index(name), diagram[name]
    ports = [p.name for p in block.ports_in]
    known = ports if port in ports else list(block.input_labels)
    if port not in known:
        hint = nearest(port, list(dict.fromkeys([*ports, *block.input_labels])))
        raise WiringError(f"block '{name}' has no input '{port}'; {hint}")
    labels = list(block.input_labels)
    labels[known.index(port)] = text(name, port, signal)
    blocks = list(diagram.blocks)
    blocks[b] = block.relabelled(name, labels, list(block.output_labels))
    read = {s for one in blocks for s in one.input_labels}
    opened = [s for s in diagram.open_inputs if s in read]
    opened += [s for s in texts(diagram.name, "inputs", inputs) if s not in opened]
    return rebuilt(diagram, blocks, opened, diagram.declared_outputs)


def check_known(diagram: Wired, signal: str) -> None:
    """Raise ``WiringError`` with the nearest name unless the diagram has such a signal or open input."""
    known = [*diagram.signals, *diagram.open_inputs]
    if text(diagram.name, "signal", signal) not in known:
        raise WiringError(f"the diagram has no signal '{signal}'; {nearest(signal, known)}")


def _parted(diagram: Wired, signal: str) -> str:
    """Return the name of what drives a signal, once it is parted from the readers."""
    return _free(diagram, signal, diagram.blocks[diagram.driven[signal][0]].name)


def _free(diagram: Wired, signal: str, block: str) -> str:
    """Return ``PV:sensor``, in a nested diagram ``loop/PV:sensor``; refuse a name that is taken."""
    folder = signal.rpartition("/")[0]
    name = f"{signal}:{block.removeprefix(f'{folder}/')}"
    if name in diagram.driven or name in diagram.open_inputs:
        raise WiringError(
            f"signal '{signal}' as block '{block}' gives it would be called '{name}', but there is a signal of that "
            "name; give the block or the signal another name"
        )
    return name


def _way(side: str, signal: str, block: Block | Wired, labels: Sequence[str]) -> str:
    """Return the input or output of a block that lies in the path of a signal: the only one, or the one of its name."""
    if len(labels) == 1:
        return labels[0]
    if signal in labels:
        return signal
    raise WiringError(
        f"'{block.name}' has {len(labels)} {side}s ({', '.join(labels) or 'none'}), so which one lies in the path of "
        f"'{signal}' is open; label that one '{signal}' with {side}s=, or declare only one"
    )


def _readers(diagram: Wired, signal: str, names: str | Iterable[str] | None) -> tuple[str, ...]:
    """Return the named readers of a signal, all for None; refuse a block that does not read it."""
    reading = tuple(block.name for block in diagram.blocks if signal in block.input_labels)
    if names is None:
        return reading
    named = texts(diagram.name, "readers", names if isinstance(names, str) else listed(names))
    for name in named:
        diagram.block_index(name)
        if name not in reading:
            hint = nearest(name, reading)
            raise WiringError(f"block '{name}' does not read '{signal}'; {hint}")
    if not named:
        raise WiringError(f"readers = [] names no reader of '{signal}'; {nearest('', reading)}; leave it out for all")
    return named


def _relabelled(block: Block, reads: Mapping[str, str], drives: Mapping[str, str]) -> Block:
    if reads.keys().isdisjoint(block.input_labels) and drives.keys().isdisjoint(block.output_labels):
        return block
    inputs, outputs = ([new.get(s, s) for s in old]
                       for new, old in ((reads, block.input_labels), (drives, block.output_labels)))  # fmt: skip
    return block.relabelled(block.name, inputs, outputs)


def _with_units(block: Block, diagram: Wired, signals: Iterable[str]) -> Block:
    """Return the block stating the units of some signals itself, because soon nobody else on its side may."""
    ports = [*zip(block.ports_in, block.input_labels, strict=True)]
    ports += zip(block.ports_out, block.output_labels, strict=True)
    units = {port.name: diagram.signal_units[signal] for port, signal in ports if signal in signals}
    return block.with_units(units) if any(units.values()) else block
