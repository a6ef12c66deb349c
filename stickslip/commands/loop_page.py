"""The report on one loop: the answer in words first, then how it changed, what speaks for it, and what was assumed."""

from datetime import timedelta
from math import nan
from typing import TYPE_CHECKING

from stickslip.commands.one_loop import READ, UNLIKELY, deciding

if TYPE_CHECKING:
    from stickslip.commands.report.page import Section
    from stickslip.detect import Diagnosis
    from stickslip.detect.evidence import Correlation, OverTime, Spectrum, StemTrend
    from stickslip.detect.judge.answer import Amount
    from stickslip.detect.prepare.prepared import Prepared
    from stickslip.detect.signals.harris import Harris

SEVERAL = 3  # of the causes that are named
HOUR = 3600.0  # s


def loop_page(diagnosis: "Diagnosis") -> str:
    """Return the whole page on one loop."""
    from stickslip.commands.report.page import page
    from stickslip.detect.evidence import over_time, stem_trend
    from stickslip.detect.prepare.prepared import Prepared
    from stickslip.detect.words import WORDS

    loop = Prepared(diagnosis.record)
    stem = stem_trend(diagnosis.methods, diagnosis.record)
    sections = [
        _answer(diagnosis, loop),
        _test(diagnosis),
        _over_time(over_time(diagnosis.record)),
        _trend(diagnosis, loop, stem),
        _evidence(diagnosis, loop, stem),
        _methods(diagnosis),
        _data(diagnosis),
    ]
    title = f"{diagnosis.loop}: {WORDS[diagnosis.verdict].spoken}"
    return page(title, _lead(diagnosis), [s for s in sections if s is not None], contents=True)


def _lead(diagnosis: "Diagnosis") -> str:
    record = diagnosis.record
    log = record.log
    hours = log.duration / HOUR
    long = (
        f"{hours / 24.0:.3g} days" if hours >= 48.0 else f"{hours:.3g} h" if hours >= 1.0 else f"{60 * hours:.3g} min"
    )
    since = "" if log.start is None else f" from {log.start + timedelta(seconds=float(record.t[0])):%Y-%m-%d %H:%M:%S}"
    every = f", one every {record.dt:.3g} s" if len(record) > 1 else ""
    what = record.measurement or "loop"
    return (
        f"{what.capitalize()}: {len(record):,} samples{every}, {long}{since}{f'; {log.origin}' if log.origin else ''}."
    )


def _answer(diagnosis: "Diagnosis", loop: "Prepared") -> "Section":
    from stickslip.commands.report.page import Section, pairs
    from stickslip.detect.judge.actions import CAUSES
    from stickslip.detect.words import WORDS
    from stickslip.logs.chances import chance

    word = WORDS[diagnosis.verdict]
    section = Section("The answer", word.spoken.upper(), word.kind, diagnosis.reason)
    facts: dict[str, str] = {}
    if diagnosis.probability is not None:
        facts["Probability of stiction"] = chance(diagnosis.probability)
    others = [(name, p) for name, p in diagnosis.causes.items() if name != "stiction" and p >= UNLIKELY]
    if others:
        facts["Other causes"] = ", ".join(f"{CAUSES[name].spoken} {chance(p)}" for name, p in others[:SEVERAL])
    for number, why in enumerate(diagnosis.because, 1):
        facts[f"Reason {number}"] = why
    for name, size in (diagnosis.amount or {}).items():
        facts[f"{_SIZES[name]} {name}"] = str(size)
    if diagnosis.detection_limit is not None:
        limit, unit = diagnosis.detection_limit
        facts["Detection limit"] = f"a stick above {limit:.2g} {unit} would have shown"
    else:
        facts["Detection limit"] = "not known for this record"
    facts["Oscillation"] = _oscillation(diagnosis, loop)
    if diagnosis.performance is not None and not _at_rest(diagnosis):
        facts["Control"] = _performance(diagnosis.performance)
    if diagnosis.action:
        facts["What to do"] = diagnosis.action
    owner = _owner(diagnosis)
    if owner:
        facts["Who"] = owner
    section.figures.append(pairs(facts))
    return section


def _performance(found: "Harris") -> str:
    return (
        f"{found.index:.0%} of the variance of the control error could be foretold {found.horizon} samples ahead "
        "(Harris index at that horizon): that much better control could take away at most"
    )


_SIZES = {"S": "Stickband plus deadband", "J": "Slip jump"}


def _owner(diagnosis: "Diagnosis") -> str:
    from stickslip.detect.judge.actions import CAUSES
    from stickslip.detect.judge.answer import NOTHING_YET

    if diagnosis.action.startswith(NOTHING_YET):
        return ""
    cause = next(iter(diagnosis.causes), "stiction" if diagnosis.verdict == "stiction" else "")
    return CAUSES[cause].owner if cause else ""


def _oscillation(diagnosis: "Diagnosis", loop: "Prepared") -> str:
    import numpy as np

    gate = loop.gate
    if not gate.oscillating or gate.period is None:
        return gate.reason
    record = diagnosis.record
    low, high = np.percentile(record.pv[record.good], (2.5, 97.5))
    unit = record.log.units.get(record.pv_name)
    amplitude = f"{0.5 * (high - low):.3g}{f' {unit}' if unit else ''}"
    return f"period {gate.period:.4g} s, {gate.cycles:.0f} cycles; PV moves by {amplitude} to either side"


def _test(diagnosis: "Diagnosis") -> "Section | None":
    from stickslip.commands.report.page import Section, table_to_html
    from stickslip.detect.judge.confirming import COLUMNS, confirming_rows

    S = (diagnosis.amount or {}).get("S")
    if S is None:
        return None
    section = Section("The test that confirms it", "", "open", "")
    section.reason = (
        "In manual, with the process in a state that bears it. After each step wait several time constants of PV, and "
        "note OP and PV (or the stem). Then: stickslip valve TEST.csv"
    )
    section.figures.append(table_to_html(COLUMNS, confirming_rows(S)))
    return section


def _over_time(found: "OverTime") -> "Section":
    from stickslip.commands.report.page import Section, figure_to_svg, table_to_html
    from stickslip.detect.figures.evidence import plot_over_time
    from stickslip.detect.words import WORDS
    from stickslip.logs.chances import chance

    section = Section("Over time", "", "open", found.words, before=found.divided)
    if not found.windows:
        return section
    if any(w.probability is not None or w.S is not None for w in found.windows):
        section.figures.append(figure_to_svg(plot_over_time(found)))
    head = ["from", "to", "samples", "verdict", "probability", "S", "90 % interval", "J", "unit"]
    rows = [
        [
            _when(found, w.start), _when(found, w.end), str(w.samples), WORDS[w.verdict].spoken,
            chance(w.probability), *_size(w.S),
            "-" if w.J is None else f"{w.J.value:.2g}", "" if w.S is None else w.S.unit,
        ]
        for w in found.windows
    ]  # fmt: skip
    kinds = [WORDS[w.verdict].kind for w in found.windows]
    section.figures.append(table_to_html(head, rows, badges={3: kinds}))
    return section


def _size(S: "Amount | None") -> tuple[str, str]:
    return ("-", "-") if S is None else (f"{S.value:.2g}", f"{S.low:.2g} to {S.high:.2g}")


def _when(found: "OverTime", t: float) -> str:
    start = found.record.log.start
    if start is not None:
        return f"{start + timedelta(seconds=t):%Y-%m-%d %H:%M}"
    from stickslip.logs.time_axis import time_unit

    scale, unit = time_unit(found.record.log.duration)
    return f"{t / scale:.4g} {unit}"


def _trend(diagnosis: "Diagnosis", loop: "Prepared", stem: "StemTrend | str") -> "Section":
    from stickslip.commands.report.page import Section, captioned, figure_to_svg
    from stickslip.detect.evidence import set_point_words
    from stickslip.detect.figures.loop_trend import plot_cycles, plot_trend

    seen = None if isinstance(stem, str) else stem
    record, period = diagnosis.record, loop.period
    section = Section("The trend", "", "open", "")
    gaps = record.log.gaps()
    shaded = [f"grey: {len(gaps)} gap{'s' * (len(gaps) > 1)}"] * bool(gaps)
    shaded += ["light red: samples that do not count"] * (not record.good.all())
    caption = "; ".join(["The whole record", *shaded]) + "."
    moved = set_point_words(record, diagnosis.period or nan)
    section.figures.append(captioned(figure_to_svg(plot_trend(record, seen)), caption, moved))
    if _at_rest(diagnosis) or (diagnosis.verdict == "not_applicable" and seen is None):
        return section
    cycles = figure_to_svg(plot_cycles(record, period, seen))
    if seen is None:
        section.figures.append(captioned(cycles, str(stem)))
        return section
    finding = f"The stem stands while OP moves in {seen.share:.0%} of the time."
    facts = "The stem as it was logged." if seen.logged else _reconstructed(seen)
    section.figures.append(captioned(cycles, f"The last cycles. {facts}", finding))
    return section


def _reconstructed(stem: "StemTrend") -> str:
    said = "The stem is reconstructed: the play with a jump that predicts PV best from OP"
    if not stem.better > 1.0:
        return f"{said}; PV is predicted as well without any, so this stem proves nothing."
    return f"{said}. Without it the error is {stem.better:.2f} times as large."


def _evidence(diagnosis: "Diagnosis", loop: "Prepared", stem: "StemTrend | str") -> "Section | None":
    from stickslip.commands.report.page import Section, captioned, figure_to_svg, side_by_side
    from stickslip.detect.evidence import correlation, spectrum
    from stickslip.detect.figures.evidence import plot_correlation, plot_pv_op, plot_spectrum, plot_stem_op

    if not diagnosis.record.good.any():
        return None
    section = Section("The evidence", "", "open", _at_rest(diagnosis))
    if section.reason:
        return section
    seen = None if isinstance(stem, str) else stem
    record, period = diagnosis.record, loop.period
    small = [
        captioned(
            figure_to_svg(plot_pv_op(record, period, seen)),
            "A valve that sticks before a fast process draws a parallelogram, a slow process or an outside wave an "
            "ellipse.", "PV against OP.",
        )
    ]  # fmt: skip
    if seen is not None:
        facts = "Level: it sticks. Steep: it jumps." if seen.logged else f"Level: it sticks. {_reconstructed(seen)}"
        title = "The stem against OP." if seen.logged else "The estimated stem (MV) against OP."
        small.append(captioned(figure_to_svg(plot_stem_op(record, period, seen)), facts, title))
    lines = spectrum(loop)
    if lines is not None:
        facts = "Dotted: harmonics of the period. A sine has none, a triangle 11 % at 3, a square 33 %."
        small.append(captioned(figure_to_svg(plot_spectrum(lines)), facts, _harmonics(lines)))
    likeness = correlation(loop)
    if likeness is not None:
        facts = (
            "Above: how regular each is. Below: near zero at no lag speaks for a sticky valve before a self-regulating "
            "process, a peak of either sign there for an outside wave or tight tuning."
        )
        small.append(captioned(figure_to_svg(plot_correlation(likeness)), facts, _lag(likeness, loop)))
    section.figures.append(side_by_side(small))
    drawn = deciding(diagnosis)
    if drawn is not None:
        section.figures.insert(0, captioned(*drawn))
    return section


def _at_rest(diagnosis: "Diagnosis") -> str:
    """Rest in words; "" where something moves."""
    from stickslip.logs.trend import rests

    record = diagnosis.record
    pv, op = record.pv[record.good], record.op[record.good]
    if not len(pv) or not (rests(pv) and rests(op)):
        return ""
    most = max(float(pv.max() - pv.min()), float(op.max() - op.min()))
    return f"At rest: nothing moves{f' by more than {most:.1g}' if most else ''}, so there is nothing to draw."


def _harmonics(lines: "Spectrum") -> str:
    if not lines.of_pv:
        return "Spectrum: no oscillation stands out."
    at = 3 if 3 in lines.of_pv else next(iter(lines.of_pv))
    return f"Spectrum: harmonic {at} has {lines.of_pv[at]:.0%} of PV's and {lines.of_op[at]:.0%} of OP's amplitude."


def _lag(found: "Correlation", loop: "Prepared") -> str:
    said = "does not follow OP" if loop.causality.present else f"follows OP by {found.lag:.3g} s"
    return f"Correlation: PV {said} (r = {found.at_lag:.2f}); at no lag r = {found.at_zero:.2f}."


def _methods(diagnosis: "Diagnosis") -> "Section | None":
    from stickslip.commands.report.page import Section, table_to_html
    from stickslip.detect.words import WORDS

    if not diagnosis.methods:
        return None
    counts = [
        said.counted(n) for word, said in WORDS.items() if (n := sum(v.verdict == word for v in diagnosis.methods))
    ]
    section = Section("What every method says", "", "open", f"Of {len(diagnosis.methods)} methods {', '.join(counts)}.")
    section.before = (
        "Published methods and our own, each as its source has it. They stand beside the answer, which is calibrated; "
        "one that does not apply says why."
    )
    rows = [
        [v.method.replace("_", " "), WORDS[v.verdict].spoken, _number(v.index), _number(v.threshold),
         _number(v.amount_percent_op), v.reason]
        for v in diagnosis.methods
    ]  # fmt: skip
    head = ["method", "says", "index", "limit", "S [% of OP]", "because"]
    section.figures.append(table_to_html(head, rows, badges={1: [WORDS[v.verdict].kind for v in diagnosis.methods]}))
    return section


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


_MET = {True: "yes", False: "no", None: "not known"}


def _data(diagnosis: "Diagnosis") -> "Section":
    from stickslip.commands.report.page import Section, table_to_html
    from stickslip.detect.health.wanted import met

    conditions = met(diagnosis.conditions)
    failed = sum(one.met is False for one in conditions)
    reason = (
        f"{failed} of {len(conditions)} conditions on the record {'is' if failed == 1 else 'are'} not met."
        if failed else "No condition on the record is missed."
    )  # fmt: skip
    section = Section("The data", "", "open", reason, notes=list(diagnosis.assumptions), notes_label=READ)
    conditions = tuple(sorted(conditions, key=lambda one: one.met is not False))
    rows = [[one.wanted, _MET[one.met], one.found, one.remedy] for one in conditions]
    kinds = ["good" if one.met else "open" for one in conditions]
    if rows:
        head = ["what is wanted", "met", "what was found", "what to do"]
        section.figures.append(table_to_html(head, rows, badges={1: kinds}))
    return section
