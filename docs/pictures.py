"""Draws the pictures of the documentation again: ``python docs/pictures.py`` from the root of the repository.

``python docs/pictures.py latent judged`` draws those of these functions only.
"""

import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

if TYPE_CHECKING:
    from matplotlib.figure import Figure

IMAGES = Path(__file__).resolve().parent / "images"


def keep(name: str, figure: "Figure", dpi: int = 100) -> None:
    """Write a figure with at most 128 colours, which a drawing of lines does not exceed, and its words beside it."""
    from matplotlib.text import Text
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    words = PngInfo()
    words.add_text("Description", " ".join(" ".join(text.get_text() for text in figure.findobj(Text)).split()))
    target = IMAGES / f"{name}.png"
    figure.savefig(target, dpi=dpi, bbox_inches="tight")
    picture = Image.open(target).convert("RGB").quantize(128, dither=Image.Dither.NONE)
    picture.save(target, optimize=True, pnginfo=words)


def topologies() -> None:
    """The three rewired loops: trends and block diagrams, and the way over the map."""
    from stickslip.cases import find
    from stickslip.cases.topologies.map_plane import map_plane

    for name in ("cascade_flow", "split_range", "own_map"):
        run = find(name).run()
        keep(name, run.plot(find(name).signals or None))
        keep(f"{name}_diagram", run.diagram.plot(), dpi=75)
    keep("own_map_plane", map_plane(find("own_map").run()))


def latent() -> None:
    """The log against the model, and what is missing at a valve that sticks, as in ``docs/gap.md``."""
    from stickslip.blocks import Staircase
    from stickslip.cases.models import ideal_flow
    from stickslip.diagram import simulate
    from stickslip.gap import diagnose, latent_input, replayed
    from stickslip.gap.effects import effect

    real = effect("stiction").insert(ideal_flow(rest=1.5), "valve", S=3.0, J=1.0)
    set_point = Staircase("SP", [1.5, 1.65, 1.35, 1.5, 1.8, 1.2] * 2, dwell=600.0)
    log = simulate(real, 7200.0, every=1.0, inputs={"SP": set_point}, signals=["SP", "PV", "OP"]).log
    report = diagnose(ideal_flow(), log)
    keep("gap", replayed(report, log).plot())
    keep("gap_diagram", report.plot_diagram())
    keep("latent_input", latent_input(report, log).plot())


def plant() -> None:
    """The production plant of the README: the stem of the gas valve, the pressure before it and the shaft's torque."""
    from stickslip.diagram import simulate
    from stickslip.plant import kicked, production_plant

    run = simulate(kicked(production_plant(F_s="high")), 1200.0, every=0.5, method="stiff")
    keep("plant", run.plot(["OP_VPCS1", "MV_VPCS1", "p_1", "tau_d"]))


def linear() -> None:
    """Poles, Bode plots and relative gains of set B, as in ``docs/linearise.md``."""
    from stickslip.diagram.linear import linearise
    from stickslip.plant import production_plant

    model = linearise(production_plant("B", F_s="high"))
    keep("linearise_poles", model.plot())
    keep("linearise_bode", model.bode())
    keep("linearise_rga", model.rga(["LCS11", "PCS11", "LCS21", "PCS21"]).plot())


def spread() -> None:
    """The study of ``docs/study.md``: 1000 runs."""
    from stickslip.study import production_subject, study

    with tempfile.TemporaryDirectory() as folder:
        found = study(
            production_subject("E", F_s="high", name="plant_1_high"),
            {"VPCS1.F_s": [1250.0, 1500.0, 1750.0, 2000.0, 2250.0], "PCS11.K_p": [5e-7, 7e-7]},
            plant={"sticky": ["VPCS1"]},
            kicks=100, every=0.5, duration=2000.0, out=folder,
        )  # fmt: skip
        keep("spread", found.plot())


def judged() -> None:
    """The first story of the demonstration, the loop of the README, and a sticky stem."""
    from stickslip.cases import find
    from stickslip.cases.stories import EXPORTS
    from stickslip.cases.valve_pictures import figure_4_1
    from stickslip.detect import diagnose
    from stickslip.logs import read_loop

    keep("stiction", figure_4_1())
    keep("sticky_flow", diagnose(read_loop(EXPORTS / "FIC101_pi_export.csv")).plot())
    keep("loop", find("ideal_high").build().plot())
    keep("run", find("ideal_high").run().plot())


def verdicts() -> None:
    """The three pictures of ``docs/verdict.md``: dead travel that is found, one that is excluded, one of many days."""
    import numpy as np
    from stickslip.detect.methods import dead_travel
    from stickslip.detect.stem.stick import stick
    from stickslip.detect.tag import judge_tag
    from stickslip.logs import LoopRecord

    def day(S: float, seed: int) -> LoopRecord:
        rng, t = np.random.default_rng(seed), np.arange(2400.0)
        op = 50 + 4 * np.sin(2 * np.pi * np.cumsum(1 + 0.1 * rng.normal(size=2400)) / 160) + np.sin(t / 31)
        pv, flow = np.empty(2400), 0.0
        for k, x in enumerate(stick(op, S, 0.3 * S)):
            pv[k] = 50 + flow + 0.4 * rng.normal()
            flow += (x - 50 - flow) / 12
        return LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t + 50, op_span=(0, 100), name=f"FIC12 day {seed}")

    keep("verdict_found", dead_travel.detect(day(2.0, 1)).plot())
    keep("verdict_excluded", dead_travel.detect(day(0.0, 2)).plot())
    keep("verdict_days", judge_tag("FIC12", [day(0.8, seed) for seed in range(3, 10)]).plot())


def both_simulators() -> None:
    """The sticky loop of ``docs/python_control.md`` in our engine and in python-control's."""
    import control as ct
    from matplotlib.figure import Figure
    from stickslip.cases import find
    from stickslip.diagram import simulate
    from stickslip.logs.style import COLOURS, tidy

    loop = find("ideal_high").build()
    log = simulate(loop, 200.0, every=0.1).log
    theirs = ct.input_output_response(loop, log.t, 0, loop.x0)
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    panels = figure.subplots(2, 2, sharex=True, sharey="row")
    seen = dict(zip(loop.output_labels, theirs.outputs, strict=True))
    for column, title, rows in ((0, "stickslip.diagram.simulate", log), (1, "ct.input_output_response", seen)):
        for panel, names in zip(panels[:, column], (("SP", "PV"), ("OP", "MV")), strict=True):
            for name in names:
                panel.plot(log.t, rows[name], color=COLOURS[name], label=name)
            panel.legend(loc="lower right")
            tidy(panel)
        panels[0, column].set_title(title)
        panels[1, column].set_xlabel("time [s]")
    keep("python_control", figure)


def level_station() -> None:
    """The static map of ``docs/evidence/gap_real.md``, where the record is."""
    from benchmarks.gap.real import DATA, picture

    if not DATA.exists():
        print(f"gap_level_station is not drawn: no data at {DATA}; set STICKSLIP_DATA", file=sys.stderr)
        return
    keep("gap_level_station", picture())


DRAWN = (topologies, plant, linear, latent, spread, judged, verdicts, both_simulators, level_station)

if __name__ == "__main__":
    wanted = sys.argv[1:] or [draw.__name__ for draw in DRAWN]
    for draw in DRAWN:
        if draw.__name__ in wanted:
            draw()
