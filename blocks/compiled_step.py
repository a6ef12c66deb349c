"""A sampled function whose program can be compiled: its state, numbers all, becomes memories of a block.

The engine calls it like any of its own blocks, so that a filter can follow it and ensembles run at full speed.  What
cannot be compiled stays in Python: classes, files, solvers, a state that is no number.
"""

import copy
from typing import Any, cast

import numpy as np
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.kernel_source import generated
from stickslip.blocks.sampled_function import SampledFunction

TRIALS = (0.0, 0.37, 1.0)  # inputs with which program and compiled program are compared
SAME = 1e-12


class CompiledStep(Block):
    """The compiled twin of a ``SampledFunction`` whose state has ``size`` numbers, 0 for none, -1 for a single one.

    >>> def mean(state, PV, share=0.5):
    ...     state += share * (PV - state)
    ...     return state, state
    >>> from stickslip.diagram import drive
    >>> block = compiled_step(SampledFunction("f", mean, dt=1.0, inputs="PV", outputs="PV_f", state=0.0))
    >>> drive(block, 2.0, every=1.0, PV=8.0).log["PV_f"].tolist()
    [4.0, 6.0, 7.0]
    """

    period_param = "dt"
    offset_param = "offset"

    def __init__(self, of: SampledFunction, size: int, many: bool) -> None:
        call = cast(Any, of.host)
        self.role, self.plays = of.role, of.plays
        self.ports_in, self.ports_out = of.ports_in, of.ports_out
        self.kernels = Kernels(step=generated(_lines(call.wanted, size, many, call.count), call.function),
                               feeds=of.kernels.feeds)  # fmt: skip
        start = [] if call.state is None else np.atleast_1d(np.asarray(call.state, dtype=float)).tolist()
        super().__init__(
            name=of.name, params=of.params, memory={f"state_{i}": value for i, value in enumerate(start)},
            start_output=of.y0, inputs=list(of.input_labels), outputs=list(of.output_labels), units=of.units,
            spans=of.spans,
        )  # fmt: skip
        self.tolerances = of.tolerances


def _lines(wanted: tuple[tuple[str, int], ...], size: int, many: bool, count: int) -> list[str]:
    """Return the kernel's lines: call the function, keep its state, put its outputs out."""
    whole = "d[0]" if size < 0 else f"({', '.join(f'd[{i}]' for i in range(size))},)"
    places = {"t": "t", "state": whole}
    given = ", ".join(places.get(group, f"{group}[{i}]") for group, i in wanted)
    lines = [f"values = function({given})"]
    out = "values"
    if any(group == "state" for group, _ in wanted):
        kept = ["d[0] = values[0]"] if size < 0 else [f"d[{i}] = values[0][{i}]" for i in range(size)]
        lines += kept
        out = "values[1]"
    return lines + [f"out[{j}] = {out}[{j}]" if many else f"out[{j}] = {out}" for j in range(count)]


def compiled_step(block: SampledFunction) -> Block:
    """Return the twin of a sampled function that the engine compiles; the block itself where its state is no number.

    The twin is tried beside the function first: both have to give the same.
    """
    call = cast(Any, block.host)
    state = call.state
    if state is None and not any(group == "state" for group, _ in call.wanted):
        size = 0
    elif _is_number(state):
        size = -1
    elif isinstance(state, tuple) and state and all(map(_is_number, state)):
        size = len(state)
    else:
        return block
    try:
        outputs = [_sampled(block, value) for value in TRIALS]
        many = {np.ndim(found[1]) > 0 for found in outputs}
        twin = CompiledStep(block, size, many == {True})
        same = all(_alike(twin, value, *found) for value, found in zip(TRIALS, outputs, strict=True))
    except (ArithmeticError, TypeError, ValueError, IndexError, KeyError):
        return block
    return twin if same and len(many) == 1 else block


def _is_number(state: Any) -> bool:
    return isinstance(state, int | float) and not isinstance(state, bool)


def _sampled(block: SampledFunction, value: float) -> tuple[Any, Any]:
    """Return next state and outputs of a function for inputs of one value."""
    call, p = cast(Any, block.host), block.p.tolist()
    state = copy.deepcopy(call.state)
    groups = {"t": (0.0,), "u": (value,) * len(block.ports_in), "p": p, "state": (state,)}
    found = call.function(*(groups[group][i] for group, i in call.wanted))
    return found if any(group == "state" for group, _ in call.wanted) else ((), found)


def _alike(twin: Block, value: float, state: Any, outputs: Any) -> bool:
    """Return whether a twin keeps the same state, and gives the same outputs."""
    d, y = twin.d0.copy(), np.full(len(twin.ports_out), np.nan)
    assert twin.kernels.step is not None
    twin.kernels.step(0.0, np.empty(0), d, np.full(len(twin.ports_in), value), twin.p, y)
    wanted = np.concatenate([np.ravel(state), np.ravel(outputs)]).astype(float)
    found = np.concatenate([d, y])
    return len(wanted) == len(found) and bool(np.allclose(found, wanted, rtol=SAME, atol=SAME))
