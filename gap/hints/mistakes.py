"""What people get wrong when they bring a model and a log: units, signs, the order of columns, clocks.

Each mistake is a log, or a model, in which it is put right.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.logs import Log

DECIMAL = tuple(10.0**k for k in (-5, -3, -2, -1, 1, 2, 3, 5))
UNITS = {  # factor between two units of one quantity: what it is between
    1.8: "degrees Fahrenheit and Celsius", 3.6: "t/h and kg/s, or km/h and m/s", 60.0: "per minute and per second",
    3600.0: "per hour and per second", 6.894757: "psi and kPa", 14.503774: "psi and bar", 0.3048: "feet and metres",
}  # fmt: skip
FAHRENHEIT, KELVIN = 32.0, 273.15  # where their zeros lie, or 0 degrees Celsius is


@dataclass(frozen=True, eq=False)
class Mistake:
    """A mistake put right: ``diagram`` and ``log`` as they should be, ``words`` of what it is, ``density`` the sum of
    ln |factor| of each good value by which the log was scaled.
    """

    words: str
    diagram: Diagram
    log: Log
    density: float = 0.0


def of_units(diagram: Diagram, log: Log) -> Iterator[Mistake]:
    """Yield the log with outputs of controllers, or what they control, in other units."""
    for controller in _controllers(diagram):
        op, sp, pv = (str(controller.loop_signal(role)) for role in ("OP", "SP", "PV"))
        if op in log:
            for by in (100.0, 0.01):
                yield _scaled(diagram, log, (op,), by, 0.0, f"{op} is logged as {by:g} times what the model has")
            low, high = controller.limits
            if np.isfinite([low, high]).all():
                turned = low + high - log[op]
                words = f"{op} is logged as {low + high:g} minus what the model has: an opening in place of a closing"
                yield Mistake(words, diagram, log.with_signals(**{op: turned}))
        both = tuple(s for s in dict.fromkeys((pv, sp)) if s in log and s in (*diagram.signals, *diagram.open_inputs))
        if both:
            yield from _in_other_units(diagram, log, both)
        if len(both) == 2:
            apart = _in_other_units(diagram, log, both[:1])
            yield from (one for one in apart if _from_each_other(one.log, pv, sp) < _from_each_other(log, pv, sp))
            swapped = log.with_signals(**{pv: log[sp], sp: log[pv]})
            yield Mistake(f"the columns of {pv} and {sp} are exchanged", diagram, swapped)


def of_controllers(diagram: Diagram, log: Log) -> Iterator[Mistake]:
    """Yield the model with a controller that acts the other way, or sums the other error."""
    for block in _controllers(diagram):
        params = block.params
        if "action" in params:
            turned = diagram.with_params({f"{block.name}.action": -params["action"]})
            yield Mistake(f"{block.name} acts the other way: direct for reverse, or reverse for direct", turned, log)
        if "present" in params:
            other = "previous" if params["present"] else "present"
            found = diagram.replace(block.name, block.with_params(present=1.0 - params["present"]))
            yield Mistake(f'the integral of {block.name} takes in the {other} error: integral="{other}"', found, log)


def late(diagram: Diagram, log: Log, signal: str, rows: int) -> Mistake:
    """Return the log with a signal that was stamped so many rows too late; too early where they are negative."""
    at = np.clip(np.arange(len(log)) + rows, 0, len(log) - 1)
    way = "late" if rows > 0 else "early"
    words = f"the time stamps of {signal} are {abs(rows) * log.dt:g} s too {way} against the other columns"
    return Mistake(words, diagram, log.with_signals(**{signal: log[signal][at]}))


def _controllers(diagram: Diagram) -> Iterator[Block]:
    """Yield the controllers of a diagram that say what is their OP, SP and PV."""
    for block in diagram.blocks:
        if block.role is Role.CONTROLLER and block.limit_params is not None and len(block.input_labels) > 1:
            yield block


def _from_each_other(log: Log, pv: str, sp: str) -> float:
    """Return how far a loop is from its set point in the mean: PV alone is in other units only if that falls."""
    return float(np.nanmean(np.abs(log[pv] - log[sp])))


def _zero(by: float) -> float:
    """Return the offset that goes with a factor between two scales of temperature, 0 for none."""
    return FAHRENHEIT if by == 1.8 else -FAHRENHEIT / 1.8 if by == 1.0 / 1.8 else 0.0


def _in_other_units(diagram: Diagram, log: Log, signals: tuple[str, ...]) -> Iterator[Mistake]:
    """Yield the log with signals in each other unit that their numbers may have."""
    said = f"{signals[0]} is logged" if len(signals) == 1 else f"{' and '.join(signals)} are logged"
    for by in (*DECIMAL, *UNITS, *(1.0 / one for one in UNITS)):
        between = next((f", the factor between {UNITS[one]}" for one in (by, 1.0 / by) if one in UNITS), "")
        for offset in dict.fromkeys((0.0, _zero(by))):
            more = f" plus {offset:.6g}" if offset else ""
            yield _scaled(
                diagram, log, signals, by, offset, f"{said} as {by:.6g} times what the model has{more}{between}"
            )
    for zero in (KELVIN, -KELVIN):
        words = f"{said} as what the model has {'plus' if zero > 0.0 else 'minus'} {KELVIN:g}: kelvin, degrees Celsius"
        yield _scaled(diagram, log, signals, 1.0, zero, words)


def _scaled(diagram: Diagram, log: Log, signals: tuple[str, ...], by: float, offset: float, words: str) -> Mistake:
    """Return the log with signals that were logged as ``by`` times the model's plus ``offset``."""
    changed = {s: (log[s] - offset) / by for s in signals}
    driven = sum(int(log.good(s).sum()) for s in signals if s not in diagram.open_inputs)
    return Mistake(words, diagram, log.with_signals(**changed), driven * float(np.log(abs(by))))
