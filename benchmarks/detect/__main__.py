"""All figures of detection: python -m benchmarks.detect [--quick] [--json FILE].

Each part is a module of this package with ``NOTES`` and ``figures(quick)``; one that is not there yet is left out.
"""

from importlib import import_module
from importlib.util import find_spec

from benchmarks.report import Figures, options, publish

PARTS = ("accuracy", "cost", "posterior")  # how right; what it costs; the stage that simulates loops like the record's


def main() -> int:
    """Run every part and return the exit code: 1 if a requirement is missed."""
    chosen = options(__doc__.splitlines()[0])
    found: Figures = {}
    notes: dict[str, str] = {}
    for name in PARTS:
        if find_spec(f"benchmarks.detect.{name}") is None:
            continue
        part = import_module(f"benchmarks.detect.{name}")
        if hasattr(part, "figures"):
            found |= part.figures(chosen.quick)
            notes |= part.NOTES
    return 0 if publish(found, notes, chosen.json, chosen.quick) else 1


if __name__ == "__main__":
    raise SystemExit(main())
