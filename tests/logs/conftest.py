"""Fixtures of the reader tests: files made in a temporary folder, real data where there are any."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from stickslip.logs import LoopRecord, read_loop

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Write text (as UTF-8) or bytes to a file of the given name."""

    def put(content: str | bytes, name: str = "trend.csv") -> Path:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
        return path

    return put


@pytest.fixture
def read(write: Callable[..., Path]) -> Callable[..., LoopRecord]:
    """Read the loop in a file with this text or these bytes."""
    return lambda content, **options: read_loop(write(content, "export.csv"), **options)


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Folder of the real records."""
    folder = Path(os.environ.get("STICKSLIP_DATA", ROOT.parent / "shared" / "data"))
    if not (folder / "loops.csv").is_file():
        pytest.skip(f"REAL DATA NOT TESTED: no loops.csv in {folder}; set STICKSLIP_DATA")
    return folder
