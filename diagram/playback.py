"""Signals of a log or a table as inputs of a run, held or joined by straight lines between the samples.

A missing sample (NaN, or marked bad) is left out: a held signal keeps its last good value, as a historian shows it, a
joined one goes straight on to the next good value.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.recorded import Recorded
from stickslip.diagram.wiring import WiringError
from stickslip.logs import Log
from stickslip.logs.from_table import from_table


@dataclass(frozen=True)
class Playback:
    """A log as input: all its signals, or ``signal``, played back with ``hold`` "previous" or "linear"."""

    log: Log
    hold: str
    signal: str = ""

    def block(self, name: str, signal: str, unit: str) -> "Played":
        """Return the source of the input ``signal``, which is in ``unit``.

        Raises ``WiringError`` if the log has no good sample of it, or has it in another unit.
        """
        column = self.signal or signal
        good = self.log.good(column)
        known = self.log.units.get(column, "")
        if not good.any():
            raise WiringError(
                f"input '{signal}': none of the log's {len(good)} samples of '{column}' is good; drive it otherwise"
            )
        if known and unit and known != unit:
            raise WiringError(
                f"input '{signal}' is in [{unit}], but the log has '{column}' in [{known}]; convert it: "
                f'log.with_signal("{column}", log["{column}"] * factor, unit="{unit}")'
            )
        played = Played(signal, self.log.t[good], self.log[column][good], self.log.t, self.hold, known, name)
        played.clock = self.log.start
        return played


class Played(Recorded):
    """A signal of a log, which knows from when to when it was logged.

    ``logged``: first and last time of the log and its usual sampling interval [s].
    """

    def __init__(self, signal: str, t: Any, values: Any, stamps: Any, hold: str, unit: str, name: str) -> None:
        self.logged = float(stamps[0]), float(stamps[-1]), float(np.median(np.diff(stamps))) if len(stamps) > 1 else 0.0
        super().__init__(signal, t, values, hold=hold, unit=unit, name=name)


def held(table: Any, signal: str = "") -> Playback:
    """Return a log or table as input of a run, each value held until the next sample: outputs of a DCS, set points.

    ``signal`` names the column where it has another name than the input.  A table is what ``stickslip.logs.from_table``
    takes: a frame of pandas or polars, or a mapping of arrays, with a ``time`` [s].

    Raises ``LogError`` for what is no table, or has no such column.

    >>> from stickslip.blocks import FirstOrder
    >>> from stickslip.diagram import drive
    >>> log = {"time": [0.0, 10.0], "OP": [1.0, 0.0]}
    >>> drive(FirstOrder(K=2.0, tau=5.0), 15.0, every=5.0, MV=held(log, "OP")).log["PV"].round(4).tolist()
    [0.0, 1.2642, 1.7293, 0.6362]
    """
    return _playback(table, "previous", signal)


def interpolated(table: Any, signal: str = "") -> Playback:
    """Return a log or table as input of a run, its samples joined by straight lines; otherwise as ``held``.

    For a signal that moves smoothly from sample to sample; between two samples it knows the later one already.

    >>> from stickslip.blocks import Gain
    >>> from stickslip.diagram import drive
    >>> log = {"time": [0.0, 10.0], "PV": [1.0, 0.0]}
    >>> drive(Gain("percent", "PV", 100.0), 10.0, every=5.0, PV=interpolated(log)).log["percent"].tolist()
    [100.0, 50.0, 0.0]
    """
    return _playback(table, "linear", signal)


def is_table(given: Any) -> bool:
    """Return whether an input is given as a log or a frame."""
    from stickslip.logs.files.frames import frame_kind

    return isinstance(given, Log) or bool(frame_kind(given))


def check_logged(blocks: Iterable[Block], t0: float, t_end: float) -> None:
    """Raise ``ValueError`` if a run from ``t0`` to ``t_end`` [s] would go beyond a log that it plays back.

    A run has one clock: recorded signals whose time 0 is not the same moment are refused too.
    """
    stamped: Block | None = None
    for block in blocks:
        if block.clock is not None:
            stamped = stamped or block
            if block.clock != stamped.clock:
                raise ValueError(
                    f"time 0 is {stamped.clock} for '{stamped.output_labels[0]}', but {block.clock} for "
                    f"'{block.output_labels[0]}'; count both in seconds from one moment, e.g. "
                    "(index - start).total_seconds()"
                )
        if isinstance(block, Played):
            first, last, dt = block.logged
            if t0 < first - 1e-9 * abs(first) or t_end > last + 1.001 * dt:
                raise ValueError(
                    f"the log of '{block.output_labels[0]}' runs from {first:g} to {last:g} s, one value every {dt:g} "
                    f"s, but the run from {t0:g} to {t_end:g} s; give t0= and a duration within it, or hold its ends "
                    "on purpose with a pair (t, values)"
                )


def _playback(table: Any, hold: str, signal: str) -> Playback:
    log = table if isinstance(table, Log) else from_table(table)
    if signal:
        log[signal]
    return Playback(log, hold, signal)
