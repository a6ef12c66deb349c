"""The independent C program (``oracle.c``): compiled once, given one diagram as text, gives a row of signals per time.

What it gets of a diagram is data: kinds, parameters by name, wiring, start values, random seeds.  How a block works,
in which order blocks follow each other, when something happens: all that is in the C file, written from the docstrings.
"""

import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.diagram import Diagram

SOURCE = Path(__file__).with_name("oracle.c")
PI = ("K_p", "T_i", "low", "high", "T_t", "action")
SENSOR = ("tau", "factor", "bias", "drift", "low", "high")
KINDS: dict[str, tuple[str, ...]] = {  # in the order of oracle.c, with the parameters in the order it reads them
    "Constant": ("value",), "Step": ("before", "after", "at"), "Ramp": ("before", "slope", "start", "end"),
    "Sine": ("mean", "amplitude", "period", "phase", "start"),
    "Square": ("mean", "amplitude", "period", "start", "duty"), "Sum": (), "Gain": ("factor", "offset"),
    "Saturation": ("low", "high"), "FirstOrder": ("K", "tau"), "SecondOrder": ("K", "omega", "zeta"),
    "Integrator": ("K", "T", "u_0"), "DeadTime": (), "PI": PI, "PID": (*PI, "T_d", "N", "b", "c"), "Sensor": SENSOR,
    "StickSlip": ("k", "M", "F_v", "F_c", "F_s", "low", "high", "v_stop"), "QuasiStaticStem": ("S", "J", "low", "high"),
    "SampledPI": PI, "Noise": ("mean", "sd", "correlation_time"),
    "SampledSensor": (*SENSOR, "sd", "correlation_time", "step"), "KanoValve": ("S", "J", "low", "high"),
    "MinSelect": (), "MaxSelect": (), "DeadZone": ("low", "high"), "Lookup1D": (), "Quantiser": ("step",),
    "Switch": ("switch_on", "switch_off"), "Relay": ("switch_on", "switch_off", "high", "low"),
    "RateLimiter": ("up", "down"), "ResetIntegrator": ("rate", "threshold", "to"), "ZeroOrderHold": (),
    "SampledFilter": ("tau",), "VariableDelay": ("longest",), "Biquad": ("b_0", "b_1", "b_2", "a_1", "a_2"),
    "Equations": ("mean", "amplitude", "omega", "bump", "centre", "width"),
}  # fmt: skip
FEEDS = {
    "Sum", "Gain", "Saturation", "PI", "PID", "QuasiStaticStem", "Deadband", "SampledPI", "SampledSensor", "KanoValve",
    "MinSelect", "MaxSelect", "DeadZone", "Lookup1D", "Quantiser", "Switch", "RateLimiter", "ZeroOrderHold",
    "SampledFilter", "VariableDelay", "Biquad",
}  # fmt: skip
ANTI_WINDUP = {"none": 0, "back_calculation": 1, "conditional": 2}


class NoCompiler(RuntimeError):
    """There is no C compiler here."""


class OracleFailed(RuntimeError):
    """The C program got nowhere."""


def covers(diagram: Diagram) -> str:
    """Return "" if the C program knows every block of the diagram, else the first kind that it does not."""
    for block in diagram.blocks:
        kind = type(block).__name__
        if kind == "PI" and getattr(block, "anti_windup", "") == "conditional":
            return "PI with conditional integration"
        if kind not in KINDS and kind != "Deadband":
            return kind
        if kind == "Equations" and tuple(block.params) != KINDS[kind]:
            return "Equations other than those drawn"
    return ""


@cache
def program() -> Path:
    """Compile the program; raise ``NoCompiler`` if there is none to compile it with."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        raise NoCompiler("the C program is SKIPPED: no gcc and no cc here; install one of them")
    target = Path(tempfile.mkdtemp(prefix="stickslip_torture_")) / "oracle"
    subprocess.run([compiler, "-O2", "-o", str(target), str(SOURCE), "-lm"], check=True)
    return target


def solve(
    diagram: Diagram, duration: float, times: NDArray[np.float64], share: float, patience: float = 60.0
) -> NDArray[np.float64]:
    """Return all signals at ``times``, (times, signals), with steps of ``share`` of the fastest time constant at work.

    Raises ``OracleFailed`` if it gets nowhere or takes longer than ``patience`` [s].
    """
    number = {signal: i for i, signal in enumerate(diagram.signals)}
    lines = [f"{duration!r} {share!r} {len(times)}", _row(times), f"{len(diagram.blocks)} {len(number)}"]
    lines += [_line(block, number) for block in diagram.blocks]
    try:
        done = subprocess.run([program()], input="\n".join(lines), capture_output=True, text=True, timeout=patience)
    except subprocess.TimeoutExpired:
        raise OracleFailed(f"it took longer than {patience:g} s") from None
    rows = done.stdout.split("\n")
    if done.returncode or len(rows) < len(times):
        raise OracleFailed(f"it ended with code {done.returncode} after {len(rows) - 1} of {len(times)} rows")
    return np.array([row.split() for row in rows[: len(times)]], dtype=float)


def _line(block: Block, number: dict[str, int]) -> str:
    kind, params = type(block).__name__, dict(block.params)
    values = [params[name] for name in KINDS.get(kind, ())]
    memory = dict(zip(block.memory_names, block.d0.tolist(), strict=True))
    place, other = 0.0, memory.get("w", 0.0)
    if kind == "Deadband":
        kind, values = "QuasiStaticStem", [params["width"], 0.0, params["low"], params["high"]]
    elif kind == "Sum":
        values = [params["offset"], *(params[f"w_{port.name}"] for port in block.ports_in)]
    elif kind == "SampledPI":
        values.append(float(ANTI_WINDUP[block.anti_windup]))  # type: ignore[attr-defined]
        place = memory["z"]
    elif kind == "KanoValve":
        place = memory["MV"]
    elif kind == "Lookup1D":
        values = block.p.tolist()
    elif kind == "VariableDelay":
        values.append(memory["u_0"])
    elif kind == "SampledFilter":
        place = memory["y"]
    elif kind == "Biquad":  # the input at which it starts settled
        b, a = sum(values[:3]), sum(values[3:])
        place = float(block.y0[0]) * (1.0 + a) / b
    elif kind in ("RateLimiter", "Relay", "Switch", "ResetIntegrator"):
        place = memory["mode"]
    if kind in ("QuasiStaticStem", "SampledSensor"):
        place = memory["x"]
    if kind == "QuasiStaticStem":
        other = memory["mode"]
    theta = float(params.get("theta", 0.0))
    feeds = kind in FEEDS or (kind == "Sensor" and params["tau"] == 0.0) or (kind == "DeadTime" and theta == 0.0)
    random = [int(memory.get(f"s{i}", 1.0)) for i in range(6)]
    parts: list[Sequence[float]] = [
        [list(KINDS).index(kind), len(values), *values, len(block.input_labels)],
        [number[s] for s in block.input_labels],
        [number[block.output_labels[0]], len(block.x0), *block.x0.tolist()],
        [
            theta,
            params.get("theta_start", 0.0),
            int(block.sampled),
            block.period,
            params.get("offset", 0.0),
            int(feeds),
        ],
        [place, other, float(block.y0[0]), *random, _fastest(kind, params)],
    ]
    return " ".join(_row(part) for part in parts)


def _fastest(kind: str, p: dict[str, float]) -> float:
    """Return the shortest time constant of a block [s], 0 if it has none."""
    if kind == "FirstOrder" or kind == "Sensor":
        return float(p["tau"])
    if kind == "SecondOrder":
        return float(1.0 / (p["omega"] * max(1.0, 2.0 * p["zeta"])))
    if kind == "StickSlip":
        return float(min(p["M"] / p["F_v"], (p["M"] / p["k"]) ** 0.5))
    if kind == "Equations":
        return min(0.6 / p["omega"], 0.5 * p["width"])
    if kind == "PID":
        return float(min(p["T_d"] / p["N"], p["T_i"]))
    return float({"PI": p.get("T_i", 0.0), "Sine": 0.1 * p.get("period", 0.0)}.get(kind, 0.0))


def _row(values: Sequence[float] | NDArray[np.float64]) -> str:
    return " ".join(repr(value) for value in np.asarray(values, dtype=object).tolist())
