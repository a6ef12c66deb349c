"""A second lag of the process, of time constant ``tau`` [s], behind the one that the model has."""

from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.lag import Lag


class SecondLag(Lag):
    """A process of one order more.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> SecondLag().insert(self_regulating_loop(), "process", tau=2.0)["process:second_lag"].params["tau"]
    2.0
    """

    name = "second_lag"
    role = Role.PROCESS
    where = "at"

    def own(self, diagram: Diagram, place: str) -> str | None:
        """Return None: it is one more lag, whatever lags the process has."""
        return None
