"""Whether an absolute tolerance was small enough for the signals of a run.

A step's error is kept below atol + rtol |x| for each state x.  Where |x| stays below atol, that allows errors as large
as the state, and the run still ends with status OK.  So the rule: a block with states whose outputs and states all
stayed below ``SHARE`` atol, and were more than rounding, is named, with an atol that suits it.

Limits: only what is logged and the states at the start and the end are looked at; a block with one large and one small
state counts as large.
"""

from collections.abc import Callable, Collection, Mapping, Sequence

from stickslip.blocks.block import Block

SHARE = 10.0  # atol is small against a block that reaches this many times atol
FINE = 1e-4  # the atol recommended, as a share of what the block reaches
ROUNDING = 1e-12  # of the largest signal: less is no signal


class ToleranceWarning(UserWarning):
    """The absolute tolerance of a run is as large as some of its signals."""


def too_coarse(
    blocks: Sequence[Block],
    logged: Collection[str],
    size: Callable[[str], float],
    states: Mapping[str, float],
    atol: float,
) -> str:
    """Return a note that names the blocks for which ``atol`` was too large, "" if there are none.

    ``size`` gives the largest absolute value of a ``logged`` signal, and is asked only where ``states``, the same by
    block, of its states, leaves it open.

    >>> from stickslip.blocks import FirstOrder, Step
    >>> from stickslip.diagram import wire
    >>> loop = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)])
    >>> too_coarse(loop.blocks, ["PV"], {"PV": 2.0}.__getitem__, {"process": 1.9}, 1.0)
    'atol = 1 is not small against process (at most 2 in this run): its error may be as large; give atol = 0.0002'
    >>> too_coarse(loop.blocks, ["PV"], {"PV": 2.0}.__getitem__, {"process": 1.9}, 1e-3)
    ''
    """
    reached = {
        block.name: max([states.get(block.name, 0.0), *(size(s) for s in block.output_labels if s in logged)])
        for block in blocks
        if len(block.x0) and states.get(block.name, 0.0) < SHARE * atol
    }
    small = {name: most for name, most in reached.items() if most < SHARE * atol}
    if small:
        least = ROUNDING * max(map(size, logged), default=0.0)
        small = {name: most for name, most in small.items() if most > least}
    if not small:
        return ""
    text = ", ".join(f"{name} (at most {most:.2g} in this run)" for name, most in list(small.items())[:6])
    more = f" and {len(small) - 6} more" if len(small) > 6 else ""
    return (
        f"atol = {atol:g} is not small against {text}{more}: its error may be as large; "
        f"give atol = {FINE * min(small.values()):.1g}"
    )
