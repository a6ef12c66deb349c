"""Programs: the calls of one kernel of several blocks, written out so that the engine only has to play them."""

from collections.abc import Iterable, Sequence

from stickslip.engine import layout as at
from stickslip.engine.flat import FlatBlock, Ints

TARGETS = {at.A_OUT: (at.O_S, at.Y), at.A_DER: (at.O_F, at.X), at.A_ZC: (at.O_G, at.G)}  # where each kernel writes


class Programs:
    """Writes programs for the blocks of one component, whose header and table are complete.

    ``reads[b]``: the component's signals that block ``b`` reads.
    """

    def __init__(self, blocks: Sequence[FlatBlock], header: Ints, table: Ints, reads: Sequence[Sequence[int]]) -> None:
        self.blocks, self.header, self.table, self.reads = blocks, header, table, reads

    def calls(self, kernel: int, numbers: Iterable[int]) -> list[list[int]]:
        """Return the calls of ``kernel`` (``A_OUT``, ``A_DER`` or ``A_ZC``) of the given blocks, in their order."""
        return [self._call(kernel, number) for number in numbers]

    def _call(self, kernel: int, number: int) -> list[int]:
        block, row, header = self.blocks[number], self.table[number], self.header
        stretch, offset = TARGETS[kernel]
        out = int(header[stretch] + row[offset])
        if block.kind in at.REPLAYING:
            return [0, at.H + number * at.R, 0, 0, 0, out, 0]
        x = int(header[at.O_X] + row[at.X])
        inputs = self._inputs(kernel, number)
        return [int(row[kernel]), x, int(row[at.D]), int(row[at.U]), int(row[at.P]), out, len(inputs), *inputs]

    def _inputs(self, kernel: int, number: int) -> list[int]:
        """Return what must be copied in front of the call."""
        block, row, header = self.blocks[number], self.table[number], self.header
        if not row[at.GATHER] or (kernel == at.A_OUT and not block.feeds):
            return []
        read = list(self.reads[number])
        rates = [int(header[at.O_RATE]) + signal for signal in read] if kernel == at.A_ZC and block.rates else []
        return [int(header[at.O_S]) + signal for signal in read] + rates
