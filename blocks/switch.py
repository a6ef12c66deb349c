"""Switch: one of two signals, as a third one says.

    y = above   once control > switch_on,    until control < switch_off
    y = below   else

in   control            the signal that decides
     above, below       the signals to choose from, of one unit
out  out                the one chosen, named first
switch_on, switch_off   [unit of control], switch_off <= switch_on; their difference is the hysteresis

Each switching is located and logged (modes "above" and "below"); there the output jumps.
Valid for any signals; a static block.  Source: textbook.
See also: relay (a switch between two constants), select (the lowest or highest signal).
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.ports import Port
from stickslip.blocks.relay import OFF, ON, Thresholds, check_thresholds, threshold_event, threshold_passed
from stickslip.blocks.role import Role


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = u[1] if d[0] == ON else u[2]


class Switch(Thresholds):
    """``above`` while ``control`` lies beyond ``switch_on`` (until it falls below ``switch_off``), else ``below``.

    ``switch_off``: as ``switch_on`` unless given.  Raises ``BlockError`` unless switch_off <= switch_on.

    >>> feed = Switch("F", "level", above="F_high", below="F_low", switch_on=0.8)
    >>> [float(feed.output(0.0, [], [level, 1.0, 2.0])[0]) for level in (0.5, 0.9)]
    [2.0, 1.0]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("control"), Port("above"), Port("below"))
    ports_out = (Port("out"),)
    kernels = Kernels(out=_out, zc=threshold_event, jump=threshold_passed, n_events=1, jumps=True, linear=True)
    modes = {"below": OFF, "above": ON}

    def __init__(
        self,
        signal: str,
        control: str,
        *,
        above: str,
        below: str,
        switch_on: float = 0.5,
        switch_off: float | None = None,
        unit: str = "",
        name: str = "",
    ) -> None:
        super().__init__(
            name=name or signal,
            params={"switch_on": switch_on, "switch_off": switch_on if switch_off is None else switch_off},
            memory={"mode": OFF},
            inputs=[control, above, below],
            outputs=signal,
            units={"above": unit, "below": unit, "out": unit},
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless switch_off <= switch_on, both finite."""
        check_thresholds(params, name)
