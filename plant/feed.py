"""The crude that enters separator 1: flow F_in [mol/s] and methane fraction Z_I [-].

    case 1   constant F_in and Z_I                                                          (thesis table 5.2)
    case 2   Z_I = mean + amplitude sin(2 pi t/period): 0.25 + 0.1 sin(2 pi t/500)          (thesis table 5.2)
    slugs    F_in saw-tooth: the riser fills slowly and blows out fast, the gas behind the oil

In a severe slug flow rises while liquid collects and then breaks off; here F_in and, opposite in phase, Z_I follow
``Slug``.  All start in the middle of their range, and the plant rests where its feed starts (``start``), so that it
meets no jump.  Their own values are the design feed of the set that the plant has unless another is asked for.  All
raise ``InfeasibleFeed`` for a flow that turns negative or a fraction that leaves 0 ... 1.
"""

import math
from collections.abc import Sequence

from stickslip.blocks.block import Block
from stickslip.blocks.periodic import Sine, Slug
from stickslip.blocks.ports import number
from stickslip.blocks.sources import Constant, Ramp
from stickslip.plant.parameters import DEFAULT, SETS
from stickslip.plant.rest import InfeasibleFeed

F_IN, Z_IN = SETS[DEFAULT].F_in, SETS[DEFAULT].Z_I  # mol/s, methane fraction


def constant(F_in: float = F_IN, Z_I: float = Z_IN) -> list[Block]:
    """Return a constant feed.

    >>> constant(8000.0, 37.0)
    Traceback (most recent call last):
    ...
    stickslip.plant.rest.InfeasibleFeed: the feed goes from Z_I = 37 to 37, but it lies within 0 to 1; give
    fractions and a smaller swing
    """
    _check(F_in, 0.0, Z_I, 0.0)
    return [Constant("F_in", F_in, unit="mol/s"), Constant("Z_I", Z_I)]


def sine(
    F_in: float = F_IN, mean: float = 0.25, amplitude: float = 0.1, period: float = 500.0, start: float = 0.0
) -> list[Block]:
    """Return a constant flow with a sinusoidal methane fraction: case 2, from ``start`` [s] on.

    >>> [round(float(block.output(125.0, [], [])[0]), 3) for block in sine()]
    [7600.0, 0.35]
    """
    _check(F_in, 0.0, mean, amplitude)
    return [Constant("F_in", F_in, unit="mol/s"), Sine("Z_I", amplitude, period, mean=mean, start=start)]


def slugs(
    F_in: float = F_IN, Z_I: float = Z_IN, *, period: float = 500.0, flow: float = 400.0, gas: float = 0.05,
    start: float = 0.0,
) -> list[Block]:  # fmt: skip
    """Return severe slugging: F_in swings by ``flow`` [mol/s] and Z_I by ``gas``, the one up when the other is down."""
    _check(F_in, flow, Z_I, gas)
    return [
        Slug("F_in", flow, period, mean=F_in, start=start, unit="mol/s"),
        Slug("Z_I", -gas, period, mean=Z_I, start=start),
    ]


def trip(
    F_in: float = F_IN, Z_I: float = Z_IN, *, to: float = 0.3, within: float = 5.0, at: float = 10.0
) -> list[Block]:
    """Return a feed that falls to the share ``to`` within some seconds, beginning ``at`` [s].

    Raises ``InfeasibleFeed`` for a trip that takes no time.
    """
    _check(F_in, 0.0, Z_I, 0.0)
    _check(to * F_in, 0.0, Z_I, 0.0)
    if not within > 0.0:
        raise InfeasibleFeed(f"a feed trip within {within!r} s is no ramp; give seconds above 0")
    slope = (to - 1.0) * F_in / within
    return [Ramp("F_in", slope, start=at, end=at + within, before=F_in, unit="mol/s"), Constant("Z_I", Z_I)]


def start(blocks: Sequence[Block]) -> dict[str, float]:
    """Return what the sources among ``blocks`` give at first: signal -> value, a step or ramp before it begins.

    >>> start(slugs(7800.0, 0.36))
    {'F_in': 7800.0, 'Z_I': 0.36}
    >>> from stickslip.blocks import Step
    >>> start([Step("F_in", after=8000.0, before=7500.0)])
    {'F_in': 7500.0}
    """
    return {
        signal: float(value)
        for block in blocks
        if block.role.drives and not block.sampled
        for signal, value in zip(block.output_labels, block.output(-math.inf, [], []), strict=True)
    }


def _check(F_in: float, flow: float, Z_I: float, gas: float) -> None:
    """Refuse a flow ``F_in`` -+ ``flow`` that turns negative and a fraction ``Z_I`` -+ ``gas`` beyond 0 ... 1."""
    for name, mean, swing, most in (("F_in", F_in, flow, math.inf), ("Z_I", Z_I, gas, 1.0)):
        middle, half = number("feed", name, mean), abs(number("feed", name, swing))
        if not (middle - half >= 0.0 and middle + half <= most and math.isfinite(middle + half)):
            rule = "lies within 0 to 1; give fractions" if most == 1.0 else "is finite and never negative; give mol/s"
            raise InfeasibleFeed(
                f"the feed goes from {name} = {middle - half:g} to {middle + half:g}, but it {rule} and a smaller swing"
            )
