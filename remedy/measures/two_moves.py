"""Two moves to where the stem should rest, then rest.  band = 4 noise or 1.5 K J, pause = 3 (lag + theta).

Source and limits: ``stickslip.blocks.two_move`` (Srinivasan and Rengaswamy 2008; Cuadros et al. 2012).
"""

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "two moves"
AT_SHUTDOWN = False
NOT_FOR = "loads that move within a few periods, processes that integrate"


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    if at.integrating:
        return []
    pause = max(3.0 * (at.lag + at.theta), 2.0 * at.dt)
    return [
        Setting(
            f"after two waves OP goes to their mean +- {at.S:.3g} for {pause:.3g} s, then to -+ "
            f"{0.5 * (at.S - at.J):.2g} {at.op_unit} of it and rests; the controller takes over again when PV is "
            f"{band:.3g} {at.pv_unit} off SP",
            {"S": at.S, "J": at.J, "band": band, "pause": pause},
            {"two_move.S": at.S, "two_move.J": at.J, "two_move.band": band, "two_move.pause": pause},
        )
        for band in sorted({max(4.0 * at.noise, 1.5 * at.K * at.J), 3.0 * at.swing})
        if band > 0.0
    ]
