"""Gap on the error: the controller does nothing while PV is near SP.  gap = K J/2, and twice the noise.

Source and limits: ``stickslip.blocks.gap_pi`` (Shinskey 1996).
"""

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "error gap"
AT_SHUTDOWN = False
NOT_FOR = "loops that must hold SP exactly"


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    gaps = sorted({0.5 * at.K * at.J + 2.0 * at.noise, at.swing})
    return [
        Setting(
            f"no action while |SP - PV| < {gap:.3g} {at.pv_unit}, and beyond it on what is beyond", {"gap": gap},
            {"controller.gap": gap},
        )
        for gap in gaps if gap > 0.0
    ]  # fmt: skip
