"""Figures as parts of a page: SVG inside the text, a caption below, several side by side."""

import html
import io
import re
import warnings
import zlib
from collections.abc import Sequence
from typing import TYPE_CHECKING

from stickslip.commands.report.style import in_variables

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["beside", "captioned", "figure_to_svg", "side_by_side"]

SILENT = dict.fromkeys(("Creator", "Date", "Format", "Type"))  # no metadata, no web addresses
OUTSIDE = 1.0  # point that something may stick out of a figure


def captioned(svg: str, caption: str, finding: str = "") -> str:
    """Return a picture with a sentence below it, for ``Section.figures``; ``finding`` stands first and stronger.

    >>> captioned("<svg></svg>", "a < b", "Found.")
    '<svg></svg><figcaption><strong>Found.</strong> a &lt; b</figcaption>'
    """
    strong = f"<strong>{html.escape(finding)}</strong> " if finding else ""
    return f"{svg}<figcaption>{strong}{html.escape(caption)}</figcaption>"


def side_by_side(pictures: Sequence[str]) -> str:
    """Return pictures side by side if there is room, else one below the other.

    >>> side_by_side(["<svg></svg>"])
    "<div class='grid'><figure><svg></svg></figure></div>"
    """
    return f"<div class='grid'>{''.join(f'<figure>{picture}</figure>' for picture in pictures)}</div>"


def beside(wide: str, small: str) -> str:
    """Return a wide picture with a small one at its side, or below it if there is no room.

    >>> beside("<svg></svg>", "<svg></svg>")
    "<div class='grid wide'><figure class=scroll><svg></svg></figure><figure><svg></svg></figure></div>"
    """
    return f"<div class='grid wide'><figure class=scroll>{wide}</figure><figure>{small}</figure></div>"


def figure_to_svg(figure: "Figure") -> str:
    """Return a figure as SVG text fit for inlining: no prolog, ids of its own, and the colours of the page.

    Text stays text: it can be searched, and the browser has the signs that matplotlib's own font lacks.
    """
    import matplotlib

    with warnings.catch_warnings(), matplotlib.rc_context({"svg.fonttype": "none"}):
        warnings.filterwarnings("ignore", "Glyph .* missing")
        text = _drawn_once(figure)
        if text is None:
            buffer = io.StringIO()
            figure.savefig(buffer, format="svg", bbox_inches="tight", metadata=SILENT, transparent=True)
            text = buffer.getvalue()
    text = text[text.index("<svg") :]
    own = f"f{zlib.crc32(text.encode()):08x}"
    text = re.sub(r'\bid="([^"]+)"', rf'id="{own}-\1"', text)
    text = re.sub(r"url\(#([^)]+)\)", rf"url(#{own}-\1)", text)
    return in_variables(re.sub(r'href="#([^"]+)"', rf'href="#{own}-\1"', text))


def _drawn_once(figure: "Figure") -> str | None:
    """The figure as SVG if its layout keeps everything inside it, else None.

    ``savefig`` draws twice, the first time for the layout, which takes half of the time of a page.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    if not isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine):
        return None
    patches = [figure.patch, *(axes.patch for axes in figure.axes)]
    colours = [patch.get_facecolor() for patch in patches]
    buffer, resolution = io.StringIO(), figure.dpi
    try:
        for patch in patches:
            patch.set_facecolor("none")
        FigureCanvasSVG(figure).print_svg(buffer, metadata=SILENT)  # type: ignore[no-untyped-call]
        needed = figure.get_tightbbox().get_points() * figure.dpi
    finally:
        for patch, colour in zip(patches, colours, strict=True):
            patch.set_facecolor(colour)
        figure.dpi = resolution
    inside = figure.bbox.get_points() * 72.0 / resolution
    sticks_out = (needed[0] < inside[0] - OUTSIDE).any() or (needed[1] > inside[1] + OUTSIDE).any()
    return None if sticks_out else buffer.getvalue()
