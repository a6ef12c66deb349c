"""Lead-lag: a dynamic compensator, the usual element of feedforward and decoupling.

    G(s) = K (T_lead s + 1)/(T_lag s + 1)
    T_lag dx/dt = u - x,        y = K (x + T_lead/T_lag (u - x))

in   in  any signal, named second          out  out  the compensated signal, named first
K        gain [unit of out per unit of in]
T_lead   lead time [s], any sign, 0 for a lag         T_lag  lag time [s], > 0
start    input at which it starts settled [unit of in]

A step of the input jumps through by K T_lead/T_lag and then decays with T_lag.  A negative lead is an inverse response.
Valid for any input; noise is amplified by T_lead/T_lag.  Source: textbook, for example Seborg, Edgar and Mellichamp,
Process Dynamics and Control, 2nd ed. 2004, chapter 15 (feedforward control).
See also: first_order (a process, with dead time), sampled_filter.
"""

from collections.abc import Mapping

from stickslip.blocks.block import Kernels
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite, positive


def _out(x: float, in_: float, K: float, T_lead: float, T_lag: float) -> float:
    return K * (x + T_lead / T_lag * (in_ - x))


def _der(x: float, in_: float, T_lag: float) -> float:
    return (in_ - x) / T_lag


class LeadLag(OneToOne):
    """A lead-lag element with gain ``K``, lead time ``T_lead`` [s] and lag time ``T_lag`` [s].

    Raises ``BlockError`` unless K and T_lead are finite and T_lag > 0.

    >>> from stickslip.diagram import drive
    >>> drive(LeadLag("FF", "D", K=2.0, T_lead=3.0, T_lag=1.0), 2.0, every=1.0, D=1.0).log["FF"].round(4).tolist()
    [6.0, 3.4715, 2.5413]
    """

    role = Role.FILTER
    kernels = Kernels(out=_out, der=_der, linear=True)
    lag_param = "T_lag"

    def __init__(
        self,
        signal: str,
        source: str,
        T_lead: float,
        T_lag: float,
        *,
        K: float = 1.0,
        start: float = 0.0,
        unit: str = "",
        name: str = "",
    ) -> None:
        params = {"K": K, "T_lead": T_lead, "T_lag": T_lag}
        super().__init__(signal, source, params, states={"x": start}, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless K and T_lead are finite and T_lag > 0."""
        finite(params, name, "K", "T_lead")
        positive(params, name, "T_lag", remedy="give seconds; without a lag take a Gain")
