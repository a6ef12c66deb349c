"""A random diagram of a seed: loops of valves, processes, controllers and sensors that disturb each other.

Every diagram has a few sources, noise among them, and one to six units.  A unit is a sum of signals from anywhere,
perhaps a controller, a valve, a limit or a dead time, and a process whose output may be measured by a sensor; units
are nested at random.  Each process has states, so there are no algebraic loops.  Scan times differ and may coincide;
the log lies off every scan.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks import Saturation
from stickslip.blocks.block import Block
from stickslip.blocks.noise import Noise
from stickslip.blocks.periodic import Sine, Square
from stickslip.blocks.sensor import SampledSensor, Sensor
from stickslip.blocks.sources import Ramp
from stickslip.diagram import Diagram, wire

from stickslip import blocks

ROWS = 150
SLOW = 8  # every so many diagrams may have a PI with conditional integration, which is left to the slow reference
SCANS = (0.1, 0.25, 0.3, 0.5, 0.7, 1.0, 2.0)
ODD = (0.1701, 0.3703, 0.9707)  # scans that meet no others, nor a step, but at the start
ANY = (*SCANS, *ODD)


@dataclass(frozen=True)
class Drawn:
    """What a seed gives: a diagram, how long it runs [s] and when it is logged [s]."""

    seed: int
    diagram: Diagram
    duration: float
    times: NDArray[np.float64]


def draw(seed: int) -> Drawn:
    """Return the diagram of a seed: the same on every machine.

    >>> draw(7).diagram.signals == draw(7).diagram.signals != draw(8).diagram.signals
    True
    """
    rng = np.random.default_rng([2009, seed])
    duration = float(rng.choice([10.0, 20.0, 40.0]))
    many = int(rng.integers(1, 7))
    sources = _sources(rng, duration)
    homes = [int(rng.integers(0, 3)) for _ in range(many)]  # 0: on its own, else the unit that it is nested in
    unit_blocks: dict[int, list[Diagram]] = {1: [], 2: []}
    outside: list[Block | Diagram] = list(sources)
    known = [source.output_labels[0] for source in sources]
    measured = [bool(rng.random() < 0.5) for _ in range(many)]
    for n in range(many):
        here = homes[n]

        def name(m: int, here: int = here) -> str:
            inside = "" if homes[m] in (0, here) else f"site{homes[m]}/"
            signal = "PV_m" if measured[m] and rng.random() < 0.7 else "PV"
            return f"{inside}n{m}/{signal}"

        read = [name(int(m)) for m in rng.choice(many, size=min(many, int(rng.integers(0, 3))), replace=False)]
        read += [str(s) for s in rng.choice(known, size=int(rng.integers(1, min(3, len(known)) + 1)), replace=False)]
        loop = _loop(rng, n, list(dict.fromkeys(read)), measured[n], seed % SLOW == 0)
        (unit_blocks[here] if here else outside).append(loop)
    for number, loops in unit_blocks.items():
        if loops:
            driven = {f"{loop.name}/{s}" for loop in loops for s in loop.signals}
            wanted = dict.fromkeys(s for loop in loops for s in loop.open_inputs if s not in driven)
            outside.append(wire(loops, inputs=list(wanted), name=f"site{number}"))
    diagram = wire(outside, outputs=known, name=f"random{seed}")
    return Drawn(seed, diagram, duration, np.sort(rng.uniform(0.0, duration, ROWS)))


def _sources(rng: np.random.Generator, duration: float) -> list[Block]:
    made: list[Block] = [blocks.Step("s0", after=float(rng.uniform(0.2, 0.8)), before=0.1, at=_instant(rng))]
    for k in range(1, int(rng.integers(2, 5))):
        signal, size = f"s{k}", float(rng.uniform(0.05, 0.3))
        kind = int(rng.integers(0, 7))
        if kind <= 1:
            colour = float(rng.choice([0.0, 2.0]))
            made.append(Noise(signal, sd=0.3 * size, dt=float(rng.choice(SCANS)), mean=size, correlation_time=colour))
        elif kind == 2:
            made.append(Sine(signal, size, float(rng.uniform(3.0, 20.0)), mean=size, start=_instant(rng)))
        elif kind == 3:
            duty = float(rng.uniform(0.2, 0.8))
            made.append(Square(signal, size, float(rng.uniform(3.0, 10.0)), mean=size, start=_instant(rng), duty=duty))
        elif kind == 4:
            start = _instant(rng)
            made.append(Ramp(signal, slope=size / duration, start=start, end=start + float(rng.uniform(1.0, 10.0))))
        elif kind == 5:
            made.append(_function(rng, signal, size, duration))
        else:
            made.append(blocks.Constant(signal, size))
    return made


def _swing(t: float, mean: float, amplitude: float, omega: float, bump: float, centre: float, width: float) -> float:
    return mean + amplitude * math.sin(omega * t) + bump * math.exp(-(((t - centre) / width) ** 2))


def _function(rng: np.random.Generator, signal: str, size: float, duration: float) -> Block:
    """Return a user's function of time: a sine and one bump, which nothing announces to the engine."""
    values = {
        "mean": size, "amplitude": 0.5 * size, "omega": float(rng.uniform(0.2, 2.0)),
        "bump": float(rng.uniform(0.1, 0.5)),
        "centre": float(rng.uniform(0.0, duration)), "width": duration * float(rng.uniform(0.02, 0.1)),
    }  # fmt: skip
    return blocks.Equations(signal, out=_swing, outputs=signal, params=values)


def _instant(rng: np.random.Generator) -> float:
    """Return an instant [s]: the start, a scan of many sensors, or none of both."""
    return float(rng.choice([0.0, float(rng.integers(1, 5)), float(rng.uniform(0.1, 5.0))]))


def _loop(rng: np.random.Generator, n: int, read: list[str], measured: bool, conditional: bool) -> Diagram:
    """Return unit ``n``: what it reads, summed, through a controller, a valve and a process."""
    weights = {s: float(rng.uniform(0.2, 0.9) if s.startswith("s") and "/" not in s else rng.uniform(-0.4, 0.4))
               for s in read}  # fmt: skip
    made: list[Block] = [blocks.Sum("in", weights, offset=float(rng.uniform(-0.05, 0.1)))]
    signal = "in"
    feedback = "PV_m" if measured else "PV"
    if rng.random() < 0.6:
        made.append(_controller(rng, {"SP": signal, "PV": feedback}, conditional))
        signal = "OP"
    if rng.random() < 0.2:
        made.append(Saturation("limited", signal, low=float(rng.uniform(-0.2, 0.2)), high=float(rng.uniform(0.3, 0.8))))
        signal = "limited"
    if rng.random() < 0.2:
        made.append(blocks.Gain("scaled", signal, float(rng.uniform(0.5, 1.5)), offset=float(rng.uniform(-0.1, 0.1))))
        signal = "scaled"
    if rng.random() < 0.2:
        made.append(blocks.DeadTime(float(rng.uniform(0.3, 3.0)), inputs=signal, outputs="late"))
        signal = "late"
    if rng.random() < 0.5:
        switched = _switching(rng, signal, read)
        made += switched
        signal = switched[-1].output_labels[0]
    if rng.random() < 0.6:
        made.append(_valve(rng, signal))
        signal = "MV"
    made.append(_process(rng, signal))
    if measured:
        made.append(_sensor(rng))
    if rng.random() < 0.3:  # something algebraic behind everything else
        made.append(blocks.Gain("PV2", feedback, 2.0))
    driven = {s for block in made for s in block.output_labels}
    return wire(made, inputs=[s for s in read if s not in driven], name=f"n{n}")


def _controller(rng: np.random.Generator, inputs: dict[str, str], conditional: bool) -> Block:
    K_p, T_i = float(rng.uniform(0.2, 1.5)), float(rng.uniform(2.0, 15.0))
    common = {"inputs": inputs, "start_op": float(rng.uniform(0.0, 0.6))}
    kind = int(rng.integers(0, 10))
    if kind <= 2:
        return blocks.PI(K_p, T_i, anti_windup=str(rng.choice(["none", "back_calculation"])), **common)
    if kind == 3:
        return blocks.PI(K_p, T_i, anti_windup="conditional" if conditional else "back_calculation", **common)
    if kind <= 5:
        return blocks.PID(K_p, T_i, float(rng.uniform(0.2, 2.0)), b=float(rng.choice([0.5, 1.0])), **common)
    anti_windup = str(rng.choice(["none", "back_calculation", "conditional"]))
    offset = float(rng.choice([0.0, 0.05]))
    return blocks.SampledPI(K_p, T_i, dt=float(rng.choice(SCANS)), offset=offset, anti_windup=anti_windup, **common)


def _switching(rng: np.random.Generator, signal: str, read: list[str]) -> list[Block]:
    """Return one or two blocks that switch, and one behind them that samples, latches or limits rates."""
    made: list[Block] = []
    here = signal
    for k in range(int(rng.integers(1, 3))):
        others = [s for s in dict.fromkeys([signal, *read]) if s != here]
        made.append(_in_some_mode(rng, _switch(rng, f"mode{k}", here, [str(s) for s in rng.permutation(others)])))
        here = f"mode{k}"
    dt, start, level = float(rng.choice(ANY)), float(rng.uniform(-0.5, 1.0)), float(rng.uniform(0.0, 0.6))
    kind = int(rng.integers(0, 7))
    if kind == 6:
        edge = float(rng.uniform(0.1, 0.9)) * math.pi / dt
        return [*made, blocks.Biquad.low_pass("taken", here, edge, dt, start=start, zeta=float(rng.uniform(0.3, 1.0)))]
    if kind == 0:
        return [*made, blocks.ZeroOrderHold("taken", here, dt, start=start)]
    if kind == 1:
        return [*made, blocks.SampledFilter("taken", here, float(rng.uniform(0.0, 3.0)), dt, start=start)]
    if kind == 2:
        return [*made, blocks.VariableDelay("taken", here, read[0], dt=dt, longest=3.0, start=start)]
    if kind == 3:
        latch = float(rng.choice([-9.0, level - 0.2]))
        return [*made, blocks.Relay("taken", here, level, latch, high=start, low=0.1, on=bool(rng.random() < 0.2))]
    if kind == 4:
        to = float(rng.uniform(0.0, 0.5))
        return [*made, blocks.ResetIntegrator("taken", signal, here, rate=0.05, threshold=level, to=to)]
    first = None if rng.random() < 0.7 else start
    limited = blocks.RateLimiter("slow", here, float(rng.uniform(0.02, 0.3)), start=first)
    return [*made, limited, blocks.ZeroOrderHold("taken", "slow", dt)]


def _in_some_mode(rng: np.random.Generator, block: Block) -> Block:
    """Return the block, or a copy that starts in another of its modes, which its input may not call for."""
    others = [mode for mode in block.modes if mode not in ("ideal", block.mode)]
    return block.in_mode(str(rng.choice(others))) if others and rng.random() < 0.3 else block


def _switch(rng: np.random.Generator, name: str, signal: str, others: list[str]) -> Block:
    """Return a block whose mode follows its input; it may have to leave the one it is built with at the start."""
    low, high = float(rng.uniform(-0.3, 0.2)), float(rng.uniform(0.3, 0.6))
    kind = int(rng.integers(0, 7))
    if kind <= 1:
        pair = [signal, others[0]] if rng.random() < 0.5 else [others[0], signal]
        return blocks.MinSelect(name, pair) if kind == 0 else blocks.MaxSelect(name, pair)
    if kind <= 2:
        return blocks.DeadZone(name, signal, low, high)
    if kind == 3:
        table = rng.uniform(-0.5, 1.0, 4).tolist()
        beyond = str(rng.choice(["hold", "extend"]))
        return blocks.Lookup1D(name, signal, [low - 0.2, low, high, high + 0.4], table, beyond=beyond)
    if kind == 4:
        return blocks.Quantiser(name, signal, float(rng.uniform(0.05, 0.3)))
    if kind == 5 and len(others) > 1:
        return blocks.Switch(name, others[0], above=signal, below=others[1], switch_on=high, switch_off=low)
    return blocks.Relay(name, signal, high, low, high=float(rng.uniform(0.4, 1.0)), low=float(rng.uniform(-0.3, 0.2)))


def _valve(rng: np.random.Generator, signal: str) -> Block:
    J = float(rng.uniform(0.002, 0.04))
    S, start = J + float(rng.uniform(0.005, 0.06)), float(rng.uniform(0.0, 0.6))
    common = {"start": start, "inputs": signal}
    kind = int(rng.integers(0, 6))
    if kind <= 2:
        # a stem that creeps to rest behind a held or slow OP sticks where rounding says, unless v_stop decides
        v_stop = 1e-6 if rng.random() < 0.2 else float(rng.choice([1e-3, 1e-4]))  # never 0, see there
        mass = float(rng.choice([1.36, 10.0, 100.0]))
        friction = mass * float(rng.uniform(30.0, 450.0))
        return blocks.StickSlip.from_bands(S, J, M=mass, F_v=friction, v_stop=v_stop, **common)
    if kind == 3:
        return _in_some_mode(rng, blocks.QuasiStaticStem(S, J, **common))
    if kind == 4:
        return _in_some_mode(rng, blocks.Deadband(S, **common))
    return blocks.KanoValve(S, J, float(rng.choice(SCANS)), **common)


def _process(rng: np.random.Generator, signal: str) -> Block:
    K, tau = float(rng.uniform(0.5, 1.8)), float(rng.uniform(0.8, 8.0))
    theta = float(rng.choice([0.0, 0.0, float(rng.uniform(0.1, 2.5)), float(rng.choice([0.5, 1.0]))]))
    kind = int(rng.integers(0, 4))
    inputs = {"MV": signal}
    if kind <= 1:
        return blocks.FirstOrder(K, tau, theta, start=float(rng.uniform(0.0, 0.5)), inputs=inputs)
    if kind == 2:
        return blocks.SecondOrder(K, 1.0 / tau, float(rng.uniform(0.3, 1.5)), theta, inputs=inputs)
    return blocks.Integrator(0.2 * K, 2.0 * tau, theta, u_0=float(rng.uniform(0.1, 0.4)), inputs=inputs)


def _sensor(rng: np.random.Generator) -> Block:
    tau = float(rng.choice([0.0, float(rng.uniform(0.2, 2.0))]))
    if rng.random() < 0.3:
        return Sensor(tau, low=-0.5, high=float(rng.uniform(0.4, 1.5)))
    return SampledSensor(
        float(rng.choice(SCANS)), sd=float(rng.choice([0.0, 0.01])), tau=tau, high=float(rng.uniform(0.5, 1.5)),
        step=float(rng.choice([0.0, 0.0, 0.01])), offset=float(rng.choice([0.0, 0.03])),
    )  # fmt: skip
