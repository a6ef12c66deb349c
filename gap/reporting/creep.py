"""A stem that creeps: one whose friction falls as soon as it is driven fast, as that of bristles does (LuGre).

OP that moves in steps, as behind a noisy measurement or a scanning controller, drives the bristles faster than the
Stribeck speed at each step.  Friction falls from F_s to F_c at once, and the stem gives way at

    |OP - MV| = F_c/k = (S - J)/2        not at (S + J)/2 = F_s/k

so that the log is that of a deadband of width S - J, but for what OP moves between two steps, which does not move the
stem.  S + J shows only where OP moves slowly: a log of a loop with noise says S - J and no more.  (Of three such stems
of the benchmark's program, S - J kept and J halved or half as large again, the same noise left a PV that differs by 2
to 15 % of the noise, and an OP that differs by more than 0.001 % from row to row in 3 to 10 % of the rows.)
"""

from collections.abc import Mapping
from dataclasses import replace

from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.answers.report import Size
from stickslip.gap.effects.deadband import Deadband
from stickslip.gap.effects.stiction import Stiction
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.records.record import Record

SLIGHT = 0.1  # of S: a jump that a fit of another law of friction finds where there is none
COARSE = 1e-4  # of the span of a controller's output: rounded to more, a log does not show how it moves between steps
SLOWLY = "OP moved slowly by hand, with the stem logged,"


def creeps(effect: Effect, sizes: Mapping[str, Size]) -> bool:
    """Return whether stiction that is not of the model's own law hardly jumps: then it creeps."""
    return isinstance(effect, Stiction) and sizes["J"].value < SLIGHT * sizes["S"].value


def least_sizes(effect: Effect, sizes: Mapping[str, Size]) -> dict[str, Size]:
    """Return S and J of a stem that creeps with intervals as wide as the log leaves them: any S from S - J on."""
    width = sizes["S"].value - sizes["J"].value
    most = next(p.high for p in effect.parameters if p.name == "S")
    return {
        "S": replace(sizes["S"], value=width, low=width, high=most),
        "J": replace(sizes["J"], value=0.0, low=0.0, high=most - width),
    }


def coarse(model: Diagram, record: Record) -> bool:
    """Return whether a log rounds the output of a controller so much that creep and play look the same."""
    for s in record.pinned:
        if model.blocks[model.driven[s][0]].role is Role.CONTROLLER:
            low, high = model.signal_spans.get(s, (0.0, 1.0))
            if record.steps[s] > COARSE * (high - low):
                return True
    return False


def about_creep(effect: Effect, sizes: Mapping[str, Size], creeping: bool = False) -> list[str]:
    """Return in words what a deadband may be as well, or what a stem that creeps does not show; nothing for others."""
    if creeping:
        width = sizes["S"].value
        return [
            f"The stem creeps: steps of OP move it that friction at rest would hold. This log shows only "
            f"S - J = {width:.3g} %, so S is at least that; {SLOWLY} would show both."
        ]
    if isinstance(effect, Deadband) or creeps(effect, sizes):
        width = sizes["width"].value if "width" in sizes else sizes["S"].value - sizes["J"].value
        return [
            f"A stem that creeps, of any S and J with S - J = {width:.3g} %, gives the same log, because OP moves in "
            f"steps; {SLOWLY} would show the difference."
        ]
    return []
