"""Whether an absolute tolerance was small enough for the signals of a run.

A step's error is kept below atol + rtol |x| for each state x.  Where |x| stays below atol, that allows errors as large
as the state, and the run still ends with status OK.  So the rule: a block with states whose outputs and states all
stayed below ``SHARE`` atol, and were more than rounding, is named, with an atol that suits it.

Limits: only what is logged and the states at the start and the end are looked at; a block with one large and one small
state counts as large.
"""

from collections.abc import Mapping, Sequence

from blocks.block import Block

SHARE = 10.0  # atol is small against a block that reaches this many times atol
FINE = 1e-4  # the atol recommended, as a share of what the block reaches
ROUNDING = 1e-12  # of the largest signal: less is no signal


class ToleranceWarning(UserWarning):
    """The absolute tolerance of a run is as large as some of its signals."""


def too_coarse(blocks: Sequence[Block], sizes: Mapping[str, float], states: Mapping[str, float], atol: float) -> str:
    """Return a note that names the blocks for which ``atol`` was too large, "" if there are none.

    ``sizes``: largest absolute value by signal, of those logged; ``states``: the same by block, of its states.

    >>> from blocks import FirstOrder, Step
    >>> from diagram import wire
    >>> loop = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)])
    >>> too_coarse(loop.blocks, {"PV": 2.0}, {"process": 1.9}, 1.0)
    'atol = 1 is not small against process (at most 2 in this run): its error may be as large; give atol = 0.0002'
    >>> too_coarse(loop.blocks, {"PV": 2.0}, {"process": 1.9}, 1e-3)
    ''
    """
    least = ROUNDING * max(sizes.values(), default=0.0)
    reached = {
        block.name: max([states.get(block.name, 0.0), *(sizes.get(s, 0.0) for s in block.output_labels)])
        for block in blocks
        if len(block.x0)
    }
    small = {name: size for name, size in reached.items() if least < size < SHARE * atol}
    if not small:
        return ""
    told = ", ".join(f"{name} (at most {size:.2g} in this run)" for name, size in list(small.items())[:6])
    more = f" and {len(small) - 6} more" if len(small) > 6 else ""
    return (
        f"atol = {atol:g} is not small against {told}{more}: its error may be as large; "
        f"give atol = {FINE * min(small.values()):.1g}"
    )
