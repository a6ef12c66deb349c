"""What sizes are measured by at a place: the span of its instrument, the time scale of its loop.

    span of a signal      the instrument span that a block states; behind one that has a single input, what the span
                          of that input becomes at rest (a positioner, a half of a split range); else 1 (fractions)
    time scale            the integral time T_i of the nearest controller, else the time constant of the nearest
                          process, else 10 s; at a process the geometric mean of that and its own time constant
    size of a source      its value, its mean, or 40 standard deviations of its noise, whichever is the largest

They set the bounds between which the size of an effect is searched; no result depends on them otherwise.
"""

import math
from functools import lru_cache

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.blocks.sources import Constant
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram

USUAL = 10.0  # [s], where a diagram says nothing
SPREADS = 40.0  # standard deviations of an unmeasured load that are its size: what it adds is searched below half of it
TIMES = ("tau", "tau_1", "T")  # time constants of processes


def scale(diagram: Diagram, place: str, per: str) -> float:
    """Return what bounds are multiples of at a block: 1 for "", else its "span", "time" or "size"."""
    if per == "span":
        return span(diagram, diagram[place].output_labels[0]) if diagram[place].output_labels else 1.0
    if per == "size":
        return size(diagram[place])
    return time_scale(diagram, place) if per == "time" else 1.0


def size(source: Block) -> float:
    """Return how large the signal of a source is [its unit], 1 if it states nothing.

    >>> from stickslip.blocks import Constant, Noise
    >>> size(Constant("F_in", 8000.0)), size(Constant("load", 0.0)), size(Noise("load", sd=0.05, dt=1.0))
    (8000.0, 1.0, 2.0)
    """
    stated = [abs(source.params[key]) for key in ("value", "mean") if key in source.param_names]
    return max(*stated, SPREADS * source.params.get("sd", 0.0), 0.0) or 1.0


def span(diagram: Diagram, signal: str) -> float:
    """Return the length of the span of a signal [its unit], 1 if no block states one.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> span(self_regulating_loop(), "OP")
    1.0
    """
    low, high = ends(diagram, signal) or (0.0, 1.0)
    return high - low


def ends(diagram: Diagram, signal: str) -> tuple[float, float] | None:
    """Return low and high end of the span of a signal [its unit], None if no block states one.

    >>> from stickslip.blocks import LeadLag, SampledPI
    >>> loop = wire([SampledPI(1.0, 9.0, dt=1.0, low=0.0, high=100.0), LeadLag("p", "OP", 0.0, 2.0)], ["SP", "PV"])
    >>> ends(loop, "p")
    (0.0, 100.0)
    """
    passed: list[Block] = []
    while (found := _stated(diagram, signal)) is None:
        driver = diagram.blocks[diagram.driven[signal][0]] if signal not in diagram.open_inputs else None
        if driver is None or driver in passed or not _passes(driver):
            return None
        passed.append(driver)
        signal = str(driver.input_labels[0])
    for block in reversed(passed):
        images = [at_rest(block, end) for end in found]
        if not all(map(math.isfinite, images)) or images[0] == images[1]:
            return None
        found = min(images), max(images)
    return found


def _stated(diagram: Diagram, signal: str) -> tuple[float, float] | None:
    """Return the span that a block states which drives or reads a signal."""
    if signal in diagram.signal_spans:
        return diagram.signal_spans[signal]
    read = [
        block.spans[port.name]
        for block in diagram.blocks
        for port, label in zip(block.ports_in, block.input_labels, strict=True)
        if label == signal and port.name in block.spans
    ]
    return read[0] if read else None


def _passes(block: Block) -> bool:
    """Return whether a block passes one signal on: a positioner, a lookup table, an element; no process does."""
    return len(block.input_labels) == len(block.output_labels) == 1 and block.role is not Role.PROCESS


@lru_cache(maxsize=256)
def at_rest(block: Block, value: float) -> float:
    """Return what a block gives at rest if a value enters it, NaN if it does not come to rest."""
    from stickslip.diagram.linear import NoOperatingPoint, operating_point

    entered = str(block.input_labels[0])
    try:
        point = operating_point(wire([Constant(entered, value), block]))
    except NoOperatingPoint:
        return math.nan
    return float(f"{point[str(block.output_labels[0])]:.9g}")  # to the digits that the rest is solved to


def time_scale(diagram: Diagram, place: str) -> float:
    """Return the time scale [s] of the loop in which a block is.

    >>> from stickslip.plant.loops import integrating_loop
    >>> time_scale(integrating_loop(), "valve")
    400.0
    """
    around = nearest_first(diagram, place)
    times = [b.params["T_i"] for b in around if b.role is Role.CONTROLLER and "T_i" in b.param_names]
    times += [time for b in around if b.role is Role.PROCESS for time in _own_times(b)]
    near = next((t for t in times if 0.0 < t < math.inf), USUAL)
    at = diagram[place]
    own = next((t for t in _own_times(at) if 0.0 < t < math.inf), near) if at.role is Role.PROCESS else near
    return math.sqrt(near * own)


def _own_times(process: Block) -> list[float]:
    return [process.params[key] for key in TIMES if key in process.param_names]


def nearest_first(diagram: Diagram, place: str) -> list[Block]:
    """Return the blocks in the order of how many signals lie between them and a place; those not joined to it last."""
    left = list(range(len(diagram.blocks)))
    found = [diagram.block_index(place)]
    left.remove(found[0])
    for b in found:
        mine = {*diagram.blocks[b].input_labels, *diagram.blocks[b].output_labels}
        near = [c for c in left if mine & {*diagram.blocks[c].input_labels, *diagram.blocks[c].output_labels}]
        found += near
        left = [c for c in left if c not in near]
    return [diagram.blocks[b] for b in [*found, *left]]
