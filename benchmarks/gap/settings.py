"""The loops of the benchmark: their numbers without an effect, their nuisances, how they are excited and logged.

ideal, coarse   the flow loop, continuous; sensor noise only; logged exactly, or rounded
site            the flow loop scanned, with an unmeasured load and tolerances, logged every 5 s
second_order    a process of two lags and a dead time, otherwise as site
level           an integrating level with its PI, otherwise as site
cascade         a level whose controller moves the set point of a flow loop, otherwise as site
"""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Setting:
    """One loop: ``numbers`` of ``physics`` that differ from the neutral ones, and what surrounds it.

    ``within``: number -> share within which the true one lies anywhere (time constants of one process move together).
    ``noise``, ``load``: standard deviations [PV unit, process input unit]; ``hours`` of a record; ``every`` [s] a row;
    ``rounding`` of PV and of OP and MV; ``levels`` of the set point and how long each stays, ``dwell`` [s].  Sizes of
    effects are scaled by ``slow`` (times) and ``span`` (what is in units of PV).
    """

    numbers: Mapping[str, float] = field(default_factory=dict)
    within: Mapping[str, float] = field(default_factory=dict)
    noise: float = 0.004
    load: float = 0.0
    hours: float = 2.0
    every: int = 1
    rounding: tuple[float, float] = (1e-6, 1e-6)
    levels: tuple[float, float] = (1.05, 1.95)
    dwell: tuple[float, float] = (60.0, 480.0)
    slow: float = 1.0
    span: float = 1.0

    @property
    def scanned(self) -> bool:
        """Whether the controller scans: then the setting is as a site gives it."""
        return self.numbers.get("scan", 0.0) > 0.0


LOAD_TIME = 60.0  # time constant of the load [s]
SITE = {"load": 0.01, "hours": 4.0, "every": 5, "rounding": (1.5e-3, 1e-3)}
SETTINGS: Mapping[str, Setting] = {
    "ideal": Setting(),
    "coarse": Setting(rounding=(1e-3, 1e-3)),
    "site": Setting({"scan": 1.0}, {"K": 0.05, "tau": 0.1}, **SITE),
    "second_order": Setting(
        {"scan": 1.0, "second": 4.0, "theta": 2.0, "K_p": 0.25, "T_i": 12.0}, {"K": 0.05, "tau": 0.1}, **SITE
    ),
    "level": Setting(
        {"scan": 1.0, "K": 1.0, "tau": 200.0, "integrating": 1.0, "outflow": 0.5, "K_p": 4.0, "T_i": 400.0},
        {"tau": 0.1}, noise=0.002, levels=(0.4, 0.6), dwell=(600.0, 2400.0), slow=5.0, span=0.15,
        **{**SITE, "rounding": (5e-4, 1e-3)},
    ),
    "cascade": Setting(
        {
            "scan": 1.0, "K": 1.0, "tau": 3.0, "K_p": 0.5, "T_i": 3.0,
            "outer_K": 4.0, "outer_T": 400.0, "outer_noise": 0.002, "vessel": 200.0, "outflow": 0.5,
        },
        {"K": 0.05, "tau": 0.1}, noise=0.004, levels=(0.4, 0.6), dwell=(600.0, 2400.0), slow=0.5, span=0.3,
        **{**SITE, "rounding": (5e-4, 1e-3)},
    ),
}  # fmt: skip
