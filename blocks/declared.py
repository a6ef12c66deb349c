"""The declarations of a block, and the facts that follow from them: ports, role, sampling, limits."""

import math
from collections.abc import Mapping
from datetime import datetime

from stickslip.blocks.kernels import Floats, Host, Kernels
from stickslip.blocks.ports import BlockError, Port, nearest
from stickslip.blocks.role import Role

STUCK_MODE, FREE_MODE = "stuck", "ideal"  # the names that these two modes of a valve have in every block
PARTS = ("SP", "PV", "OP", "MV")


class Declared:
    """The class data of a block, which subclasses fill in, and what they say about it.

    Class data: ``role``, ``ports_in``, ``ports_out``, ``kernels``, ``modes`` (name -> value of ``d[0]``),
    ``discrete`` (memories that hold a mode or a count), ``shown_by`` (memory that is kept only now and then -> the
    output port that shows it at any time), ``period_param`` and ``offset_param`` (sampled blocks),
    ``dead_time_param`` (delays all inputs in the engine) and ``before_param`` (what they were before the start),
    ``limit_params`` (low and high end of the output), ``lag_param`` (time constant of a first-order lag),
    ``one_unit`` (ports whose signals have one unit, as far as theirs is stated),
    ``plays`` (part in a loop -> port that plays it, where the port has another name; see ``loop_signal``).
    """

    role: Role = Role.PROCESS
    plays: Mapping[str, str] = {}
    ports_in: tuple[Port, ...] = ()
    ports_out: tuple[Port, ...] = ()
    kernels: Kernels = Kernels()
    modes: Mapping[str, float] = {}
    discrete: tuple[str, ...] = ("mode",)
    shown_by: Mapping[str, str] = {}
    period_param: str | None = None
    offset_param: str | None = None
    dead_time_param: str | None = None
    before_param: str | None = None
    limit_params: tuple[str, str] | None = None
    lag_param: str | None = None
    one_unit: tuple[str, ...] = ()
    host: Host | None = None
    tolerances: Mapping[str, float] = {}
    clock: datetime | None = None  # the moment of time 0, of a block that plays recorded moments

    name: str
    input_labels: list[str]
    output_labels: list[str]
    param_names: tuple[str, ...]
    p: Floats
    d0: Floats
    timetable: Floats | None

    @property
    def sampled(self) -> bool:
        """Whether the block runs at its own sampling instants."""
        return self.period_param is not None

    @property
    def takes_samples(self) -> bool:
        """Whether the block does something at sampling instants, be they periodic or listed in its timetable."""
        return self.sampled or (self.timetable is not None and self.kernels.step is not None)

    @property
    def period(self) -> float:
        """Sampling period [s]; 0 for a continuous block."""
        return float(self.p[self.param_names.index(self.period_param)]) if self.period_param else 0.0

    @property
    def dead_time(self) -> float:
        """Dead time of all inputs [s]; 0 if there is none."""
        return float(self.p[self.param_names.index(self.dead_time_param)]) if self.dead_time_param else 0.0

    @property
    def value_before(self) -> float:
        """The inputs before the start, which leave the dead time first; 0 unless a parameter gives them."""
        return float(self.p[self.param_names.index(self.before_param)]) if self.before_param else 0.0

    @property
    def limits(self) -> tuple[float, float]:
        """Low and high end of the output in its unit, infinite where there is none."""
        if self.limit_params is None:
            return -math.inf, math.inf
        low, high = (float(self.p[self.param_names.index(key)]) for key in self.limit_params)
        return low, high

    def loop_signal(self, part: str) -> str | None:
        """Return the signal at the port that plays ``part`` in a loop (SP, PV, OP or MV), None if no port does.

        A port plays the part it is named after, unless the block's ``plays`` says that another does.

        >>> from stickslip.blocks import AntiSurge, PI
        >>> PI(1.0, 10.0, inputs=["level_SP", "level"]).loop_signal("PV"), AntiSurge().loop_signal("PV")
        ('level', 'q')
        """
        wanted = self.plays.get(part, part)
        ports = zip((*self.ports_in, *self.ports_out), (*self.input_labels, *self.output_labels), strict=True)
        return next((str(label) for port, label in ports if port.name == wanted), None)

    @property
    def can_stick(self) -> bool:
        """Whether the block is a valve with a mode in which its stem is stuck."""
        return self.role is Role.VALVE and STUCK_MODE in self.modes

    @property
    def mode(self) -> str | None:
        """Name of the present mode, if the block has modes."""
        return next((m for m, value in self.modes.items() if self.d0[0] == value), None) if self.modes else None

    def param_index(self, key: str) -> int:
        """Return where a parameter stands in ``p``; raise ``BlockError`` with the nearest name if it does not."""
        if key not in self.param_names:
            known = list(self.param_names)
            raise BlockError(f"block '{self.name}' has no parameter '{key}'; {nearest(key, known)}")
        return self.param_names.index(key)
