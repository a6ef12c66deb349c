"""Historian: the plant's archive, which reads signals and gives none.

in   the signals named

It does nothing in a run: how often a log was taken and how it was rounded is read off the log.  It is the place of what
happens to signals after everyone has used them, such as compression (``stickslip.gap.effects``).
Source: textbook.  See also: sensor (what happens to a signal before it is used).
"""

from collections.abc import Sequence
from typing import Any

from stickslip.blocks.arguments import texts
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import BlockError, Port
from stickslip.blocks.role import Role


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    pass


class Historian(Block):
    """The archive of some signals.

    ``signals``: their names.  Raises ``BlockError`` if there is none.

    >>> Historian(["SP", "PV", "OP"]).input_labels
    ['SP', 'PV', 'OP']
    """

    role = Role.HISTORIAN
    kernels = Kernels(out=_out)

    def __init__(self, signals: str | Sequence[str], *, name: str = "historian") -> None:
        kept = texts(name, "signals", signals)
        if not kept:
            raise BlockError(f"{name}: signals = {signals!r}, but a historian keeps at least one; name it")
        self.ports_in = tuple(Port(signal) for signal in kept)
        super().__init__(name=name, params={})
