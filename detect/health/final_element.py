"""Does the loop have a valve? What OP moves, as far as the log shows it.

    cascade   OP is the set point of another loop, as the diagram or the file notes it (``LoopSignals.master_of``)
    unit      OP is a speed, a flow, a temperature, a torque, a power or a frequency: another controller's set point, or
              the command of a machine; valves are moved by %, a share of span, mA, V, a pressure or a travel

A loop whose stem is logged has a valve, and a unit that is not known says nothing.
"""

from stickslip.detect.health.fact import Fact
from stickslip.logs import LoopRecord
from stickslip.logs.tags import measurement_in

NO_VALVES = ("speed", "flow", "temperature")
MACHINES = ("n m", "nm", "n·m", "w", "kw", "mw", "hz")  # what no instrument of `stickslip.logs.tags` measures


def no_valve(record: LoopRecord) -> Fact:
    """Whether the log shows that OP moves no valve.

    >>> from stickslip.logs import Log
    >>> log = Log([0.0, 1.0], {"PV": [4.0, 5.0], "OP": [50.0, 51.0]}, units={"OP": "N m"})
    >>> no_valve(log.loop()).text
    'There is no valve in this loop: OP is in N m.'
    """
    unit = record.log.units.get(record.op_name, "")
    parts = (record.pv_name, record.op_name)
    below = next((loop.master_of for loop in record.log.loops.values() if (loop.pv, loop.op) == parts), "")
    moves_none = measurement_in(unit) in NO_VALVES or unit.strip().casefold() in MACHINES
    present = record.mv_name is None and (bool(below) or moves_none)
    why = f"OP is the set point of {below}" if below else f"OP is in {unit}"
    text = f"There is no valve in this loop: {why}." if present else "OP is not known to move anything but a valve."
    return Fact("no_valve", present, float(present), 0.5, text, "Judge the loop that has the valve.")
