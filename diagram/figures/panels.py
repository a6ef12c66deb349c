"""The panels of a figure of a run: which signals share one, which are omitted, and the text at the axis."""

from collections.abc import Iterable, Sequence

import numpy as np
from stickslip.blocks.arguments import texts
from stickslip.blocks.block import Block
from stickslip.blocks.declared import PARTS
from stickslip.blocks.ports import nearest
from stickslip.blocks.role import Role
from stickslip.diagram.simulation import Run
from stickslip.diagram.wired import Wired
from stickslip.logs import Log
from stickslip.logs.trend import rests

PANELS = 8  # most panels when nobody says which signals to show
TOGETHER = 4  # most signals on one axis that share no more than a unit
ALIKE = 5.0  # how far the ranges of two signals may differ to share an axis for their unit alone
FAR = 1.0  # ranges of what moves; a set point farther off is not drawn
WIDE = 17  # letters beside a panel


def choose(run: Run, names: Sequence[str] | None) -> tuple[list[list[str]], list[str], list[str]]:
    """Return the signals of each panel, those left out, and the resting ones that would have flattened the others.

    Raises ``ValueError`` for an unknown name, and if there is nothing to show.
    """
    diagram, log = run.final, run.log
    chosen = list(log.names) if names is None else list(texts("plot", "names", names))
    for signal in chosen:
        if signal not in log:
            raise ValueError(f"the run logged no signal '{signal}'; {nearest(signal, list(log.names))}")
    if not chosen:
        raise ValueError("there is no signal to plot; name one, or log one")
    panels = _together(diagram, log, chosen)
    if names is not None:
        return panels, [], []
    if len(panels) > PANELS:
        panels = _most_moving(run, panels)
    shown = {s for panel in panels for s in panel}
    squashing = [s for panel in panels for s in _squashing(log, panel)]
    panels = [[s for s in panel if s not in squashing] for panel in panels]
    return panels, [s for s in chosen if s not in shown], squashing


def _most_moving(run: Run, panels: list[list[str]]) -> list[list[str]]:
    """Return ``PANELS`` panels in their order: first what controllers measure and sticking valves, last what rests."""
    diagram, log = run.final, run.log
    main = main_signals(diagram)
    measured = {block.loop_signal("PV") for block in diagram.blocks if _controls(block)}
    sticking = {s for block in diagram.blocks if block.can_stick for s in block.output_labels}

    def rank(panel: list[str]) -> int:
        if not any(_moves(log, s) for s in panel):
            return 3
        return 0 if measured.intersection(panel) or sticking.intersection(panel) else 1

    kept = [panel for panel in panels if main.intersection(panel)] or panels
    best = sorted(range(len(kept)), key=lambda i: rank(kept[i]))[:PANELS]
    return [kept[i] for i in sorted(best)]


def _moves(log: Log, signal: str) -> bool:
    return not rests(log[signal])


def _squashing(log: Log, panel: Sequence[str]) -> list[str]:
    """Return the signals that rest so far away that the moving ones would be a line on a common axis.

    The nearest of those that rest stays: it may be the set point that is missed.
    """
    moving = [log[s][np.isfinite(log[s])] for s in panel if _moves(log, s)]
    if not moving:
        return []
    low, high = min(float(y.min()) for y in moving), max(float(y.max()) for y in moving)
    away = {}
    for s in panel:
        y = log[s][np.isfinite(log[s])]
        if y.size and not _moves(log, s):
            away[s] = max(low - float(y[0]), float(y[0]) - high)
    nearest_one = min(away, key=lambda s: away[s], default=None)
    return [s for s in away if s != nearest_one and away[s] > FAR * (high - low)]


def main_signals(diagram: Wired) -> set[str]:
    """Return the signals an operator looks at: SP, PV and OP of controllers, and what valves give.

    >>> from stickslip.blocks.sources import Step
    >>> from stickslip.diagram import wire
    >>> main_signals(wire([Step("SP", 0.5)], outputs=["SP"]))
    set()
    """
    found: set[str] = set()
    for block in diagram.blocks:
        if block.role is Role.VALVE or _controls(block):
            found |= {*block.input_labels, *block.output_labels}
    return found


def _controls(block: Block) -> bool:
    """Return whether a block holds a PV at an SP: a controller, or a valve with one of its own."""
    acts = block.role in (Role.CONTROLLER, Role.VALVE)
    return acts and block.loop_signal("SP") is not None and block.loop_signal("PV") is not None


def _together(diagram: Wired, log: Log, chosen: Sequence[str]) -> list[list[str]]:
    """Return which signals share a panel: SP with PV, OP with MV, then what has one unit and a similar range."""
    panel = {signal: [signal] for signal in chosen}

    def join(signals: Iterable[str]) -> None:
        present = [s for s in signals if s in panel]
        for other in present[1:]:
            if panel[other] is not panel[present[0]]:
                merged = [*panel[present[0]], *panel[other]]
                panel.update(dict.fromkeys(merged, merged))

    for block in diagram.blocks:
        for pair in (("SP", "PV"), ("OP", "MV")):
            found = [signal for part in pair if (signal := block.loop_signal(part)) is not None]
            if len(found) == len(pair):
                join(found)
    for i, signal in enumerate(chosen):
        for other in chosen[:i]:
            one, two = panel[signal], panel[other]
            alone = len(one) == 1 and len(two) < TOGETHER and one is not two
            if (
                alone
                and log.units.get(signal)
                and log.units.get(signal) == log.units.get(other)
                and _alike(log, signal, other)
            ):
                join((other, signal))
    return list({id(shown): shown for shown in panel.values()}.values())


def _alike(log: Log, a: str, b: str) -> bool:
    sizes = [float(np.ptp(log[s][np.isfinite(log[s])])) if np.isfinite(log[s]).any() else 0.0 for s in (a, b)]
    both = np.concatenate([log[a], log[b]])
    whole = float(np.nanmax(both) - np.nanmin(both)) if np.isfinite(both).any() else 0.0
    return whole <= ALIKE * max(min(sizes), 1e-12)


def parts_played(diagram: Wired, shown: Sequence[str]) -> list[str]:
    """Return the part each signal plays in its panel: SP, PV, OP, MV for controllers and valves, else its name."""
    played: dict[str, list[str]] = {signal: [] for signal in shown}
    wired = [(part, block.loop_signal(part), block) for block in diagram.blocks for part in PARTS]
    for out in (True, False):  # outputs first: a signal is what drives it
        for part, label, block in wired:
            if label is not None and label in played and (label in block.output_labels) is out:
                played[label].append(part)
    loop = any("PV" in parts for parts in played.values())
    found = []
    for signal, parts in played.items():
        own = signal.rpartition("/")[2]
        if own in PARTS:
            found.append(own)
        elif loop and "SP" in parts:  # the output of one controller is the set point of the next
            found.append("SP")
        else:
            found.append(parts[0] if parts else signal)
    return found


def heading(shown: Sequence[str], unit: str) -> str:
    """Return what stands at the axis: names (behind their common nested diagram) and the unit they share.

    >>> heading(["a/SP", "a/PV"], "bar"), heading(["one/m", "two/m"], "kg/s"), heading(["OP_VLCS1", "MV_VLCS1"], "")
    ('a\\nSP, PV [bar]', 'm [kg/s]', 'OP_VLCS1\\nMV_VLCS1')
    """
    group = shown[0].rpartition("/")[0]
    within = group and all(s.rpartition("/")[0] == group for s in shown)
    own = [s.rpartition("/")[2] for s in shown]
    names = list(dict.fromkeys(own)) if within or len(set(own)) == 1 else list(shown)
    bracket = f" [{unit}]" if unit else ""
    text = ", ".join(names) + bracket
    if len(text) > WIDE:  # the legend has the names
        text = (
            f"{names[0]}\n{names[1]}{bracket}"
            if len(names) == 2 and not within
            else bracket.strip() or f"{names[0]}, ..."
        )
    return (f"{group}\n" if within else "") + text
