"""Notice when a file of the user's, such as ``plant.py``, hides one of our packages."""

import importlib.machinery
import sys
from pathlib import Path

PACKAGES = ("blocks", "cases", "detect", "engine", "online", "plant", "records")


def shadowed() -> str | None:
    """Return a message naming the first of our packages that something else hides, or None.

    >>> shadowed() is None
    True
    """
    ours = Path(__file__).resolve().parent.parent
    for name in PACKAGES:
        spec = importlib.machinery.PathFinder.find_spec(name, sys.path)
        found = Path(spec.origin).resolve() if spec and spec.origin else None
        if found is not None and ours not in found.parents:
            return (
                f"'{found}' hides stickslip's own package '{name}'; rename that file or folder, "
                f"or run stickslip from another folder"
            )
        if found is None:
            return f"stickslip's package '{name}' is missing from {ours}; install stickslip again"
    return None
