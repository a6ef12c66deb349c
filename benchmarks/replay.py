"""How fast a diagram is replayed against a log: 2 h of a flow loop at 1 s, pinned in OP and PV.

The loop is ``ideal_flow``: PI with conditional anti-windup, valve, first-order process, sensor with noise held between
samples; its log comes from a run of the same loop, so the offsets found have to be that noise.
"""

import numpy as np
from stickslip.blocks import PI, FirstOrder, IdealValve, Noise, QuasiStaticStem, Sensor, Staircase, Sum
from stickslip.blocks.block import Block
from stickslip.diagram import simulate, wire
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.pins import pinned, replays, residuals
from stickslip.logs import Log

from benchmarks.report import Figures, median_seconds

DURATION, EVERY = 7200.0, 1.0
STICKBAND, SLIP_JUMP = 0.06, 0.02
LEVELS = np.round(0.3 + 0.3 * np.random.default_rng(1).random(12), 3)

NOTES = {
    "replay_ms": "pinned replay of 2 h at 1 s: controller, valve, process, sensor, one core [ms] (required: at most 4)",
    "replay_stick_ms": "the same with a sticky stem [ms] (required: at most 8)",
    "replay_error": "largest error of the offsets found, rtol 1e-6 (the sensor's noise is known)",
    "replay_batch_ms": "a hundred such replays with other parameters on all cores, one of them [ms]",
}


def flow_loop(valve: Block, noisy: bool) -> Diagram:
    """Return the loop, with or without the sensor's noise."""
    noise = [Noise("D", sd=0.004, dt=EVERY), Sum("seen", {"PV": 1.0, "D": 1.0})] if noisy else []
    return wire(
        [
            Staircase("SP", LEVELS.tolist(), dwell=600.0),
            PI(0.4, 10.0, anti_windup="conditional", inputs={"PV": "PV_m"}, start_op=0.1),
            valve,
            FirstOrder(3.0, 10.0, start=0.3),
            *noise,
            Sensor(inputs="seen" if noisy else "PV", outputs="PV_m"),
        ]
    )


def replay_figures(repeats: int) -> Figures:
    """Return the figures of pinned replays."""
    figures: Figures = {"replay_error": 0.0}
    for name, valve in (("replay_ms", IdealValve()), ("replay_stick_ms", QuasiStaticStem(STICKBAND, SLIP_JUMP))):
        truth = simulate(flow_loop(valve, True), DURATION, every=EVERY).log
        log = Log(truth.t, {signal: truth[signal] for signal in ("OP", "PV_m")})
        model = pinned(flow_loop(valve, False), log)
        offsets = [signal for signal in model.signals if signal.endswith(":offset")]

        def once(model=model, t=log.t, offsets=offsets):
            return simulate(model, DURATION, times=t, signals=offsets)

        error = float(np.abs(residuals(once())["PV_m"] - truth["D"]).max())
        figures["replay_error"] = max(error, figures["replay_error"])
        figures[name] = 1e3 * median_seconds(once, repeats)
        if name == "replay_ms":
            gains = np.linspace(2.9, 3.1, 100)

            def batch(log=log, valve=valve, gains=gains):
                return replays(flow_loop(valve, False), log, params={"process.K": gains}, keep_logs=False, summary=rms)

            figures["replay_batch_ms"] = 1e3 * median_seconds(batch, min(repeats, 3)) / len(gains)
    return figures


def rms(t, signals):
    """Return the root mean square of the sensor's offset."""
    return {"rms": float(np.sqrt(np.mean(signals["PV_m:offset"] ** 2)))}
