"""The one strict way to wire: by signal name, checked when the diagram is built.

Every rule here raises ``WiringError`` with the signals it concerns and, for unknown names, the nearest right one.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence

from stickslip.blocks.block import Block
from stickslip.blocks.ports import nearest


class WiringError(ValueError):
    """The blocks do not fit together: an unknown, dangling, doubly driven or mismatched signal, or a loop."""


def drivers(blocks: Sequence[Block], inputs: Sequence[str]) -> dict[str, tuple[int, int]]:
    """Return signal -> (block, output port); refuse doubly driven signals and repeated block names."""
    names: set[str] = set()
    found: dict[str, tuple[int, int]] = {}
    for b, block in enumerate(blocks):
        if block.name in names:
            raise WiringError(f"two blocks are called '{block.name}'; give one of them another name= ")
        names.add(block.name)
        for j, signal in enumerate(block.output_labels):
            if signal in found:
                other = blocks[found[signal][0]].name
                raise WiringError(
                    f"signal '{signal}' is driven by both '{other}' and '{block.name}'; "
                    f"label the output of one of them with outputs=, or add them with a Sum block"
                )
            if signal in inputs:
                raise WiringError(
                    f"signal '{signal}' is driven by '{block.name}' and also declared as an input of the diagram; "
                    f"take it out of inputs="
                )
            found[signal] = (b, j)
    return found


def _remedy(signal: str) -> str:
    """Return what to do about a signal that nothing drives; python-control calls unnamed ports u[0], u[1], ..."""
    declared = f"or declare it with inputs=['{signal}']"
    if signal.startswith("u[") and signal.endswith("]"):
        return f"a system of python-control is joined by its labels: give it inputs=, outputs= and name=, {declared}"
    return declared


def check_readers(
    blocks: Sequence[Block], driven: Mapping[str, tuple[int, int]], inputs: Sequence[str], outputs: Sequence[str]
) -> None:
    """Refuse inputs nobody drives, declared inputs nobody reads, unknown outputs."""
    known = [*driven, *inputs]
    read: set[str] = set()
    for block in blocks:
        for port, signal in zip(block.ports_in, block.input_labels, strict=True):
            read.add(signal)
            if signal not in driven and signal not in inputs:
                raise WiringError(
                    f"input {port.name} of block '{block.name}' reads signal '{signal}', which nothing drives; "
                    f"{nearest(signal, known)}; {_remedy(signal)}"
                )
    for signal in inputs:
        if signal not in read:
            raise WiringError(
                f"the diagram declares an input '{signal}' that no block reads; {nearest(signal, sorted(read))}"
            )
    for signal in outputs:
        if signal not in driven:
            raise WiringError(
                f"the diagram declares an output '{signal}' that nothing drives; {nearest(signal, list(driven))}"
            )


def check_sources(sources: Iterable[Block], blocks: Iterable[Block], outputs: Sequence[str]) -> None:
    """Refuse sources whose signal no block reads.

    A block without inputs that has states of its own, such as Lorenz's equations, is a system, not a source: it may
    stand alone.
    """
    read = {signal for block in blocks for signal in block.input_labels}
    for block in sources:
        if block.role.drives and not any(s in read or s in outputs for s in block.output_labels):
            wanted = nearest(block.output_labels[0], sorted(read))
            raise WiringError(
                f"no block reads '{block.output_labels[0]}' from source '{block.name}'; {wanted}; "
                f"remove the source, or name the signal in outputs="
            )


def check_units(blocks: Sequence[Block]) -> dict[str, str]:
    """Return signal -> unit, "" if none is stated; refuse different units of one signal, or where a block has one."""
    stated: dict[str, dict[str, str]] = {}
    for block in blocks:
        ports = [*zip(block.ports_in, block.input_labels, strict=True)]
        ports += zip(block.ports_out, block.output_labels, strict=True)
        for port, signal in ports:
            unit = block.units[port.name]
            here = stated.setdefault(signal, {})
            if unit:
                here[unit] = f"{port.name} of '{block.name}'"
    for signal, units in stated.items():
        if len(units) > 1:
            said = "; ".join(f"{where} is in [{unit}]" for unit, where in units.items())
            raise WiringError(
                f"signal '{signal}' has mismatched units: {said}; convert with a Gain block, or correct units="
            )
    found = {signal: next(iter(units), "") for signal, units in stated.items()}
    for block in blocks:
        if block.one_unit:
            _check_one_unit(block, found)
    return found


def _check_one_unit(block: Block, units: Mapping[str, str]) -> None:
    """Refuse signals of different units at ports of a block that have one unit."""
    ports = (
        *zip(block.ports_in, block.input_labels, strict=True),
        *zip(block.ports_out, block.output_labels, strict=True),
    )
    read = {units[signal]: signal for port, signal in ports if port.name in block.one_unit and units[signal]}
    if len(read) > 1:
        said = " and ".join(f"'{signal}' in [{unit}]" for unit, signal in read.items())
        raise WiringError(
            f"block '{block.name}' has mismatched units: {said}, but both have one unit there; convert one of them "
            "with a Gain block, or correct units="
        )


def spans(blocks: Iterable[Block]) -> dict[str, tuple[float, float]]:
    """Return the instrument spans of the signals that have one, low and high in the unit of the signal."""
    return {
        signal: block.spans[port.name]
        for block in blocks
        for port, signal in zip(block.ports_out, block.output_labels, strict=True)
        if port.name in block.spans
    }


def followed(block: Block) -> list[str]:
    """Return the signals on which a block's outputs depend at the same instant."""
    labels = block.input_labels
    follows = [False] * len(labels) if block.dead_time else block.kernels.follows(len(labels))
    return [label for label, at_once in zip(labels, follows, strict=True) if at_once]


def seen_followed(block: Block) -> list[str]:
    """Return the same for what python-control sees: there an event shows at once in what remembers it."""
    return list(block.input_labels) if block.remembers else followed(block)


def flow_order(
    blocks: Sequence[Block], driven: Mapping[str, tuple[int, int]], follows: Callable[[Block], list[str]] = followed
) -> list[int]:
    """Return the blocks in signal-flow order; refuse algebraic loops, naming their signals."""
    waits: dict[int, set[int]] = {}
    readers: dict[int, list[int]] = {}
    for b, block in enumerate(blocks):
        waits[b] = {driven[s][0] for s in follows(block) if s in driven}
        for origin in waits[b]:
            readers.setdefault(origin, []).append(b)
    order: list[int] = []
    missing = {b: len(before) for b, before in waits.items()}
    ready = [b for b, count in missing.items() if count == 0]
    while ready:
        order += ready
        freed = []
        for origin in ready:
            for b in readers.get(origin, ()):
                missing[b] -= 1
                if missing[b] == 0:
                    freed.append(b)
        ready = sorted(freed)
    if len(order) < len(blocks):
        done = set(order)
        raise WiringError(_describe_loop(blocks, driven, {b: waits[b] - done for b in waits if b not in done}))
    # A sampled block whose output does not follow its input publishes first, but takes its sample last of all at
    # an instant, when everything it may read has been brought up to date.
    return sorted(order, key=lambda b: blocks[b].sampled and not followed(blocks[b]))


def _describe_loop(
    blocks: Sequence[Block], driven: Mapping[str, tuple[int, int]], waits: Mapping[int, Iterable[int]]
) -> str:
    path: list[int] = []
    b = next(iter(waits))
    while b not in path:
        path.append(b)
        b = next(iter(waits[b]))
    loop = path[path.index(b) :][::-1]
    parts = []
    for here, there in zip(loop, [*loop[1:], loop[0]], strict=True):
        signal = next(s for s in blocks[there].input_labels if driven.get(s, (-1, 0))[0] == here)
        parts.append(f"'{blocks[here].name}' -({signal})-> ")
    return (
        f"algebraic loop: {''.join(parts)}'{blocks[loop[0]].name}'; every loop needs one block whose output does not "
        f"follow its input at once (a lag, an integrator, a dead time)"
    )
