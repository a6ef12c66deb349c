"""A longer integral time, so that a stuck stem is pushed more slowly.

    T_i <- 3 T_i or 10 T_i

A stick-slip wave gets slower with T_i and dies where P action alone holds the stem.  Source: textbook.
"""

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "longer T_i"
AT_SHUTDOWN = False
NOT_FOR = "loads that the integral has to follow"


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    if at.T_i == float("inf"):
        return []
    return [
        Setting(f"T_i {factor * at.T_i:.3g} s", {"T_i": factor * at.T_i}, factors={"controller.T_i": factor})
        for factor in (3.0, 10.0)
    ]
