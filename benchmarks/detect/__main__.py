"""All figures of detection: python -m benchmarks.detect [--quick] [--json FILE] [--only PART,PART].

Each part is a module of this package with ``NOTES`` and ``figures(quick)``. By the time of one loop, two idle cores
take some three minutes for ``cost``, ten for ``posterior`` (60 records), ten for ``accuracy`` (4,000 loops), one for
``levels``. ``posterior`` and ``accuracy`` go on where they were stopped (``calibration_parts``), and begin anew where
the code has changed. The JSON file is written after every part.
"""

import json
import sys
import time
from importlib import import_module
from pathlib import Path

from benchmarks.report import Figures, options, publish

# what it costs; the stage that simulates loops like the record's; how right; levels that a deadband makes cycle
PARTS = ("cost", "posterior", "accuracy", "levels")


def main() -> int:
    """Run the parts asked for and return the exit code: 1 if a requirement is missed."""
    chosen = options(__doc__.splitlines()[0], PARTS)
    found: Figures = {}
    notes: dict[str, str] = {}
    for name in chosen.only:
        begun = time.perf_counter()
        print(f"{name} ...", file=sys.stderr, flush=True)
        part = import_module(f"benchmarks.detect.{name}")
        found |= part.figures(chosen.quick)
        notes |= part.NOTES
        if chosen.json and chosen.json != "-":
            Path(chosen.json).write_text(json.dumps(found, indent=2) + "\n")
        print(f"{name}: {time.perf_counter() - begun:.0f} s", file=sys.stderr, flush=True)
    return 0 if publish(found, notes, chosen.json, chosen.quick) else 1


if __name__ == "__main__":
    raise SystemExit(main())
