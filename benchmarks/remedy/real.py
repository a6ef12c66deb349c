"""Fits of real loops: is the stick seen, and how far does each fit foretell PV: ``python -m benchmarks.remedy.real``.

``STICKSLIP_DATA`` holds ``loops.csv`` with a label for each loop.  No label was used to make the fit.
"""

from __future__ import annotations

import os
from pathlib import Path

from stickslip.logs import read_loop
from stickslip.remedy import FitError, fit

DATA = Path(os.environ.get("STICKSLIP_DATA", "../shared/data"))
STICKY = ("isdb/CHEM1", "isdb/CHEM10", "isdb/CHEM12", "isdb/PAP2", "refinery/FIC46005_20240613_2155")
SOUND = (
    "isdb/CHEM13", "isdb/PAP9", "refinery/FIC10201_20241017_2155", "refinery/LIC33102_20241003_2155",
    "refinery/LIC44001_20240901_2155",
)  # fmt: skip


def main() -> None:
    """Print a line a loop."""
    for label, names in (("sticky", STICKY), ("sound", SOUND)):
        for name in names:
            try:
                found = fit(read_loop(DATA / f"{name}.csv"))
            except (FitError, ValueError) as reason:
                print(f"{name:34} {label:7} no fit: {str(reason)[:90]}", flush=True)
                continue
            word = "sticks" if found.sticks else "-"
            print(
                f"{name:34} {label:7} {word:7} gain {found.gain:6.0f} nats  S {found.S}  one step "
                f"{found.one_step_error:.2f}  free {found.free_error:.2f}  law {found.controller.explained:.2f}",
                flush=True,
            )  # fmt: skip


if __name__ == "__main__":
    main()
