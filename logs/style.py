"""How all our pictures look: their quiet colours, and panels with no more lines than they need."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, SOFT, AXIS, GRID = "#1d2733", "#5b6875", "#808080", "#e3e6ea"


def tidy(ax: "Axes") -> None:
    """Leave a panel a light grid and two thin axes.

    >>> from matplotlib.figure import Figure
    >>> ax = Figure().subplots()
    >>> tidy(ax)
    >>> [side for side in ax.spines if ax.spines[side].get_visible()]
    ['left', 'bottom']
    """
    ax.grid(True, which="major", color=GRID, linewidth=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set_color(AXIS)
    ax.tick_params(color=AXIS, labelsize=8.5, which="both")
