"""Notice when a file of the user's, such as ``plant.py`` or ``control.py``, hides a package that stickslip needs."""

import importlib.machinery
import sys
from pathlib import Path

PACKAGES = (
    "blocks", "calibration", "cases", "detect", "diagram", "engine", "gap", "logs", "plant", "remedy", "scan", "study",
)  # fmt: skip
OTHERS = ("click", "control", "filelock", "filterpy", "matplotlib", "numba", "numpy", "polars", "rich", "scipy")


def shadowed() -> str | None:
    """Return a message naming the first of the packages that something else hides, or None.

    >>> shadowed() is None
    True
    """
    ours = Path(__file__).resolve().parent.parent
    for name in PACKAGES:
        found = _origin(name)
        if found is None:
            return f"stickslip's package '{name}' is missing from {ours}; install stickslip again"
        if ours not in found.parents:
            return _hides(found, name)
    here = Path.cwd()
    for name in OTHERS:
        found = _origin(name)
        if found is not None and here in (found.parent, found.parent.parent) and here != ours:
            return _hides(found, name)
    return None


def _origin(name: str) -> Path | None:
    spec = importlib.machinery.PathFinder.find_spec(name, sys.path)
    return Path(spec.origin).resolve() if spec and spec.origin else None


def _hides(found: Path, name: str) -> str:
    place = found.parent if found.name == "__init__.py" else found
    return (
        f"Error: '{place}' hides the package '{name}' that stickslip needs; rename that file or folder, "
        f"or run stickslip from another folder"
    )
