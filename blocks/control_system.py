"""Any python-control system as a block: what ``wire`` does with the systems it is given."""

from typing import Any

import control as ct
import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.nonlinear_system import NonlinearSystem, sampling_period
from stickslip.blocks.ports import BlockError
from stickslip.blocks.state_space import StateSpace
from stickslip.blocks.transfer_function import TransferFunction


def as_block(system: Any) -> Block:
    """Return the block of a python-control system, under its name and with its labels.

    ``ct.tf`` and ``ct.zpk`` become a ``TransferFunction`` (with several inputs or outputs a ``StateSpace``), ``ct.ss``
    a ``StateSpace``, ``ct.nlsys`` and ``ct.interconnect`` a ``NonlinearSystem``; sampled ones run with their ``dt``.
    A block is returned as it is.

    Raises ``BlockError`` for an improper transfer function, a sampling period without a number (dt = True), measured
    frequency responses, and what is no system.

    >>> import control as ct
    >>> as_block(ct.tf([3], [10, 1], inputs="MV", outputs="PV", name="process")).param_names
    ('n', 'dt', 'w', 'c', 'a_0', 'a_1', 'b_0')
    """
    if isinstance(system, Block):
        return system
    if isinstance(system, ct.StateSpace):
        return StateSpace(
            system.A, system.B, system.C, system.D, sampling_period(system), states=tuple(system.state_labels),
            **_named(system),
        )  # fmt: skip
    if isinstance(system, ct.TransferFunction):
        dt = sampling_period(system)
        if system.issiso():
            return TransferFunction(system.num_array[0, 0], system.den_array[0, 0], dt, **_named(system))
        return StateSpace(*_realised(system, dt), dt, **_named(system))
    if isinstance(system, ct.NonlinearIOSystem):
        return NonlinearSystem(system)
    if isinstance(system, ct.FrequencyResponseData):
        raise BlockError(
            f"{system.name}: a measured frequency response has no states to integrate; fit a transfer function to it "
            "and give that"
        )
    if isinstance(system, type):
        raise BlockError(
            f"{system.__name__} is a class and no block; call it with its parameters: {system.__name__}(...)"
        )
    raise BlockError(
        f"{system!r} is neither a block nor a diagram nor a python-control system; give one of them, or make a block "
        "of your equations with stickslip.blocks.Equations"
    )


def _named(system: ct.InputOutputSystem) -> dict[str, Any]:
    return {"name": system.name, "inputs": list(system.input_labels), "outputs": list(system.output_labels)}


def _realised(system: ct.TransferFunction, dt: float) -> tuple[Any, Any, Any, Any]:
    """Return matrices of a transfer function with several inputs or outputs: one controller form per entry."""
    q, m = system.noutputs, system.ninputs
    parts = {
        (i, j): TransferFunction(
            system.num_array[i, j], system.den_array[i, j], dt, name=f"{system.name}[{i}, {j}]"
        ).matrices()
        for i in range(q)
        for j in range(m)
    }
    n = sum(len(A) for A, *_ in parts.values())
    A, B, C, D = np.zeros((n, n)), np.zeros((n, m)), np.zeros((q, n)), np.zeros((q, m))
    first = 0
    for (i, j), (a, b, c, d) in parts.items():
        own = slice(first, first + len(a))
        A[own, own], B[own, j : j + 1], C[i : i + 1, own], D[i, j] = a, b, c, d[0, 0]
        first += len(a)
    return A, B, C, D
