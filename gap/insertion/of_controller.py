"""A lead and a lag in the path of one signal, and what a controller computes of SP or PV before it uses them.

y = r u + (1 - r) x,    lag dx/dt = u - x                      r: lead as a share of the lag
at scans, each dt:      x_k = x_(k-1) + s (u_k - x_(k-1)),     s = dt/(lag + dt)
or, a scan late:        x_k = x_(k-1) + s (u_(k-1) - x_(k-1)), s = dt/lag
"""

from collections.abc import Mapping
from typing import ClassVar

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.inserted import Inserted


def _step(x: float, in_: float, ratio: float, share: float, late: float) -> tuple[float, float]:
    if late == 0.0:
        x += share * (in_ - x)
    shown = ratio * in_ + (1.0 - ratio) * x
    if late != 0.0:
        x += share * (in_ - x)
    return x, shown


class AtScans(OneToOne):
    """What a controller computes of one signal at its scans; subclasses give ``kernels`` and ``memories``."""

    role = Role.FILTER
    period_param = "dt"
    offset_param = "offset"
    same_unit = True
    memories: ClassVar[tuple[str, ...]] = ("x",)

    def __init__(
        self, signal: str, source: str, params: Mapping[str, float], *, dt: float, offset: float = 0.0, name: str = ""
    ) -> None:
        memory, given = dict.fromkeys(self.memories, 0.0), {**params, "dt": dt, "offset": offset}
        super().__init__(signal, source, given, memory=memory, start_output=[0.0], unit="", name=name)


class ScannedLeadLag(AtScans):
    """A lead and a lag that a controller computes at its scans; ``late``: the lag takes in what was read a scan ago.

    >>> from stickslip.diagram import drive
    >>> lead = ScannedLeadLag("y", "u", {"ratio": 3.0, "share": 0.5, "late": 0.0}, dt=1.0)
    >>> drive(lead, 2.0, every=1.0, u=1.0).log["y"].tolist()
    [2.0, 1.5, 1.25]
    """

    kernels = Kernels(step=_step)


class OfController(Inserted):
    """An effect in what a controller ``reads``, SP or PV; one that scans computes it at its scans.

    ``own``: the parameters that do the same in a controller that has them, by the names that the effect has for them.
    """

    role = Role.CONTROLLER
    where = "before"
    reads = ("SP",)
    own: ClassVar[tuple[str, ...]] = ()

    def has(self, controller: Block) -> bool:
        """Return whether a controller has parameters for the effect."""
        return bool(self.own) and {*self.own} <= {*controller.param_names}

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the block of the effect, as it is for a controller that has parameters for it."""
        return diagram if self.has(diagram[place]) else super().put(diagram, place)

    def nominal(self, diagram: Diagram, place: str) -> dict[str, float]:
        """Return the neutral values; of a controller that has parameters for the effect what they are."""
        controller = diagram[place]
        found = super().nominal(diagram, place)
        return found | {key: controller.params[key] for key in self.own} if self.has(controller) else found

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram with the block of the effect settled, as it is where there is none."""
        return diagram if self.has(diagram[place]) else super().started(diagram, place, first)

    def enters(self, diagram: Diagram, block: Block) -> str | None:
        """Return the signal in whose path the effect lies, None if the controller does not read it."""
        found = block.loop_signal(*self.reads)
        return str(found) if found in block.input_labels else None

    def scans(self, controller: Block) -> dict[str, float]:
        """Return when a controller scans."""
        return {"dt": controller.period, "offset": controller.params.get(controller.offset_param or "", 0.0)}

    def late(self, controller: Block) -> float:
        """Return 1 for a controller that scans and whose integral takes in the previous error, else 0."""
        return float(controller.params.get("present") == 0.0)
