"""How right the calibrated verdict is: loops of another physics and other seeds than all that it was fitted on.

Half of the loops have a sticky valve, of S 2 to 15 % of OP and J of at least 0.3 S, a fifth of them without a cycle;
the others are spread over thirteen groups, every defect of data over all.  What is simulated is kept in a folder.
"""

from pathlib import Path
from typing import Any

from stickslip.calibration import draw, simulate
from stickslip.calibration.commands import TESTING
from stickslip.calibration.records import PART, Table, kept_table, table
from stickslip.calibration.scoring import score
from stickslip.detect.judge.model import calibrated

from benchmarks.report import Figures

LOOPS, QUICK = 4000, 60
FOLDER = Path("calibration_parts")

NOTES = {
    "loops": "simulated loops of the setting other_physics, half sticky",
    "auc": "chance that a sticky loop is more probable than another (goal: at least 0.97)",
    "false_alarm": "share of the loops without stiction that are called sticky (goal: at most 0.02)",
    "coverage": "share of the sticky loops that are called so (goal: at least 0.8)",
    "calibration_error": "expected calibration error of the probability, ten bins (goal: at most 0.03)",
    "s_error": "median relative error of S where stiction is called (goal: at most 0.15)",
    "j_error": "median relative error of J where stiction is called (goal: at most 0.25)",
    "s_inside": "share of the sticky loops whose S lies in its 90 % interval",
    "j_inside": "share of the sticky loops whose J lies in its 90 % interval",
    "quiet_others": "share of the loops without stiction that the model lets the record clear",
    "quiet_sticky": "share of the sticky loops that the model lets the record clear",
}


def figures(quick: bool) -> Figures:
    """Return the figures, the hits by detectability and the calls by group behind them."""
    found = score(calibrated(), _table(quick))
    plain: Figures = {name: found[name] for name in NOTES}
    for kind, key in (("by_detectability", "found"), ("by_group", "called")):
        more: dict[str, Any] = found[kind]
        plain |= {f"{key}: {name} ({one['loops']:.0f})": one[key] for name, one in more.items()}
    return plain | {f"baseline: {name}": value for name, value in found["baselines"].items()}


def _table(quick: bool) -> Table:
    if quick:
        return table(simulate(draw(QUICK, TESTING, "other_physics")))
    return kept_table(FOLDER, "other_physics", TESTING, LOOPS // PART)
