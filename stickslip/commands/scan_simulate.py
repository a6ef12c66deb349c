"""Simulation at the record's own conditions for the top of a scan's list."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.commands.scan_beside import beside, judged

if TYPE_CHECKING:
    from stickslip.logs import LoopRecord
    from stickslip.scan import ScanResult

KEPT = "simulated.json"
SCHEMA = "stickslip.scan-simulated/1"


def simulated(
    result: "ScanResult", source: str, out: Path, most: int, loop_map: Path | None, workers: int | None
) -> list[dict[str, Any]]:
    """Return what simulation says of each of the first ``most`` loops that were judged, in their order.

    Each is {"rank", "loop", "simulation", "sentences"}; a loop of which simulation can say nothing has None for the
    simulation, and the reason.
    """
    from stickslip.calibration import at_record

    def found_of(record: "LoopRecord | str") -> dict[str, Any]:
        try:
            if isinstance(record, str):
                raise ValueError(record)
            found = at_record(record, workers=workers)
        except ValueError as fault:
            return {"simulation": None, "sentences": [f"Simulation: not applicable, because {fault}."]}
        return {"simulation": found.to_dict(), "sentences": list(found.sentences)}

    return beside(judged(result, most), source, out, loop_map, KEPT, SCHEMA, "loops simulated", found_of)
