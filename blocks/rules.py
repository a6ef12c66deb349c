"""Rules that the parameters of many blocks keep; each raises ``BlockError`` with the value, the rule and the remedy."""

import math
from collections.abc import Mapping

from stickslip.blocks.ports import require


def finite(params: Mapping[str, float], name: str, *keys: str) -> None:
    """Raise ``BlockError`` unless the named parameters are finite numbers."""
    for key in keys:
        value = float(params[key])
        require(math.isfinite(value), name, key, value, "it must be a finite number", f"give {key} a number")


def positive(params: Mapping[str, float], name: str, *keys: str, remedy: str = "give SI units") -> None:
    """Raise ``BlockError`` unless the named parameters are positive and finite.

    >>> positive({"V": 0.0}, "C2_inlet", "V")
    Traceback (most recent call last):
    ...
    stickslip.blocks.ports.BlockError: C2_inlet: V = 0.0, but it must be positive and finite; give SI units
    """
    for key in keys:
        value = float(params[key])
        require(0.0 < value < math.inf, name, key, value, "it must be positive and finite", remedy)


def not_negative(
    params: Mapping[str, float], name: str, *keys: str, rule: str = "it must be finite and not negative",
    remedy: str = "give 0 or more",
) -> None:  # fmt: skip
    """Raise ``BlockError`` unless the named parameters are zero or positive, and finite."""
    for key in keys:
        value = float(params[key])
        require(0.0 <= value < math.inf, name, key, value, rule, remedy)


def check_limits(params: Mapping[str, float], name: str) -> None:
    """Raise ``BlockError`` unless ``low`` < ``high`` (either may be infinite)."""
    low, high = float(params["low"]), float(params["high"])
    require(low < high, name, "low", low, f"it must be below high = {high!r}", "exchange or correct the limits")


def check_scan(params: Mapping[str, float], name: str) -> None:
    """Raise ``BlockError`` unless ``dt`` and ``offset`` are a sampling period and a first sampling instant [s]."""
    finite(params, name, "dt", "offset")
    dt = float(params["dt"])
    require(dt > 0.0, name, "dt", dt, "it must be positive", "give the sampling period in seconds")
