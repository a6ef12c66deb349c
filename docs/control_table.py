"""Write the table of docs/python_control.md again: ``python docs/control_table.py``.

Every block is driven by sines for 100 s, at its inputs or in a small loop, in a diagram of its own: by our engine with
``rtol=1e-8`` and by ``ct.input_output_response`` with LSODA and ``rtol=1e-6``.
"""

import re
import sys
import warnings
from dataclasses import dataclass
from pathlib import Path

import control as ct
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

from stickslip.blocks.block import Block
from stickslip.diagram import simulate, wire
from trials import TRIALS, Trial

PAGE = Path(__file__).parent / "python_control.md"
COLUMNS = ["block", "moves", "`ct.linearize`", "largest difference"]
DURATION = 100.0
TIMES = np.append(0.0, np.arange(0.123, DURATION, 0.25))  # beside the sampling instants, where signals jump
STEPS = {"rtol": 1e-6, "max_step": 0.5}


@dataclass(frozen=True)
class Seen:
    """What python-control makes of a block: whether it moves, its slopes in words, the largest difference [share of
    how far the signal moves in our engine]."""

    moves: bool
    slopes: str
    difference: float

    def cells(self, name: str) -> list[str]:
        """A row of the table; differences below 1e-6 are the integrators' own."""
        difference = "< 1e-6" if self.difference < 1e-6 else f"{self.difference:.0e}".replace("e-0", "e-")
        return [name, "yes" if self.moves else "no", self.slopes, difference]


def seen(trial: Trial) -> Seen:
    """Run a trial in both simulators."""
    diagram = trial.diagram()
    block = diagram.blocks[-1]
    ours = simulate(diagram, DURATION, times=TIMES, rtol=1e-8, atol=1e-10).log
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        theirs = ct.input_output_response(
            diagram, TIMES, 0, diagram.x0, solve_ivp_method="LSODA", solve_ivp_kwargs={**STEPS, "atol": trial.atol}
        )
    differences, moved, moves = [0.0], False, True
    for label in block.output_labels:
        ran, saw = np.nan_to_num(ours[label]), theirs.outputs[diagram.output_labels.index(label)]
        if np.ptp(ran) > 0.0:
            moved, moves = True, moves and bool(np.ptp(saw) > 0.1 * np.ptp(ran))
            differences.append(float(np.abs(saw - ran)[1:].max() / np.ptp(ran)))
    return Seen(moved and moves, slopes(block), max(differences))


def slopes(block: Block) -> str:
    """What ``ct.linearize`` gives of the block alone with its inputs open."""
    if not block.ports_in:
        return "no input"
    diagram = wire([block], inputs=block.input_labels, outputs=block.output_labels)
    u = [0.5] * len(block.ports_in)
    try:
        model = ct.linearize(diagram, diagram.x0, u)
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    zero = not np.any(model.B) and not np.any(model.D)
    return "0 where it starts" if zero else "yes"


def table() -> dict[str, Seen]:
    """Every block by name."""
    return {name: seen(trial) for name, trial in TRIALS.items()}


def markdown(rows: dict[str, Seen]) -> str:
    """The table as it stands on the page."""
    lines = [COLUMNS, ["---"] * len(COLUMNS), *(row.cells(name) for name, row in rows.items())]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def rewritten(page: str, rows: dict[str, Seen]) -> str:
    """The page with the table between ``<!-- table -->`` and ``<!-- end -->`` as it is now."""
    return re.sub(
        r"<!-- table -->\n.*?<!-- end -->", f"<!-- table -->\n{markdown(rows)}\n<!-- end -->", page, flags=re.S
    )


if __name__ == "__main__":
    PAGE.write_text(rewritten(PAGE.read_text(), table()))
