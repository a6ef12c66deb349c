"""Parts that checks of one and of several loops share: the kind of PV that a user states, and the report on a loop."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stickslip.commands.report.page import Section
    from stickslip.detect import Diagnosis
    from stickslip.detect.prepare.prepared import Prepared
    from stickslip.logs import LoopRecord


READ = "What was read and assumed"
UNLIKELY = 0.01  # a cause that is less probable is not listed


def with_stated(
    record: "LoopRecord", measurement: str | None, span: tuple[float, float] | None, infer: bool
) -> "LoopRecord":
    """Return the record with the measurement that the user gives; the kind of process follows from it unless given,
    too.
    """
    from dataclasses import replace

    from stickslip.logs.tags import process_of

    if measurement is not None:
        known = "" if measurement == "other" else measurement
        process = process_of(known) if infer else record.process
        record = replace(record, measurement=known, process=process)
    if span is not None:
        low, high = span
        if not low < high:
            raise ValueError(f"--span {low:g} {high:g}: the first must lie below the second; give the span of PV")
        record = replace(record, log=replace(record.log, spans={**record.log.spans, record.pv_name: (low, high)}))
    return record


def diagnosed(record: "LoopRecord | Prepared") -> "Diagnosis":
    """Return the diagnosis; while the methods are being compiled, which happens once, that is said."""
    from stickslip.detect import diagnose
    from stickslip.engine.notice import noticed

    with noticed("detection methods"):
        return diagnose(record)


def answered(diagnosis: "Diagnosis") -> tuple[str, int, bool]:
    """Return name and rows of a loop, and whether the verdict or a method says something on it."""
    spoken = diagnosis.verdict != "not_applicable" or any(method.applicable for method in diagnosis.methods)
    return diagnosis.loop, len(diagnosis.record), spoken


def section_of(diagnosis: "Diagnosis") -> "Section":
    """Return the article on one loop of a page."""
    from stickslip.commands.report.page import Section
    from stickslip.detect.judge.actions import CAUSES
    from stickslip.detect.words import WORDS
    from stickslip.logs.chances import chance

    word = WORDS[diagnosis.verdict]
    section = Section(
        diagnosis.loop, word.spoken.upper(), word.kind, diagnosis.reason, after=diagnosis.action, notes_label=READ
    )
    section.notes.extend(diagnosis.because)
    section.notes.extend(f"{name} {size}." for name, size in (diagnosis.amount or {}).items())
    if diagnosis.causes:
        likely = {cause: p for cause, p in diagnosis.causes.items() if p >= UNLIKELY or cause == "stiction"}
        chances = ", ".join(f"{CAUSES[cause].spoken} {chance(p)}" for cause, p in likely.items())
        section.notes.append(f"Probabilities: {chances}.")
    section.notes.extend(diagnosis.assumptions)
    section.figures += pictures_of(diagnosis)
    return section


def pictures_of(diagnosis: "Diagnosis") -> list[str]:
    """Return what shows a verdict on a page of several: the trend with PV against OP, and what decided."""
    from math import nan

    from stickslip.commands.report.page import beside, captioned, figure_to_svg
    from stickslip.detect.evidence import set_point_words
    from stickslip.detect.figures.evidence import plot_pv_op
    from stickslip.detect.figures.loop_trend import plot_trend

    record, period = diagnosis.record, diagnosis.period or nan
    trend = figure_to_svg(plot_trend(record))
    moved = set_point_words(record, period)
    if not record.good.any():
        return [trend]
    small = figure_to_svg(plot_pv_op(record, period, None))
    pictures = [beside(captioned(trend, "", moved) if moved else trend, captioned(small, "PV against OP."))]
    drawn = deciding(diagnosis)
    return pictures if drawn is None else [*pictures, captioned(*drawn)]


def deciding(diagnosis: "Diagnosis") -> tuple[str, str, str] | None:
    """Return what decided, as a picture as wide as a page with its caption and title; None where nothing is drawn."""
    from stickslip.commands.report.page import figure_to_svg
    from stickslip.detect.figures.deciding import draw_deciding, what_decided
    from stickslip.logs.picture import Picture

    words = what_decided(diagnosis)
    if words is None:
        return None
    figure = Picture(figsize=(9.6, 3.7), layout="constrained")
    draw_deciding(diagnosis, figure)
    return figure_to_svg(figure), words[1], f"{words[0]}."
