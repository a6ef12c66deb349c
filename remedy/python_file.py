"""The best loop of a fit as a Python file that a person can read, edit and run."""

from __future__ import annotations

import math

import numpy as np
from stickslip.remedy.loop_fit import LoopFit

__all__ = ["python_of"]

PAGE = '''"""The loop {name}, fitted to its log by stickslip: the likeliest values, beside 90 % intervals.

{rows}

OP and MV are deviations from {op0:.6g} {op_unit}, PV and SP from {pv0:.6g} {pv_unit}.
The load is drawn anew; it has the spread and the memory of what the fitted loop left of the log.
"""

from math import inf

from stickslip.blocks import {imports}
from stickslip.diagram import simulate, wire

loop = wire([
    Step("SP", 0.0),
    {controller}({tuning}, dt={dt:.6g}, low={low}, high={high}, action="{action}"),
    {valve},
    FirstOrder(1.0, {tau_2:.6g}, name="second lag", inputs="MV", outputs="MV_2"),
    {process},
    Noise("load", {load:.6g}, {dt:.6g}, correlation_time={memory:.6g}),
    Noise("noise", {noise:.6g}, {dt:.6g}),
    Sum("PV", {{"flow": 1.0, "load": 1.0, "noise": 1.0}}),
], outputs=["SP", "PV", "OP", "MV"])

if __name__ == "__main__":
    run = simulate(loop, {duration:.6g}, every={dt:.6g})
    print(f"standard deviation of PV {{run.log['PV'].std():.4g}}")
    run.log.plot()
'''


def python_of(fit: LoopFit) -> str:
    """Return the file as text; a filter of PV is left out of it, and the table says so."""
    law, one, day = fit.controller, fit.best, fit.days[0]
    controller = "SampledPID" if law.T_d > 0.0 else "SampledPI"
    tuning = f"K_p={abs(law.K_p):.6g}, T_i={'inf' if math.isinf(law.T_i) else f'{law.T_i:.6g}'}"
    if law.T_d > 0.0:
        tuning += f", T_d={law.T_d:.6g}, N=inf"
    op0 = float(np.mean(day.op))
    pv0 = float(np.mean(day.pv if day.sp is None else day.sp))
    stem, of = ("ChenValve", "") if one.follows else ("HeValve", ".from_bands")
    valve = f"{stem}{of}(S={one.S:.6g}, J={one.J:.6g}, dt={law.dt:.6g}, low=-inf, high=inf)"
    kind = "Integrator" if one.integrating else "FirstOrder"
    second = "1.0" if one.integrating else f"{one.tau:.6g}"
    process = f'{kind}({one.K:.6g}, {second}, {one.theta:.6g}, inputs="MV_2", outputs="flow")'
    left = fit.lefts[0][0] - np.mean(fit.lefts[0][0])
    near = float(left[2:] @ left[:-2]) / max(float(left[1:] @ left[:-1]), 1e-300)
    memory = -law.dt / math.log(min(max(near, 0.05), 0.9999))
    return PAGE.format(
        name=fit.name or "of this log", op0=op0, pv0=pv0, op_unit=fit.op_unit, pv_unit=fit.pv_unit or "of PV",
        rows="\n".join(f"{what:22} {value} [{unit}]" for what, value, unit in fit.rows()),
        imports=", ".join(sorted({"Noise", controller, "Step", "Sum", "FirstOrder", stem, kind})),
        controller=controller, tuning=tuning, dt=law.dt, low=_limit(law.low - op0),
        high=_limit(law.high - op0), action="reverse" if law.K_p > 0.0 else "direct", valve=valve,
        tau_2=max(one.tau_2, 0.01 * law.dt), process=process, load=fit.load_sd.value or 0.0, memory=memory,
        noise=fit.noise_sd.value or 0.0,
        duration=min(float(day.t[-1] - day.t[0]), 20_000.0 * law.dt),
    )  # fmt: skip


def _limit(x: float) -> str:
    return f"{x:.6g}" if math.isfinite(x) else ("inf" if x > 0.0 else "-inf")
