"""Play between controller output and stem: backlash, the deadband of a valve without stiction.

    x = OP - width/2  while it is pushed up,   x = OP + width/2  while it is pushed down,   held in between

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
width  movement of OP after a reversal until the stem follows [fraction of OP], >= 0
low, high  end stops [fraction of travel]; -inf and inf lift them

This is quasi_static_stem with f_s = f_c = width/2 (J = 0, S = width), so it shares its kernels and its events:
the reversals are located, not stepped over.  With integral action on a process that integrates, or nearly does, it
sustains a limit cycle once the loop is kicked; from rest it starts none.
Textbook model; its describing function is in any text on nonlinear control.  See also: quasi_static_stem.
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.massless_stem import MasslessStem
from stickslip.blocks.ports import Port, require
from stickslip.blocks.quasi_static_stem import QuasiStaticStem, started_between
from stickslip.blocks.role import Role
from stickslip.blocks.seen_stem import STUCK


class Deadband(MasslessStem):
    """Backlash of the given ``width`` [fraction of OP]; raises ``BlockError`` for a negative one.

    ``start``: MV at the start [unit of OP].

    >>> from stickslip.diagram import drive
    >>> drive(Deadband(0.1), 3.0, every=1.0, OP=([0, 1, 2, 3], [0.0, 0.5, 0.42, 0.3])).log["MV"].round(3).tolist()
    [0.0, 0.45, 0.45, 0.35]
    """

    role = Role.VALVE
    ports_in = (Port("OP"),)
    ports_out = (Port("MV"),)
    kernels = QuasiStaticStem.kernels
    modes = QuasiStaticStem.modes
    shown_by = QuasiStaticStem.shown_by
    limit_params = ("low", "high")

    def __init__(
        self, width: float, *, low: float = 0.0, high: float = 1.0, start: float = 0.0, name: str = "valve",
        **labels: Any,
    ) -> None:  # fmt: skip
        started_between(low, high, start, name)
        super().__init__(
            name=name,
            params={"width": width, "J": 0.0, "low": low, "high": high},
            memory={"mode": STUCK, "x": start},
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless width >= 0, J = 0 and low < high."""
        width, J = float(params["width"]), float(params["J"])
        require(width >= 0.0, name, "width", width, "a deadband is not negative", "give 0 or more")
        require(J == 0.0, name, "J", J, "a deadband does not jump", "use QuasiStaticStem(S=width, J=...)")
        QuasiStaticStem.check({"S": width, "J": 0.0, "low": params["low"], "high": params["high"]}, name)
