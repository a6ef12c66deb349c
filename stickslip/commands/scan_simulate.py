"""Simulation at the record's own conditions for the top of a scan's list: kept on the way, as the scan itself."""

import hashlib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.commands.targets import write_whole

if TYPE_CHECKING:
    from stickslip.scan import ScanResult

KEPT = "simulated.json"
SCHEMA = "stickslip.scan-simulated/1"


def simulated(
    result: "ScanResult", source: str, out: Path, most: int, loop_map: Path | None, workers: int | None
) -> list[dict[str, Any]]:
    """Return what simulation says of each of the first ``most`` loops that were judged, in their order.

    Each is {"rank", "loop", "simulation", "sentences"}; a loop of which simulation can say nothing has None for the
    simulation, and the reason.  What is done stands in the scan's folder, and is not done again for the same result.
    """
    from stickslip.calibration import at_record
    from stickslip.diagram.progress import reporting
    from stickslip.scan.again import read_again

    rows = [row for row in result.table.iter_rows(named=True) if row["probability"] is not None][:most]
    digest = hashlib.sha256((out / "scan.parquet").read_bytes()).hexdigest()[:16]
    done = _kept(out / KEPT, digest)
    missing = [row["order"] for row in rows if str(row["order"]) not in done]
    with reporting(None, len(missing), "loops simulated") as tell:
        for order, record in read_again(source, out, missing, loop_map=loop_map):
            try:
                if isinstance(record, str):
                    raise ValueError(record)
                found = at_record(record, workers=workers)
                done[str(order)] = {"simulation": found.to_dict(), "sentences": list(found.sentences)}
            except ValueError as fault:
                done[str(order)] = {"simulation": None, "sentences": [f"Simulation: not applicable, because {fault}."]}
            document = {"schema": SCHEMA, "of": digest, "loops": done}
            write_whole(out / KEPT, (json.dumps(document, indent=2, allow_nan=False) + "\n").encode())
            tell(sum(str(order) in done for order in missing), len(missing))
    return [{"rank": row["rank"], "loop": row["loop"], **done[str(row["order"])]} for row in rows]


def _kept(file: Path, digest: str) -> dict[str, Any]:
    """Return what an earlier call found for the same result."""
    try:
        found = json.loads(file.read_text())
        return dict(found["loops"]) if found["of"] == digest else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}
