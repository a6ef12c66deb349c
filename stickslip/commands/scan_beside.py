"""Work for the top of a scan's list only; its results are saved on the way, as those of the scan."""

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.commands.targets import write_whole

if TYPE_CHECKING:
    from stickslip.logs import LoopRecord
    from stickslip.scan import ScanResult


def beside(
    rows: list[dict[str, Any]], source: str, out: Path, loop_map: Path | None, file: str, schema: str, what: str,
    found_of: "Callable[[LoopRecord | str], dict[str, Any]]",
) -> list[dict[str, Any]]:  # fmt: skip
    """Return what ``found_of`` says of the record of each of these rows of a scan, in their order.

    Each is {"rank", "loop", ...}.  ``found_of`` is given the record, or the reason why there is none.  What is done
    stands in ``file`` of the scan's folder, and is not done again for the same result; ``what`` is counted on the
    terminal.
    """
    from stickslip.diagram.progress import reporting
    from stickslip.scan.again import read_again

    digest = hashlib.sha256((out / "scan.parquet").read_bytes()).hexdigest()[:16]
    done = _kept(out / file, digest)
    missing = [row["order"] for row in rows if str(row["order"]) not in done]
    with reporting(None, len(missing), what) as tell:
        for order, record in read_again(source, out, missing, loop_map=loop_map):
            done[str(order)] = found_of(record)
            document = {"schema": schema, "of": digest, "loops": done}
            write_whole(out / file, (json.dumps(document, indent=2, allow_nan=False) + "\n").encode())
            tell(sum(str(order) in done for order in missing), len(missing))
    return [{"rank": row["rank"], "loop": row["loop"], **done[str(row["order"])]} for row in rows]


def judged(result: "ScanResult", most: int, verdict: str | None = None) -> list[dict[str, Any]]:
    """The first ``most`` rows that were judged, of one verdict or of any."""
    rows = [row for row in result.table.iter_rows(named=True) if row["probability"] is not None]
    return [row for row in rows if verdict is None or row["verdict"] == verdict][:most]


def _kept(file: Path, digest: str) -> dict[str, Any]:
    """Return what an earlier call found for the same result."""
    try:
        found = json.loads(file.read_text())
        return dict(found["loops"]) if found["of"] == digest else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}
