"""How far OP has travelled since it turned, compiled; loaded when first called."""

from typing import Any

import numpy as np
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def travelled(u: Any, back: float) -> Any:
    """The travel of u (n,) since it last turned by more than ``back``, with the sign of its way, (n,)."""
    w = np.zeros(len(u))
    way, low, high = 0.0, u[0], u[0]
    start = far = u[0]
    for k in range(len(u)):
        x = u[k]
        if way == 0.0:
            low, high = min(low, x), max(high, x)
            if x - low > back:
                way, start, far = 1.0, low, x
            elif high - x > back:
                way, start, far = -1.0, high, x
        elif way * (x - far) > 0.0:
            far = x
        elif way * (far - x) > back:
            way, start, far = -way, far, x
        w[k] = x - start
    return w
