"""Draw a diagram as a control engineer would: boxes left to right, feedback below, every arrow with its signal."""

import math
import re
import textwrap
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.figures.placement import Arrow, Grid, Node, common, grid, wrapped
from stickslip.diagram.figures.routes import Box, Sheet, sheet
from stickslip.diagram.figures.strokes import HEAD_LENGTH, branches, strokes
from stickslip.diagram.wired import Wired
from stickslip.logs.style import EDGE, FILL, FRAME, FRAME_EDGE, INK, RED, SOFT, WIRE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# which parameters a box shows first: the ones by which engineers know a block
MAIN = (
    "K_p", "T_i", "T_d", "K", "tau", "T", "theta", "F_s", "F_c", "S", "J", "C_v", "value", "before", "after", "at",
    "slope", "amplitude", "period", "sd", "dt",
)  # fmt: skip
SHOWN = 3
GREEK = (
    "alpha",
    "beta",
    "gamma",
    "delta",
    "zeta",
    "eta",
    "theta",
    "kappa",
    "lambda",
    "mu",
    "rho",
    "sigma",
    "tau",
    "omega",
)
NAME_SIZE, WORD_SIZE, VALUE_SIZE, SIGNAL_SIZE = 9.5, 7.5, 7.5, 8.0
LINE = 10.5  # height of a line of small text [points]
MARGIN = 16.0
HEADING = 26.0
WIDEST = 1120.0  # of a drawing [points], 1600 pixels on a screen; a wider one goes on below


def draw(
    diagram: Wired, marks: Mapping[str, float] | None = None, units: Mapping[str, Sequence[str]] | None = None,
    said: Mapping[str, str] | None = None,
) -> "Figure":  # fmt: skip
    """Return a figure of the diagram, as large as it needs to be at the size of its text; a wide one goes on below.

    A box shows the name of its block, the word of its class and up to three main parameters.  Green: sources;
    blue: controllers; orange: valves; violet: blocks that run in Python.  ``marks``: block -> 0 to 1, how red and thick
    its frame is.  ``units``: name -> names of the blocks that are drawn as one box, with what runs between the units.
    ``said``: block -> words in red at the foot of its box.

    Raises ``WiringError`` if a unit names a block that is not there.

    >>> from stickslip.blocks.sources import Step
    >>> from stickslip.diagram import wire
    >>> figure = draw(wire([Step("SP", 0.5)], outputs=["SP"], name="set point"))
    >>> [text.get_text() for text in figure.axes[0].texts][:2]
    ['set point', 'SP']
    """
    from stickslip.logs.picture import Picture

    for inner in (units or {}).values():
        for name in inner:
            diagram[name]
    plan = grid(diagram, units)
    ink = _Ink(diagram, plan, marks or {}, said or {})
    laid = sheet(plan, ink.size, ink.label_width, ink.entry_width)
    for bands in range(2, max(plan.column) + 2):
        if laid.width <= WIDEST:
            break
        ink.plan = wrapped(plan, bands)
        laid = sheet(ink.plan, ink.size, ink.label_width, ink.entry_width)
    width = max(laid.width, _width(diagram.name, 12.0, "bold")) + 2 * MARGIN
    height = laid.height + 2 * MARGIN + HEADING
    figure = Picture(figsize=(width / 72.0, height / 72.0), facecolor="white")
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set_xlim(-MARGIN, width - MARGIN)
    ax.set_ylim(height - MARGIN - HEADING, -MARGIN - HEADING)
    ax.set_axis_off()
    ax.text(0.0, -HEADING, diagram.name, size=12.0, weight="bold", color=INK, va="center", parse_math=False)
    ink.paint(ax, laid)
    return figure


def symbol(name: str) -> str:
    """Return a parameter's name as a symbol in mathtext.

    >>> symbol("K_p"), symbol("tau"), symbol("dead time")
    ('$K_{p}$', '$\\\\tau$', 'dead time')
    """
    base, _, index = name.partition("_")
    if base in GREEK:
        base = f"\\{base}"
    elif len(base) > 1:
        return name.replace("_", " ")
    return f"${base}_{{{index.replace('_', ' ')}}}$" if index else f"${base}$"


def word(block: Block) -> str:
    """Return the word of a block's class: ``FirstOrder`` is a first order.

    >>> from stickslip.blocks.sources import Step
    >>> word(Step("SP"))
    'step'
    """
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z][a-z0-9]*|[a-z0-9]+", type(block).__name__)
    return " ".join(part if part.isupper() and len(part) > 1 else part.lower() for part in parts)


def colour(block: Block) -> str:
    """Return the key of a block's colours: its role where that has some, "python" for one that runs in Python."""
    if block.host is not None:
        return "python"
    role = Role.SOURCE if block.role.drives else block.role
    return str(role) if role in FILL else "plain"


def main_parameters(block: Block) -> list[str]:
    """Return up to three lines ``symbol = value``: the parameters engineers know a block by, zeros left out.

    >>> from stickslip.blocks.sources import Step
    >>> main_parameters(Step("SP", after=0.5, at=60.0))
    ['after = 0.5', 'at = 60']
    """
    finite = [n for n in block.param_names if math.isfinite(block.params[n]) and not n.startswith("w_")]
    known = [n for n in MAIN if n in finite and block.params[n] != 0.0]
    return [f"{symbol(n)} = {block.params[n]:.4g}" for n in (known or finite[: SHOWN - 1])[:SHOWN]]


def _listed(names: Sequence[str]) -> list[str]:
    """Return the names of a unit's blocks, a few in a line."""
    return textwrap.wrap(", ".join(names), 30)


def _width(text: str, size: float, weight: str = "normal") -> float:
    """Return the width of a text [points]."""
    from matplotlib import rcParams

    fonts = *rcParams["font.family"], *rcParams["font.sans-serif"], rcParams["mathtext.fontset"]
    return _measured(text, size, weight, fonts)


@lru_cache(maxsize=4096)
def _measured(text: str, size: float, weight: str, fonts: tuple[str, ...]) -> float:
    """Return the width of a text in the fonts set now [points]; most texts of a drawing are in the next one, too."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    prop = FontProperties(size=size, weight=weight)
    return float(TextToPath().get_text_width_height_descent(text, prop, "$" in text)[0])


class _Ink:
    """The texts of one drawing, and how to put them on paper."""

    def __init__(
        self, diagram: Wired, plan: Grid, marks: Mapping[str, float], said: Mapping[str, str] | None = None
    ) -> None:
        self.diagram, self.plan, self.marks = diagram, plan, marks
        self.said = {
            v: [
                words
                for name, words in (said or {}).items()
                if name in (node.inner or (diagram.blocks[node.block].name,))
            ]
            for v, node in enumerate(plan.nodes)
            if node.kind == "block"
        }
        self.lines = {
            v: _listed(node.inner) if node.inner else main_parameters(diagram.blocks[node.block])
            for v, node in enumerate(plan.nodes)
            if node.kind == "block"
        }

    def size(self, v: int, least: float) -> tuple[float, float]:
        """Return width and height of a node [points]."""
        node = self.plan.nodes[v]
        if node.kind != "block":
            return _width(self._signal(node.name), SIGNAL_SIZE) + 18.0, max(least, 18.0)
        widths = [_width(node.name, NAME_SIZE, "bold"), _width(self._word(node), WORD_SIZE)]
        widths += [_width(line, VALUE_SIZE) for line in self.lines[v]]
        widths += [_width(line, SIGNAL_SIZE, "bold") for line in self.said[v]]
        return max(64.0, max(widths) + 16.0), max(least, 32.0 + LINE * (len(self.lines[v]) + len(self.said[v])))

    def _word(self, node: Node) -> str:
        return f"{len(node.inner)} blocks" if node.inner else word(self.diagram.blocks[node.block])

    def label_width(self, arrow: Arrow) -> float:
        """Return the width of the label where an arrow begins."""
        return _width(self._label(arrow), SIGNAL_SIZE) + 6.0 if self._labelled(arrow) else 4.0

    def entry_width(self, arrow: Arrow) -> float:
        """Return the width of the label where an arrow ends."""
        return _width(self._entry(arrow), SIGNAL_SIZE) if self._enters_labelled(arrow) else 0.0

    def _labelled(self, arrow: Arrow) -> bool:
        """Tell whether the arrow needs a label: not if the box or oval at one of its ends says the same."""
        ends = [self.plan.nodes[a.target] for a in self.plan.arrows if a.signal == arrow.signal]
        source = self.plan.nodes[arrow.source]
        return source.kind == "block" and source.name != self._label(arrow) and any(n.kind == "block" for n in ends)

    def _enters_labelled(self, arrow: Arrow) -> bool:
        return self.plan.nodes[arrow.target].kind == "block"

    def _label(self, arrow: Arrow) -> str:
        group = "/".join(self.plan.nodes[arrow.source].group)
        return self._signal(arrow.signal).removeprefix(f"{group}/" if group else "")

    def _signal(self, signal: str) -> str:
        unit = self.diagram.signal_units.get(signal, "")
        return f"{signal} [{unit}]" if unit not in ("", "1") else signal

    def _sign(self, arrow: Arrow) -> str:
        """Return what a signal is multiplied by where it enters a sum: its sign, with the factor if that is not one."""
        node = self.plan.nodes[arrow.target]
        if node.kind != "block" or node.inner:
            return ""
        block = self.diagram.blocks[node.block]
        weight = block.params.get(f"w_{block.ports_in[arrow.into].name}")
        if weight is None:
            return ""
        size = "" if abs(weight) == 1.0 else f" {abs(weight):.3g} ×"
        return f"{'+' if weight >= 0.0 else '−'}{size}"

    def _entry(self, arrow: Arrow) -> str:
        return f"{self._sign(arrow)} {self._name_there(arrow)}".strip()

    def _name_there(self, arrow: Arrow) -> str:
        home = "/".join(common(self.plan.nodes[arrow.source].group, self.plan.nodes[arrow.target].group))
        return arrow.signal.removeprefix(f"{home}/") if home else arrow.signal

    def paint(self, ax: "Axes", laid: Sheet) -> None:
        """Put frames, lines, boxes and texts on the axes."""
        from matplotlib.patches import FancyBboxPatch

        for group, (left, top, right, bottom) in laid.frames.items():
            ax.add_patch(FancyBboxPatch(
                (left, top), right - left, bottom - top, boxstyle="round,pad=0,rounding_size=8",
                facecolor=FRAME if len(group) % 2 else "white", edgecolor=FRAME_EDGE, linewidth=0.9,
                zorder=0.1 * len(group),
            ))  # fmt: skip
            ax.text(
                left + 9.0,
                top + 9.5,
                group[-1],
                size=8.0,
                color=SOFT,
                weight="bold",
                va="center",
                zorder=3,
                parse_math=False,
            )
        self._wires(ax, laid)
        for v, (node, box) in enumerate(zip(self.plan.nodes, laid.boxes, strict=True)):
            if node.kind == "block":
                self._box(ax, v, node, box)
            else:
                _oval(ax, self._signal(node.name), box)

    def _wires(self, ax: "Axes", laid: Sheet) -> None:
        labelled: set[tuple[int, int]] = set()
        for xs, ys in strokes(self.plan, laid):
            ax.plot(xs, ys, color=WIRE, linewidth=1.0, zorder=2, solid_capstyle="projecting")
        for arrow, line, close in zip(self.plan.arrows, laid.lines, laid.near, strict=True):
            tip, y = line[-1]
            ax.fill(
                [tip, tip - HEAD_LENGTH, tip - HEAD_LENGTH], [y, y - 2.9, y + 2.9], color=WIRE, linewidth=0, zorder=2.1
            )
            text: dict[str, Any] = {"size": SIGNAL_SIZE, "va": "bottom", "zorder": 4, "parse_math": False}
            if (arrow.source, arrow.out) not in labelled and self._labelled(arrow):
                labelled.add((arrow.source, arrow.out))
                ax.text(line[0][0] + 5.0, line[0][1] - 2.0, self._label(arrow), color=INK, **text)
            if not close and self._enters_labelled(arrow):
                ax.text(tip - 9.0, y - 2.0, self._entry(arrow), color=SOFT, ha="right", **text)
            elif self._sign(arrow):
                ax.text(tip - 9.0, y - 2.0, self._sign(arrow), color=SOFT, ha="right", **text)
        for x, y in branches(self.plan, laid):
            ax.plot([x], [y], marker="o", markersize=3.6, color=WIRE, zorder=2.2)

    def _box(self, ax: "Axes", v: int, node: Node, box: Box) -> None:
        from matplotlib.patches import FancyBboxPatch

        kind = "plain" if node.inner else colour(self.diagram.blocks[node.block])
        mark = max(self.marks.get(name, 0.0) for name in node.inner or (self.diagram.blocks[node.block].name,))
        ax.add_patch(FancyBboxPatch(
            (box.x - box.width / 2, box.y - box.height / 2), box.width, box.height,
            boxstyle="round,pad=0,rounding_size=4", facecolor=FILL[kind], edgecolor=EDGE[kind], linewidth=1.2, zorder=3,
        ))  # fmt: skip
        if mark > 0.0:
            ax.add_patch(FancyBboxPatch(
                (box.x - box.width / 2, box.y - box.height / 2), box.width, box.height, fill=False,
                boxstyle="round,pad=0,rounding_size=4", edgecolor=RED, alpha=0.35 + 0.65 * mark,
                linewidth=1.2 + 3.0 * mark, zorder=3.5,
            ))  # fmt: skip
        lines = self.lines[v]
        y = box.y - (LINE * (len(lines) + len(self.said[v])) + 21.0) / 2 + 5.5
        text: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 4}
        ax.text(box.x, y, node.name, size=NAME_SIZE, weight="bold", color=INK, parse_math=False, **text)
        ax.text(
            box.x,
            y + 11.5,
            self._word(node),
            size=WORD_SIZE,
            style="italic",
            color=EDGE[kind],
            parse_math=False,
            **text,
        )
        for i, line in enumerate(lines):
            ax.text(box.x, y + 23.0 + LINE * i, line, size=VALUE_SIZE, color=INK, math_fontfamily="dejavusans",
                    parse_math=not node.inner, **text)  # fmt: skip
        for i, line in enumerate(self.said[v], len(lines)):
            ax.text(box.x, y + 23.0 + LINE * i, line, size=SIGNAL_SIZE, weight="bold", color=RED, parse_math=False,
                    **text)  # fmt: skip


def _oval(ax: "Axes", name: str, box: Box) -> None:
    from matplotlib.patches import FancyBboxPatch

    ax.add_patch(FancyBboxPatch(
        (box.x - box.width / 2, box.y - 9.0), box.width, 18.0, boxstyle="round,pad=0,rounding_size=9",
        facecolor="white", edgecolor=WIRE, linewidth=1.0, zorder=3,
    ))  # fmt: skip
    ax.text(box.x, box.y, name, size=SIGNAL_SIZE, color=INK, ha="center", va="center", zorder=4, parse_math=False)
