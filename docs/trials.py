"""Every block as it is tried: against python-control (``control_table.py``) and on its card (``cards.py``)."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from stickslip.blocks.block import Block
from stickslip.detect import blocks as detectors
from stickslip.detect.methods import harmonics
from stickslip.diagram import Diagram, wire

from stickslip import blocks

NAMES: dict[str, Any] = {**vars(blocks), **vars(detectors), "harmonics": harmonics}


@dataclass(frozen=True)
class Trial:
    """A block as code, and what drives it: port -> (mean, amplitude) of a sine, or the code of the blocks around it.

    ``atol``: what python-control's solver may be wrong by [unit of each state].
    """

    code: str
    sines: Sequence[tuple[float, float]] = ((0.5, 0.3), (0.4, 0.2))
    around: Sequence[str] = ()
    atol: float = 1e-9

    def block(self) -> Block:
        """The block."""
        made: Block = eval(self.code, NAMES)
        return made

    def drives(self) -> list[str]:
        """The code of the blocks that drive it."""
        pairs = zip(self.block().input_labels, self.sines, strict=False)
        return list(self.around) or [
            f'Sine("{label}", {amplitude:g}, {37.0 + 16.0 * i}, mean={mean:g}, name="drive {i + 1}")'
            for i, (label, (mean, amplitude)) in enumerate(pairs)
        ]

    def diagram(self) -> Diagram:
        """The block among what drives it."""
        block, drives = self.block(), [eval(code, NAMES) for code in self.drives()]
        if self.around:
            return wire([*drives, block])
        return wire([*drives, block], outputs=[*(drive.output_labels[0] for drive in drives), *block.output_labels])


P = (30e5, 3e5)  # a pressure and its swing [Pa]
LOOP = (  # a set point that steps and a process that is slow; the block between them is a controller
    'Step("SP", 0.5, 0.2, at=5.0)', 'FirstOrder(1.5, 10.0, inputs="OP", outputs="PV")',
)  # fmt: skip
STICKY_LOOP = ('Step("SP", 0.5)', "PI(0.4, 10.0)", "FirstOrder(3.0, 10.0)")  # the block between them is a valve

TRIALS: dict[str, Trial] = {
    "Constant": Trial('Constant("out", 1.0)'),
    "Step": Trial('Step("out", at=20.0)'),
    "Ramp": Trial('Ramp("out", 0.1, start=10.0, end=50.0)'),
    "Sine": Trial('Sine("out", 1.0, 30.0)'),
    "Square": Trial('Square("out", 1.0, 30.0)'),
    "Triangle": Trial('Triangle("out", 1.0, 30.0)'),
    "Slug": Trial('Slug("out", 1.0, 30.0)'),
    "Staircase": Trial('Staircase("out", [0.0, 1.0, 0.5], dwell=20.0)'),
    "Recorded": Trial('Recorded("out", [0.0, 30.0, 60.0], [0.0, 1.0, 0.5])'),
    "Noise": Trial('Noise("out", 1.0, 1.0, seed=1)'),
    "PRBS": Trial('PRBS("out", 1.0, 5.0)'),
    "Chirp": Trial('Chirp("out", 1.0, f_start=0.01, f_end=0.1, duration=100.0)'),
    "Pin": Trial("Pin([10.0, 40.0, 70.0], [0.5, 0.6, 0.3])"),
    "Historian": Trial('Historian(["in"])'),
    "PI": Trial("PI(2.0, 10.0)", around=LOOP),
    "PID": Trial("PID(2.0, 10.0, 1.0)", around=LOOP),
    "SampledPI": Trial("SampledPI(2.0, 10.0, dt=0.5)", around=LOOP),
    "SampledPID": Trial("SampledPID(2.0, 10.0, 1.0, dt=0.1)", around=LOOP),
    "GapPI": Trial("GapPI(2.0, 10.0, dt=0.5, gap=0.01)", around=LOOP),
    "RelayTuner": Trial(
        "RelayTuner(0.1, bias=0.3, dt=0.1)",
        around=('Step("SP", 0.5)', 'FirstOrder(1.5, 10.0, theta=2.0, start=0.45, inputs="OP")'),
    ),
    "AntiSurge": Trial("AntiSurge()", ((0.65, 0.05), (0.56, 0.0))),
    "Flare": Trial("Flare()", ((30e5, 0.0), (30.5e5, 0.4e5))),
    "Knocker": Trial("Knocker(0.03, 2.5, 1.0, 0.5, start=0.5)"),
    "ConstantReinforcement": Trial("ConstantReinforcement(0.03, 0.5, start=0.5)"),
    "TwoMove": Trial("TwoMove(0.06, 0.02, 0.1, 5.0, 0.5, start=0.5)", ((0.5, 0.3), (0.5, 0.2), (0.5, 0.0))),
    "StickSlip": Trial("StickSlip(start=0.5)"),
    "StribeckStem": Trial("StribeckStem(start=0.5)"),
    "LuGreStem": Trial("LuGreStem(start=0.5)"),
    "QuasiStaticStem": Trial("QuasiStaticStem(start=0.5)", around=STICKY_LOOP),
    "RestingStem": Trial("RestingStem(start=0.5)", atol=1e-6),  # with 1e-9 as much, in 15 times the time
    "KanoValve": Trial("KanoValve(0.06, 0.02, 0.5, start=0.5)"),
    "ChoudhuryValve": Trial("ChoudhuryValve(0.06, 0.02, 0.5, start=0.5)"),
    "ChenValve": Trial("ChenValve(0.06, 0.02, 0.5, start=0.5)"),
    "HeValve": Trial("HeValve(0.04, 0.02, 0.5, start=0.5)"),
    "StenmanValve": Trial("StenmanValve(0.04, 0.5, start=0.5)"),
    "Deadband": Trial("Deadband(0.05, start=0.5)"),
    "IdealValve": Trial("IdealValve()"),
    "Positioner": Trial(
        "Positioner(start=0.5)",
        around=('Sine("OP", 0.3, 37.0, mean=0.5)', 'StickSlip(F_s=1750.0, inputs="p", start=0.5)'),
    ),
    "ControlValveFlow": Trial("ControlValveFlow(6.1)", (P, (12e5, 1e5), (0.5, 0.3))),
    "GasValveFlow": Trial("GasValveFlow(3620.0)", (P, (12e5, 1e5), (0.5, 0.3))),
    "Characteristic": Trial("Characteristic(50.0)"),
    "CheckValve": Trial("CheckValve(0.06)", ((22e5, 1e5), (22e5, 0.0))),
    "FlowResistance": Trial("FlowResistance(0.06)", ((22e5, 1e5), (22e5, 0.0))),
    "Separator": Trial("Separator()", ((8000.0, 100.0), (0.37, 0.0), (5716.3, 100.0), (2283.7, 0.0), (0.0, 0.0))),
    "Scrubber": Trial("Scrubber()", (P,)),
    "Plenum": Trial("Plenum(0.6, start=20e5)", ((10.0, 1.0), (10.0, 0.0))),
    "Compressor": Trial("Compressor(start=47.05)", ((22.1e5, 0.0), (75e5, 1e5), (994.838, 0.0))),
    "Shaft": Trial("Shaft(start=994.838)", ((100.0, 50.0), (100.0, 0.0))),
    "GasTurbine": Trial("GasTurbine(start=10000.0)", ((10000.0, 2000.0), (994.838, 0.0))),
    "FirstOrder": Trial("FirstOrder(3.0, 10.0)"),
    "SecondOrder": Trial("SecondOrder(3.0, 0.2, 0.5)"),
    "Integrator": Trial("Integrator(1.0, 10.0, u_0=0.5)"),
    "DeadTime": Trial("DeadTime(5.0, start=0.5)"),
    "VariableDelay": Trial(
        'VariableDelay("out", "in", "theta", dt=0.5, longest=10.0, start=0.5)', ((0.5, 0.3), (5.0, 1.0))
    ),
    "Tank": Trial("Tank(2.0, 0.5, top=1.2)"),
    "Overflow": Trial("Overflow(1.2)", ((2.0, 1.0), (1.5, 0.0), (1.2, 0.0))),
    "Sensor": Trial("Sensor(2.0, bias=0.01, low=0.0, high=0.7)"),
    "SampledSensor": Trial("SampledSensor(0.5, sd=0.01, seed=1)"),
    "Sum": Trial('Sum("out", {"in_1": 1.0, "in_2": -1.0})'),
    "Gain": Trial('Gain("out", "in", 2.0)'),
    "Product": Trial('Product("out", ["in_1", "in_2"])'),
    "Divide": Trial('Divide("out", "in_1", "in_2")'),
    "Lookup1D": Trial('Lookup1D("out", "in", [0.0, 0.5, 1.0], [0.0, 1.0, 1.2])'),
    "Lookup2D": Trial('Lookup2D("out", "in_1", "in_2", [0.0, 1.0], [0.0, 1.0], [[0.0, 1.0], [1.0, 3.0]])'),
    "StateSpace": Trial("StateSpace([[-0.1]], [[0.1]], [[1.0]], dt=0.0)"),
    "TransferFunction": Trial("TransferFunction([1.0], [10.0, 1.0])"),
    "Equations": Trial(
        'Equations("yours", der=lambda y, u: (u - y) / 10.0, states={"y": 0.0}, inputs="u", outputs="y")'
    ),
    "SampledFunction": Trial(
        'SampledFunction("yours", lambda state, u: (0.9 * state + 0.1 * u,) * 2, dt=0.5, '
        'inputs="u", outputs="y", state=0.5, start_output=0.5)'
    ),
    "Saturation": Trial('Saturation("out", "in", 0.3, 0.7)'),
    "DeadZone": Trial('DeadZone("out", "in", 0.4, 0.6)'),
    "Quantiser": Trial('Quantiser("out", "in", 0.1)'),
    "RateLimiter": Trial('RateLimiter("out", "in", 0.02, start=0.5)'),
    "Relay": Trial('Relay("out", "in", 0.6, 0.4)'),
    "Switch": Trial(
        'Switch("out", "control", above="in_1", below="in_2", switch_on=0.6, switch_off=0.4)',
        ((0.5, 0.3), (0.5, 0.3), (0.4, 0.2)),
    ),
    "MinSelect": Trial('MinSelect("out", ["in_1", "in_2"])'),
    "MaxSelect": Trial('MaxSelect("out", ["in_1", "in_2"])'),
    "LeadLag": Trial('LeadLag("out", "in", 10.0, 5.0, start=0.5)'),
    "SampledFilter": Trial('SampledFilter("out", "in", 5.0, 0.5, start=0.5)'),
    "Biquad": Trial('Biquad("out", "in", [0.2, -0.1, 0.4], [-1.2, 0.5], 0.5, start=0.5)'),
    "ZeroOrderHold": Trial('ZeroOrderHold("out", "in", 0.5, start=0.5)'),
    "ResetIntegrator": Trial('ResetIntegrator("out", "in", "reset")'),
    "DetectorBlock": Trial(
        "DetectorBlock(harmonics, dt=0.16, verdict_every=100)",
        around=(
            'Step("SP", 0.55)',
            "PI(0.6, 1.28, start_op=0.42)",
            "StickSlip.from_bands(S=0.06, J=0.03, start=0.4)",
            "FirstOrder(1.3, 0.8, theta=0.16, start=0.52)",
        ),
    ),
    "PrefilterBlock": Trial("PrefilterBlock(0.5, window=32)"),
}
