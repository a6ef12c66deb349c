import subprocess
import sys

HEAVY = (
    "scipy", "matplotlib", "polars", "filterpy", "numba", "control",
    "stickslip.blocks", "stickslip.engine", "stickslip.plant",
)  # fmt: skip


def test_detect_needs_numpy_only():
    code = f"import sys, stickslip.detect; print([m for m in {HEAVY!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
