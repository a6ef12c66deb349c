"""The verdict on the real tags of ``STICKSLIP_DATA``, the records of each pooled: printed, and nothing is chosen on it.

python -m benchmarks.real_tags [--json FILE]
"""

import csv
import sys
from collections.abc import Mapping, Sequence

from stickslip.detect.tag import Tag, judge_tag
from stickslip.logs import read_loop
from stickslip.logs.chances import chance

from benchmarks.report import Figures, options, publish
from benchmarks.stability import DATA

NOTES = {
    "found": "tags labelled sticky that are called (goal: at least 6)",
    "cleared": "tags labelled sticky that are cleared (goal: at most 0)",
    "accused": "other tags that are called (goal: at most 0)",
    "others_cleared": "other tags that are cleared",
}


def tags() -> list[tuple[str, str, Tag]]:
    """Tag, label and verdict of each."""
    with (DATA / "loops.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return [
        (tag, these[0]["label"], judge_tag(tag, [read_loop(DATA / row["file"]) for row in these]))
        for tag in dict.fromkeys(row["tag"] for row in rows)
        if (these := [row for row in rows if row["tag"] == tag])
    ]


def figures(judged: Sequence[tuple[str, str, Tag]]) -> Figures:
    """The counts."""
    words: Mapping[bool, list[str]] = {
        sticky: [tag.verdict for _, label, tag in judged if (label == "stiction") == sticky] for sticky in (True, False)
    }
    return {
        "found": float(words[True].count("stiction")), "cleared": float(words[True].count("no_stiction")),
        "accused": float(words[False].count("stiction")), "others_cleared": float(words[False].count("no_stiction")),
    }  # fmt: skip


def main() -> int:
    """Judge and print; 1 if a goal is missed, 2 without the records."""
    asked = options(__doc__.splitlines()[0])
    if not (DATA / "loops.csv").exists():
        print(f"real records not found at {DATA}; set STICKSLIP_DATA", file=sys.stderr)
        return 2
    judged = tags()
    for name, label, tag in judged:
        own = ", ".join(f"{tag.words.count(word)} {word}" for word in dict.fromkeys(tag.words))
        print(f"{name:12}{label:14}{tag.verdict:16}{chance(tag.answer.probability):>6}  by themselves {own}")
    return 0 if publish(figures(judged), NOTES, asked.json, asked.quick) else 1


if __name__ == "__main__":
    raise SystemExit(main())
