"""The cost of the stick in each sticky loop of a scan, the dearest first."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.commands.scan_beside import beside, judged

if TYPE_CHECKING:
    from stickslip.logs import LoopRecord
    from stickslip.scan import ScanResult

KEPT = "costs.json"
SCHEMA = "stickslip.scan-costs/1"


def costs(result: "ScanResult", source: str, out: Path, most: int, loop_map: Path | None) -> list[dict[str, Any]]:
    """Return the cost of each of the first ``most`` loops with stiction, the dearest first.

    Each is {"rank", "loop", "cost", "sentence"}; a loop that cannot be fitted, or whose fit sees no stick, has None for
    the cost, and the reason.
    """
    from stickslip.remedy import cost, fit

    def found_of(record: "LoopRecord | str") -> dict[str, Any]:
        try:
            if isinstance(record, str):
                raise ValueError(record)
            found = fit(record)
            own = cost(found)
        except ValueError as fault:
            return {"cost": None, "sentence": f"Not known, because {fault}."}
        if not found.sticks:
            return {"cost": None, "sentence": "Not known, because the fit sees no stick."}
        return {"cost": own.to_dict(), "sentence": own.words(found.op_unit)}

    rows = judged(result, most, "stiction")
    costs = beside(rows, source, out, loop_map, KEPT, SCHEMA, "loops fitted", found_of)
    return sorted(costs, key=lambda one: -(one["cost"]["pv_sd_ratio"]["value"] if one["cost"] else 0.0))
