"""One valve of several records: its section of a page, and a page of its own."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stickslip.commands.report.page import Section
    from stickslip.detect.tag import Tag
    from stickslip.logs import LoopRecord

DAYS = ("record", "by itself", "S", "gain [nats]", "adds [nats]", "reversals")


def tag_section(tag: "Tag") -> "Section":
    """Return the verdict on a valve, S and gain of every record as picture and table, and what to do."""
    from stickslip.commands.report.page import Section, figure_to_svg, table_to_html
    from stickslip.detect.words import WORDS

    word = WORDS[tag.verdict]
    name, answer = f"{tag.tag}: {len(tag.records)} records", tag.answer
    section = Section(name, word.spoken.upper(), word.kind, answer.reason, after=answer.action)
    section.figures += [figure_to_svg(tag.plot()), table_to_html(list(DAYS), tag.rows)]
    return section


def tag_page(name: str, records: "Sequence[LoopRecord]") -> str:
    """Return the page on one valve: all records together, then each."""
    from stickslip.commands.one_loop import section_of
    from stickslip.commands.report.page import page
    from stickslip.detect import diagnose
    from stickslip.detect.tag import judge_tag

    answers = [diagnose(record) for record in records]
    starts = [record.log.start for record in records]
    days = [f"{one:%Y-%m-%d %H:%M}" if one else f"record {i}" for i, one in enumerate(starts, 1)]
    tag = replace(judge_tag(name, records, answers), records=tuple(days))
    return page(tag.headline, "", [tag_section(tag), *(section_of(one) for one in answers)])
