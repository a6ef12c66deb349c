"""Constant reinforcement: a constant on top of OP in the way that it goes.  a = (S - J)/2 or S/2.

Source and limits: ``stickslip.blocks.constant_reinforcement`` (Ivan and Lakshminarayanan 2009).
"""

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "constant reinforcement"
AT_SHUTDOWN = False
NOT_FOR = "noise in OP, a size of stick that changes, a valve with positioner"


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    hold = 3.0 * abs(at.K_p) * at.noise
    return [
        Setting(
            f"{a:.3g} {at.op_unit} added in the direction in which OP moves; its sign changes when OP has gone back by "
            f"{hold:.2g}",
            {"a": a, "hold": hold}, {"reinforcement.a": a, "reinforcement.hold": hold},
        )
        for a in (0.5 * (at.S - at.J), 0.5 * at.S) if a > 0.0
    ]  # fmt: skip
