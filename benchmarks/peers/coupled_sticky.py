"""Sticky loops in a ring: each process also feels the measured values of the next two loops; all valves differ."""

import numpy as np
from stickslip.blocks import PI, FirstOrder, SampledPI, Step, StickSlip, Sum
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram


def coupled_sticky_loops(count: int, A: float = 0.02, B: float = -0.01, scan: float = 0.0) -> Diagram:
    """Return ``count`` coupled loops; with ``scan`` [s] their controllers are sampled, one after the other in it."""
    blocks = []
    for i, F_s in enumerate(np.linspace(1900.0, 2250.0, count).tolist()):
        wires = {"name": f"C{i}", "inputs": [f"SP{i}", f"PV{i}"], "outputs": f"OP{i}"}
        if scan:
            controller = SampledPI(K_p=0.4, T_i=10.0, dt=scan, offset=scan * i / count, **wires)
        else:
            controller = PI(K_p=0.4, T_i=10.0, low=-np.inf, high=np.inf, **wires)
        blocks += [
            Step(f"SP{i}", after=0.5),
            controller,
            StickSlip(F_s=F_s, name=f"V{i}", inputs=[f"OP{i}"], outputs=f"MV{i}"),
            Sum(f"u{i}", {f"MV{i}": 1.0, f"PV{(i + 1) % count}": A, f"PV{(i + 2) % count}": B} if count > 2
                else {f"MV{i}": 1.0}),
            FirstOrder(3.0, 10.0, name=f"P{i}", inputs=[f"u{i}"], outputs=f"PV{i}"),
        ]  # fmt: skip
    return wire(blocks, name="coupled sticky loops")
