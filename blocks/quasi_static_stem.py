"""The sticky stem without mass: what stick_slip becomes when its stem is infinitely faster than the loop.

    stuck    x held while |OP - x| <= f_s; then it slips to OP - dir f_c, dir = sgn(OP - x)
    sliding  x = OP - dir f_c while dir dOP/dt >= 0; on a reversal of OP it sticks where it is

    f_s = (S + J)/2 = F_s/k,   f_c = (S - J)/2 = F_c/k        (reduction of thesis eqs. 4.4 and 4.5)

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
S    movement of OP after a reversal until the stem breaks away [fraction of OP]
J    jump when it breaks away [fraction of OP], 0 <= J <= S
low, high  end stops [fraction of travel]; -inf and inf lift them

With the thesis's stem (modes at -115 and -335 1/s) and OP periods of 37 to 500 s it follows the full-mass stem
within about 0.01 s times the rate of OP, except for 0.1 s after a jump.  An OP that stands still does not stop a
sliding stem for good: it goes on from there without a new jump, as the full-mass stem does, which only creeps
towards rest; the sampled models of Kano and Choudhury stick there and need J more.  Where OP jumps back (a
sampled controller), the stem sticks where it was before the jump and then sees the new OP.

At a stop the stem rests (stuck) until OP pulls it away by more than f_s; so does one that is started beyond it.
Mode "ideal" is MV = OP, without stops.
Python-control, which knows no jumps, sees it with a little mass (``massless_stem``): MV is then a state.
A breakaway needs f_s plus 1e-12 of travel, so that rounding cannot free the stem, and 1e-9 where f_s = f_c.
See also: stick_slip (with mass), deadband (J = 0).
"""

import math
from collections.abc import Mapping
from typing import Any, Self

from stickslip.blocks.block import Kernels
from stickslip.blocks.massless_stem import MasslessStem
from stickslip.blocks.ports import BlockError, Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.seen_stem import DOWN, IDEAL, STUCK, UP

ROUNDING = 1e-12  # of travel
CREEP = 1e-8  # OP that moves slower than this [1/s] stands still: what a dead time gives of a held OP is not so exact
NOISE = 1e-9  # of travel: so little beyond the band may be the integration's error, while OP is on its way back


def sliding_at(OP: float, direction: float, S: float, J: float, low: float, high: float) -> float:
    """Return where a stem that slides in ``direction`` stands."""
    return min(max(OP - direction * 0.5 * (S - J), low), high)


def position(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    """Write where the stem stands."""
    if d[0] == STUCK:
        y[0] = d[1]
    elif d[0] == IDEAL:
        y[0] = u[0]
    else:  # towards the stop behind it no stem slides
        stem = u[0] - d[0] * 0.5 * (p[0] - p[1])
        y[0] = min(stem, p[3]) if d[0] == UP else max(stem, p[2])


def event_functions(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    """Write what breaks the stem away, or sticks it, when it exceeds zero."""
    g[0] = -1.0
    g[1] = -1.0
    if d[0] == STUCK:
        pull = u[0] - d[1]
        free = d[1] < p[3] if pull > 0.0 else d[1] > p[2]  # not through a stop
        if free:  # without a jump it would stick again at once, so that the integration's error must not free it
            g[0] = abs(pull) - 0.5 * (p[0] + p[1]) - (ROUNDING if p[1] > 0.0 else NOISE)
    elif d[0] != IDEAL:
        g[0] = -d[0] * u[1] - CREEP
        stem = u[0] - d[0] * 0.5 * (p[0] - p[1])
        ahead, behind = (stem - p[3], p[2] - stem) if d[0] == UP else (p[2] - stem, stem - p[3])
        g[1] = max(ahead, behind - NOISE)  # behind: it was started so


def transition(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    """Let a stem that stuck slide, and one that slid stick."""
    if d[0] == STUCK:
        d[0] = UP if u[0] > d[1] else DOWN
    else:
        d[1] = sliding_at(u[0], d[0], p[0], p[1], p[2], p[3])
        d[0] = STUCK


class QuasiStaticStem(MasslessStem):
    """A massless valve stem with the bands ``S`` and ``J``; defaults are the thesis's high stiction.

    ``start``: where the stem rests at the start [fraction of travel].
    Raises ``BlockError`` unless 0 <= J <= S and the stops are in order.

    >>> from stickslip.diagram import drive
    >>> valve = QuasiStaticStem(S=0.06, J=0.02)  # f_s = 0.04, f_c = 0.02
    >>> drive(valve, 3.0, every=1.0, OP=([0, 1, 2, 3], [0.0, 0.039, 0.1, 0.05])).log["MV"].round(3).tolist()
    [0.0, 0.0, 0.08, 0.08]
    """

    role = Role.VALVE
    ports_in = (Port("OP"),)
    ports_out = (Port("MV"),)
    kernels = Kernels(
        out=position,
        zc=event_functions,
        jump=transition,
        n_events=2,
        rates=True,
        rate_modes=(UP, DOWN),
        jumps=True,
        linear=True,
    )
    modes = {"stuck": STUCK, "sliding up": UP, "sliding down": DOWN, "ideal": IDEAL}
    shown_by = {"x": "MV"}  # a stem that slides keeps no place of its own
    limit_params = ("low", "high")

    def __init__(
        self, S: float = 3500.0 / 52500.0, J: float = 1000.0 / 52500.0, *, low: float = 0.0, high: float = 1.0,
        start: float = 0.0, name: str = "valve", **labels: Any,
    ) -> None:  # fmt: skip
        started_between(low, high, start, name)
        super().__init__(
            name=name,
            params={"S": S, "J": J, "low": low, "high": high},
            memory={"mode": STUCK, "x": start},
            **labels,
        )

    @classmethod
    def from_friction(cls, f_s: float, f_c: float, **keywords: Any) -> Self:
        """Return the stem with the static and Coulomb friction bands ``f_s`` >= ``f_c`` [fraction of OP].

        >>> valve = QuasiStaticStem.from_friction(f_s=0.04, f_c=0.02)
        >>> round(valve.f_s, 12), round(valve.f_c, 12)
        (0.04, 0.02)
        """
        return cls(f_s + f_c, f_s - f_c, **keywords)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless 0 <= J <= S and low < high."""
        S, J = float(params["S"]), float(params["J"])
        require(0.0 <= S < math.inf, name, "S", S, "a band is finite and not negative", "give 0 or more")
        require(0.0 <= J <= S, name, "J", J, f"0 <= J <= S = {S} is needed", "a jump is part of S; lower J or raise S")
        check_stops(params, name)

    def param_index(self, key: str) -> int:
        """Return where a parameter stands in ``p``; a stem without mass has bands instead of forces.

        Raises ``BlockError`` for F_s, F_c and k, naming the bands, and for an unknown name.
        """
        if key in ("F_s", "F_c", "k"):
            raise BlockError(
                f"block '{self.name}' has no parameter '{key}', for its stem has no mass; give the bands "
                "S = (F_s + F_c)/k and J = (F_s - F_c)/k, or take a StickSlip"
            )
        return super().param_index(key)

    @property
    def S(self) -> float:
        """Movement of OP after a reversal until the stem breaks away [fraction of OP]."""
        return float(self.p[0])

    @property
    def J(self) -> float:
        """Slip jump [fraction of OP]."""
        return float(self.p[1])

    @property
    def f_s(self) -> float:
        """Static friction band (S + J)/2 [fraction of OP]."""
        return (self.S + self.J) / 2.0

    @property
    def f_c(self) -> float:
        """Coulomb friction band (S - J)/2 [fraction of OP]."""
        return (self.S - self.J) / 2.0


def started_between(low: float, high: float, start: float, name: str) -> None:
    """Raise ``BlockError`` unless a stem starts between its stops."""
    require(low <= start <= high, name, "start", start, f"the stops are at {low} and {high}", "start between them")


def check_stops(params: Mapping[str, float], name: str) -> None:
    """Raise ``BlockError`` unless the stops are in order, low < high."""
    low, high = float(params["low"]), float(params["high"])
    require(low < high, name, "high", high, f"the upper stop lies above the lower one, {low}", "raise high")
