"""A diagram with pins behind the drivers of its logged signals: see ``pins`` for what that is good for."""

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.arguments import texts
from stickslip.blocks.pin import Pin
from stickslip.blocks.ports import nearest
from stickslip.blocks.recorded import Recorded
from stickslip.diagram.changes import rebuilt
from stickslip.diagram.inputs import close, source_name
from stickslip.diagram.wired import D, Wired
from stickslip.diagram.wiring import WiringError
from stickslip.logs import Log

Floats = NDArray[np.float64]
Fresh = Mapping[str, tuple[float, float]]  # signal -> (period, first time) [s] of noise that is drawn anew
DRAWN = 1e-6  # of a period: what is drawn so soon behind a row is what the row shows
SHARED = 256  # pins and sources that copies of a diagram share, with their tables


def pinned(diagram: D, log: Log, signals: Sequence[str] | None = None, fresh: Fresh | None = None) -> D:
    """Return the diagram with a pin behind the driver of every logged signal; see ``Diagram.pinned``."""
    if not isinstance(log, Log):
        raise WiringError(f"the diagram is to be pinned to {log!r:.60}; give a Log, e.g. Log(t=..., signals={{...}})")
    names = logged(diagram, log, signals)
    played, pins = pin_blocks(diagram, log, names, fresh)
    if played:
        diagram = close(diagram, played)
    model = {pin.output_labels[0]: pin.input_labels[0] for pin in pins}
    blocks = [
        block.relabelled(block.name, list(block.input_labels), [model.get(s, s) for s in block.output_labels])
        for block in diagram.blocks
    ]
    return rebuilt(diagram, [*blocks, *pins], diagram.open_inputs, diagram.declared_outputs)


def pin_blocks(
    diagram: Wired, log: Log, names: Sequence[str], fresh: Fresh | None = None
) -> tuple[dict[str, Recorded], list[Pin]]:
    """Return the sources that play the logged open inputs, and the pins of the other signals."""
    played = {s: _source(log, s, source_name(diagram, s)) for s in names if s in diagram.open_inputs}
    pins = []
    for s in names:
        if s not in played:
            folder, _, _ = s.rpartition("/")
            driver = diagram.blocks[diagram.driven[s][0]]
            drawn = (*fresh[s], driver.sampled) if fresh and s in fresh else None
            name = driver.name.removeprefix(f"{folder}/")
            pins.append(_pin(log, s, name, diagram.signal_units[s], diagram.signal_spans.get(s), drawn))
    return played, pins


@lru_cache(maxsize=SHARED)
def _source(log: Log, signal: str, name: str) -> Recorded:
    """Return the source that plays a logged open input; the same one again for the next diagram."""
    source = Recorded(signal, *_samples(log, signal), hold="previous", name=name)
    source.clock = log.start
    return source


@lru_cache(maxsize=SHARED)
def _pin(
    log: Log, s: str, driver: str, unit: str, span: tuple[float, float] | None, drawn: tuple[float, float, bool] | None
) -> Pin:
    """Return the pin behind the driver of a signal; the same one again for the next diagram."""
    t, values = _samples(log, s)
    until = None
    if drawn is not None:
        t, until = _in_force(t, *drawn)
    pin = Pin(
        t,
        values,
        until=until,
        name=f"{s} pin",
        inputs=[f"{s}:{driver}"],
        outputs=[s, f"{s}:offset"],
        units=dict.fromkeys(("r", "s", "offset"), unit),
        spans=None if span is None else {"s": span},
    )
    pin.clock = log.start
    return pin


def _in_force(t: Floats, period: float, first: float, held: bool) -> tuple[Floats, Floats]:
    """Return from when on and until when [s] the noise that rows show is there, drawn every ``period`` from ``first``.

    ``held``: the signal has stood since the draw, so that a row shows what was there before it.
    """
    k = np.floor((t - first) / period + DRAWN)
    drawn, until = first + k * period, first + np.maximum(k + 1.0, 0.0) * period
    since = (drawn < t) & (drawn > np.concatenate([t[:1], t[:-1]])) if held else np.zeros(len(t), dtype=bool)
    return np.where(since, drawn, t), until


def logged(diagram: Wired, log: Log, signals: Sequence[str] | None) -> list[str]:
    """Return the signals to pin: those named, or all that log and diagram share.

    Raises ``WiringError`` if they share none, or for a named signal that one of them has not.
    """
    known = [*diagram.open_inputs, *diagram.signals]
    if signals is None:
        names = [s for s in known if s in log and log.good(s).any()]
        if not names:
            raise WiringError(
                f"the log has none of the diagram's signals: it has {', '.join(log.names) or 'none'}; "
                f"rename them with log.renamed({{...}}) to some of {', '.join(known[:20])}"
            )
        return names
    for s in texts(diagram.name, "signals", signals):
        if s not in known:
            raise WiringError(f"the diagram has no signal '{s}' to pin; {nearest(s, known)}")
        if not log.good(s).any():
            raise WiringError(f"the log has no good sample of '{s}', so it cannot be pinned; leave it out of signals=")
    return list(dict.fromkeys(signals))


def _samples(log: Log, signal: str) -> tuple[Floats, Floats]:
    good = log.good(signal)
    return log.t[good], log[signal][good]
