"""The verdict on crossed loops: of families that nothing is learnt from, and of the others.

    python -m benchmarks.other_physics [--quick] [--json FILE] [--loops N] [--seed N] [--folder DIR]

Families of ``stickslip.calibration.crossed.drawing.WITHHELD`` are in nothing that is learnt from.  Seeds below 10 are
for this benchmark alone.  Rows are kept in the folder, and a second call goes on.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from stickslip.calibration.crossed.drawing import draw

from benchmarks.other_physics.judging import judged, runs
from benchmarks.other_physics.scoring import Row, by_family, figures, leaks
from benchmarks.report import Figures, publish
from benchmarks.resumed import code_of, resumed

NOTES = {
    "withheld_shown_auc": "withheld families, loops whose stem turns four times and OP travels 0.8 S, sticky against "
    "sound (goal: at least 0.92)",
    "withheld_shown_found": "of these, found at 2 % false alarms (goal: at least 0.7)",
    "withheld_auc": "all loops of withheld families",
    "withheld_alarms": "sound loops of withheld families called sticky (goal: at most 0.02)",
    "withheld_cleared": "sticky loops of withheld families cleared (goal: at most 0.005)",
    "withheld_calibration_error": "ten bins (goal: at most 0.03)",
    "withheld_by_chance": "the calibration error that right probabilities would show on so few loops",
    "worst_calibration_error": "of any family of friction, process, driver, positioner (goal: at most 0.03)",
    "withheld_S_error": "median of |found / true - 1| where called (goal: at most 0.12)",
    "positioner_auc": "loops with a positioner (goal: at least 0.8)",
    "play_called": "valves with dead travel and no jump that are called sticky",
    "play_cleared": "of these, cleared (goal: at most 0.005)",
    "stands_called": "valves that never move, of which PV shows nothing, that are called sticky",
    "stands_cleared": "of these, cleared (goal: at most 0.005)",
    "worst_leak": "AUC of the attribute of the draw that tells most (goal: at most 0.55)",
}


def main() -> int:
    """Judge the loops and print the figures; 1 if a goal is missed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="60 loops")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--loops", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", type=Path, default=Path("other_physics_rows"))
    given = parser.parse_args()
    n = 60 if given.quick else given.loops
    file = given.folder / f"{given.seed}_{code_of('detect', 'calibration/crossed', 'benchmarks/other_physics')}.jsonl"
    asked = runs(n, given.seed)
    rows = []
    for row in resumed(asked, judged, file, 1e9):
        rows.append(row)
        print(f"\r{len(rows)} of {len(asked)}", end="", file=sys.stderr)
    print(file=sys.stderr)
    print("\n".join(_lines(rows)))
    return 0 if publish(summary(rows), NOTES, given.json, given.quick) else 1


def summary(rows: Sequence[Row]) -> Figures:
    """The figures that have goals, of the families that are held back and of those learnt from."""
    out: Figures = {}
    for part, own in (("withheld", True), ("learnt", False)):
        these = [row for row in rows if row["withheld"] == own]
        shown = [row for row in these if row["shows"] or row["kind"] == "sound"]
        for label, name in (("", "p"), ("network alone: ", "p_learnt"), ("evidence alone: ", "p_evidence")):
            whole, seen = figures(these, name), figures(shown, name)
            if not label:
                out[f"{part}_shown_sticky"] = float(sum(row["kind"] == "sticks" for row in shown))
                out[f"{part}_shown_sound"] = float(sum(row["kind"] == "sound" for row in shown))
            out |= {f"{label}{part}_shown_{key}": seen.get(key) for key in ("auc", "found")}
            out[f"{label}{part}_auc"] = whole.get("auc")
        whole = figures(these)
        keys = ("calibration_error", "by_chance", "alarms", "called", "cleared", "cleared_sound", "S_error")
        out |= {f"{part}_{key}": whole.get(key) for key in keys}
    out["positioner_auc"] = figures([row for row in rows if row["positioner"] != "none"]).get("auc")
    errors = [one["calibration_error"] for one in by_family(rows).values() if one["calibration_error"] is not None]
    out["worst_calibration_error"] = max(errors) if errors else None
    for kind in ("play", "stands"):
        words = [row["word"] for row in rows if row["kind"] == kind]
        out[f"{kind}_called"] = sum(w == "stiction" for w in words) / max(len(words), 1)
        out[f"{kind}_cleared"] = sum(w == "no_stiction" for w in words) / max(len(words), 1)
    drawn = draw(6000, 1)
    found = leaks([one.attributes() for one in drawn], np.array([one.sticks for one in drawn]))
    out["worst_leak"] = 0.5 + max(abs(value - 0.5) for value in found.values())
    return out


def _lines(rows: Sequence[Row]) -> list[str]:
    columns = (
        "loops", "auc", "found", "called", "alarms", "cleared", "cleared_sound", "calibration_error", "by_chance",
        "S_error",
    )  # fmt: skip
    lines = [f"{'family':28}" + "".join(f"{name[:10]:>11}" for name in columns)]
    for name, one in by_family(rows).items():
        shown = ["-" if one[c] is None else f"{one[c]:.3g}" for c in columns]
        lines.append(f"{name:28}" + "".join(f"{value:>11}" for value in shown))
    return lines


if __name__ == "__main__":
    raise SystemExit(main())
