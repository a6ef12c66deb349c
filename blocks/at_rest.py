"""A sampled block that has no continuous twin, as it is seen where a diagram rests.

    y = what the block gives after so many samples of one and the same u that nothing changes any more

It gives values only, of no dynamics; ``operating_point`` takes it in the place of the block.
"""

from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Floats, Kernel, Kernels
from stickslip.blocks.ports import BlockError

LEAST, MOST = 500, 20_000  # samples taken; a dead time or a filter of less than LEAST samples is seen through
SAME = 1e-12  # relative change from sample to sample that is none


class NoRest(BlockError):
    """The outputs of a sampled block go on changing while its inputs stand still."""


class AtRest(Block):
    """What ``block`` gives once its inputs have stood still for long, at time ``t`` [s].

    When asked for its output it raises ``NoRest`` (a ``BlockError``) for a block that never settles, such as an
    integrator.

    >>> from stickslip.blocks import SampledFunction
    >>> mean = SampledFunction("mean", lambda state, u: (0.5 * (state + u), state), dt=1.0, inputs="u", outputs="y",
    ...                        state=0.0)
    >>> AtRest(mean).output(0.0, [], [3.0]).round(9).tolist()
    [3.0]
    """

    def __init__(self, block: Block, t: float = 0.0) -> None:
        self.role, self.plays = block.role, block.plays
        self.ports_in, self.ports_out = block.ports_in, block.ports_out
        self.kernels = Kernels(out=_settling(block, t), feeds=True)
        super().__init__(
            name=block.name, params=block.params, units=block.units, spans=block.spans,
            inputs=list(block.input_labels), outputs=list(block.output_labels),
        )  # fmt: skip


def _settling(block: Block, at: float) -> Kernel:
    def out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
        for i, value in enumerate(settled_outputs(block, at, np.array([u[j] for j in range(len(block.ports_in))]))):
            y[i] = value

    out.may_run_in_python = "it takes samples until they settle"  # type: ignore[attr-defined]
    return out


def settled_outputs(block: Block, t: float, u: Floats) -> Floats:
    """Return the outputs of a sampled block after so many samples of ``u`` that they stand still.

    They count as standing still once they have done so for half of all samples.  Raises ``NoRest`` if they never do.
    """
    state, before, changed = block.state_before(), np.full(len(block.ports_out), np.inf), 0
    for taken in range(MOST):
        state, y = block.take(t, state, u)
        if not np.all(np.abs(y - before) <= SAME * np.maximum(1.0, np.abs(y))):
            changed, before = taken, y
        if taken >= max(LEAST, 2 * changed):
            return y
    values = ", ".join(f"{label} = {value:g}" for label, value in zip(block.input_labels, u, strict=True))
    raise NoRest(
        f"block '{block.name}' goes on changing its outputs while its inputs stand still at {values}: it integrates or "
        "swings by itself; give a block of ours in its place, such as SampledPI, or simulate"
    )
