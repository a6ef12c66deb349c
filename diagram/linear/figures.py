"""Pictures of a linearised diagram: poles over time constants, Bode plots of loops, relative gains."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from stickslip.diagram.linear.gain_arrays import Rga
from stickslip.diagram.linear.loop import Loop
from stickslip.diagram.linear.poles import Pole
from stickslip.logs.style import BLUE, CYCLE, GRID, INK, PALE, RED, SOFT, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LINES = (*CYCLE, RED, SOFT)
DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)))  # tell neighbours apart on grey paper
STABLE, UNSTABLE, HELD = BLUE, RED, PALE
LEAST_GAIN, MOST_GAIN = 1e-3, 1e3  # of a Bode plot: what lies beyond says nothing about the loop


def plot_poles(poles: Sequence[Pole], title: str = "") -> "Figure":
    """Return the poles, one line each: time constant 1/|Re p| on a log axis, and the states it is made of.

    Filled: real; open ring: oscillating, with its damping; red: unstable; a bar at the right: held, or without decay.
    """
    from stickslip.logs.picture import Picture

    figure = Picture(figsize=(9.0, 1.0 + 0.27 * len(poles)), layout="constrained")
    ax = figure.subplots()
    moving = [pole.time_constant for pole in poles if pole.value.real]
    low, high = (min(moving) / 3.0, max(moving) * 3.0) if moving else (0.1, 10.0)
    for row, pole in enumerate(poles):
        if pole.held or not pole.value.real:
            ax.plot([high], [row], marker="|", color=HELD, markersize=11, clip_on=False)
            why = "held" if pole.held else f"undamped, {pole.frequency:.3g} rad/s" if pole.value.imag else "integrates"
            text = f"{pole.made_of()}   {why}"
            ax.annotate(text, (high, row), (-8, 0), textcoords="offset points", va="center", ha="right", color=HELD,
                        fontsize=8)  # fmt: skip
            continue
        colour = UNSTABLE if pole.value.real > 0.0 else STABLE
        swings = pole.value.imag != 0.0
        ax.plot([low, pole.time_constant], [row, row], color=GRID, linewidth=0.8, zorder=0.5)
        ax.plot([pole.time_constant], [row], "o", color=colour, markersize=6.5, zorder=3,
                markerfacecolor="white" if swings else colour, markeredgewidth=1.6)  # fmt: skip
        said = pole.made_of() + (f"   damping {pole.damping:.2g}" if swings else "")
        left = np.log(high / pole.time_constant) < 0.45 * np.log(high / low)  # slow ones have their text on the left
        ax.annotate(said, (pole.time_constant, row), (-9 if left else 9, 0), textcoords="offset points", va="center",
                    ha="right" if left else "left", fontsize=8, color=INK, zorder=4,
                    bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"})  # fmt: skip
    ax.set_xscale("log")
    ax.set_xlim(low, high)
    ax.set_ylim(len(poles) - 0.4, -0.6)
    ax.set_yticks([])
    ax.set_xlabel("time constant 1/|Re p| [s]")
    tidy(ax)
    ax.spines["left"].set_visible(False)
    _head(figure, f"{title}: poles" if title else "poles")
    return figure


def plot_loops(loops: Sequence[Loop]) -> "Figure":
    """Return gain and phase of loops against frequency, crossovers marked, margins in the legend."""
    from stickslip.logs.picture import Picture

    figure = Picture(figsize=(9.0, 5.6), layout="constrained")
    gain, phase = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    shown = []
    for i, loop in enumerate(loops):
        colour = LINES[i % len(LINES)]
        size = np.abs(loop.response)
        seen = (size > LEAST_GAIN) & (size < MOST_GAIN)
        if not seen.any():
            continue
        omega = loop.omega[seen]
        shown += [omega[0], omega[-1]]
        dash = DASHES[i % len(DASHES)]
        gain.loglog(omega, size[seen], color=colour, linewidth=1.4, linestyle=dash, label=_margins(loop))
        phase.semilogx(omega, loop.phase[seen], color=colour, linewidth=1.4, linestyle=dash)
        for w in loop.crossovers:
            gain.plot([w], [1.0], "o", color=colour, markersize=5)
            phase.plot([w], [np.interp(np.log(w), np.log(loop.omega), loop.phase)], "o", color=colour, markersize=5)
    gain.axhline(1.0, color=SOFT, linewidth=0.8)
    phase.axhline(-180.0, color=SOFT, linewidth=0.8)
    if shown:
        gain.set_xlim(min(shown), max(shown))
    gain.set_ylabel("|L|")
    phase.set_ylabel("phase of L [degrees]")
    phase.set_xlabel("frequency [rad/s]")
    from matplotlib.ticker import MultipleLocator

    phase.yaxis.set_major_locator(MultipleLocator(90.0))
    phase.set_ylim(min(-200.0, *phase.get_ylim()), max(-60.0, phase.get_ylim()[1]))
    for ax in (gain, phase):
        tidy(ax)
    gain.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, fontsize=8.0, handlelength=2.8)
    _head(figure, "open loops" if len(loops) > 1 else f"loop of {loops[0].controller}: {loops[0].OP} to {loops[0].PV}")
    return figure


def plot_rga(rga: Rga) -> "Figure":
    """Return a relative gain array: shades of its size, the numbers written in."""
    from stickslip.logs.picture import Picture

    n = len(rga.controllers)
    figure = Picture(figsize=(2.2 + 0.95 * n, 1.6 + 0.6 * n), layout="constrained")
    ax = figure.subplots()
    values = rga.values.real if rga.frequency == 0.0 else np.abs(rga.values)
    ax.imshow(np.abs(values), cmap="Blues", vmin=0.0, vmax=max(1.6, float(np.abs(values).max())), aspect="auto")
    for row in range(n):
        for column in range(n):
            value = values[row, column]
            colour = UNSTABLE if value < -0.005 else "white" if abs(value) > 1.1 else INK
            ax.text(
                column, row, f"{value:.2f}".replace("-0.00", "0.00"), ha="center", va="center", color=colour, fontsize=9
            )
    ax.set_xticks(range(n), rga.OPs, fontsize=8.5, rotation=30 if n > 4 else 0)
    ax.set_yticks(range(n), rga.PVs, fontsize=8.5)
    ax.tick_params(length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)
    _head(figure, "relative gains, steady" if rga.frequency == 0.0 else f"|relative gains| at {rga.frequency:g} rad/s")
    return figure


def _margins(loop: Loop) -> str:
    if not loop.crossovers:
        return f"{loop.controller}: |L| < 1 throughout"
    crossover = f"{loop.crossover:.3g}" if loop.crossover < 1000.0 else f"{loop.crossover:.0f}"
    return f"{loop.controller}: {crossover} rad/s, phase margin {loop.phase_margin:.0f}°"


def _head(figure: "Figure", text: str) -> None:
    figure.suptitle(text, x=0.01, ha="left", fontsize=11, weight="bold")
