"""Where a diagram rests: python-control's ``find_operating_point``, scaled and given exact slopes.

States of one diagram span ten decades (a valve opening of 0.1 beside a pressure of 1e7 Pa), and integrators that
are held at a limit (a flare that is shut, a valve at its stop) make the equations singular.  So

1. sources stand still at their values at time ``t``, sticky stems are seen without friction, blocks that sample as
   their continuous twins or, without one, as what they settle to, dead times as none;
2. each state is divided by its size, each rate by its largest slope, and states that nothing moves are left out;
3. ``find_operating_point`` solves the rest with the slopes of ``slopes``;
4. if that fails from the start given, the diagram is simulated for longer and longer times to come nearer, as a
   plant is brought up, and solved from there.
"""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import control as ct
import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.at_rest import AtRest, NoRest
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.blocks.sources import Constant
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.inputs import close
from stickslip.diagram.linear.slopes import Slopes, check_time, slopes
from stickslip.diagram.simulation import simulate
from stickslip.engine.status import Status

Floats = NDArray[np.float64]
SETTLE = (300.0, 3e3, 3e4, 3e5)  # s, simulated one after the other where solving fails
MOST_STEPS = 100_000  # of one such simulation; a diagram that needs more is not coming to rest
NOTHING = 1e-9  # a state smaller than this counts as zero
ROUNDS = 4  # of solving, as held states may change meanwhile


class NoOperatingPoint(ValueError):
    """The diagram cannot rest as asked; the message says what keeps moving and what stands at a limit."""


@dataclass(frozen=True)
class OperatingPoint:
    """Where a diagram rests.

    ``diagram`` stands there, stems and all, and can be simulated or linearised; ``states`` and ``signals`` by name;
    ``residual`` the largest rate left, relative to each state's own; ``held`` states that nothing moves there (the
    integrators of controllers at a limit); ``settled`` seconds simulated to come near, 0 if solving alone did.
    """

    diagram: Diagram
    states: Mapping[str, float]
    signals: Mapping[str, float]
    residual: float
    held: tuple[str, ...]
    settled: float

    def __getitem__(self, signal: str) -> float:
        """Return the value of a signal or state."""
        return self.signals[signal] if signal in self.signals else self.states[signal]


def operating_point(
    diagram: Diagram,
    start: Diagram | Mapping[str, float] | None = None,
    *,
    inputs: Mapping[str, Any] | None = None,
    t: float = 0.0,
    tolerance: float = 1e-9,
) -> OperatingPoint:
    """Return where ``diagram`` rests, found from ``start``.

    Parameters: ``start`` a diagram whose states to begin with (say, the same plant at rest for another feed), or
    values as for ``Diagram.starting_at`` (default: where the diagram starts); ``inputs`` values of open inputs; ``t``
    time at which sources stand still [s]; ``tolerance`` largest relative rate left.

    Raises ``NoOperatingPoint`` if there is no rest, with what keeps moving and which controllers are at a limit.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> point = operating_point(self_regulating_loop(setpoint=0.6))
    >>> round(point["PV"], 9), round(point["OP"], 9), point.held
    (0.6, 0.2, ())
    """
    check_time(t)
    if not tolerance > 0.0:
        raise ValueError(f"tolerance = {tolerance!r}, but a largest relative rate is positive; give 1e-9 or so")
    closed = close(diagram, inputs) if inputs else diagram
    if closed.open_inputs:
        name = closed.open_inputs[0]
        raise ValueError(f"the diagram's input '{name}' is open; give it a value: inputs={{'{name}': 0.0}}")
    closed = closed.starting_at(_values(closed, start)).with_past(None)  # at rest nothing is under way
    point, settled, ended = still(closed, t), 0.0, ""
    found = _solved(point, t, tolerance)
    for duration in SETTLE:
        if found is not None or ended:
            break
        point, ended = _settled(point, duration, t)
        settled += 0.0 if ended else duration
        found = _solved(point, t, tolerance)
    if found is None:
        raise NoOperatingPoint(_why(point, t, ended or f"after {settled:g} s"))
    states = dict(zip(found.states, found.x.tolist(), strict=True))
    signals = dict(zip(found.signals, found.s.tolist(), strict=True))
    placed = _placed(closed, states, signals)
    here = dict(zip(placed.state_labels, placed.x0.tolist(), strict=True)) | states  # of stems with friction too
    return OperatingPoint(placed, here, signals, residual(found), held(found), settled)


# --- the diagram to solve -----------------------------------------------------------------------------------


def _values(diagram: Diagram, start: Diagram | Mapping[str, float] | None) -> Mapping[str, float]:
    """Return start values by ``block.state`` for the states that the diagram has."""
    if start is None:
        return {}
    if not isinstance(start, Diagram):
        return start
    found = {}
    for block in start.blocks:
        for name, value in zip(block.state_names, block.x0, strict=True):
            found[f"{block.name}.{name}"] = float(value)
    mine = {f"{block.name}.{name}" for block in diagram.blocks for name in block.state_names}
    return {key: value for key, value in found.items() if key in mine}


def still(diagram: Diagram, t: float) -> Diagram:
    """Return the diagram without friction, sampling, dead time and time."""
    blocks: list[Block] = []
    for block in diagram.blocks:
        if block.dead_time_param:  # at rest nothing is under way
            block = block.with_params(**{block.dead_time_param: 0.0})
        seen = block.without_friction().smooth()
        if block.role.drives and len(seen.ports_out) == 1:
            label = block.output_labels[0]
            seen = Constant(label, float(seen.output(t, np.zeros(0), np.zeros(0))[0]), name=block.name)
        elif seen.samples_kept:
            seen = AtRest(block, t)
        blocks.append(seen)
    return Diagram(blocks, (), diagram.declared_outputs, diagram.name)


def _settled(diagram: Diagram, duration: float, t: float) -> tuple[Diagram, str]:
    """Return the diagram as it stands after a while and "", or as it stood and why it does not get there."""
    try:
        run = simulate(diagram, duration, every=duration, t0=t, method="stiff", max_steps=MOST_STEPS)
    except NoRest as error:
        raise NoOperatingPoint(f"'{diagram.name}' comes to no rest: {error}") from error
    if run.status is Status.INTERRUPTED:
        raise KeyboardInterrupt
    return (still(run.final, t), "") if run.ok else (diagram, f"on the way {run.hint}")


def _placed(diagram: Diagram, states: Mapping[str, float], signals: Mapping[str, float]) -> Diagram:
    """Return the diagram at rest: stems where OP is and stuck, dead times filled with what stands there."""
    blocks: list[Block] = []
    for block in diagram.blocks:
        at = {n: states[f"{block.name}[{n}]"] for n in block.state_names if f"{block.name}[{n}]" in states}
        OP = block.loop_signal("OP")
        if block.can_stick and OP is not None and OP in signals:
            rest = float(np.clip(signals[OP], *block.limits))
            at |= {n: rest for n in (*block.state_names, *block.memory_names) if n == "x"}
        block = block.starting_at(**at)
        if block.before_param:
            block = block.with_params(**{block.before_param: signals[block.input_labels[0]]})
        blocks.append(block)
    return diagram.with_blocks(blocks)


# --- solving ------------------------------------------------------------------------------------------------


def _solved(diagram: Diagram, t: float, tolerance: float) -> Slopes | None:
    """Return the diagram at its operating point, or None."""
    try:
        here = slopes(diagram, t)
        for _ in range(ROUNDS):
            if residual(here) <= tolerance:
                return here
            x = _step_to_rest(here, t)
            if x is None or not np.all(np.isfinite(x)):
                return None
            here = slopes(here.diagram.at_state(x), t)
    except (ValueError, ArithmeticError, RuntimeError, np.linalg.LinAlgError):
        # A guess outside what the equations allow; where they give NaN, python-control suspects an algebraic loop.
        return None
    return here if residual(here) <= tolerance else None


def _step_to_rest(here: Slopes, t: float) -> Floats | None:
    """Return what ``find_operating_point`` finds from here for the states that move, the others as they are."""
    still = unmoved(here)
    free = np.array([name not in still for name in here.states])
    size, pace = sizes(here)
    if not free.any():
        return None

    def at(z: Floats) -> Floats:
        x = here.x.copy()
        x[free] = z * size[free]
        return x

    def rates(t: float, z: Floats, u: Floats, params: Any) -> Floats:
        return np.asarray(here.diagram.dynamics(t, at(z), u)[free] / pace[free])

    def jacobian(z: Floats) -> Floats:
        A = slopes(here.diagram.at_state(at(z)), t).joined()[0]
        return np.asarray(A[np.ix_(free, free)] * size[free] / pace[free, None])

    scaled = ct.NonlinearIOSystem(rates, None, inputs=0, outputs=int(free.sum()), states=int(free.sum()), name="scaled")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a guess may overflow; then it is no solution
        found = ct.find_operating_point(
            scaled, here.x[free] / size[free], [], t=t,
            root_kwargs={"jac": jacobian, "options": {"xtol": 1e-13}}, return_result=True,
        )  # fmt: skip
    return at(found.states)


def sizes(here: Slopes) -> tuple[Floats, Floats]:
    """Return the size of each state and the largest share any state has in its rate."""
    A = here.joined()[0]
    size = np.where(np.abs(here.x) > NOTHING, np.abs(here.x), 1.0)
    pace = (np.abs(A) * size).max(axis=1, initial=0.0)
    return size, np.where(pace > 0.0, pace, size)


def residual(here: Slopes) -> float:
    """Return the largest rate, each relative to the pace of its state."""
    return float((np.abs(here.rates) / sizes(here)[1]).max(initial=0.0))


def held(here: Slopes) -> tuple[str, ...]:
    """Return the states that are held: unmoved ones of blocks that have a use for them."""
    idle = here.idle
    return tuple(name for name in unmoved(here) if name not in idle)


def unmoved(here: Slopes) -> tuple[str, ...]:
    """Return the states that neither move nor depend on anything."""
    A = here.joined()[0]
    return tuple(s for i, s in enumerate(here.states) if not A[i].any() and here.rates[i] == 0.0)


def _why(diagram: Diagram, t: float, when: str) -> str:
    """Return what keeps the diagram from resting; ``when`` the search gave up."""
    advice = "give a load that the valves can carry, a start nearer to rest, or another time t for its sources"
    parts = [f"'{diagram.name}' comes to no rest: {when}"]
    if any(block.trouble() for block in diagram.blocks):
        return "; ".join([*parts, advice])
    here = slopes(diagram, t)
    pace = np.abs(here.rates) / sizes(here)[1]
    moving = [f"{here.states[i]} ({here.rates[i]:+.3g}/s)" for i in np.argsort(-pace)[:3] if pace[i] > 0.0]
    parts[0] += f" still moving are {', '.join(moving)}" if when.startswith("after") else ""
    values = dict(zip(here.signals, here.s.tolist(), strict=True))
    for block in diagram.blocks:
        SP, PV = (values.get(block.loop_signal(part) or "") for part in ("SP", "PV"))
        if block.role is not Role.CONTROLLER or SP is None or PV is None:
            continue
        if abs(SP - PV) > 1e-6 * max(abs(SP), abs(PV)):
            OP = values[block.output_labels[0]]
            where = " at its limit" if OP in block.limits else ""
            parts.append(f"{block.name} misses its set point by {SP - PV:.3g} with OP = {OP:.4g}{where}")
    return "; ".join([*parts, advice])
