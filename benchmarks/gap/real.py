"""Real data: what separates a simple model from a genuine record, by free runs and left-out blocks.

    python -m benchmarks.gap.real tanks | valve | pump | loops        (STICKSLIP_DATA, default ../shared/data)

Nothing here was tuned on labels.  Every parameter is fitted on the whole record named; errors on left-out blocks come
from fits that have not seen them.
"""

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from stickslip.gap.effects import CATALOGUE, effect
from stickslip.logs import Log

from benchmarks.gap.free_run import FreeFit, FreeModel, explained, folds, left_out
from benchmarks.gap.static_map import static_map

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DATA = Path(os.environ.get("STICKSLIP_DATA", "../shared/data"))
OF_VALVE = ("stiction", "deadband", "valve_rate_limit", "positioner_lag", "valve_saturation", "valve_characteristic")
OF_LOOP = ("stiction", "deadband", "valve_characteristic", "positioner_lag", "dead_time", "second_lag")
LOOPS = ("isdb/CHEM1", "isdb/CHEM10", "isdb/CHEM12", "isdb/PAP2", "refinery/FIC46005_20240613_2155")
LOOP_ROWS = 1000
NAMED = 0.9  # a cause is named if it leaves at most this share of the error on left-out blocks


def table(name: str) -> dict[str, np.ndarray]:
    """Return the columns of a file of the data folder, by name."""
    found = np.genfromtxt(DATA / f"{name}.csv", delimiter=",", names=True)
    return {str(key).strip('"'): np.asarray(found[key]) for key in found.dtype.names or ()}


def tanks() -> tuple[FreeModel, dict[str, float]]:
    """Return the cascaded tanks with their estimation record, and start values.

    The unit of the upper level is free, so its outlet is not; the upper level at the start is.
    """
    from stickslip.cases.models import cascaded_tanks

    d = table("cascaded_tanks/estimation")
    own = {"tank_1.A": (10.0, 60.0), "tank_2.A": (5.0, 40.0), "tank_2.k": (0.6, 2.4)}
    model = FreeModel(
        cascaded_tanks(), Log(d["time"], {"u": d["u"], "y": d["y"]}), ("y",), own, {"tank_1.h": (0.5, 10.0)}
    )
    return model, {"tank_1.A": 37.1, "tank_2.A": 13.37, "tank_2.k": 1.2014, "tank_1.h": 5.05}


def valve() -> tuple[FreeModel, dict[str, float]]:
    """Return the boiler feed valve: an ideal one, and a sensor of its position; OP and stem in % of closing."""
    from stickslip.blocks import IdealValve, Sensor
    from stickslip.diagram import wire

    d = table("damadics/first_half")
    span = (0.0, 100.0)
    ideal = IdealValve(spans={"OP": span, "MV": span})
    sensor = Sensor(inputs="MV", outputs="stem", name="position", spans={"PV_m": span})
    diagram = wire([ideal, sensor], inputs=["OP"], name="feed_valve")
    return FreeModel(diagram, Log(d["time"], {"OP": d["OP"], "stem": d["stem"]}), ("stem",), {}), {}


def sticky_loop(name: str) -> tuple[FreeModel, dict[str, float]]:
    """Return a loop's valve and one lag, driven by its logged OP; both about their mean, PV in its own spread."""
    from stickslip.blocks import FirstOrder, IdealValve, Sensor
    from stickslip.diagram import wire

    d = table(name)
    t, op, pv = (d[key][:LOOP_ROWS] for key in ("time", "OP", "PV"))
    dt = float(np.median(np.diff(t)))
    middle, spread = float(np.mean(op)), float(np.std(op))
    op = op - middle
    low, high = float(op.min() - spread), float(op.max() + spread)
    log = Log(t - t[0], {"OP": op, "PV": (pv - pv.mean()) / pv.std()})
    diagram = wire(
        [
            IdealValve(spans={"OP": (low, high), "MV": (low, high)}),
            FirstOrder(1.0 / spread, 5.0 * dt, start=float(log["PV"][0]), inputs="MV", outputs="y"),
            Sensor(inputs="y", outputs="PV"),
        ],
        inputs=["OP"],
        name=name,
    )
    gain = 4.0 / spread
    own = {"process.K": (-gain, gain), "process.tau": (0.3 * dt, 100.0 * dt)}
    return FreeModel(diagram, log, ("PV",), own), {"process.K": 1.0 / spread, "process.tau": 5.0 * dt}


def steps(name: str, most: int = 3, catalogue: Sequence[str] | None = None) -> tuple[list[FreeFit], list[float], str]:
    """Return the fits step by step, their errors on left-out blocks, and the steps in words."""
    model, start = {"tanks": tanks, "valve": valve}[name]() if name in ("tanks", "valve") else sticky_loop(name)
    effects = CATALOGUE if catalogue is None else [effect(word) for word in catalogue]
    found = explained(model, start, effects, most)
    sets = folds(model.log, model.outputs[0], 16, 4)
    lines, errors = [], []
    for fit, tried in found:
        error, each = left_out(fit, sets)
        errors.append(error)
        added = fit.model.effects[-1].name if fit.model.effects else "no effect"
        others = ", ".join(f"{one.model.effects[-1].name} {one.rms:.3f}" for one in tried[1:4] if one.model.effects)
        values = ", ".join(f"{key} {value:.4g}" for key, value in fit.values.items())
        lines.append(
            f"{added}: error {fit.rms:.3f}, on left-out blocks {error:.3f} ({min(each):.3f} to {max(each):.3f})"
        )
        lines.append(f"    next best: {others or 'none'}; at a bound: {', '.join(fit.at_bound) or 'none'}")
        lines.append(f"    {values}")
    return [fit for fit, _ in found], errors, "\n".join(lines)


def loops() -> str:
    """Return for each sticky loop what is named, or why nothing is."""
    lines = []
    for name in LOOPS:
        fits, errors, _ = steps(name, 1, OF_LOOP)
        tried = f"error on left-out blocks {errors[0]:.2f}" + (f" -> {errors[1]:.2f}" if len(errors) > 1 else "")
        lines.append(f"{name}: {said(fits, errors)}; {tried} standard deviations of PV")
    return "\n".join(lines)


def said(fits: Sequence[FreeFit], errors: Sequence[float]) -> str:
    """Return what is named of a loop, or why nothing is: ``fits`` without and with an effect, and their errors.

    A name needs less error on rows that were not fitted, sizes inside their bounds, and that nothing but noise is left:
    what moves PV otherwise moves OP too, through the controller, and then any effect may stand for any other.
    """
    if len(fits) < 2 or errors[1] >= NAMED * errors[0]:
        return "nothing named: no effect of the valve leaves less on rows that were not fitted"
    one = fits[1].model.effects[-1]
    sizes = ", ".join(f"{p.name} {fits[1].values[f'{one.name}.{p.name}']:.3g} {p.unit}" for p in one.effect.parameters)
    nearest = f"{one.effect.name}, {sizes}"
    if fits[1].at_bound:
        return f"nothing named: nearest is {nearest}, but at a bound: {', '.join(fits[1].at_bound)}"
    if not fits[1].leaves_noise:
        return (
            f"nothing named: nearest is {nearest}, but what it leaves is not noise (neighbouring rows correlate by "
            f"{fits[1].memory:.2f}): an unmeasured disturbance, or a stem that waits, can look like that"
        )
    return nearest


def pump() -> str:
    """Return the static map of the level station in words."""
    d = table("labvolt/training_set")
    found = static_map(d["time"], d["input"], d["output"])
    gains = ", ".join(f"{u:.3f} V {y:.0f} mm" for u, y in zip(found.u, found.y, strict=True))
    slopes = ", ".join(f"{g:.0f}" for g in found.gains)
    return (
        f"error {found.linear_rms:.1f} mm with a straight map, {found.rms:.1f} mm with this one behind a lag of "
        f"{found.tau:.0f} s:\n  {gains}\n  slopes {slopes} mm/V"
    )


def picture() -> "Figure":
    """Draw the static map of the level station over its record."""
    from stickslip.logs.picture import Picture
    from stickslip.logs.style import BLUE, ORANGE, tidy

    d = table("labvolt/training_set")
    found = static_map(d["time"], d["input"], d["output"])
    picture = Picture(figsize=(6.0, 4.0), layout="constrained")
    axes = picture.subplots()
    axes.plot(d["input"], d["output"], ".", color=BLUE, markersize=3, alpha=0.5, label="logged: on its way to rest")
    axes.plot(found.u, found.y, "o-", color=ORANGE, label="fitted map: at rest")
    axes.set(xlabel="pump voltage [V]", ylabel="level [mm]")
    axes.set_title("Level station: pump voltage to steady level", loc="left", fontsize=10)
    axes.legend(frameon=False)
    tidy(axes)
    return picture


def main() -> None:
    """Print what was found on one kind of data."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", choices=("tanks", "valve", "pump", "loops"))
    options = parser.parse_args()
    if not DATA.exists():
        raise SystemExit(f"no data at {DATA}; set STICKSLIP_DATA to the folder of the real records")
    if options.what in ("pump", "loops"):
        print({"pump": pump, "loops": loops}[options.what]())
    else:
        print(steps(options.what, 3, (*OF_VALVE, "sensor_bias", "sensor_span") if options.what == "valve" else None)[2])


if __name__ == "__main__":
    main()
