"""Sticky valve with one band, sampled (Stenman, Gustafsson & Forsman 2003).

    MV = MV before   while |OP - MV before| <= d
    MV = OP          otherwise

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
d    stickband and jump in one [unit of OP], >= 0: S = J = d                 dt  sampling period [s]
low, high  ends of the span [unit of OP], which OP is clipped to; -inf and inf lift them

Source: A. Stenman, F. Gustafsson, K. Forsman, A segmentation-based method for detection of stiction in control
valves, Int. J. Adaptive Control and Signal Processing 17 (2003) 625-634.
After a jump the stem is where the controller wants it, so there is no deadband; real valves have one.
Valid for a first guess and for one-parameter fits.  See also: he_valve, kano_valve.
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.sampled_valve import SampledValve, check_band, check_sampling


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    op = min(max(u[0], p[1]), p[2])
    if abs(op - d[0]) > p[0] or op == p[1] or op == p[2]:
        d[0] = op
    y[0] = d[0]


class StenmanValve(SampledValve):
    """The sampled one-parameter valve with band ``d`` [unit of OP] and sampling period ``dt`` [s].

    ``start`` is where MV stands before the first sample.  Raises ``BlockError`` unless 0 <= d <= high - low and
    dt > 0.

    >>> from stickslip.diagram import drive
    >>> valve = StenmanValve(d=0.04, dt=1.0, start=0.5)
    >>> drive(valve, 3.0, every=1.0, OP=([0, 1, 2, 3], [0.5, 0.53, 0.56, 0.59])).log["MV"].round(3).tolist()
    [0.5, 0.5, 0.56, 0.56]
    """

    kernels = Kernels(step=_step)

    def __init__(
        self, d: float, dt: float, *, low: float = 0.0, high: float = 1.0, start: float = 0.0, name: str = "valve",
        **labels: Any,
    ) -> None:  # fmt: skip
        super().__init__(
            name=name,
            params={"d": d, "low": low, "high": high, "dt": dt},
            memory={"MV": start},
            start_output=start,
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless 0 <= d <= high - low and dt > 0."""
        check_sampling(params, name)
        check_band(params, name, "d")
