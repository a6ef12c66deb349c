"""Relay with hysteresis: a two-position controller or an alarm switch.

    off -> on   when u > switch_on           y = high while on
    on -> off   when u < switch_off          y = low while off

in   in  any signal, named second          out  out  the position, named first
switch_on, switch_off   [unit of the input], switch_off <= switch_on; their difference is the hysteresis
high, low               output while on and while off [unit of the output]; low may be above high (a relay that
                        switches off what the input asks less of)

Each switching is located and logged.  The output does not depend on the input within an instant, so a relay closes a
loop without an algebraic loop.  Without hysteresis the loop around a process of first order slides along the
threshold and switches without end (status CHATTERING), as the real contact would; give it a hysteresis.
Python-control sees the hysteresis, too, but switches at its solver's own steps (``seen_modes``).
Valid for any signal.  Source: textbook; its limit cycle in a loop: Astrom and Hagglund, Automatica 20(5), 1984, pp.
645-651.
See also: saturation, switch, relay_tuner.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Floats, Kernels
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.ports import require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite
from stickslip.blocks.seen_modes import Call

OFF, ON = 0.0, 1.0

# p = switch_on, switch_off, high, low


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[2] if d[0] == ON else p[3]


def threshold_event(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    """Write the event function of ``u[0]`` beyond ``p[0]`` (off) or below ``p[1]`` (on); mode ``d[0]``."""
    g[0] = p[1] - u[0] if d[0] == ON else u[0] - p[0]


def threshold_passed(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    """Change the mode ``d[0]`` (kernel)."""
    d[0] = OFF if d[0] == ON else ON


class Thresholds(Block):
    """A block whose mode follows its first input between the thresholds ``p[0]`` and ``p[1]``."""

    remembers = True

    def seen_after(self, before: Call | None, x: Floats, u: Floats) -> Floats:
        """Return the mode, shape (1,), that the input calls for; within the hysteresis it stays what it was."""
        on, off = self._p_now[:2]
        was = self.d0[0] if before is None else before.memory[0]
        return np.array([ON if u[0] > on else OFF if u[0] < off else was])


def check_thresholds(params: Mapping[str, float], name: str) -> None:
    """Raise ``BlockError`` unless switch_off <= switch_on, both finite."""
    finite(params, name, "switch_on", "switch_off")
    on, off = float(params["switch_on"]), float(params["switch_off"])
    rule = f"it switches off at or below where it switches on, switch_on = {on!r}"
    require(off <= on, name, "switch_off", off, rule, "exchange them, or exchange high and low")


class Relay(Thresholds, OneToOne):
    """A relay: on, output ``high``, above ``switch_on``; off, output ``low``, below ``switch_off``.

    ``switch_off``: as ``switch_on`` unless given; ``on``: whether it starts on.
    Raises ``BlockError`` unless switch_off <= switch_on and all are finite.

    >>> from stickslip.diagram import drive
    >>> alarm = Relay("alarm", "T", 80.0, 75.0)
    >>> drive(alarm, 3.0, every=1.0, T=([0, 1, 2, 3], [70.0, 85.0, 77.0, 70.0])).log["alarm"].tolist()
    [0.0, 1.0, 1.0, 0.0]
    """

    role = Role.ARITHMETIC
    kernels = Kernels(
        out=_out, zc=threshold_event, jump=threshold_passed, n_events=1, feeds=False, jumps=True, linear=True
    )
    modes = {"off": OFF, "on": ON}

    def __init__(
        self,
        signal: str,
        source: str,
        switch_on: float,
        switch_off: float | None = None,
        *,
        high: float = 1.0,
        low: float = 0.0,
        on: bool = False,
        unit: str = "",
        name: str = "",
    ) -> None:
        thresholds = {"switch_on": switch_on, "switch_off": switch_on if switch_off is None else switch_off}
        super().__init__(
            signal,
            source,
            thresholds | {"high": high, "low": low},
            memory={"mode": ON if on else OFF},
            unit=unit,
            name=name,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless switch_off <= switch_on and all are finite."""
        check_thresholds(params, name)
        finite(params, name, "high", "low")
