"""One HTML page that opens offline: no script, no request, pictures inside as SVG."""

import html
import io
import re
import warnings
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from string import Template
from typing import TYPE_CHECKING

from logs.style import NIGHT, PAGE

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _variables(colours: Mapping[str, str]) -> str:
    return " ".join(f"--{name}: {colour};" for name, colour in colours.items())


CSS = Template("""
:root { color-scheme: light dark; $day }
@media (prefers-color-scheme: dark) { :root { $night } }
@media print { :root { color-scheme: light; $day } }
* { box-sizing: border-box; }
body { font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, Arial, sans-serif; color: var(--ink);
  background: var(--ground); margin: 0; }
main { max-width: 1040px; margin: 0 auto; padding: 32px 20px 64px; }
h1 { font-size: 30px; margin: 0 0 6px; letter-spacing: -0.01em; }
h2 { font-size: 20px; margin: 0; }
.lead { color: var(--soft); margin: 0 0 22px; max-width: 72ch; }
article { background: var(--card); border: 1px solid var(--line); border-radius: 10px; padding: 20px 22px;
  margin: 18px 0; }
header.row { display: flex; gap: 12px; align-items: baseline; flex-wrap: wrap; }
.badge { font-size: 13px; font-weight: 650; padding: 2px 10px; border-radius: 99px; border: 1px solid transparent; }
.bad { background: var(--bad); color: var(--bad_ink); border-color: var(--bad_line); }
.good { background: var(--good); color: var(--good_ink); border-color: var(--good_line); }
.open { background: var(--open); color: var(--open_ink); border-color: var(--open_line); }
.truth { color: var(--soft); font-size: 14px; }
.reason { margin: 10px 0 4px; max-width: 80ch; }
.story { color: var(--soft); margin: 6px 0; max-width: 80ch; }
.guide { max-width: 80ch; }
.label { color: var(--soft); font-size: 14px; font-weight: 600; margin: 12px 0 0; }
ul.notes { color: var(--soft); font-size: 14px; margin: 2px 0 8px; padding-left: 18px; }
figure { margin: 14px 0 0; overflow-x: auto; }
figure svg { width: 100%; height: auto; min-width: 640px; background: var(--paper); border-radius: 6px; }
figcaption { color: var(--soft); font-size: 14.5px; max-width: 80ch; margin: 4px 0 22px; position: sticky; left: 0;
  width: fit-content; }
h1, h2, td, li, p { overflow-wrap: anywhere; } td:not(.num) { min-width: 7.5em; }
/* A shade at the edge tells that a table goes on to the side. */
.wide, figure { overflow-x: auto; background: linear-gradient(to left, var(--card), var(--card)) left / 24px 100%,
  linear-gradient(to left, var(--card), var(--card)) right / 24px 100%,
  linear-gradient(to left, transparent, var(--hint)) right / 10px 100%,
  linear-gradient(to right, transparent, var(--hint)) left / 10px 100%;
  background-repeat: no-repeat; background-attachment: local, local, scroll, scroll; }
table { border-collapse: collapse; margin: 6px 0 0; font-size: 14.5px; width: 100%; }
th, td { text-align: left; padding: 6px 14px 6px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { color: var(--soft); font-weight: 600; }
.num { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
figure td:first-child:not(.num) { min-width: 9.5em; }
tr.missed td { background: var(--missed); }
tr.missed td.mark { color: var(--bad_ink); font-weight: 650; white-space: nowrap; }
sup { line-height: 0; } ol.foot { color: var(--soft); font-size: 14px; margin: 8px 0 0; padding-left: 28px; }
ol.foot li { max-width: 80ch; position: sticky; left: 0; }
a { color: var(--link); } footer { color: var(--soft); font-size: 13.5px; margin-top: 28px; }
@media print { body { background: none; } article, figure { break-inside: auto; } tr, svg { break-inside: avoid; }
  figure, .wide { overflow: visible; } figure svg { min-width: 0; } }
""").substitute(day=_variables(PAGE), night=_variables(NIGHT))


@dataclass
class Section:
    """One article: title, a badge of a kind (bad, good or open), a reason, and what helps to believe it."""

    title: str
    badge: str
    kind: str
    reason: str
    story: str = ""
    truth: str = ""
    lesson: str = ""
    notes: list[str] = field(default_factory=list)
    figures: list[str] = field(default_factory=list)


def page(
    title: str, lead: str, sections: Sequence[Section], table: Sequence[Sequence[str]] = (), guide: str = ""
) -> str:
    """Return the whole page; the first row of ``table`` is its head and each row links to its section.

    ``guide``, below the table, tells how to read the verdicts.
    """
    parts = [
        "<!doctype html><html lang='en'><head><meta charset='utf-8'>",
        "<meta name='viewport' content='width=device-width, initial-scale=1'>",
        f"<title>{html.escape(title)}</title><style>{CSS}</style></head><body><main>",
        f"<h1>{html.escape(title)}</h1>",
        f"<p class='lead'>{html.escape(lead)}</p>" if lead else "",
    ]
    if table:
        parts.append(_table(table))
    if guide:
        parts.append(f"<p class='guide'>{html.escape(guide)}</p>")
    for number, section in enumerate(sections):
        parts.append(_article(number, section))
    parts.append(
        "<footer>Written by stickslip. This page needs no network and no script.</footer></main></body></html>"
    )
    return "\n".join(part for part in parts if part)


def _table(rows: Sequence[Sequence[str]]) -> str:
    kinds = _kinds(rows[1:], len(rows[0]))
    head = "".join(f"<th{kind}>{html.escape(cell)}</th>" for cell, kind in zip(rows[0], kinds, strict=True))
    body = ""
    for number, row in enumerate(rows[1:]):
        first = f"<td><a href='#s{number}'>{html.escape(row[0])}</a></td>"
        others = (f"<td{kind}>{html.escape(cell)}</td>" for cell, kind in zip(row[1:], kinds[1:], strict=True))
        body += f"<tr>{first}{''.join(others)}</tr>"
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    return f"<article><div class='wide'>{table}</div></article>"


def _article(number: int, section: Section) -> str:
    notes = "".join(f"<li>{html.escape(note)}</li>" for note in section.notes)
    figures = "".join(f"<figure>{svg}</figure>" for svg in section.figures)
    return (
        f"<article id='s{number}'><header class='row'><h2>{html.escape(section.title)}</h2>"
        + (f"<span class='badge {section.kind}'>{html.escape(section.badge)}</span>" if section.badge else "")
        + (f"<span class='truth'>{html.escape(section.truth)}</span>" if section.truth else "")
        + "</header>"
        + (f"<p class='story'>{html.escape(section.story)}</p>" if section.story else "")
        + (f"<p class='reason'>{html.escape(section.reason)}</p>" if section.reason else "")
        + (f"<p class='story'>{html.escape(section.lesson)}</p>" if section.lesson else "")
        + figures
        + (f"<p class='label'>What was read and assumed</p><ul class='notes'>{notes}</ul>" if notes else "")
        + "</article>"
    )


MISSED, MARK = " class='missed'", " class='mark'"
NUMBER = re.compile(r"[-+.\d\s%e]*( to [-+.\d\se]*)?( ✗)?")


def table_to_html(
    columns: Sequence[str], rows: Sequence[Sequence[str]], notes: Sequence[str] = (), missed: Sequence[bool] = ()
) -> str:
    """Return a table of plain text as HTML; columns of numbers are set to the right.

    ``notes``, one a row, become footnotes of the first column, each said once; an empty one is none.  Rows that are
    ``missed`` are marked, the last cell above all.

    >>> table_to_html(["row"], [["a < b"]])
    '<table><thead><tr><th>row</th></tr></thead><tbody><tr><td>a &lt; b</td></tr></tbody></table>'
    >>> table_to_html(["row"], [["a"], ["b"]], notes=["why", "why"]).count("why")
    1
    """
    kinds = _kinds(rows, len(columns))
    head = "".join(f"<th{kind}>{html.escape(name)}</th>" for name, kind in zip(columns, kinds, strict=True))
    said = list(dict.fromkeys(note for note in notes if note))
    body = ""
    for i, row in enumerate(rows):
        bad = bool(missed) and missed[i]
        cells = []
        for k, (cell, kind) in enumerate(zip(row, kinds, strict=True)):
            text = html.escape(cell)
            if k == 0 and notes and notes[i]:
                text += f"&nbsp;<sup>{said.index(notes[i]) + 1}</sup>"
            cells.append(f"<td{MARK if bad and k == len(row) - 1 else kind}>{text}</td>")
        body += f"<tr{MISSED if bad else ''}>{''.join(cells)}</tr>"
    foot = "".join(f"<li>{html.escape(note).replace(' %', '&nbsp;%')}</li>" for note in said)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>" + (
        f"<ol class='foot'>{foot}</ol>" if foot else ""
    )


def _kinds(rows: Sequence[Sequence[str]], columns: int) -> list[str]:
    """Return the class of every column: that of numbers if all its cells are numbers, bands of numbers or empty."""
    numbers = [bool(rows) and all(NUMBER.fullmatch(row[k]) for row in rows) for k in range(columns)]
    return [" class='num'" if number else "" for number in numbers]


def captioned(svg: str, caption: str) -> str:
    """Return a picture with a sentence below it, for ``Section.figures``.

    >>> captioned("<svg></svg>", "a < b")
    '<svg></svg><figcaption>a &lt; b</figcaption>'
    """
    return f"{svg}<figcaption>{html.escape(caption)}</figcaption>"


def figure_to_svg(figure: "Figure") -> str:
    """Return a figure as SVG text fit for inlining: no prolog, and ids that clash with no other picture."""
    import matplotlib

    buffer = io.StringIO()
    silent = dict.fromkeys(("Creator", "Date", "Format", "Type"))  # no metadata, no web addresses
    with warnings.catch_warnings(), matplotlib.rc_context({"svg.fonttype": "none"}):
        # Text stays text: it can be searched, and the browser has the signs that matplotlib's own font lacks.
        warnings.filterwarnings("ignore", "Glyph .* missing")
        figure.savefig(buffer, format="svg", bbox_inches="tight", metadata=silent)
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    own = f"f{zlib.crc32(text.encode()):08x}"
    text = re.sub(r'\bid="([^"]+)"', rf'id="{own}-\1"', text)
    text = re.sub(r"url\(#([^)]+)\)", rf"url(#{own}-\1)", text)
    return re.sub(r'href="#([^"]+)"', rf'href="#{own}-\1"', text)
