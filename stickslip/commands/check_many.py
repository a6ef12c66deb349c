"""``stickslip check`` on several loops, of one file or of several: a table, the groups, and where to look first."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from stickslip.commands.console import Speaker, complain
from stickslip.commands.short import refuse_short
from stickslip.commands.tag_page import DAYS, tag_section
from stickslip.commands.targets import check_targets, write_whole

if TYPE_CHECKING:
    from stickslip.detect import Diagnosis, Survey
    from stickslip.detect.prepare.prepared import Prepared
    from stickslip.detect.tag import Tag
    from stickslip.logs import Log, LoopRecord

SCHEMA = "stickslip.check-many/1"
COLUMNS = ("loop", "verdict", "seen in", "probability", "period [s]", "OP travel [%]", "what the other tags show")
FIRST = ("stiction", "inconclusive", "no_stiction", "not_applicable")  # verdicts in the order to look at them
OF_ONE = ("pv", "op", "sp", "mv", "mode", "op_span", "loop")  # options that name one loop or its columns


class Read(NamedTuple):
    """The content of a file: its loops, and the whole log if there are several; or why it cannot be read."""

    file: Path
    records: "tuple[LoopRecord, ...]"
    log: "Log | None"
    fault: str = ""


def several(files: Sequence[Path], stated: Mapping[str, Any]) -> "list[Read]":
    """Return what every file holds; of one file, where options name a loop or its columns, that loop alone.

    Raises ``ValueError`` where options that name the parts of one loop meet several files, and as ``read_loops`` does.
    """
    one = [part for part in OF_ONE if stated.get(part) is not None]
    if one and len(files) > 1:
        option = one[0].replace("_", "-")
        raise ValueError(f"--{option} names what belongs to one loop, but {len(files)} files are given; give one file")
    from stickslip.logs import ReadError, read_log, read_loop, read_loops

    options = {name: value for name, value in stated.items() if value is not None}
    if one:
        return [Read(files[0], (read_loop(files[0], **options),), None)]
    found = []
    for file in files:
        try:
            records = read_loops(file, **options)
            log = read_log(file, **{k: v for k, v in options.items() if k != "process"}) if len(records) > 1 else None
            found.append(Read(file, records, log))
        except ReadError as fault:
            if len(files) == 1:
                raise
            found.append(Read(file, (), None, str(fault)))
    return found


def check_many(
    found: "Sequence[Read]", html: Path | None, json_file: str | None, measurement: str | None = None
) -> int:
    """Judge every loop, survey every file with several, say it and write it; return the exit code.

    That is 2 where a file cannot be read (the others are judged all the same), 1 where a loop is called sticky, else 0.
    """
    from stickslip.commands.one_loop import answered, diagnosed, with_stated
    from stickslip.detect.prepare.prepared import prepared

    check_targets({"--html": html, "--json": json_file})
    say = Speaker(json_file)
    faults = [(read.file, read.fault) for read in found if read.fault]
    found = [read for read in found if not read.fault]
    if not found:
        raise ValueError("; ".join(fault for _, fault in faults))
    loops = [[prepared(with_stated(one, measurement, None, infer=True)) for one in read.records] for read in found]
    judged = [(read.file, [diagnosed(one) for one in each]) for read, each in zip(found, loops, strict=True)]
    refuse_short(answered(one) for _, answers in judged for one in answers)
    tags = _tags(judged, loops)
    surveys = [_surveyed(read, answers) for read, (_, answers) in zip(found, judged, strict=True)]
    rows = _rows(judged, surveys)
    say(f"{len(rows)} loops, those to look at first on top:", bold=True)
    say.table(list(COLUMNS[:-1]), [row[:-1] for _, row in rows])
    if any(row[-1] for _, row in rows):
        say("Each verdict is that of --loop, from the loop itself. What the other tags show beside it:")
    for why in dict.fromkeys(row[-1] for _, row in rows if row[-1]):  # what is said of several loops is said once
        say.paragraph(f"{', '.join(row[0] for _, row in rows if row[-1] == why)}: {why}.", "  - ")
    for tag in tags:
        say(tag.headline, bold=True)
        say.paragraph(tag.answer.reason)
        say.table(list(DAYS), tag.rows)
        if tag.answer.action:
            say.paragraph(f"Next: {tag.answer.action}")
    for read, one in zip(found, surveys, strict=True):
        if one is not None:
            say(f"{read.file.name}: oscillations that tags share", bold=True)
            for words in one.words.split("\n"):
                say.paragraph(words, "  - ")
    say("One loop in full: stickslip check FILE --loop NAME")
    if html is not None:
        write_whole(html, _page(judged, surveys, rows, tags).encode())
        say(f"report: {html}")
    say.document(
        {
            "schema": SCHEMA,
            "files": [
                {
                    "file": str(file),
                    "loops": [answer.to_dict() for answer in answers],
                    "survey": None if one is None else one.to_dict(),
                }
                for (file, answers), one in zip(judged, surveys, strict=True)
            ],
            "tags": [tag.to_dict() for tag in tags],
            "skipped": [{"file": str(file), "reason": reason} for file, reason in faults],
        }
    )
    for _, reason in faults:
        complain(reason)
    if faults:
        return 2
    of_tags = {record: tag.verdict for tag in tags for record in tag.records}  # of several records, all together
    every = [(file, one) for file, answers in judged for one in answers]
    return int(any(of_tags.get(_called(file, one.loop), one.verdict) == "stiction" for file, one in every))


def _called(file: Path, loop: str) -> str:
    """Return how a record is called among those of its valve: by its file, and by its tag where that says more."""
    return file.stem if loop in ("", file.stem) else f"{file.stem}: {loop}"


def _tags(judged: "Sequence[tuple[Path, list[Diagnosis]]]", loops: "Sequence[Sequence[Prepared]]") -> "list[Tag]":
    """Return the verdict on every valve of which several files hold a record; those of one valve share its tag."""
    from stickslip.detect.tag import judge_tag
    from stickslip.logs.tags import valve_in

    parts: dict[str, list[tuple[Prepared, Diagnosis, str]]] = {}
    for (file, answers), each in zip(judged, loops, strict=True):
        for loop, answer in zip(each, answers, strict=True):
            parts.setdefault(valve_in(answer.loop), []).append((loop, answer, _called(file, answer.loop)))
    return [
        replace(judge_tag(name, [p[0] for p in part], [p[1] for p in part]), records=tuple(p[2] for p in part))
        for name, part in parts.items()
        if len(part) > 1
    ]


def _surveyed(read: "Read", answers: "Sequence[Diagnosis]") -> "Survey | None":
    """Return the survey of a file with several loops, None of another."""
    from stickslip.detect import survey

    if read.log is None or not read.log.loops:
        return None
    return survey(read.log, {answer.loop: answer.verdict for answer in answers})


def _rows(
    judged: "Sequence[tuple[Path, list[Diagnosis]]]", surveys: "Sequence[Survey | None]"
) -> list[tuple[int, list[str]]]:
    """Return one row a loop as in ``COLUMNS``, the likeliest valve first, each with the number of its loop.

    The verdict is the loop's own, as everywhere; what the other tags show stands beside it and puts the loop forward.
    """
    from stickslip.detect.words import WORDS
    from stickslip.logs.chances import chance

    order: list[tuple[tuple[int, float, float], int, list[str]]] = []
    for (file, answers), one in zip(judged, surveys, strict=True):
        suspects = {} if one is None else {suspect.loop: suspect for suspect in one.suspects}
        logged = {} if one is None else {record.name: record for record in one.log.loop_records()}
        for answer in answers:
            suspect = suspects.get(answer.loop)
            name = answer.loop if len(judged) == 1 else f"{file.stem}: {answer.loop}"
            travel, why, gain = "-", "", 0.0
            word = answer.verdict
            suspected = word == "stiction" if suspect is None else suspect.suspected
            if suspect is None and one is not None:
                why = _not_asked(logged[answer.loop])
            elif suspect is not None:
                travel, why, gain = f"{suspect.travel:.3g}", suspect.reason.split("; its own verdict")[0], suspect.gain
            period = "-" if answer.period is None else f"{float(f'{answer.period:.3g}'):g}"
            seen = _seen_in(answer)
            row = [name, WORDS[word].spoken, seen, chance(answer.probability), period, travel, why.rstrip(".")]
            place = FIRST.index(word) if one is None else int(not suspected)
            sure = 1.0 if answer.probability is None and word == "stiction" else answer.probability or 0.0
            order.append(((place, -gain, -sure), len(order), row))
    return [(number, row) for _, number, row in sorted(order, key=lambda one: one[:2])]


def _not_asked(record: "LoopRecord") -> str:
    """Return why the other tags of the file are not asked of the valve of a loop."""
    from stickslip.detect.prepare.logged_part import LOGGED_SHARE

    logged = float(record.good.mean())
    if logged < LOGGED_SHARE:
        return f"it is logged in {100.0 * logged:.0f} % of the time, too little to ask the other tags"
    return "the span of OP is not known" if record.op_span is None else "OP hardly moves"


def _seen_in(answer: "Diagnosis") -> str:
    """Return what the verdict on a loop rests on."""
    if answer.verdict == "not_applicable":
        return "-"
    if answer.probability is not None:
        return "PV and OP"
    mv = answer.record.mv
    dead = mv is None or (answer.amount is not None and float(mv.max() - mv.min()) == 0.0)
    return "PV" if dead else "stem"


def _page(
    judged: "Sequence[tuple[Path, list[Diagnosis]]]",
    surveys: "Sequence[Survey | None]",
    rows: list[tuple[int, list[str]]],
    tags: "Sequence[Tag]",
) -> str:
    from stickslip.commands.one_loop import section_of
    from stickslip.commands.report.page import Section, figure_to_svg, page, table_to_html
    from stickslip.detect.words import WORDS

    shared = []
    for (file, _), one in zip(judged, surveys, strict=True):
        if one is not None:
            section = Section(file.name, f"{len(one.groups)} shared oscillations", "open", one.words.replace("\n", " "))
            if one.groups:
                section.figures.append(figure_to_svg(one.plot()))
            shared.append(section)
    shared += [tag_section(tag) for tag in tags]
    answers = [one for _, found in judged for one in found]
    said = [k for k in range(len(COLUMNS)) if k < 2 or any(row[k] not in ("", "-") for _, row in rows)]
    links = [f"#s{1 + len(shared) + number}" for number, _ in rows]
    kinds = [WORDS[answers[number].verdict].kind for number, _ in rows]
    cells = [[row[k] for k in said] for _, row in rows]
    table = Section("All loops", f"{len(rows)} loops", "open", "Those to look at first are on top.")
    table.figures.append(table_to_html([COLUMNS[k] for k in said], cells, links=links, badges={1: kinds}))
    sticky = sum(answer.verdict == "stiction" for answer in answers)
    lead = f"In {sticky} of {len(answers)} loops the valve looks sticky." if sticky else "No valve is called sticky."
    return page(f"{len(rows)} loops", lead, [table, *shared, *(section_of(answer) for answer in answers)])
