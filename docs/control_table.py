"""Write the table of docs/python_control.md again: ``python docs/control_table.py``.

Every block is driven by sines for 100 s, at its inputs or in a small loop, in a diagram of its own: by our engine with
``rtol=1e-8`` and by ``ct.input_output_response`` with LSODA and ``rtol=1e-6``.
"""

import re
import sys
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import control as ct
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from stickslip.blocks.block import Block
from stickslip.detect.blocks import DetectorBlock, PrefilterBlock
from stickslip.detect.methods import harmonics
from stickslip.diagram import Diagram, simulate, wire

from stickslip import blocks as b

PAGE = Path(__file__).parent / "python_control.md"
COLUMNS = ["block", "moves", "`ct.linearize`", "largest difference"]
DURATION = 100.0
TIMES = np.append(0.0, np.arange(0.123, DURATION, 0.25))  # beside the sampling instants, where signals jump
STEPS = {"solve_ivp_method": "LSODA", "solve_ivp_kwargs": {"rtol": 1e-6, "atol": 1e-9, "max_step": 0.5}}


@dataclass(frozen=True)
class Trial:
    """A block, and what drives it: port -> (mean, amplitude) of a sine, or the blocks around it."""

    block: Callable[[], Block]
    sines: Sequence[tuple[float, float]] = ((0.5, 0.3), (0.4, 0.2))
    around: Callable[[], Sequence[Block]] | None = None

    def diagram(self) -> Diagram:
        """The block among what drives it."""
        block = self.block()
        if self.around is not None:
            return wire([*self.around(), block])
        drives = [
            b.Sine(label, amplitude, 37.0 + 16.0 * i, mean=mean, name=f"drive {i + 1}")
            for i, (label, (mean, amplitude)) in enumerate(zip(block.input_labels, self.sines, strict=False))
        ]
        return wire([*drives, block], outputs=[*(drive.output_labels[0] for drive in drives), *block.output_labels])


def loop(sp: float = 0.5) -> list[Block]:
    """A set point that steps and a process that is slow; the block between them is a controller."""
    return [b.Step("SP", sp, 0.2, at=5.0), b.FirstOrder(1.5, 10.0, inputs="OP", outputs="PV")]


def sticky_loop() -> list[Block]:
    """A set point that steps, a controller and a process; the block between them is a valve."""
    return [b.Step("SP", 0.5), b.PI(0.4, 10.0), b.FirstOrder(3.0, 10.0)]


def valve(make: Callable[..., Block], *bands: float, **more: float) -> Trial:
    """A valve that starts where the sine does."""
    return Trial(lambda: make(*bands, start=0.5, **more))


def signal(make: Callable[..., Block], *values: object, **more: object) -> Trial:
    """A block whose first argument is its signal, and whose second the one it reads."""
    return Trial(lambda: make("out", *values, **more))


P = (30e5, 3e5)  # a pressure and its swing [Pa]

TRIALS: dict[str, Trial] = {
    "Constant": signal(b.Constant, 1.0),
    "Step": signal(b.Step, at=20.0),
    "Ramp": signal(b.Ramp, 0.1, start=10.0, end=50.0),
    **{kind.__name__: signal(kind, 1.0, 30.0) for kind in (b.Sine, b.Square, b.Triangle, b.Slug)},
    "Staircase": signal(b.Staircase, [0.0, 1.0, 0.5], dwell=20.0),
    "Recorded": signal(b.Recorded, [0.0, 30.0, 60.0], [0.0, 1.0, 0.5]),
    "Noise": signal(b.Noise, 1.0, 1.0, seed=1),
    "PRBS": signal(b.PRBS, 1.0, 5.0),
    "Chirp": signal(b.Chirp, 1.0, f_start=0.01, f_end=0.1, duration=100.0),
    "Pin": Trial(lambda: b.Pin([10.0, 40.0, 70.0], [0.5, 0.6, 0.3])),
    "Historian": Trial(lambda: b.Historian(["in"])),
    "PI": Trial(lambda: b.PI(2.0, 10.0), around=loop),
    "PID": Trial(lambda: b.PID(2.0, 10.0, 1.0), around=loop),
    "SampledPI": Trial(lambda: b.SampledPI(2.0, 10.0, dt=0.5), around=loop),
    "GapPI": Trial(lambda: b.GapPI(2.0, 10.0, dt=0.5, gap=0.01), around=loop),
    "RelayTuner": Trial(
        lambda: b.RelayTuner(0.1, bias=0.3, dt=0.1),
        around=lambda: [b.Step("SP", 0.5), b.FirstOrder(1.5, 10.0, theta=2.0, start=0.45, inputs="OP")],
    ),
    "AntiSurge": Trial(lambda: b.AntiSurge(), ((0.65, 0.05), (0.56, 0.0))),
    "Flare": Trial(lambda: b.Flare(), ((30e5, 0.0), (30.5e5, 0.4e5))),
    "Knocker": Trial(lambda: b.Knocker(0.03, 2.5, 1.0, 0.5, start=0.5)),
    "ConstantReinforcement": Trial(lambda: b.ConstantReinforcement(0.03, 0.5, start=0.5)),
    "TwoMove": Trial(lambda: b.TwoMove(0.06, 0.02, 0.1, 5.0, 0.5, start=0.5), ((0.5, 0.3), (0.5, 0.2), (0.5, 0.0))),
    "StickSlip": valve(b.StickSlip),
    "StribeckStem": valve(b.StribeckStem),
    "LuGreStem": valve(b.LuGreStem),
    "QuasiStaticStem": Trial(lambda: b.QuasiStaticStem(start=0.5), around=sticky_loop),
    **{kind.__name__: valve(kind, 0.06, 0.02, 0.5) for kind in (b.KanoValve, b.ChoudhuryValve, b.ChenValve)},
    "HeValve": valve(b.HeValve, 0.04, 0.02, 0.5),
    "StenmanValve": valve(b.StenmanValve, 0.04, 0.5),
    "Deadband": valve(b.Deadband, 0.05),
    "IdealValve": Trial(lambda: b.IdealValve()),
    "Positioner": Trial(
        lambda: b.Positioner(start=0.5),
        around=lambda: [b.Sine("OP", 0.3, 37.0, mean=0.5), b.StickSlip(F_s=1750.0, inputs="p", start=0.5)],
    ),
    "ControlValveFlow": Trial(lambda: b.ControlValveFlow(6.1), (P, (12e5, 1e5), (0.5, 0.3))),
    "GasValveFlow": Trial(lambda: b.GasValveFlow(3620.0), (P, (12e5, 1e5), (0.5, 0.3))),
    "Characteristic": Trial(lambda: b.Characteristic(50.0)),
    "CheckValve": Trial(lambda: b.CheckValve(0.06), ((22e5, 1e5), (22e5, 0.0))),
    "FlowResistance": Trial(lambda: b.FlowResistance(0.06), ((22e5, 1e5), (22e5, 0.0))),
    "Separator": Trial(
        lambda: b.Separator(), ((8000.0, 100.0), (0.37, 0.0), (5716.3, 100.0), (2283.7, 0.0), (0.0, 0.0))
    ),
    "Scrubber": Trial(lambda: b.Scrubber(), (P,)),
    "Plenum": Trial(lambda: b.Plenum(0.6, start=20e5), ((10.0, 1.0), (10.0, 0.0))),
    "Compressor": Trial(lambda: b.Compressor(start=47.05), ((22.1e5, 0.0), (75e5, 1e5), (994.838, 0.0))),
    "Shaft": Trial(lambda: b.Shaft(start=994.838), ((100.0, 50.0), (100.0, 0.0))),
    "GasTurbine": Trial(lambda: b.GasTurbine(start=10e3), ((10e3, 2e3), (994.838, 0.0))),
    "FirstOrder": Trial(lambda: b.FirstOrder(3.0, 10.0)),
    "SecondOrder": Trial(lambda: b.SecondOrder(3.0, 0.2, 0.5)),
    "Integrator": Trial(lambda: b.Integrator(1.0, 10.0, u_0=0.5)),
    "DeadTime": Trial(lambda: b.DeadTime(5.0, start=0.5)),
    "VariableDelay": Trial(
        lambda: b.VariableDelay("out", "in", "theta", dt=0.5, longest=10.0, start=0.5), ((0.5, 0.3), (5.0, 1.0))
    ),
    "Tank": Trial(lambda: b.Tank(2.0, 0.5, top=1.2)),
    "Overflow": Trial(lambda: b.Overflow(1.2), ((2.0, 1.0), (1.5, 0.0), (1.2, 0.0))),
    "Sensor": Trial(lambda: b.Sensor(2.0, bias=0.01, low=0.0, high=0.7)),
    "SampledSensor": Trial(lambda: b.SampledSensor(0.5, sd=0.01, seed=1)),
    "Sum": signal(b.Sum, {"in_1": 1.0, "in_2": -1.0}),
    "Gain": signal(b.Gain, "in", 2.0),
    "Product": signal(b.Product, ["in_1", "in_2"]),
    "Divide": signal(b.Divide, "in_1", "in_2"),
    "Lookup1D": signal(b.Lookup1D, "in", [0.0, 0.5, 1.0], [0.0, 1.0, 1.2]),
    "Lookup2D": signal(b.Lookup2D, "in_1", "in_2", [0.0, 1.0], [0.0, 1.0], [[0.0, 1.0], [1.0, 3.0]]),
    "StateSpace": Trial(lambda: b.StateSpace([[-0.1]], [[0.1]], [[1.0]], dt=0.0)),
    "TransferFunction": Trial(lambda: b.TransferFunction([1.0], [10.0, 1.0])),
    "Equations": Trial(
        lambda: b.Equations("yours", der=lambda y, u: (u - y) / 10.0, states={"y": 0.0}, inputs="u", outputs="y")
    ),
    "SampledFunction": Trial(
        lambda: b.SampledFunction(
            "yours", lambda state, u: (0.9 * state + 0.1 * u,) * 2, dt=0.5, inputs="u", outputs="y", state=0.5,
            start_output=0.5,
        )
    ),
    "Saturation": signal(b.Saturation, "in", 0.3, 0.7),
    "DeadZone": signal(b.DeadZone, "in", 0.4, 0.6),
    "Quantiser": signal(b.Quantiser, "in", 0.1),
    "RateLimiter": signal(b.RateLimiter, "in", 0.02, start=0.5),
    "Relay": signal(b.Relay, "in", 0.6, 0.4),
    "Switch": Trial(
        lambda: b.Switch("out", "control", above="in_1", below="in_2", switch_on=0.6, switch_off=0.4),
        ((0.5, 0.3), (0.5, 0.3), (0.4, 0.2)),
    ),
    "MinSelect": signal(b.MinSelect, ["in_1", "in_2"]),
    "MaxSelect": signal(b.MaxSelect, ["in_1", "in_2"]),
    "LeadLag": signal(b.LeadLag, "in", 10.0, 5.0, start=0.5),
    "SampledFilter": signal(b.SampledFilter, "in", 5.0, 0.5, start=0.5),
    "Biquad": signal(b.Biquad, "in", [0.2, -0.1, 0.4], [-1.2, 0.5], 0.5, start=0.5),
    "ZeroOrderHold": signal(b.ZeroOrderHold, "in", 0.5, start=0.5),
    "ResetIntegrator": signal(b.ResetIntegrator, "in", "reset"),
    "DetectorBlock": Trial(
        lambda: DetectorBlock(harmonics, dt=0.16, verdict_every=100),
        around=lambda: [
            b.Step("SP", 0.55), b.PI(0.6, 1.28, start_op=0.42), b.StickSlip.from_bands(S=0.06, J=0.03, start=0.4),
            b.FirstOrder(1.3, 0.8, theta=0.16, start=0.52),
        ],
    ),
    "PrefilterBlock": Trial(lambda: PrefilterBlock(0.5, window=32)),
}  # fmt: skip


@dataclass(frozen=True)
class Seen:
    """What python-control makes of a block: whether it moves, its slopes in words, the largest difference [share of
    how far the signal moves in our engine]."""

    moves: bool
    slopes: str
    difference: float

    def cells(self, name: str) -> list[str]:
        """A row of the table; differences below 1e-6 are the integrators' own."""
        difference = "< 1e-6" if self.difference < 1e-6 else f"{self.difference:.0e}".replace("e-0", "e-")
        return [name, "yes" if self.moves else "no", self.slopes, difference]


def seen(trial: Trial) -> Seen:
    """Run a trial in both simulators."""
    diagram = trial.diagram()
    block = diagram.blocks[-1]
    ours = simulate(diagram, DURATION, times=TIMES, rtol=1e-8, atol=1e-10).log
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        theirs = ct.input_output_response(diagram, TIMES, 0, diagram.x0, **STEPS)
    differences, moved, moves = [0.0], False, True
    for label in block.output_labels:
        ran, saw = np.nan_to_num(ours[label]), theirs.outputs[diagram.output_labels.index(label)]
        if np.ptp(ran) > 0.0:
            moved, moves = True, moves and bool(np.ptp(saw) > 0.1 * np.ptp(ran))
            differences.append(float(np.abs(saw - ran)[1:].max() / np.ptp(ran)))
    return Seen(moved and moves, slopes(block), max(differences))


def slopes(block: Block) -> str:
    """What ``ct.linearize`` gives of the block alone with its inputs open."""
    if not block.ports_in:
        return "no input"
    diagram = wire([block], inputs=block.input_labels, outputs=block.output_labels)
    u = [0.5] * len(block.ports_in)
    try:
        model = ct.linearize(diagram, diagram.x0, u)
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    zero = not np.any(model.B) and not np.any(model.D)
    return "0 where it starts" if zero else "yes"


def table() -> dict[str, Seen]:
    """Every block by name."""
    return {name: seen(trial) for name, trial in TRIALS.items()}


def markdown(rows: dict[str, Seen]) -> str:
    """The table as it stands on the page."""
    lines = [COLUMNS, ["---"] * len(COLUMNS), *(row.cells(name) for name, row in rows.items())]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def rewritten(page: str, rows: dict[str, Seen]) -> str:
    """The page with the table between ``<!-- table -->`` and ``<!-- end -->`` as it is now."""
    return re.sub(
        r"<!-- table -->\n.*?<!-- end -->", f"<!-- table -->\n{markdown(rows)}\n<!-- end -->", page, flags=re.S
    )


if __name__ == "__main__":
    PAGE.write_text(rewritten(PAGE.read_text(), table()))
