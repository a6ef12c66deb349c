"""A detector as the other rooms know it: a card, and a function from a record to a verdict."""

from typing import Protocol, runtime_checkable

from stickslip.detect.card import Card
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.verdict import Verdict
from stickslip.logs import LoopRecord


@runtime_checkable
class Method(Protocol):
    """A module or any other object with these two names; it need not belong to this package.

    Optional beside them: ``draw(verdict, figure)``, the picture of its evidence, and for streaming ``Params``,
    ``init``, ``update`` and ``verdict`` (see ``stream``). A method whose card says ``experimental`` is shown, marked.

    >>> from stickslip.detect.methods import area_ratio
    >>> isinstance(area_ratio, Method)
    True
    """

    CARD: Card

    def detect(self, record: LoopRecord | Prepared) -> Verdict:
        """The verdict on one loop."""
        ...
