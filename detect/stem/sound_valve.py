"""Moves of OP that a sound valve need not follow, and those that it must, in % of OP's span.

A control valve shall follow moves of 1 % (EnTech, Control Valve Dynamic Specification 3.0, 1998), one with a positioner
follows 0.1 to 0.5 %.
"""

NEED_NOT_MOVE_PERCENT = 1.0
MUST_MOVE_PERCENT = 2.0
