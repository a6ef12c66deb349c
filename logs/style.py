"""How all our pictures and pages look: every colour of the house, and panels with no more lines than they need."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Lines, words and grounds, from dark to light.
INK, WIRE, SOFT, AXIS, PALE, GRID = "#1d2733", "#3a4653", "#5b6875", "#808080", "#8896a5", "#e3e6ea"
SHADE = "#f1f4f8"  # behind every other group
# Told apart in print and by colour-blind eyes: dark line for what is measured, warm for what commands.
BLUE, ORANGE, GREEN, VIOLET, TEAL, OLIVE, RED = (
    "#1f4e79", "#c55a11", "#2e7d32", "#6a3d9a", "#00798c", "#7f6000", "#b00020",
)  # fmt: skip
COLOURS = {"SP": "#7f7f7f", "PV": BLUE, "OP": ORANGE, "MV": GREEN, "bad": RED}
CYCLE = (BLUE, ORANGE, GREEN, VIOLET, TEAL, OLIVE)  # of signals without a part
OUTSIDE = "#555555"  # a signal of no nested diagram, beside some that are
STUCK, EVENT = "#d8a566", "#8a5a2b"  # where a stem is stuck; other changes of mode
# Half cycles before and after a turn: a dark and a light one, which mean no signal; those that do not count; a fit.
BEFORE, AFTER, UNUSED, FIT = "#7b5ea7", "#f0c05a", "#e6e6e6", "#333333"
# Sizes of stiction from light to dark, so that grey paper keeps the order, and OP beside them.
STICTION = {"none": "#9aa7b4", "normal": "#4a90d0", "high": "#a3281a"}
COMMAND = "#8a97a5"
# Boxes of a drawing by the role of their block, and the frames of nested diagrams.
FILL = {"source": "#e9f4ec", "controller": "#e7f0fb", "valve": "#fdf0e1", "python": "#f1eafa", "plain": "#ffffff"}
EDGE = {"source": "#4d8f63", "controller": "#3f73b0", "valve": "#c07a22", "python": "#7d5bb0", "plain": "#54616e"}
FRAME, FRAME_EDGE = "#f4f6f9", "#c3ccd6"
# Numbers on a scale of colours, which is the same day and night.
ON_DARK, ON_LIGHT = "#fefefe", "#101010"
PAPER = "#ffffff"  # behind a picture, and letters on a strong colour
# Pages.
PAGE = {
    "ink": INK, "soft": SOFT, "line": "#dfe4ea", "ground": "#f6f8fa", "card": "#ffffff", "link": "#1f5fa8",
    "missed": "#fdf1e4", "paper": "#ffffff", "hint": "#c3ccd6",
    "bad": "#fdecea", "bad_ink": "#96231c", "bad_line": "#f3c1bc",
    "good": "#e8f5ec", "good_ink": "#1c6b38", "good_line": "#bfe2cb",
    "open": "#fff6e0", "open_ink": "#7a5600", "open_line": "#f0dca8",
}  # fmt: skip
# The same at night.
NIGHT = {
    "ink": "#e6ebf1", "soft": "#a3afbb", "line": "#333d48", "ground": "#12171d", "card": "#1a2129", "link": "#8cb8ee",
    "missed": "#3a2c1a", "paper": "#1a2129", "hint": "#55626f",
    "bad": "#47201d", "bad_ink": "#ffb4ab", "bad_line": "#6d322d",
    "good": "#1b3a26", "good_ink": "#9fd8b0", "good_line": "#2e5b3d",
    "open": "#40320f", "open_ink": "#f2d58a", "open_line": "#665122",
}  # fmt: skip

# What becomes of the colours of a picture on a page at night; those that are not here suit both.
AT_NIGHT = {
    "#000000": NIGHT["ink"], PAPER: NIGHT["paper"], INK: NIGHT["ink"], WIRE: "#c3cdd8", SOFT: "#a3afbb",
    GRID: "#2c353f", SHADE: "#212b35", BLUE: "#7fb2e5", ORANGE: "#f0985a", GREEN: "#7cc680", VIOLET: "#b79ae0",
    TEAL: "#4fc0d2", OLIVE: "#d0b04a", RED: "#ff7a85", COLOURS["SP"]: "#a8a8a8", OUTSIDE: "#b0b0b0",
    STUCK: "#9a7440", EVENT: "#d29a63", BEFORE: "#a58bd0", AFTER: "#8a6a1c", UNUSED: "#3d4650", FIT: "#d5dbe2",
    STICTION["high"]: "#e8695a", FILL["source"]: "#1f3327", FILL["controller"]: "#1c2f45", FILL["valve"]: "#3d2f1c",
    FILL["python"]: "#30273f", FRAME: "#1e262f", FRAME_EDGE: "#46515d",
}  # fmt: skip


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
