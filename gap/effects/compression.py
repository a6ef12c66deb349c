"""Compression: the historian keeps PV to within ``deviation`` [unit of PV] by a swinging door
(``stickslip.logs.dirt``).

It acts on the log only: the controller has seen the true PV.
"""

from collections.abc import Mapping

from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, EffectError, Parameter, not_below
from stickslip.logs import Log
from stickslip.logs.dirt import swinging_door


class Compression(Effect):
    """A historian that compresses; ``signals`` are those it compresses, PV unless others are named.

    >>> log = Log(t=[0, 1, 2, 3], signals={"PV": [0.0, 0.9, 2.1, 3.0], "OP": [0.0, 1.0, 0.0, 1.0]})
    >>> Compression().on_log(log, deviation=0.2)["PV"].tolist()
    [0.0, 1.0, 2.0, 3.0]
    """

    name = "compression"
    role = Role.HISTORIAN
    parameters = (Parameter("deviation", "PV", 0.0, 0.0005, 0.2, "log"),)
    of_log = True

    def __init__(self, *signals: str) -> None:
        self.signals = signals or ("PV",)

    def log_with(self, log: Log, place: str, values: Mapping[str, float]) -> Log:
        """Return the log with its signals as the historian gives them back.

        Raises ``EffectError`` for a negative deviation.
        """
        wrong = not_below(values, {"deviation": 0.0})
        if wrong:
            raise EffectError(f"compression: {wrong}")
        found = [signal for signal in self.signals if signal in log]
        return swinging_door(log, values["deviation"], found) if values["deviation"] > 0.0 else log

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"deviation": 0.0})
