"""What a remedy changes in a fitted loop: parameters of the trial's blocks, and the same in the controller's terms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

__all__ = ["Setting", "Situation"]


@dataclass(frozen=True)
class Situation:
    """What a remedy is set by: medians of the fitted loops.

    K_p, T_i, dt : of the controller, K_p with its sign;  S, J : [unit of OP];  K : without its sign
    lag, theta : sum of the lags, dead time [s];  noise, swing : standard deviations of noise and of e [unit of PV]
    gain_known : whether the record tells K;  op_unit, pv_unit : for the words
    """

    K_p: float
    T_i: float
    dt: float
    S: float
    J: float
    K: float
    lag: float
    theta: float
    noise: float
    swing: float
    integrating: bool
    gain_known: bool
    op_unit: str
    pv_unit: str


@dataclass(frozen=True)
class Setting:
    """One way to set a remedy: ``params`` block.parameter -> value, ``factors`` by which a loop's own is multiplied.

    The factor ``stick`` is that of S and J.
    ``values`` are the settings by name and ``words`` the same as a person enters them.
    """

    words: str
    values: Mapping[str, float]
    params: Mapping[str, float] = field(default_factory=dict)
    factors: Mapping[str, float] = field(default_factory=dict)
