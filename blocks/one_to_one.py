"""The base of blocks that make one signal of another.

in   in  the signal named second          out  out  the signal named first
See also: sources (blocks without inputs), arithmetic, saturation, dead_zone, lookup_1d, rate_limiter, relay, lead_lag.
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.ports import Port


class OneToOne(Block):
    """A block that makes ``signal`` of ``source``; it bears the name of its signal unless ``name`` says otherwise.

    Subclasses fill in the class data and call ``__init__`` with their parameters.  ``unit`` is the unit of the output;
    where ``same_unit`` is set it is that of the input too.
    """

    ports_in = (Port("in"),)
    ports_out = (Port("out"),)
    same_unit = False

    def __init__(
        self, signal: str, source: str, params: Mapping[str, float], *, unit: str, name: str, **data: Any
    ) -> None:
        units = {"out": unit} | ({"in": unit} if self.same_unit else {})
        super().__init__(name=name or signal, params=params, inputs=source, outputs=signal, units=units, **data)
