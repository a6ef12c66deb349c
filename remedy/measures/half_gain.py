"""Half the gain, the usual first advice; here it is tried like the others.

K_p <- K_p / 2          waves of stick grow where the loop is slower than the stem's jump asks
"""

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "half the gain"
AT_SHUTDOWN = False
NOT_FOR = "stick: the waves stay or grow"


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    return [Setting(f"K_p {0.5 * at.K_p:.3g}", {"K_p": 0.5 * at.K_p}, factors={"controller.K_p": 0.5})]
