"""A digest of the code that makes the rows of a scan: rows of two versions must not share a table."""

import hashlib
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

__all__ = ["code"]

PACKAGES = ("detect", "logs", "scan")


@lru_cache(maxsize=1)
def code() -> str:
    """Return a hash of the sources that make the rows, the same as long as none of them is changed."""
    digest = hashlib.sha256()
    for name in PACKAGES:
        spec = find_spec(f"stickslip.{name}")
        assert spec is not None and spec.submodule_search_locations
        folder = Path(next(iter(spec.submodule_search_locations)))
        for path in sorted(folder.rglob("*.py")):
            digest.update(str(path.relative_to(folder)).encode() + path.read_bytes())
    return digest.hexdigest()[:16]
