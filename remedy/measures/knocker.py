"""Knocker: pulses on top of OP.  a = 0.35 S or 0.55 S, two scans long, every five scans.

Source and limits: ``stickslip.blocks.knocker`` (Hagglund 2002).
"""

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "knocker"
AT_SHUTDOWN = False
NOT_FOR = "worn packing, little air, a positioner with integral action"


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    return [
        Setting(
            f"pulses of {a:.3g} {at.op_unit} in the direction in which OP last moved, {2 * at.dt:g} s long, every "
            f"{5 * at.dt:g} s",
            {"a": a, "width": 2.0 * at.dt, "period": 5.0 * at.dt},
            {"knocker.a": a, "knocker.period": 5.0 * at.dt, "knocker.width": 2.0 * at.dt},
        )
        for a in (0.35 * at.S, 0.55 * at.S)
    ]
