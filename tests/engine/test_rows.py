"""Log rows between the scans: every signal of the engine's log equals the reference's, whatever stands behind what.

Forty random diagrams are compared each time.  ``STICKSLIP_DIAGRAMS=500 python -m pytest tests/engine/test_rows.py``
compares as many as one likes (500: two minutes).
"""

import inspect
import os

import numpy as np
import pytest
import stickslip.detect.blocks
from stickslip.blocks import (
    PI,
    Biquad,
    ChenValve,
    ChoudhuryValve,
    ConstantReinforcement,
    DeadTime,
    FirstOrder,
    Gain,
    GapPI,
    HeValve,
    IdealValve,
    Integrator,
    KanoValve,
    Knocker,
    Noise,
    QuasiStaticStem,
    Ramp,
    RelayTuner,
    SampledFilter,
    SampledFunction,
    SampledPI,
    SampledPID,
    SampledSensor,
    Saturation,
    SecondOrder,
    Sine,
    StenmanValve,
    Step,
    Sum,
    TwoMove,
    VariableDelay,
    ZeroOrderHold,
)
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.detect.blocks import DetectorBlock, PrefilterBlock
from stickslip.detect.methods import area_ratio
from stickslip.diagram import simulate, wire
from stickslip.diagram.ensembles import ensemble
from stickslip.diagram.reference import simulate_reference
from stickslip.engine.status import Status

from stickslip import blocks

SHARP = {"rtol": 1e-10, "atol": 1e-12}
DIAGRAMS = int(os.environ.get("STICKSLIP_DIAGRAMS", "40"))


def _late(t, x, d, u, p, y):
    y[0] = d[0]
    d[0] = u[0]


class UnitDelay(Block):
    """y(k) = u(k - 1): what it publishes at an instant does not follow what it reads there."""

    ports_in = (Port("in"),)
    ports_out = (Port("out"),)
    kernels = Kernels(step=_late, feeds=False)
    period_param = "dt"

    def __init__(self, dt, name="delay", **labels):
        super().__init__(name=name, params={"dt": dt}, memory={"last": 0.3}, start_output=[0.3], **labels)


# one of every sampled block: what it reads is a sine, what it drives is called "D" (and "E")
SAMPLED = {
    Noise: lambda: Noise("D", sd=1.0, dt=1.0),
    SampledPI: lambda: SampledPI(0.4, 10.0, dt=1.0, inputs=["a", "b"], outputs="D"),
    SampledPID: lambda: SampledPID(0.4, 10.0, 2.0, dt=1.0, inputs=["a", "b"], outputs="D"),
    SampledSensor: lambda: SampledSensor(1.0, sd=0.1, inputs="a", outputs="D"),
    KanoValve: lambda: KanoValve(0.06, 0.02, 1.0, inputs="a", outputs="D"),
    ChoudhuryValve: lambda: ChoudhuryValve(0.06, 0.02, 1.0, inputs="a", outputs="D"),
    ChenValve: lambda: ChenValve(0.06, 0.02, 1.0, inputs="a", outputs="D"),
    HeValve: lambda: HeValve(0.06, 0.02, 1.0, inputs="a", outputs="D"),
    StenmanValve: lambda: StenmanValve(0.06, 1.0, inputs="a", outputs="D"),
    PrefilterBlock: lambda: PrefilterBlock(1.0, inputs="a", outputs=["D", "E"]),
    DetectorBlock: lambda: DetectorBlock(area_ratio, 1.0, verdict_every=3, inputs=["b", "a", "x"], outputs=["E", "D"]),
    Knocker: lambda: Knocker(0.1, 5.0, 2.0, 1.0, inputs="a", outputs="D"),
    ConstantReinforcement: lambda: ConstantReinforcement(0.1, 1.0, inputs="a", outputs="D"),
    TwoMove: lambda: TwoMove(0.1, 0.02, 0.05, 5.0, 1.0, inputs=["a", "b", "x"], outputs="D"),
    GapPI: lambda: GapPI(0.4, 10.0, gap=0.05, dt=1.0, inputs=["a", "b"], outputs="D"),
    UnitDelay: lambda: UnitDelay(1.0, inputs="a", outputs="D"),
    ZeroOrderHold: lambda: ZeroOrderHold("D", "a", 1.0),
    SampledFilter: lambda: SampledFilter("D", "a", 3.0, 1.0),
    Biquad: lambda: Biquad("D", "a", [0.3, 0.2, 0.1], [-0.4, 0.1], 1.0),
    VariableDelay: lambda: VariableDelay("D", "a", "b", dt=1.0, longest=5.0),
    RelayTuner: lambda: RelayTuner(0.2, dt=1.0, bias=0.5, inputs=["a", "b"], outputs=["D", "K_u", "T_u", "K_p", "E"]),
    SampledFunction: lambda: SampledFunction("D", lambda a: 2.0 * a, dt=1.0, inputs="a", outputs="D"),
}


def every_sampled_block():
    return {
        kind
        for room in (blocks, stickslip.detect.blocks)
        for kind in vars(room).values()
        if inspect.isclass(kind) and issubclass(kind, Block) and kind.period_param
    }


def test_every_sampled_block_of_the_catalogue_is_here():
    assert every_sampled_block() <= set(SAMPLED)


def behind(sampled):
    """Return the diagram of a sampled block with algebraic blocks, a lag and a dead time behind it, readers first."""
    chain = [
        Gain("u", "D", 2.0), Sum("w", {"u": 1.0, "x": -0.5}), IdealValve(inputs="w", outputs="v", name="valve_v"),
        FirstOrder(1.0, 5.0, inputs="u", outputs="x"), DeadTime(0.7, inputs="u", outputs="z"),
    ]  # fmt: skip
    sources = [Sine("a", 0.4, 7.3, mean=0.5), Sine("b", 0.3, 11.0, mean=0.4)]
    return wire([*chain, sampled, *sources], outputs=["a", "b", "u", "v", "z"])


def off_scan(duration, count=91):
    """Return log times that are no multiples of any period here."""
    return np.linspace(0.0, duration, count)[1:-1] + 0.0137


def compare(diagram, duration, times, tolerance=1e-7):
    ours = simulate(diagram, duration, times=times, **SHARP)
    theirs = simulate_reference(diagram, duration, times=times, rtol=1e-9, atol=1e-11)
    assert ours.status is theirs.status is Status.OK
    for signal in ours.log.names:
        scale = 1.0 + np.nanmax(np.abs(theirs.log[signal]), initial=0.0)
        np.testing.assert_allclose(ours.log[signal], theirs.log[signal], atol=tolerance * scale, err_msg=signal)
    return ours


@pytest.mark.parametrize("kind", SAMPLED, ids=lambda kind: kind.__name__)
def test_algebraic_blocks_behind_a_sampled_block(kind):
    run = compare(behind(SAMPLED[kind]()), 10.0, off_scan(10.0))
    np.testing.assert_array_equal(run.log["u"], 2.0 * run.log["D"])  # analytic
    np.testing.assert_array_equal(run.log["v"], run.log["w"])  # analytic


@pytest.mark.parametrize(
    "kind",
    [kind for kind in SAMPLED if kind not in (PrefilterBlock, DetectorBlock, SampledFunction)],
    ids=lambda kind: kind.__name__,
)
def test_in_an_ensemble_too(kind):
    logs = ensemble(behind(SAMPLED[kind]()), 10.0, params={"u.factor": [1.0, 2.0, 3.0]}, every=0.23).values
    np.testing.assert_array_equal(logs["u"], np.array([[1.0], [2.0], [3.0]]) * logs["D"])  # analytic
    np.testing.assert_array_equal(logs["v"], logs["w"])  # analytic


def random_diagram(rng):
    """Return a diagram of noise, sampled, algebraic and continuous blocks wired at random, in a random order.

    The last lag closes a loop through whatever reads ``PV``.
    """
    number = lambda low, high: float(f"{rng.uniform(low, high):.3g}")  # noqa: E731
    signals = ["PV"]
    found: list[Block] = []

    def read():
        return str(rng.choice(signals))

    def two():
        return [str(s) for s in rng.choice(signals, 2, replace=False)]

    def fresh():
        return f"s{len(found)}"

    algebraic = [
        lambda s: Gain(s, read(), number(-2.0, 2.0), offset=number(-1.0, 1.0)),
        lambda s: Sum(s, {key: number(-1.0, 1.0) for key in dict.fromkeys([read(), read()])}),
        lambda s: IdealValve(inputs=read(), outputs=s, name=s),
        lambda s: Saturation(s, read(), number(-1.0, 0.0), number(0.1, 1.0)),
    ]
    sampled = [
        lambda s: Noise(s, sd=number(0.01, 1.0), dt=number(0.2, 2.0), seed=int(rng.integers(1000))),
        lambda s: SampledPI(number(0.05, 0.4), number(3.0, 20.0), dt=number(0.2, 1.5), offset=number(0.0, 0.5),
                            inputs=two(), outputs=s, name=s),
        lambda s: SampledSensor(number(0.2, 1.0), sd=number(0.0, 0.1), tau=number(0.0, 1.0), inputs=read(), outputs=s,
                                seed=int(rng.integers(1000)), name=s),
        lambda s: KanoValve(0.06, 0.02, number(0.2, 1.0), inputs=read(), outputs=s, name=s),
        lambda s: UnitDelay(number(0.2, 1.0), inputs=read(), outputs=s, name=s),
    ]  # fmt: skip
    continuous = [
        lambda s: FirstOrder(number(0.3, 1.5), number(0.5, 8.0), inputs=read(), outputs=s, name=s),
        lambda s: FirstOrder(number(0.3, 1.5), number(0.5, 8.0), number(0.3, 2.0), inputs=read(), outputs=s, name=s),
        lambda s: SecondOrder(1.0, number(0.3, 0.9), number(0.3, 1.5), inputs=read(), outputs=s, name=s),
        lambda s: Integrator(number(0.1, 0.5), number(5.0, 20.0), inputs=read(), outputs=s, name=s),
        lambda s: DeadTime(number(0.3, 2.0), inputs=read(), outputs=s, name=s),
        lambda s: PI(number(0.05, 0.4), number(3.0, 20.0), inputs=two(), outputs=s, name=s),
        lambda s: QuasiStaticStem(0.06, 0.02, inputs=read(), outputs=s, name=s),
    ]
    sources = [
        lambda s: Sine(s, number(0.2, 0.5), number(3.0, 9.0), mean=number(0.2, 0.6)),
        lambda s: Step(s, number(0.2, 0.6), at=number(0.3, 2.0)),
        lambda s: Ramp(s, number(0.02, 0.1), start=0.5),
    ]
    kinds = [sources, sampled, *(rng.permutation([0, 1, 1, 1, 2, 2, 3, 3])[: rng.integers(3, 9)])]
    groups = [sources, algebraic, sampled, continuous]
    for kind in kinds:
        group = kind if isinstance(kind, list) else groups[int(kind)]
        found.append(group[int(rng.integers(len(group)))](fresh()))
        signals.append(found[-1].output_labels[0])
    found.append(FirstOrder(number(0.3, 1.0), number(1.0, 8.0), inputs=signals[-1], outputs="PV", name="process"))
    return wire([found[i] for i in rng.permutation(len(found))], outputs=["PV", *signals[1:]])


@pytest.mark.parametrize("seed", range(DIAGRAMS))
def test_random_diagrams_between_their_scans(seed):
    rng = np.random.default_rng(seed)
    diagram = random_diagram(rng)
    compare(diagram, 5.0, np.sort(rng.uniform(0.0, 5.0, 60)), tolerance=1e-6)
