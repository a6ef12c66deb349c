"""A filter of first order that a control system computes at scan times.

    y_k = y_(k-1) + (1 - exp(-dt/tau)) (u_k - y_(k-1))

in   in  any signal, named second          out  out  the filtered signal, held between samples, named first
dt   scan time [s], > 0     offset  first scan [s]      tau  time constant [s], >= 0, 0: no filter
start    y before the first scan [unit of the signal]

What a control system computes: each sample counts as if the input had stood there since the one before.
Python-control sees the continuous lag in its place.
Valid for any dt.  Source: Astrom and Wittenmark, Computer-Controlled Systems, 3rd ed. 1997, chapter 2.
See also: biquad, zero_order_hold, lead_lag (continuous), sensor, the Kalman prefilter in ``online``.
"""

import math
from collections.abc import Mapping

from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_scan, not_negative


def _lag_step(y: float, in_: float, tau: float, dt: float) -> tuple[float, float]:
    y += (1.0 - math.exp(-dt / tau) if tau > 0.0 else 1.0) * (in_ - y)
    return y, y


class SampledFilter(OneToOne):
    """A first-order filter with the time constant ``tau`` [s], computed every ``dt`` [s].

    Raises ``BlockError`` unless tau >= 0 and dt > 0.

    >>> from stickslip.diagram import drive
    >>> drive(SampledFilter("PV_f", "PV", tau=2.0, dt=1.0), 3.0, every=1.0, PV=1.0).log["PV_f"].round(4).tolist()
    [0.3935, 0.6321, 0.7769, 0.8647]
    """

    role = Role.FILTER
    kernels = Kernels(step=_lag_step)
    period_param = "dt"
    offset_param = "offset"
    same_unit = True

    def __init__(
        self, signal: str, source: str, tau: float, dt: float, *, offset: float = 0.0, start: float = 0.0,
        unit: str = "", name: str = "",
    ) -> None:  # fmt: skip
        super().__init__(
            signal,
            source,
            {"tau": tau, "dt": dt, "offset": offset},
            memory={"y": start},
            start_output=[start],
            unit=unit,
            name=name,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless tau >= 0 and dt > 0."""
        not_negative(params, name, "tau", remedy="give seconds, or 0 for no filter")
        check_scan(params, name)

    def smooth(self) -> Block:
        """Return the continuous lag that python-control sees."""
        tau, unit = float(self.p[0]), self.units["out"]
        if tau == 0.0:
            return Gain(self.output_labels[0], self.input_labels[0], 1.0, unit=unit, name=self.name)
        return FirstOrder(
            1.0,
            tau,
            start=float(self.d0[0]),
            name=self.name,
            inputs=self.input_labels,
            outputs=self.output_labels,
            units={"MV": unit, "PV": unit},
        )
