"""The valve repaired: no stick is left.

    S = J = 0

What a new packing or a new valve can give at best; some friction stays in any valve.
"""

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "valve repaired"
AT_SHUTDOWN = True
NOT_FOR = ""
FREE = Setting("no stick is left", {"S": 0.0, "J": 0.0}, factors={"stick": 0.0})


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    return [FREE]
