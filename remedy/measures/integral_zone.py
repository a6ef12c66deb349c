"""Dead zone of the integral: it stands while PV is near SP.  zone = K J/2 or K J, and twice the noise.

Source and limits: ``stickslip.blocks.gap_pi`` (Shinskey 1996).
"""

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "integral dead zone"
AT_SHUTDOWN = False
NOT_FOR = "loops that must hold SP exactly"


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    zones = sorted({share * at.K * at.J + 2.0 * at.noise for share in (0.5, 1.0)} | {at.swing, 2.0 * at.swing})
    return [
        Setting(f"integral stands while |SP - PV| < {zone:.3g} {at.pv_unit}", {"zone": zone}, {"controller.zone": zone})
        for zone in zones if zone > 0.0
    ]  # fmt: skip
