"""The compressor map as the machine's maker draws it, with the way a run takes over it."""

from typing import TYPE_CHECKING

import numpy as np
from stickslip.cases.topologies.own_map import own_map
from stickslip.logs.style import BLUE, GRID, ORANGE, PALE, RED, SOFT, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from stickslip.diagram.simulation import Run

CURVE, SURGE = PALE, RED
WAYS = {"bare": (ORANGE, 0.9), "guarded": (BLUE, 2.4)}
SAID = {"bare": "without anti-surge control", "guarded": "with anti-surge control"}


def map_plane(run: "Run") -> "Figure":
    """Return head against inlet flow: the curves of each speed, the surge line, and where the run of ``own_map`` went.

    The head is the one the pressures of the plena ask for; in surge the machine gives more or less than that.

    >>> from stickslip.cases import find
    >>> figure = map_plane(find("own_map").run())
    >>> figure.axes[0].get_xlabel()
    'inlet flow [m3/h]'
    """
    from stickslip.blocks.compressor_map import head_for
    from stickslip.cases.topologies.own_map import C_01, GAMMA
    from stickslip.logs.picture import Picture

    shape = own_map()
    rpm, volume, head = shape.point
    figure = Picture(figsize=(7.6, 4.4), layout="constrained")
    ax = figure.subplots()
    for i, n in enumerate(shape.speeds):
        q = np.linspace(-0.4, float(shape.q_c[i]), 300)
        H = np.array([head * n * n * shape.psi(v, n) for v in q])
        right = q >= shape.q_s[i]
        ax.plot(volume * n * q[right], H[right], color=CURVE, linewidth=1.6)
        ax.plot(volume * n * q[~right], H[~right], color=CURVE, linewidth=0.9, linestyle=(0, (3, 2)))
        ax.annotate(f"{n * rpm:.0f} rpm", (volume * n * q[-1], H[-1]), (4, 0), textcoords="offset points", fontsize=8,
                    color=SOFT, va="center")  # fmt: skip
    tops = [head * n * n * shape.psi(q, n) for n, q in zip(shape.speeds, shape.q_s, strict=True)]
    ax.plot(volume * shape.speeds * shape.q_s, tops, color=SURGE, linewidth=1.4, label="surge line")
    for name, (colour, width) in WAYS.items():
        ratio = run.log[f"{name}/p_out"] / run.log[f"{name}/p_in"]
        asked = [head_for(float(r), C_01, GAMMA) / 1e3 for r in ratio]
        flows = volume * run.log[f"{name}/q"]
        ax.plot(flows, asked, color=colour, linewidth=width, label=SAID[name])
        if name == "guarded":
            ax.plot(flows[-1:], asked[-1:], "o", color=colour, markersize=6)
    ax.axvline(0.0, color=GRID, linewidth=0.8, zorder=0.5)
    ax.set_xlabel("inlet flow [m3/h]")
    ax.set_ylabel("head [kJ/kg]")
    tidy(ax)
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, frameon=False, fontsize=8.5)
    return figure
