"""The span of a controller output, from its unit or from the values it takes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["guess_op_span"]

_BY_UNIT = {
    "%": (0.0, 100.0),
    "pct": (0.0, 100.0),
    "percent": (0.0, 100.0),
    "% open": (0.0, 100.0),
    "ma": (4.0, 20.0),
    "psi": (3.0, 15.0),
    "psig": (3.0, 15.0),
}


def guess_op_span(
    values: npt.NDArray[np.float64], unit: str = ""
) -> tuple[tuple[float, float] | None, str, str | None]:
    """Span, unit and the sentence to note, for the good values of OP.

    mA means 4 to 20, psi 3 to 15; values within 0 to 1 are a fraction, within -5 to 105 a percentage. Values
    spread about zero were centred or standardised by somebody: they have no span.

    >>> guess_op_span(np.array([36.4, 38.1]))
    ((0.0, 100.0), '%', 'OP is taken as % of its span (values 36.4 to 38.1).')
    >>> guess_op_span(np.array([-0.9, 1.1, 0.2, -0.3]))
    (None, '', None)
    """
    if len(values) == 0:
        return None, unit, None
    low, high = float(values.min()), float(values.max())
    extent = f"values {low:.4g} to {high:.4g}"
    known = _BY_UNIT.get(unit.strip().casefold())
    if known is not None:
        width = known[1] - known[0]
        if low < known[0] - 0.25 * width or high > known[1] + 0.25 * width:
            return None, unit, f"OP is in {unit}, but its {extent} do not fit a span of {known[0]:g} to {known[1]:g}."
        if known != (0.0, 100.0):
            return known, unit, f"OP is in {unit}: its span is taken as {known[0]:g} to {known[1]:g}."
        if not (low >= 0 and high <= 1 and high > 0):
            return known, "%", None
    elif unit:
        return None, unit, None
    if low >= 0 and 0 < high <= 1:
        return (0.0, 1.0), "", f"OP is taken as a fraction of its span ({extent})."
    centred = low < 0 < high and abs(float(values.mean())) < 0.5 * float(values.std())
    if centred or low < -5 or high > 105:
        return None, unit, None
    return (0.0, 100.0), "%", f"OP is taken as % of its span ({extent})."
