"""The ideal loops of the thesis: PI controller, sticky valve, one process.

    SP -> controller -> OP -> valve -> MV -> process -> PV

All signals are fractions: OP and MV of full travel, SP and PV of the measurement.
"""

from stickslip.blocks import PI, FirstOrder, Integrator, Step, StickSlip
from stickslip.diagram import Diagram, wire


def self_regulating_loop(
    K: float = 3.0,
    tau: float = 10.0,
    K_p: float = 0.4,
    T_i: float = 10.0,
    F_s: float = 2250.0,
    setpoint: float = 0.5,
    name: str = "self_regulating_loop",
) -> Diagram:
    """Return the loop of eq. 6.2: process K / (tau s + 1), controller K_p (T_i s + 1) / (T_i s), stem eqs 4.4-4.5.

    Units: ``tau``, ``T_i`` [s], ``F_s`` [N], the rest [-].  Starts at rest; the set point steps at t = 0.

    >>> self_regulating_loop().signals
    ('SP', 'OP', 'MV', 'PV')
    """
    return wire(
        [
            Step("SP", after=setpoint),
            PI(K_p=K_p, T_i=T_i, low=float("-inf"), high=float("inf"), spans={"OP": (0.0, 1.0)}),
            StickSlip(F_s=F_s),
            FirstOrder(K=K, tau=tau),
        ],
        name=name,
    )


def integrating_loop(
    K: float = 3.0,
    T: float = 10.0,
    K_p: float = 0.2,
    T_i: float = 400.0,
    F_s: float = 2250.0,
    setpoint: float = 0.0,
    name: str = "integrating_loop",
) -> Diagram:
    """Return the loop of eq. 7.4: process K / (T s), controller K_p (T_i s + 1) / (T_i s), stem eqs 4.4-4.5.

    Units as in ``self_regulating_loop``.  OP and MV are deviations from mid travel, so that they span
    -0.5 to 0.5; negative travel is allowed, as in the thesis.
    """
    return wire(
        [
            Step("SP", after=setpoint),
            PI(K_p=K_p, T_i=T_i, low=float("-inf"), high=float("inf"), spans={"OP": (-0.5, 0.5)}),
            StickSlip(F_s=F_s, low=float("-inf"), high=float("inf")),
            Integrator(K=K, T=T),
        ],
        name=name,
    )
