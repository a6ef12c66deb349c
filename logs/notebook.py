"""A log and a picture as HTML, for a notebook."""

from __future__ import annotations

import base64
import html
import io
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from stickslip.logs.signals import Signals

ROWS = 5  # at the beginning and at the end
COLUMNS = 12


def table(log: Signals) -> str:
    """Return the first and last rows of a log as an HTML table; what is left out is said below it."""
    shown = log.names[:COLUMNS]
    heads = ["time [s]", *(f"{name} [{log.units[name]}]" if name in log.units else name for name in shown)]
    n = len(log)
    rows = list(range(n)) if n <= 2 * ROWS else [*range(ROWS), -1, *range(n - ROWS, n)]
    lines = ["<tr>" + "".join(f"<th>{html.escape(head)}</th>" for head in heads) + "</tr>"]
    for i in rows:
        cells = ["&hellip;"] * len(heads) if i < 0 else [f"{value:.6g}" for value in _row(log, shown, i)]
        lines.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    more = f" and {len(log.names) - COLUMNS} more signals" if len(log.names) > COLUMNS else ""
    return f"<table>{''.join(lines)}</table><p>{n} samples over {log.duration:g} s{more}</p>"


def _row(log: Signals, names: tuple[str, ...], i: int) -> list[np.float64]:
    return [log.t[i], *(log[name][i] for name in names)]


def png(figure: Figure) -> bytes:
    """Return a picture as PNG."""
    kept = io.BytesIO()
    figure.savefig(kept, format="png", dpi=100)
    return kept.getvalue()


def image(figure: Figure) -> str:
    """Return a picture as an HTML image with its data inside."""
    return f'<img src="data:image/png;base64,{base64.b64encode(png(figure)).decode()}">'


def paragraph(text: str) -> str:
    """Return a sentence as an HTML paragraph."""
    return f"<p>{html.escape(text)}</p>"
