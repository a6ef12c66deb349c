"""A positioner that is there or is put there, tuned: what stays of the stick is its resolution.

    S <- S / 5, J <- J / 5,   of a good valve at most 1 % of span (ANSI/ISA-75.25: dead band below 1 % is usual)

It takes the valve in hand, so it belongs to a shutdown or to a bypass.  About a larger jump it hunts itself.
"""

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "tuned positioner"
AT_SHUTDOWN = True
NOT_FOR = "a stem that jumps more than the positioner's band"


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    return [Setting("dead travel a fifth of today's", {"S": 0.2 * at.S}, factors={"stick": 0.2})]
