"""What is said of one loop: by the verdict, by the learnt model alone, and by the evidence of likelihood alone."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from stickslip.calibration.crossed.drawing import Drawn, draw
from stickslip.calibration.crossed.history import seen
from stickslip.detect.judge.answer import answer
from stickslip.detect.judge.features import features_of, view_of
from stickslip.detect.judge.features.earned import usable
from stickslip.detect.judge.model import calibrated
from stickslip.detect.prepare.prepared import Prepared


@dataclass(frozen=True)
class Run:
    """A drawn loop and its number."""

    number: int
    drawn: Drawn

    @property
    def key(self) -> str:
        """The name of its row."""
        return f"{self.drawn.seed}_{self.number}"


def runs(n: int, seed: int) -> list[Run]:
    """``n`` loops to judge."""
    return [Run(i, d) for i, d in enumerate(draw(n, seed))]


def judged(run: Run) -> dict[str, Any]:
    """A row: what was drawn, what is true, what is said."""
    made = seen(run.drawn)
    loop = Prepared(made.record)
    said = answer(loop)
    view = view_of(loop)
    row: dict[str, Any] = asdict(run.drawn) | {
        "kind": run.drawn.kind, "withheld": run.drawn.withheld, "shows": made.shows, "travelled": made.travel,
        "turns": made.turns,
        "word": said.word, "p": said.probability, "S_told": None if said.S is None else said.S.value,
        "cause": next(iter(said.causes), ""),
    }  # fmt: skip
    if view is not None and said.probability is not None:
        row["p_learnt"] = calibrated().judge(features_of(loop, view) | {"dead_travel": math.nan}).probability
    found = loop.dead_travel if usable(loop) else None
    if found is not None:
        row |= {
            "gain": min(found.gain, found.without_best), "accuses": bool(found.accuses), "clears": bool(found.clears),
            "S_evidence": found.S,
        }  # fmt: skip
        row["p_evidence"] = 0.5 + 0.5 * math.tanh(0.05 * row["gain"])
    return {"key": run.key} | row
