"""``stickslip demo``: five short stories with known truth, and two real loops where they are at hand."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip.commands.console import COLOUR_OF, Speaker, json_option, user_errors
from stickslip.commands.targets import check_folder, check_targets, write_whole

if TYPE_CHECKING:
    from stickslip.detect import Diagnosis
    from stickslip.detect.words import Wording

REAL = (
    ("PAP2", "isdb/PAP2.csv", "stiction", "A flow loop of a paper mill (International Stiction Data Base, FC525)."),
    ("PAP9", "isdb/PAP9.csv", "no stiction", "A temperature loop of a paper mill (International Stiction Data Base)."),
)
LEAD = (
    "Five loops of our own making, exported as a historian would, so the truth is known{real}. Each was judged from "
    "SP, PV and OP alone."
)
WITH_REAL = "; then real loops, labelled by experts"
GUIDE = (
    "How to read it: the verdict weighs all that a record shows. The lower picture shows what decided it, and words "
    "below it say what to look for. Where nothing decided, it shows a method that has evidence of its own. The area "
    "ratio is such a method. It cuts the control error SP - PV into half waves, and each half wave at its peak. R is "
    "the area before the peak over the area after it. Tight tuning or an outside wave gives R near 1. A valve that "
    "sticks and then jumps lets PV creep to its peak and throws it back. Then R is above 1.25 in both half waves. A "
    "sticky valve behind a slow process or under noise has R near 1 too, so that clears no valve. Where the "
    "assumptions of a method do not hold, it abstains and says why."
)


@dataclass(frozen=True)
class Judged:
    """One loop of the demonstration and the verdict on it; ``known`` says how the truth is known."""

    title: str
    truth: str
    known: str
    story: str
    lesson: str
    diagnosis: "Diagnosis"

    @property
    def score(self) -> str:
        """Right, wrong, or abstained, against the truth or label."""
        if self.said == self.truth:
            return "right"
        return "WRONG" if self.diagnosis.verdict in ("stiction", "no_stiction") else "abstained"

    @property
    def said(self) -> str:
        """The verdict as people read it."""
        return self.wording.spoken

    @property
    def wording(self) -> "Wording":
        """How the verdict is said and shown."""
        from stickslip.detect.words import WORDS

        return WORDS[self.diagnosis.verdict]


@click.command("demo")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("stickslip-demo"),
    show_default=True,
    help="Folder for the page.",
)
@json_option
@user_errors
def command(out: Path, json_file: str | None) -> None:
    """Diagnose five example exports (and two real loops) and write one HTML page.

    Real loops are read from the folder that the variable STICKSLIP_DATA names (default ../shared/data).

    \b
    Examples:
      stickslip demo
      stickslip demo --out pages --json -

    \b
    Exit codes: 0 done, 2 the page cannot be written.
    """
    check_folder(out)
    check_targets({"--json": json_file})
    say = Speaker(json_file)
    judged = _stories(say) + _real(say)
    rows = [[t.title, t.truth, t.said, t.score] for t in judged]
    say.table(["loop", "truth or label", "verdict", "score"], rows)
    page = _page(judged).encode()
    out.mkdir(parents=True, exist_ok=True)
    target = out / "index.html"
    write_whole(target, page)
    say(f"open {target} in a browser: trends, PV-OP pictures and the evidence for every verdict")
    say.document(
        {
            "schema": "stickslip.demo/1",
            "page": str(target),
            "loops": [{"truth": t.truth, "score": t.score, "title": t.title, **t.diagnosis.to_dict()} for t in judged],
        }
    )


def _stories(say: Speaker) -> list[Judged]:
    from stickslip.cases.stories import STORIES

    return [_tell(say, s.path, f"{s.name}: {s.title}", s.truth, "in truth", s.story, s.lesson) for s in STORIES]


def _real(say: Speaker) -> list[Judged]:
    default = Path(__file__).resolve().parents[3] / "shared" / "data"
    named = os.environ.get("STICKSLIP_DATA")
    folder = Path(named or default)
    if not folder.is_dir():
        if named:  # nobody else has them to miss
            say(f"no real loops: there is no folder {folder}; set STICKSLIP_DATA to one that holds them", fg="yellow")
        return []
    judged = []
    for name, file, truth, story in REAL:
        try:
            judged.append(_tell(say, folder / file, f"{name}: a real loop", truth, "expert's label", story, ""))
        except ValueError as unreadable:
            say(f"real loop {name} is skipped: {unreadable}", fg="yellow")
    return judged


def _tell(say: Speaker, path: Path, title: str, truth: str, known: str, story: str, lesson: str) -> Judged:
    from stickslip.commands.one_loop import diagnosed
    from stickslip.logs import read_loop

    judged = Judged(title, truth, known, story, lesson, diagnosed(read_loop(path)))
    say(f"{title}: ", nl=False)
    say(judged.said, fg=COLOUR_OF[judged.wording.kind], bold=True)
    return judged


def _page(judged: list[Judged]) -> str:
    from stickslip.commands.one_loop import READ, pictures_of
    from stickslip.commands.report.page import Section, page

    sections = []
    table = [["loop", "truth or label", "verdict", "score"]]
    for t in judged:
        truth = f"{t.known}: {t.truth} ({t.score})"
        section = Section(
            t.title, t.said.upper(), t.wording.kind, t.diagnosis.reason, t.story, truth, t.lesson, notes_label=READ
        )
        section.notes.extend(t.diagnosis.assumptions)
        section.figures += pictures_of(t.diagnosis)
        sections.append(section)
        table.append([t.title, t.truth, t.said, t.score])
    real = any(t.known != "in truth" for t in judged)
    return page("Is it the valve?", LEAD.format(real=WITH_REAL if real else ""), sections, table, GUIDE)
