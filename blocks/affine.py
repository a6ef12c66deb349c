"""Try whether a block is linear in each mode as it says: affine in states, inputs and time while no event fires.

Four points z, z + a, z + b and z + a + b that all belong to a mode (no event function is positive there) show it:

    f(z + a + b) - f(z + a) - f(z + b) + f(z) = 0         also with b = a

What these points do not show, the engine notices at the end of each of its steps (``stickslip.engine.series``).
"""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from stickslip.blocks.block import Block

Floats = NDArray[np.float64]
TRIES, SEEN = 12, 2  # places tried in each mode, and how many of them that belong to it are enough
STEP = 0.02  # size of a and b
ROUNDING = 1e-10  # of the largest value


def not_affine(block: "Block") -> str:
    """Return which kernel of a block is not affine in which mode, "" if none shows it."""
    modes: dict[str, float] = {**block.modes} or {"": math.nan}
    for mode, value in modes.items():
        d = block.d0.copy()
        if mode:
            d[0] = value
        seen = 0
        for number in range(TRIES):
            if seen < SEEN and (values := _corners(block, d, number)) is not None:
                seen += 1
                for name, (here, one, other, both) in values.items():
                    size = np.abs([here, one, other, both]).max()
                    if np.abs(both - one - other + here).max() > ROUNDING * size:
                        return (
                            f"{name} ({getattr(block.kernels, name).__code__.co_name})"
                            + f" in mode '{mode}'" * bool(mode)
                        )
    return ""


def _corners(block: "Block", d: Floats, number: int) -> dict[str, list[Floats]] | None:
    """Return what ``out`` and ``der`` write at four points, None if one of them does not belong to the mode."""
    n, m = len(block.x0), len(block.ports_in)
    z = np.concatenate([[0.0], block.x0, np.zeros(m)])
    spread = np.sin((1.0 + number) * np.arange(1.0, n + m + 1.0))
    z[1:] += (0.02, 0.1, 0.4, 1.0)[number % 4] * spread + (0.0, 0.3, 0.6)[number % 3]
    a = STEP * np.cos(np.arange(n + m + 1.0) + number)
    b = a if number % 2 else STEP * np.cos(2.0 + 3.0 * np.arange(n + m + 1.0))
    a[0], b[0] = abs(a[0]), abs(b[0])
    points = [z, z + a, z + b, z + a + b]
    if block.kernels.next_time is not None:
        instant = np.array([math.inf, math.inf])
        block.kernels.next_time(0.0, block.x0.copy(), d.copy(), np.zeros(m), block.p, instant)
        if 0.0 < instant[0] <= points[-1][0]:
            return None
    found: dict[str, list[Floats]] = {"out": [], "der": []}
    for point in points:
        t, x, u = float(point[0]), point[1 : n + 1], point[n + 1 :]
        if block.kernels.n_events and (_written(block, "zc", t, x, d, np.concatenate([u, np.zeros(m)])) > 0.0).any():
            return None
        found["out"].append(_written(block, "out", t, x, d, u))
        if n:
            found["der"].append(_written(block, "der", t, x, d, u))
    return {name: values for name, values in found.items() if values and values[0].size}


def _written(block: "Block", name: str, t: float, x: Floats, d: Floats, u: Floats) -> Floats:
    sizes = {"out": len(block.ports_out), "der": len(block.x0), "zc": block.kernels.n_events}
    out = np.zeros(sizes[name])
    kernel: Any = getattr(block.kernels, name)
    if kernel is not None:
        kernel(t, x, d.copy(), u, block.p, out)
    return out
