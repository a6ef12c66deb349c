"""One HTML page that opens offline: no script, no request, pictures inside as SVG."""

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from stickslip.commands.report.pictures import beside, captioned, figure_to_svg, side_by_side
from stickslip.commands.report.style import CSS
from stickslip.commands.report.tables import ordered_table, table_to_html

__all__ = [
    "Section", "beside", "bullets", "captioned", "figure_to_svg", "ordered_table", "page", "pairs", "side_by_side",
    "table_to_html",
]  # fmt: skip


@dataclass
class Section:
    """One article: a title, a badge of a kind (bad, good or open), a reason, and what helps to believe it.

    ``before`` and ``after`` stand around the reason, paler; ``aside`` beside the title.  ``notes`` are a list under
    ``notes_label``.  ``figures`` are pieces of HTML: a picture, a table, what the functions of this package return.
    """

    title: str
    badge: str
    kind: str
    reason: str
    before: str = ""
    aside: str = ""
    after: str = ""
    notes: list[str] = field(default_factory=list)
    figures: list[str] = field(default_factory=list)
    notes_label: str = "Notes"


def page(
    title: str,
    lead: str,
    sections: Sequence[Section],
    table: Sequence[Sequence[str]] = (),
    guide: str = "",
    contents: bool = False,
    footer: str = "",
) -> str:
    """Return the whole page; the first row of ``table`` is its head and each row links to its section.

    ``guide``, below the table, tells how to read what follows; ``contents`` lists the sections on top; ``footer`` says
    who wrote the page and of what.
    """
    parts = [
        "<!doctype html><html lang='en'><head><meta charset='utf-8'>",
        "<meta name='viewport' content='width=device-width, initial-scale=1'>",
        f"<title>{html.escape(title)}</title><style>{CSS}</style></head><body><main>",
        f"<h1>{html.escape(title)}</h1>",
        f"<p class='lead'>{html.escape(lead)}</p>" if lead else "",
    ]
    if contents:
        links = (f"<a href='#s{number}'>{html.escape(section.title)}</a>" for number, section in enumerate(sections))
        parts.append(f"<nav>{' '.join(links)}</nav>")
    if table:
        rows = table_to_html(table[0], table[1:], links=[f"#s{number}" for number in range(len(table) - 1)])
        parts.append(f"<article>{rows}</article>")
    if guide:
        parts.append(f"<p class='guide'>{html.escape(guide)}</p>")
    parts += [_article(number, section) for number, section in enumerate(sections)]
    said = f"{footer} " if footer else ""
    parts.append(
        f"<footer>{html.escape(said)}Written by stickslip. This page needs no network and no script.</footer>"
        "</main></body></html>"
    )
    return "\n".join(part for part in parts if part)


def _article(number: int, section: Section) -> str:
    figures = "".join(
        piece if _in_figures(piece) else f"<figure{' class=scroll' if _alone(piece) else ''}>{piece}</figure>"
        for piece in section.figures
    )
    return (
        f"<article id='s{number}'><header class='row'><h2>{html.escape(section.title)}</h2>"
        + (f"<span class='badge {section.kind}'>{html.escape(section.badge)}</span>" if section.badge else "")
        + (f"<span class='aside'>{html.escape(section.aside)}</span>" if section.aside else "")
        + "</header>"
        + (f"<p class='soft'>{html.escape(section.before)}</p>" if section.before else "")
        + (f"<p class='reason'>{html.escape(section.reason)}</p>" if section.reason else "")
        + (f"<p class='soft'>{html.escape(section.after)}</p>" if section.after else "")
        + figures
        + (bullets(section.notes_label, section.notes) if section.notes else "")
        + "</article>"
    )


def _alone(piece: str) -> bool:
    """Whether a piece is one wide picture, which scrolls sideways where the window is narrow."""
    return piece.startswith("<svg")


def _in_figures(piece: str) -> bool:
    """Whether a piece is several pictures, each a figure of its own."""
    return piece.startswith("<div class='grid")


def bullets(label: str, items: Sequence[str]) -> str:
    """Return a list under a label.

    >>> bullets("Read", ["a < b"])
    "<p class='label'>Read</p><ul class='notes'><li>a &lt; b</li></ul>"
    """
    said = "".join(f"<li>{html.escape(item)}</li>" for item in items)
    return f"<p class='label'>{html.escape(label)}</p><ul class='notes'>{said}</ul>"


def pairs(items: Mapping[str, str]) -> str:
    """Return names with what belongs to each.

    >>> pairs({"S": "5 %"})
    '<dl><dt>S</dt><dd>5 %</dd></dl>'
    """
    said = (f"<dt>{html.escape(name)}</dt><dd>{html.escape(text)}</dd>" for name, text in items.items())
    return f"<dl>{''.join(said)}</dl>"
