"""Gain schedule: the gain of the controller, and its integral action, change by ``slope`` per unit of PV.

K_p (1 + slope (PV - PV_0))                     PV_0: the first set point, where the model's gain is right
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, finite, known_first


def _out(SP: float, PV: float, slope: float, about: float) -> float:
    return PV + (1.0 + slope * (PV - about)) * (SP - PV)


class Scheduled(Block):
    """A set point whose error to PV is ``slope`` (PV - ``about``) larger, as a share.

    >>> Scheduled(2.0, about=0.5).output(0.0, [], [1.0, 0.75]).tolist()
    [1.125]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("SP"), Port("PV"))
    ports_out = (Port("out"),)
    kernels = Kernels(out=_out)

    def __init__(
        self, slope: float, about: float = 0.0, *, inputs: tuple[str, str] = ("SP", "PV"), name: str = ""
    ) -> None:
        super().__init__(name=name, params={"slope": slope, "about": about}, inputs=inputs)


class GainSchedule(Effect):
    """A controller whose gain depends on PV.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> loop = GainSchedule().insert(self_regulating_loop(), "controller", slope=0.5)
    >>> loop["controller:gain_schedule"].params["slope"]
    0.5
    """

    name = "gain_schedule"
    role = Role.CONTROLLER
    parameters = (Parameter("slope", "1/PV", 0.0, -3.0, 3.0),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the controller reads SP and PV, and answers their difference alone."""
        whole = block.params.get("b", 1.0) == 1.0
        return whole and all(block.loop_signal(part) in block.input_labels for part in ("SP", "PV"))

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with a set point whose error is larger."""
        sp, pv = (str(diagram[place].loop_signal(part)) for part in ("SP", "PV"))
        return diagram.insert(sp, Scheduled(0.0, inputs=(sp, pv), name=self.block(place)), readers=place)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the slope."""
        return {f"{self.block(place)}.slope": values["slope"]}

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram with the model's own gain at the first set point."""
        own = diagram[self.block(place)]
        about = known_first(first, map(str, own.input_labels), float(own.params["about"]))
        return diagram.with_params({f"{own.name}.about": about})

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return finite(values, "slope")
