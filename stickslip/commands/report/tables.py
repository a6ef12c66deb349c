"""Tables as parts of a page: numbers to the right, footnotes, marked rows, and an order that the reader chooses."""

import html
import re
from collections.abc import Mapping, Sequence

__all__ = ["ordered_table", "table_to_html"]

MISSED, MARK = " class='missed'", " class='mark'"
NUMBER = re.compile(r"(over |below )?[-+.\d\s%e]*( to [-+.\d\se]*)?( ✗)?")
LONG = 60  # characters: a column with such a cell is not squeezed


def table_to_html(
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    notes: Sequence[str] = (),
    missed: Sequence[bool] = (),
    links: Sequence[str] = (),
    badges: Mapping[int, Sequence[str]] | None = None,
) -> str:
    """Return a table of plain text as HTML; columns of numbers are set to the right.

    ``notes``, one a row, become footnotes of the first column, each said once; an empty one is none.  Rows that are
    ``missed`` are marked, the last cell above all.  ``links``, one a row, is where the first cell leads, "" nowhere.
    ``badges`` gives the cells of a column, one a row, a kind (bad, good, open), "" none.

    >>> table_to_html(["row"], [["a < b"]]).removeprefix("<div class='scroll'>").removesuffix("</div>")
    '<table><thead><tr><th>row</th></tr></thead><tbody><tr><td>a &lt; b</td></tr></tbody></table>'
    >>> table_to_html(["row"], [["a"], ["b"]], notes=["why", "why"]).count("why")
    1
    """
    head, body, foot = _parts(columns, rows, notes, missed, links, badges or {})
    lines = "".join(f"<tr{kind}>{cells}</tr>" for kind, cells in body)
    return f"<div class='scroll'><table><thead><tr>{head}</tr></thead><tbody>{lines}</tbody></table></div>{foot}"


def ordered_table(
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    orders: Mapping[str, Sequence[int]],
    name: str = "order",
    links: Sequence[str] = (),
    badges: Mapping[int, Sequence[str]] | None = None,
) -> str:
    """Return a table whose rows the reader puts in order without a script: the browser does it by style alone.

    ``orders`` gives for each name the place of every row in that order; the first is the one shown, and the only one
    on paper and in browsers that know no subgrid.  ``name`` tells this table from others of the page; ``links`` and
    ``badges`` as in ``table_to_html``.

    >>> table = ordered_table(["item", "size"], [["a", "1"], ["b", "2"]], {"name": [0, 1], "size": [1, 0]})
    >>> table.count("type='radio'"), "style='--o0:0;--o1:1'" in table
    (2, True)
    """
    head, body, foot = _parts(columns, rows, (), (), links, badges or {})
    rules = [f"#{name} tbody tr {{ order: var(--o0); }}"]
    choices, labels = "", ""
    for k, said in enumerate(orders):
        checked = " checked" if k == 0 else ""
        choices += f"<input class='order' type='radio' name='{name}' id='{name}{k}'{checked}>"
        labels += f"<label for='{name}{k}'>{html.escape(said)}</label>"
        rules.append(
            f"#{name}{k}:checked ~ .scroll tbody tr {{ order: var(--o{k}); }}"
            f"#{name}{k}:checked ~ .orders label[for={name}{k}] {{ background: var(--open); color: var(--open_ink); }}"
            f"#{name}{k}:focus-visible ~ .orders label[for={name}{k}] {{ outline: 2px solid var(--link); }}"
        )
    widths = _widths(columns, rows, badges or {})
    rules.append(f"@supports (grid-template-columns: subgrid) {{ #{name} {{ grid-template-columns: {widths}; }} }}")
    lines = ""
    for i, (kind, cells) in enumerate(body):
        places = ";".join(f"--o{k}:{place[i]}" for k, place in enumerate(orders.values()))
        lines += f"<tr{kind} style='{places}'>{cells}</tr>"
    return (
        f"<style>{' '.join(rules)}</style>{choices}<div class='orders'>In the order of {labels}</div>"
        f"<div class='scroll'><table class='ordered' id='{name}'><thead><tr>{head}</tr></thead><tbody>{lines}</tbody>"
        f"</table></div>{foot}"
    )


def _parts(
    columns: Sequence[str], rows: Sequence[Sequence[str]], notes: Sequence[str], missed: Sequence[bool],
    links: Sequence[str], badges: Mapping[int, Sequence[str]],
) -> tuple[str, list[tuple[str, str]], str]:  # fmt: skip
    """Head, rows (class, cells) and footnotes."""
    kinds = _kinds(rows, len(columns))
    heads = ["" if " long" in kind or kind == " class='long'" else kind for kind in kinds]
    head = "".join(f"<th{kind}>{html.escape(name)}</th>" for name, kind in zip(columns, heads, strict=True))
    said = list(dict.fromkeys(note for note in notes if note))
    body = []
    for i, row in enumerate(rows):
        bad = bool(missed) and missed[i]
        cells = []
        for k, (cell, kind) in enumerate(zip(row, kinds, strict=True)):
            text = html.escape(cell)
            if k == 0 and links and links[i]:
                text = f"<a href='{html.escape(links[i], quote=True)}'>{text}</a>"
            if k in badges and badges[k][i]:
                text = f"<span class='badge {badges[k][i]}'>{text}</span>"
            if k == 0 and notes and notes[i]:
                text += f"&nbsp;<sup>{said.index(notes[i]) + 1}</sup>"
            cells.append(f"<td{MARK if bad and k == len(row) - 1 else kind}>{text}</td>")
        body.append((MISSED if bad else "", "".join(cells)))
    foot = "".join(f"<li>{html.escape(note).replace(' %', '&nbsp;%')}</li>" for note in said)
    return head, body, f"<ol class='foot'>{foot}</ol>" if foot else ""


def _kinds(rows: Sequence[Sequence[str]], columns: int) -> list[str]:
    """Return the class of every column: of numbers (or bands of them, or empty cells), of long texts, or none."""
    found = []
    for k in range(columns):
        number = bool(rows) and all(NUMBER.fullmatch(row[k]) for row in rows)
        long = k > 0 and any(len(row[k]) > LONG for row in rows)
        found.append(" class='num'" if number else " class='long'" if long else "")
    return found


def _widths(columns: Sequence[str], rows: Sequence[Sequence[str]], badges: Mapping[int, Sequence[str]]) -> str:
    """Return the widths of columns: numbers and badges fit one line, texts get ten letters or more."""
    widths = []
    for k, kind in enumerate(_kinds(rows, len(columns))):
        if "long" in kind:
            widths.append("minmax(18em, 3fr)")
        elif "num" in kind or k in badges or k == 0:
            widths.append("minmax(max-content, auto)" if k else "minmax(9em, auto)")
        else:
            widths.append("minmax(10em, 1fr)")
    return " ".join(widths)
