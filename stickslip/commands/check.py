"""``stickslip check``: one loop from a file, a verdict in words first."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import COLOUR_OF, Speaker, json_option, user_errors
from stickslip.commands.reading import form_options
from stickslip.commands.short import refuse_short
from stickslip.commands.standard_input import with_standard_input
from stickslip.commands.targets import check_targets, write_whole

if TYPE_CHECKING:
    from stickslip.calibration import AtRecord
    from stickslip.detect import Diagnosis, Method

MEASUREMENTS = ("flow", "level", "pressure", "temperature", "analyser", "other")


@click.command("check")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--pv", metavar="COLUMN", help="Name of the measurement column.")
@click.option("--op", metavar="COLUMN", help="Name of the controller output column.")
@click.option("--sp", metavar="COLUMN", help="Name of the set point column.")
@click.option("--mv", metavar="COLUMN", help="Name of the stem position column.")
@click.option("--mode", metavar="COLUMN", help="Name of the controller mode column.")
@form_options
@click.option("--loop", metavar="TAG", help="Name of the loop, where the file holds several.")
@click.option("--process", type=click.Choice(["self_regulating", "integrating"]), help="Kind of process, if known.")
@click.option("--measurement", type=click.Choice(MEASUREMENTS), help="What PV measures; by default read from the tag.")
@click.option("--span", nargs=2, type=float, metavar="LOW HIGH", help="Span of PV in its own unit.")
@click.option("--op-span", nargs=2, type=float, metavar="LOW HIGH", help="Span of OP in its own unit.")
@click.option(
    "--method", "own", multiple=True, metavar="FILE.py:FUNCTION", help="Also show a detector of your own; repeatable."
)
@click.option(
    "--simulate/--no-simulate", default=None,
    help="Show beside the verdict what 2,000 loops simulated like this record say, 6 to 20 s; by default where the "
    "model is unsure. The verdict stays.",
)  # fmt: skip
@click.option(
    "--remedy",
    is_flag=True,
    help="Of a valve that sticks, say what to do until the shutdown: fit the loop and try each remedy, 20 to 60 s.",
)
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file report with pictures.")
@json_option
@user_errors
def command(files: tuple[Path, ...], **stated: Any) -> None:
    """Say whether the valve of the loop in FILE sticks, and why; of several loops or files, which to look at first.

    FILE is CSV or Parquet with a time column, PV and OP; an hour or ten periods of raw data is a good start. '-' reads
    from a pipe. With --method FILE.py:FUNCTION that file IS EXECUTED; the function takes a record and returns a
    stickslip.detect.Verdict, which is shown beside the others.

    \b
    Examples:
      stickslip check FIC101.csv
      stickslip check export.csv --loop FIC101 --html report.html
      stickslip check plant.csv
      stickslip check trend.csv --pv FT101 --op FCV101 --time Zeit --decimal ,
      stickslip check FIC101.csv --json - | jq .verdict
      stickslip check FIC101.csv --simulate
      stickslip check FIC101.csv --remedy
      zcat FIC101.csv.gz | stickslip check -
      stickslip check FIC101.csv --method my_detector.py:detect

    \b
    Exit codes:
      0  done: no stiction, or the record leaves it open (the verdict says which)
      1  done, and stiction found
      2  FILE cannot be read or is too short for any verdict, or the request makes no sense
    """
    with with_standard_input(files) as found:
        _check(found, **stated)


def _check(
    files: tuple[Path, ...], html: Path | None, json_file: str | None, simulate: bool | None, measurement: str | None,
    span: tuple[float, float] | None, own: tuple[str, ...], remedy: bool, **stated: Any,
) -> None:  # fmt: skip
    methods = _methods(own)
    for file in files:
        check_targets({"--html": html, "--json": json_file}, source=file)
        if file.is_char_device() or file.is_block_device():
            raise ValueError(f"{file} is a device, not a file; name a CSV or Parquet file")
    from stickslip.commands.check_many import check_many, several
    from stickslip.commands.one_loop import answered, diagnosed, with_stated

    many = several(files, stated)
    if len(many) > 1 or len(many[0].records) > 1:
        for option, given in (("simulate", simulate), ("span", span is not None), ("method", own), ("remedy", remedy)):
            if given:
                raise ValueError(f"--{option} is of one loop; name it with --loop")
        raise SystemExit(check_many(many, html, json_file, measurement))
    from stickslip.detect.diagnosis import ask
    from stickslip.detect.prepare.prepared import prepared

    (record,) = many[0].records
    loop = prepared(with_stated(record, measurement, span, stated["process"] is None))
    diagnosis = diagnosed(loop)
    diagnosis = replace(diagnosis, methods=(*diagnosis.methods, *(ask(method, loop) for method in methods)))
    refuse_short([answered(diagnosis)])
    say = Speaker(json_file)
    asked = simulate or (simulate is None and diagnosis.unsure)
    found = _simulated(diagnosis) if asked else ""
    _tell(say, diagnosis)
    beside = _beside(say, diagnosis, found) if asked else {}
    if remedy and diagnosis.verdict == "stiction":
        beside |= _remedy(say, diagnosis)
    if html is not None:
        from stickslip.commands.loop_page import loop_page

        write_whole(html, loop_page(diagnosis).encode())
        say(f"report: {html}")
    say.document(diagnosis.to_dict() | beside)
    raise SystemExit(1 if diagnosis.verdict == "stiction" else 0)


def _methods(own: tuple[str, ...]) -> "list[Method]":
    """Return the detectors of the user's own; the others are shown anyway."""
    if not own:
        return []
    from stickslip.commands.own import is_own, method_named

    for given in own:
        if not is_own(given):
            raise ValueError(f"--method {given}: all methods of detect are shown anyway; give FILE.py:FUNCTION")
    return [method_named(given) for given in own]


def _simulated(diagnosis: "Diagnosis") -> "AtRecord | str":
    """Return what loops simulated under the record's conditions say, or why there are none."""
    from stickslip.calibration import at_record
    from stickslip.calibration.by_simulation import LOOPS

    if diagnosis.probability is None:
        return "not run, because the calibrated model was not run either"
    if sys.stderr.isatty():
        click.echo(f"Simulating {LOOPS} loops like this record: 6 to 20 s on two cores ...", err=True)
    try:
        return at_record(diagnosis.record)
    except ValueError as error:
        return f"not applicable, because {error}"


def _beside(say: Speaker, diagnosis: "Diagnosis", found: "AtRecord | str") -> dict[str, Any]:
    """Print what simulation says, and return what JSON holds of it.

    It stands beside the verdict and changes nothing of it, so that every entry point gives one answer.
    """
    from stickslip.calibration.by_simulation import together
    from stickslip.logs.chances import chance

    if isinstance(found, str) or diagnosis.probability is None:
        say.paragraph(f"Simulation: {found}.")
        return {"simulation": None}
    both = together(diagnosis.probability, found.probability)
    for sentence in found.sentences:
        say.paragraph(sentence)
    say.paragraph(
        f"With the calibrated model's {chance(diagnosis.probability)} that makes {chance(both)}. The verdict is "
        "the model's, as everywhere; simulation stands beside it."
    )
    stated = found.to_dict() | {"together": both}
    return {"simulation": stated}


def _remedy(say: Speaker, diagnosis: "Diagnosis") -> dict[str, Any]:
    """Print what the fitted loop says to do in place of a general rule, and return what JSON holds of it."""
    from stickslip.commands.fit import working
    from stickslip.remedy import FitError, fit, remedies

    say()
    try:
        advice = remedies(fit(diagnosis.record, progress=working), progress=working)
    except FitError as reason:
        say.paragraph(f"What to do until the shutdown is not known: {reason}.")
        return {"remedy": None}
    for sentence in advice.words():
        say.paragraph(sentence)
    if advice.fit.sticks:
        say.paragraph(advice.cost.words(advice.fit.op_unit))
    keys = ("until_shutdown", "at_shutdown", "cost", "words")
    return {"remedy": {key: value for key, value in advice.to_dict().items() if key in keys}}


def _tell(say: Speaker, diagnosis: "Diagnosis") -> None:
    """Print verdict, reason, assumptions and the methods' numbers, in this order."""
    from stickslip.commands.one_loop import UNLIKELY
    from stickslip.detect.judge.actions import CAUSES
    from stickslip.detect.words import WORDS
    from stickslip.logs.chances import chance

    word = WORDS[diagnosis.verdict]
    say(f"{diagnosis.loop}: {word.spoken.upper()}", fg=COLOUR_OF[word.kind], bold=True)
    say.paragraph(diagnosis.reason)
    for number, why in enumerate(diagnosis.because, 1):
        say.paragraph(why, f"  {number}. ")
    for name, size in (diagnosis.amount or {}).items():
        say.paragraph(f"{name} {size}")
    if diagnosis.action:
        say.paragraph(f"Next: {diagnosis.action}")
    if diagnosis.causes:
        say()
        likely = {cause: p for cause, p in diagnosis.causes.items() if p >= UNLIKELY or cause == "stiction"}
        rows = [[CAUSES[cause].spoken, chance(p)] for cause, p in likely.items()]
        left = len(diagnosis.causes) - len(likely)
        say.table(["cause", "probability"], rows + [[f"each of {left} others", chance(0.0)]] * (left > 0))
    say()
    say("Read and assumed:")
    for sentence in diagnosis.assumptions:
        say.paragraph(sentence, "  - ")
    rows = [
        [
            verdict.method,
            WORDS[verdict.verdict].spoken,
            "-" if verdict.index is None else f"{verdict.index:.3g}",
            "-" if verdict.threshold is None else f"{verdict.threshold:.3g}",
            "-" if verdict.amount_percent_op is None else f"{verdict.amount_percent_op:.3g}",
        ]
        for verdict in diagnosis.methods
        if verdict.applicable
    ]
    if rows:
        say.table(["method", "verdict", "index", "threshold", "S [% OP]"], rows)
    if silent := [verdict.method for verdict in diagnosis.methods if not verdict.applicable]:
        say.paragraph(f"Not applicable: {', '.join(silent)}.")
    say("The verdict is the calibrated one; the methods are for comparison. --json has the reason of each.")
