"""Records of control loops: time and named signals, with units, spans and quality.

A ``Log`` holds signals on one time axis. A ``LoopRecord`` is a view of a log as one control loop: set point SP,
measurement PV, controller output OP and, where the plant measures it, stem position MV; e = SP - PV. Simulators
make logs, historians are read into them, detectors take loop records.

``read_log``, ``read_loop`` and ``read_loops`` read CSV, text and Parquet files as historians and control systems export
them, and data frames of pandas, polars and pyarrow: any usual separator, decimal mark, encoding and time stamp; times
of numbers in any usual unit; one column a tag or one row a value; digital states ("Bad Input") in place of numbers;
quality columns; loop columns by the names the usual systems give them. Nothing is asked: whatever was assumed or
repaired, and every column not used, is a sentence in ``notes``, and a file that cannot be read raises ``ReadError``
with the line, the rule and the remedy. A file that runs from the newest row to the oldest is turned round, and stamps
that a historian has rounded are evened out. What is never done: sort rows, choose between two values at one time,
fill a gap, or guess a number from a text.

The package needs numpy; polars and matplotlib are imported when a file is read or a figure drawn.
"""

from typing import TYPE_CHECKING, Any

from stickslip.logs.errors import LogError, ReadError
from stickslip.logs.log import Log
from stickslip.logs.loop import LoopRecord
from stickslip.logs.loop_signals import LoopSignals

if TYPE_CHECKING:
    from stickslip.logs.files.read import read_log, read_loop, read_loops

__all__ = ["Log", "LogError", "LoopRecord", "LoopSignals", "ReadError", "read_log", "read_loop", "read_loops"]


def __getattr__(name: str) -> Any:
    """Load the readers when they are asked for; a simulation reads no files."""
    if name not in ("read_log", "read_loop", "read_loops"):
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    from stickslip.logs.files import read

    return getattr(read, name)
