"""Random diagrams by seed: sources, noise, sampled and continuous controllers, sticky valves, dead times, nesting."""

import numpy as np
from stickslip.blocks import (
    PI,
    DeadTime,
    FirstOrder,
    IdealValve,
    KanoValve,
    Noise,
    QuasiStaticStem,
    Recorded,
    SampledPI,
    SampledSensor,
    SecondOrder,
    Sine,
    Step,
    StickSlip,
    Sum,
)
from stickslip.detect.blocks import DetectorBlock, PrefilterBlock
from stickslip.detect.methods import area_ratio
from stickslip.diagram import wire


def random_diagram(seed):
    """Return a diagram of one or two loops; the same seed gives the same diagram."""
    rng = np.random.default_rng(seed)
    return wire([_loop(rng, f"loop{k}") for k in range(rng.integers(1, 3))], name=f"seed_{seed}")


def _loop(rng, name):
    one_of = lambda *made: made[rng.integers(len(made))]()  # noqa: E731
    number = lambda low, high: round(float(rng.uniform(low, high)), 3)  # noqa: E731
    K_p, T_i, theta, dt = number(0.05, 0.4), number(3.0, 20.0), float(rng.choice([0.0, 0.4, 1.7])), number(0.1, 1.0)
    blocks = [
        one_of(
            lambda: Step("SP", number(0.2, 0.6), at=number(0.0, 3.0)),
            lambda: Sine("SP", number(0.1, 0.3), number(5.0, 20.0), mean=0.4),
            lambda: Recorded("SP", [0.0, number(1.0, 5.0), 30.0], [0.1, 0.5, number(0.2, 0.6)]),
        ),
        one_of(lambda: PI(K_p, T_i, inputs={"PV": "PV_m"}), lambda: SampledPI(K_p, T_i, dt=dt, inputs={"PV": "PV_m"})),
        one_of(IdealValve, StickSlip, lambda: QuasiStaticStem(0.06, 0.02), lambda: KanoValve(0.06, 0.02, dt=dt)),
        one_of(
            lambda: FirstOrder(number(0.5, 2.0), number(2.0, 10.0), theta, outputs="a"),
            lambda: SecondOrder(number(0.5, 2.0), number(0.2, 0.8), number(0.3, 1.5), theta, outputs="a"),
        ),
        one_of(lambda: DeadTime(number(0.3, 2.0), inputs="a", outputs="PV"),
               lambda: FirstOrder(1.0, number(0.5, 2.0), name="lag", inputs="a", outputs="PV")),
        Noise("D", number(0.0, 0.01), dt=number(0.2, 1.0), seed=int(rng.integers(1000))),
        Sum("seen", {"PV": 1.0, "D": 1.0}),
        one_of(
            lambda: SampledSensor(dt=dt, sd=0.005, step=0.001, inputs="seen", outputs="PV_m"),
            lambda: PrefilterBlock(dt=dt, inputs="seen", outputs=["PV_m", "noise"]),
            lambda: FirstOrder(1.0, 0.5, name="filter", inputs="seen", outputs="PV_m"),
        ),
    ]  # fmt: skip
    if rng.integers(3) == 0:
        blocks.append(DetectorBlock(area_ratio, dt=1.0, inputs={"PV": "PV_m"}))
    return wire(blocks, name=name)
