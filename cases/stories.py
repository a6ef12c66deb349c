"""Five short stories with known truth: loops of our own making, exported as a plant historian would.

Each story is simulated here, made dirty in its own way and kept as a file in ``cases/exports``.
``python -m stickslip.cases.stories FOLDER`` writes them again: the same bytes on the same machine with the same engine.
The three loops with a sticky valve and a noisy sensor are chaotic, so after any change of the solver's last digits
they are another record of the same valve: alike for some minutes, and in verdict, but not in every digit.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from stickslip.logs import Log

EXPORTS = Path(__file__).parent / "exports"
START = datetime(2026, 3, 2, 6, 0, 0)


@dataclass(frozen=True)
class Story:
    """One example: its file, what happened in truth, and how an analyst would tell it.

    ``truth`` is "stiction" or "no stiction"; ``lesson`` says what the answer should teach.
    """

    name: str
    file: str
    title: str
    truth: str
    story: str
    lesson: str
    make: Callable[[], str]

    @property
    def path(self) -> Path:
        """Where the export is kept."""
        return EXPORTS / self.file


def _loop(items: list[Any], duration: float, every: float) -> "Log":
    from stickslip.diagram import simulate, wire

    run = simulate(wire(items), duration, every=every)
    if not run.ok:
        raise RuntimeError(run.hint)
    return run.log


def _rows(log: "Log", columns: dict[str, tuple[str, float, float, int]]) -> list[list[str]]:
    """Return text columns: signal -> (header, factor, offset, decimals)."""
    return [
        [f"{value * factor + offset:.{decimals}f}" for value in log[signal]]
        for signal, (_, factor, offset, decimals) in columns.items()
    ]


def _sticky_flow_log(seed: int) -> "Log":
    """Return the flow loop whose valve has S = 6 % and J = 3 % of OP; ``seed`` of the sensor's noise."""
    from stickslip.blocks import PI, FirstOrder, SampledSensor, Step, StickSlip

    return _loop(
        [
            Step("SP", 0.55),
            PI(K_p=0.6, T_i=8.0, start_op=0.42, inputs={"PV": "PV_m"}),
            StickSlip.from_bands(S=0.06, J=0.03, start=0.40),
            FirstOrder(K=1.3, tau=5.0, theta=1.0, start=0.52),
            SampledSensor(dt=1.0, sd=0.0008, seed=seed),
        ],
        2400.0,
        1.0,
    )


def sticky_flow() -> str:
    """A flow valve with S = 6 % and J = 3 % of OP; PI-style wide export with digital states."""
    log = _sticky_flow_log(seed=11)
    columns = {
        "SP": ("FIC101.SP", 120.0, 0.0, 2), "PV_m": ("FIC101.PV", 120.0, 0.0, 3), "OP": ("FIC101.OP", 100.0, 0.0, 3),
    }  # fmt: skip
    rows = _rows(log, columns)
    for bad in (311, 312, 1204):
        rows[1][bad] = "Bad Input"
    rows[1][1777] = "I/O Timeout"
    lines = ["Time," + ",".join(head for head, *_ in columns.values())]
    for i, cells in enumerate(zip(*rows, strict=True)):
        stamp = (START + timedelta(seconds=i)).strftime("%d-%b-%y %H:%M:%S")
        lines.append(f"{stamp},{','.join(cells)}")
    return "\n".join(lines) + "\n"


def tight_tuning() -> str:
    """A healthy temperature loop tuned to the edge; export with decimal comma, semicolons and a units row."""
    from stickslip.blocks import PI, FirstOrder, Noise, SampledSensor, SecondOrder, Step, Sum

    log = _loop(
        [
            Step("SP", 0.5),
            PI(K_p=4.55, T_i=60.0, start_op=0.5, inputs={"PV": "PV_m"}),
            Noise("load", sd=0.03, dt=5.0, correlation_time=30.0, seed=5),
            Sum("MV", {"OP": 1.0, "load": 1.0}),
            FirstOrder(K=1.0, tau=60.0, theta=8.0, start=0.5, outputs="T_jacket", name="jacket"),
            SecondOrder(K=1.0, omega=0.144, zeta=1.15, start=0.5, inputs="T_jacket"),
            SampledSensor(dt=2.0, sd=0.0005, seed=6),
        ],
        4800.0,
        2.0,
    )
    columns = {
        "SP": ("TIC-204 Sp", 80.0, 40.0, 2),
        "PV_m": ("TIC-204 Pv", 80.0, 40.0, 3),
        "OP": ("TIC-204 Out", 100.0, 0.0, 2),
    }
    rows = _rows(log, columns)
    lines = ["Zeit;" + ";".join(head for head, *_ in columns.values()), ";degC;degC;%"]
    for i, cells in enumerate(zip(*rows, strict=True)):
        stamp = (START + timedelta(seconds=2 * i)).strftime("%d.%m.%Y %H:%M:%S")
        lines.append(";".join([stamp, *(cell.replace(".", ",") for cell in cells)]))
    return "\r\n".join(lines) + "\r\n"


def outside_disturbance() -> str:
    """A healthy pressure valve under slug flow from upstream; long-form export, logged on change."""
    from stickslip.blocks import PI, FirstOrder, SampledSensor, Sine, Step, Sum

    log = _loop(
        [
            Step("SP", 0.6),
            PI(K_p=0.8, T_i=40.0, start_op=0.5, inputs={"PV": "PV_m"}, action="reverse"),
            Sine("slug", amplitude=0.05, period=180.0),
            Sum("MV", {"OP": 1.0, "slug": 1.0}),
            FirstOrder(K=1.2, tau=15.0, start=0.6),
            SampledSensor(dt=2.0, sd=0.0006, seed=21),
        ],
        5400.0,
        2.0,
    )
    rng = np.random.default_rng(7)
    lines = ["Tag,Timestamp,Value,Status"]
    tags = {"SP": ("PIC305.SP", 50.0), "PV_m": ("PIC305.PV", 50.0), "OP": ("PIC305.OP", 100.0)}
    for i in range(len(log)):
        stamp = (START + timedelta(seconds=2 * i)).isoformat()
        for signal, (tag, factor) in tags.items():
            if signal == "SP" and i % 150 and i != len(log) - 1:
                continue  # a set point is logged when it changes, and now and then
            status = "Uncertain" if rng.random() < 0.001 else "Good"
            lines.append(f"{tag},{stamp},{log[signal][i] * factor:.4f},{status}")
    return "\n".join(lines) + "\n"


def sticky_level() -> str:
    """A level loop with a sticky outlet valve: the area ratio cannot see it, and must say so."""
    from stickslip.blocks import PI, Gain, Integrator, SampledSensor, Step, StickSlip

    log = _loop(
        [
            Step("SP", 0.5),
            PI(K_p=1.6, T_i=500.0, action="direct", start_op=0.47, inputs={"PV": "PV_m"}),
            StickSlip.from_bands(S=0.06, J=0.02, start=0.45),
            Gain("net", "MV", -1.0, offset=0.46),
            Integrator(K=1.0, T=120.0, start=0.5, inputs="net"),
            SampledSensor(dt=5.0, sd=0.0004, seed=31),
        ],
        9000.0,
        5.0,
    )
    columns = {
        "SP": ("LIC410.SP", 100.0, 0.0, 1), "PV_m": ("LIC410.PV", 100.0, 0.0, 2), "OP": ("LIC410.OP", 100.0, 0.0, 2),
    }  # fmt: skip
    rows = _rows(log, columns)
    lines = ["timestamp," + ",".join(head for head, *_ in columns.values()) + ",LIC410.MODE"]
    for i, cells in enumerate(zip(*rows, strict=True)):
        lines.append(f"{(START + timedelta(seconds=5 * i)).isoformat()},{','.join(cells)},AUTO")
    return "\n".join(lines) + "\n"


def compressed_flow() -> str:
    """The sticky flow valve again, after a historian's swinging door: too little is left to judge."""
    from stickslip.logs.dirt import swinging_door

    rebuilt = swinging_door(_sticky_flow_log(seed=12), {"PV_m": 0.012, "OP": 0.01})
    lines = ["t,FIC512.SP,FIC512.PV,FIC512.OP"]
    for t, sp, pv, op in zip(rebuilt.t, rebuilt["SP"], rebuilt["PV_m"], rebuilt["OP"], strict=True):
        lines.append(f"{t:.0f},{sp * 80:.2f},{pv * 80:.6f},{op * 100:.6f}")
    return "\n".join(lines) + "\n"


STORIES = (
    Story("FIC-101", "FIC101_pi_export.csv", "A flow valve that sticks", "stiction",
          "The operators say the flow hunts. The packing was tightened last month; the tuning was not touched.",
          "The error rests near its peaks and falls fast through zero: the valve sticks and slips.", sticky_flow),
    Story("TIC-204", "TIC204_decimal_comma.csv", "A temperature loop tuned to the edge", "no stiction",
          "After a retuning for speed the jacket temperature swings. Is it the valve?",
          "Symmetric like a sine, which fits the tuning but does not clear the valve: step it in manual.",
          tight_tuning),
    Story("PIC-305", "PIC305_long_form.csv", "A pressure loop shaken from outside", "no stiction",
          "Slugs arrive every three minutes. The valve is new.",
          "The error is symmetric, as from outside. In manual the wave would stay, and that settles what this cannot.",
          outside_disturbance),
    Story("LIC-410", "LIC410_level.csv", "A level loop with a sticky valve", "stiction",
          "The outlet valve sticks, but a level integrates: its error is a triangle whatever moves it.",
          "A method used outside its assumptions must say so instead of guessing.", sticky_level),
    Story("FIC-512", "FIC512_compressed.csv", "The same sticky valve after compression", "stiction",
          "Only the corner points survived the historian; straight lines join them.",
          "The corners still show the stick; most methods need what lies between them.", compressed_flow),
)  # fmt: skip


def main(folder: Path = EXPORTS) -> None:
    """Write all exports again, into ``folder``; without one the kept files are replaced."""
    folder.mkdir(parents=True, exist_ok=True)
    for story in STORIES:
        (folder / story.file).write_text(story.make(), encoding="utf-8", newline="")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
