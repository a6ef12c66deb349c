"""The scores of each method on records with a label: counted per tag, next to the trivial answers and published
shares.

Several records of one tag are one valve.  A tag is called by the majority of the records that the method decides
("stiction" or "no_stiction"); a tie leaves it open.

    found = sticky tags called sticky / sticky tags              wrong = other tags called sticky / other tags
    right = tags called rightly / tags,  an open one counts as not right

A label is somebody's opinion of a loop, seldom an opened valve; with a dozen tags an interval is wide.
"""

import csv
import os
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from stickslip.detect.comparison import Comparison
from stickslip.detect.published import PUBLISHED, interval_words
from stickslip.detect.rates import COMBINED
from stickslip.logs import ReadError

SCORE_COLUMNS = ("method", "sticky found", "others accused", "right", "90 % interval", "open tags")


@dataclass(frozen=True)
class Label:
    """A record's label: ``tag`` of its valve and whether that is said to be sticky."""

    tag: str
    sticky: bool


@dataclass(frozen=True)
class Score:
    """The score of a method over the tags: counts, see the module; ``open_tags`` were not decided."""

    method: str
    sticky: int
    others: int
    found: int
    wrong: int
    right: int
    open_tags: int


def read_labels(path: str | os.PathLike[str]) -> dict[str, Label]:
    """Labels by the name of the record, from a CSV file with the columns loop, label and, where there is one, tag.

    A label that is "stiction" or "sticky" means so, any other does not; an empty one is left out. Without a tag the
    record's name is its tag.

    Raises ReadError if the file cannot be read, lacks a column or holds no label.
    """
    try:
        with Path(path).open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError) as fault:
        raise ReadError(f"{path}: {fault}") from None
    for column in ("loop", "label"):
        if not rows or column not in rows[0]:
            raise ReadError(f"{path} has no column '{column}'; give a CSV file with the columns loop, label and tag")
    found = {
        row["loop"]: Label(row.get("tag") or row["loop"], row["label"].strip().casefold() in ("stiction", "sticky"))
        for row in rows
        if (row["loop"] or "").strip() and (row["label"] or "").strip()
    }
    if not found:
        raise ReadError(f"{path} holds no label; give 'stiction' or another word in the column 'label'")
    return found


def scores(comparison: Comparison, labels: Mapping[str, Label]) -> list[Score]:
    """One score a method and one of the combined verdict; loops without a label are left out.

    Raises ReadError if no loop has a label.
    """
    said: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for judged in comparison.loops:
        label = labels.get(judged.loop)
        if label is not None:
            for verdict in judged.verdicts:
                said[verdict.method][label.tag].append(verdict.verdict)
            said[COMBINED][label.tag].append(judged.combined)
    if not said:
        raise ReadError("no loop has a label; the names in the column 'loop' must be those of the records")
    sticky = {label.tag: label.sticky for label in labels.values()}
    return [_score(method, words, sticky) for method, words in said.items()]


def _score(method: str, words: Mapping[str, list[str]], sticky: Mapping[str, bool]) -> Score:
    calls = {tag: _called(own) for tag, own in words.items()}
    accused = [tag for tag, call in calls.items() if call is True]
    return Score(
        method, sum(sticky[tag] for tag in calls), sum(not sticky[tag] for tag in calls),
        sum(sticky[tag] for tag in accused), sum(not sticky[tag] for tag in accused),
        sum(call is sticky[tag] for tag, call in calls.items()), sum(call is None for call in calls.values()),
    )  # fmt: skip


def _called(words: list[str]) -> bool | None:
    """Whether the decided records of a tag say sticky, None where they say nothing or as often so as not."""
    lead = words.count("stiction") - words.count("no_stiction")
    return None if lead == 0 else lead > 0


def score_rows(found: list[Score]) -> list[list[str]]:
    """One row of text a method, as in ``SCORE_COLUMNS``, then "always sticky", then the published shares of loops.

    >>> score_rows([Score("m", 7, 6, 2, 0, 6, 5)])[0]
    ['m', '2 of 7', '0 of 6', '6 of 13', '26% to 68%', '5']
    """
    rows = []
    for one in found:
        tags = one.sticky + one.others
        counts = [f"{one.found} of {one.sticky}", f"{one.wrong} of {one.others}", f"{one.right} of {tags}"]
        rows.append([one.method, *counts, interval_words(one.right, tags), str(one.open_tags)])
    if found:
        sticky, others = found[0].sticky, found[0].others
        always = f"{sticky} of {sticky}", f"{others} of {others}", f"{sticky} of {sticky + others}"
        rows.append(["always sticky", *always, interval_words(sticky, sticky + others), "0"])
    for share in PUBLISHED:
        if share.what.endswith("loops right") and share.right is not None and share.of is not None:
            name = f"published: {share.what.removesuffix(': loops right')} ({share.mark}, {share.loops})"
            rows.append([name, "-", "-", f"{share.right} of {share.of}", interval_words(share.right, share.of), "-"])
    return rows
