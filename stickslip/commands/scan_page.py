"""The page of a scan: what was found, what changed, who oscillates together, and every loop in the order asked for."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip.commands.report.page import Section
    from stickslip.scan import ScanResult

ROWS = 500  # on the page
DETAILS = 20  # loops described in full below the list, where they have no page of their own
NAMED = 12  # of a group that are named

Row = dict[str, Any]


def scan_page(
    result: "ScanResult", headline: str, pages: Mapping[int, str] | None = None, simulations: Sequence[Row] = ()
) -> str:
    """Return the page; ``pages`` says by the column ``order`` which loops have a page of their own, and where.

    ``simulations``: what ``scan_simulate.simulated`` found of the first loops.
    """
    from stickslip.commands.report.page import page

    pages = pages or {}
    rows = list(result.table.head(ROWS).iter_rows(named=True))
    facts = [row for row in rows[:DETAILS] if row["order"] not in pages]
    sections = [_found(result, headline), *_changed(result), *_groups(result), *_simulated(simulations)]
    first = len(sections) + 1
    anchors = {row["order"]: f"#s{first + k}" for k, row in enumerate(facts)}
    sections.append(_list(result, rows, {**anchors, **pages}))
    sections += [_detail(row) for row in facts]
    return page(f"Scan of {Path(result.source).name or result.source}", "", sections)


def file_names(rows: Sequence[Row]) -> dict[int, str]:
    """Return a file name for each row: its rank and what of its tag any system takes.

    >>> file_names([{"order": 7, "rank": 1, "loop": "../FIC 1<b>"}])
    {7: '001-FIC_1_b_.html'}
    """
    return {
        row["order"]: f"{row['rank']:03d}-{re.sub(r'[^A-Za-z0-9.-]+', '_', row['loop'])[:60].lstrip('._')}.html"
        for row in rows
    }


def _found(result: "ScanResult", headline: str) -> "Section":
    from stickslip.commands.report.page import Section, figure_to_svg

    sticky = result.counts.get("stiction", 0)
    badge = f"{sticky} sticky" if sticky else "none sticky"
    section = Section("What was found", badge, "bad" if sticky else "good", headline, notes=list(result.notes))
    section.notes_label = "What was read and assumed"
    section.figures.append(figure_to_svg(result.plot()))
    return section


def _changed(result: "ScanResult") -> "list[Section]":
    from stickslip.commands.report.page import Section, table_to_html

    if not result.changes:
        return []
    rows = [[c.loop, spoken(c.before) or "new", spoken(c.now) or "gone"] for c in result.changes]
    section = Section("What changed since the last scan", f"{len(rows)} loops", "open", "")
    kinds = [_kind(change.now) for change in result.changes]
    section.figures.append(table_to_html(["loop", "before", "now"], rows[:ROWS], badges={2: kinds[:ROWS]}))
    return [section]


def _groups(result: "ScanResult") -> "list[Section]":
    from stickslip.commands.report.page import Section, table_to_html
    from stickslip.logs.chances import chance

    found: dict[str, list[Row]] = {}
    for row in result.table.iter_rows(named=True):
        if row["group"]:
            found.setdefault(row["group"], []).append(row)
    if not found:
        return []
    section = Section("Loops that share an oscillation", f"{len(found)} group{'s' * (len(found) != 1)}", "open", "")
    section.reason = "The same period, in step all the time: one source moves them. Look at the likely source first."
    rows = []
    for source, group in sorted(found.items(), key=lambda item: -len(item[1])):
        first = next((row for row in group if row["loop"] == source), group[0])
        names = [row["loop"] for row in group if row["loop"] != source]
        more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
        rows.append([
            source, spoken(first["verdict"] or "error"), chance(first["probability"]), str(len(group)),
            number(first["period_s"], ".3g"), ", ".join(names[:NAMED]) + more,
        ])  # fmt: skip
    head = ["likely source", "verdict", "probability", "loops", "period [s]", "with it"]
    section.figures.append(table_to_html(head, rows))
    return [section]


def _simulated(simulations: Sequence[Row]) -> "list[Section]":
    from stickslip.commands.report.page import Section, table_to_html
    from stickslip.logs.chances import chance

    if not simulations:
        return []
    section = Section("Simulated under their own conditions", f"{len(simulations)} loops", "open", "")
    section.reason = "Of each loop, loops with and without a sticky valve were simulated under the record's conditions."
    rows = []
    for one in simulations:
        found = one["simulation"]
        if found is None:
            rows.append([str(one["rank"]), one["loop"], "-", "-", "-", " ".join(one["sentences"])])
            continue
        S, limit = found["amount"]["S"], found["detection_limit"]
        rows.append([
            str(one["rank"]), one["loop"], chance(found["probability"]),
            f"{S['value']:.2g} {S['unit']} ({S['low']:.2g} to {S['high']:.2g})",
            "none up to OP's travel" if limit is None else f"{limit['value']:.2g} {limit['unit']}",
            one["sentences"][-1],
        ])  # fmt: skip
    head = ["rank", "loop", "probability of stiction", "S if it sticks (90 % interval)", "would have shown", "in words"]
    section.figures.append(table_to_html(head, rows))
    return [section]


def _list(result: "ScanResult", rows: Sequence[Row], links: Mapping[int, str]) -> "Section":
    from stickslip.commands.report.page import Section, ordered_table
    from stickslip.logs.chances import chance

    shown = f"the first {len(rows)} of {len(result.table)}" if len(rows) < len(result.table) else f"{len(rows)} loops"
    section = Section("All loops", shown, "open", "")
    head = ["loop", "rank", "verdict", "probability", "likely cause", "S [% of OP]", "period [s]", "shared with",
            "data", "what to do"]  # fmt: skip
    cells = [
        [
            row["loop"], str(row["rank"]), spoken(row["verdict"] or "error"), chance(row["probability"]),
            cause(row), size(row), number(row["period_s"], ".3g"), row["group"] or "",
            (row["health"] or "").replace("_", " "), _first_sentence(row["error"] or row["action"] or row["reason"]),
        ]
        for row in rows
    ]  # fmt: skip
    orders = {
        "rank": list(range(len(rows))),
        "loop": _places([row["loop"] for row in rows]),
        "probability": _places([-(row["probability"] if row["probability"] is not None else -1.0) for row in rows]),
        "S": _places([-(row["S"] or 0.0) for row in rows]),
        "period": _places([row["period_s"] or float("inf") for row in rows]),
        "shared with": _places([row["group"] or "\U0010ffff" for row in rows]),
        "likely cause": _places([row["cause"] or "\U0010ffff" for row in rows]),
    }
    badges = {2: [_kind(row["verdict"]) for row in rows]}
    section.figures.append(
        ordered_table(head, cells, orders, "loops", [links.get(r["order"], "") for r in rows], badges)
    )
    return section


def _detail(row: Row) -> "Section":
    from stickslip.commands.report.page import Section, pairs

    verdict = row["verdict"] or "error"
    section = Section(
        row["loop"], spoken(verdict).upper(), _kind(row["verdict"]) or "open", row["error"] or row["reason"]
    )
    facts = {"What to do": row["action"] or "-", "Likely cause": cause(row) or "-", "S": size(row)}
    if row["S_low"] is not None:
        facts["S"] += f" {row['size_unit']} (90 % interval {row['S_low']:.2g} to {row['S_high']:.2g})"
    if row["detection_limit"] is not None:
        facts["Detection limit"] = f"{row['detection_limit']:.2g} {row['size_unit']}"
    facts["Period"] = f"{number(row['period_s'], '.3g')} s" if row["period_s"] else "no oscillation"
    facts["Shared with"] = row["group"] or "-"
    facts["Data"] = f"{row['samples']} samples, one every {row['interval_s']:.3g} s" if row["samples"] else "-"
    if row["health"]:
        facts["Data"] += f"; {row['health'].replace('_', ' ')}"
    section.figures.append(pairs(facts))
    return section


def _places(keys: Sequence[Any]) -> list[int]:
    """The place of every row when rows are put in the order of their keys."""
    places = [0] * len(keys)
    for place, i in enumerate(sorted(range(len(keys)), key=lambda i: (keys[i], i))):
        places[i] = place
    return places


def _first_sentence(text: str | None) -> str:
    return re.split(r"(?<=[.)]) (?=[A-Z])", text or "")[0][:300]


def _kind(verdict: str | None) -> str:
    from stickslip.detect.words import WORDS

    return WORDS[verdict].kind if verdict else ""  # type: ignore[index]  # words of the table are words of a verdict


def spoken(word: str) -> str:
    """Return a verdict of the table as people read it, also where there is none."""
    from stickslip.detect.words import WORDS

    if word == "error":
        return "could not be judged"
    return WORDS[word].spoken if word else ""  # type: ignore[index]


def cause(row: Row) -> str:
    """Return the likeliest cause in words."""
    from stickslip.detect.judge.actions import CAUSES

    return CAUSES[row["cause"]].spoken if row["cause"] else ""


def size(row: Row) -> str:
    """Return S of a row, with its unit where that is not % of OP."""
    in_percent = row["S"] is None or row["size_unit"] in (None, "% of OP")
    return number(row["S"], ".2g") + ("" if in_percent else " (unit of OP)")


def number(value: float | None, form: str) -> str:
    """Return a number in a form, or a dash; a number of three digits without a power of ten up to 100,000.

    >>> number(1170.4, ".3g"), number(None, ".3g")
    ('1170', '-')
    """
    return "-" if value is None else f"{float(format(value, form)):g}" if form.endswith("g") else format(value, form)
