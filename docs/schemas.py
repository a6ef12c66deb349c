"""Write docs/schemas.md again from what the commands write: ``python docs/schemas.py``.

Every command is run on small inputs, and the shapes of its documents are put together.
"""

import json
import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from click.testing import CliRunner
from stickslip.cases.stories import EXPORTS

from stickslip.commands.cli import cli

PAGE = Path(__file__).parent / "schemas.md"
HEAD = """# JSON schemas

`--json FILE` writes one JSON document, `--json -` writes it to standard output, alone. `schema` names the form and
its version. The version grows when a field goes or changes its meaning; new fields may come at any time. Numbers are
finite; an unknown value is null. Times are in seconds, amplitudes in the unit of the signal, S and J in the unit given
with them. A name in angle brackets stands for any name. This page is written by
`python docs/schemas.py`.

```
stickslip check FIC101.csv --json - | jq '.verdict, .period_s, .amplitude'
```
"""
OPEN = {
    "causes",
    "final",
    "signals",
    "states",
    "request",
    "parameters",
    "shares",
    "plant",
    "vary",
    "start",
    "shrinkage",
    "settings",
}  # objects whose keys are names
MODEL = """
from stickslip.blocks import FirstOrder, IdealValve, Step
from stickslip.diagram import wire


def loop():
    return wire([Step("OP", after=1.0), IdealValve(), FirstOrder(K=1.0, tau=5.0)])
"""
# what the page says first -> command lines in a folder of inputs; the shapes of all are put together
SLOW = ("demo", "reproduce")
LINES: dict[str, tuple[Sequence[str], ...]] = {
    "check": (("check", "FIC101.csv"), ("check", "still.csv")),
    "check, several loops": (
        ("check", "FIC101.csv", "unit.csv"),
        ("check", "FIC12_day1.csv", "FIC12_day2.csv"),
        ("check", "FIC13_day1.csv", "FIC13_day2.csv"),
        ("check", "hidden.csv"),
    ),
    "fit": (("fit", "sticky.csv"),),
    "remedy": (("remedy", "sticky.csv"),),
    "valve": (("valve", "steps.csv"),),
    "table": (("table", "FIC101.csv", "--method", "area_ratio", "--method", "curve_fit"),),
    "table --cards": (("table", "--cards", "--method", "area_ratio"),),
    "scan": (("scan", "plant", "--workers", "1"),),
    "simulate": (("simulate", "ideal_high", "--duration", "20", "--numbers"),),
    "simulate --list": (("simulate", "--list"),),
    "linearise": (("linearise", "ideal_high"),),
    "study": (("study", "ideal_high", "--vary", "valve.F_s=1750,2250", "--duration", "20"),),
    "gap": (("gap", "run.csv", "--model", "model.py:loop"),),
    "blocks": (("blocks", "Shaft"),),
    "demo": (("demo",),),
    "reproduce": (("reproduce", "--quick"),),
}


def inputs(folder: Path) -> None:
    """Write the small inputs of all commands."""
    export = (EXPORTS / "FIC101_pi_export.csv").read_text()
    (folder / "FIC101.csv").write_text(export)
    rows = range(300)
    for name in ("still", "FIC13_day1", "FIC13_day2"):
        (folder / f"{name}.csv").write_text("time,PV,OP\n" + "".join(f"{i},4,50\n" for i in rows))
    head = "time,FIC1.PV,FIC1.OP,LIC2.PV,LIC2.OP\n"
    body = "".join(f"{i},{40 + i % 7},{50 + i % 5},{30 + i % 3},{60 + i % 9}\n" for i in rows)
    (folder / "unit.csv").write_text(head + body)
    levels = [50, 52, 54, 56, 54, 52, 50, 50.5, 51, 50.5, 50]
    steps = [(60 * k + i, level, level - 0.4 * (k % 2)) for k, level in enumerate(levels) for i in range(60)]
    (folder / "steps.csv").write_text("time,PV,OP,MV\n" + "".join(f"{t},{mv},{op},{mv}\n" for t, op, mv in steps))
    (folder / "run.csv").write_text(
        "time,OP,PV\n" + "".join(f"{i},{0.5 + (i > 99)},{0.5 + (i > 120)}\n" for i in range(400))
    )
    from stickslip.remedy.example import sticky

    made = sticky(hours=1.0, seed=3)
    columns = zip(made.t, made.sp, made.pv, made.op, strict=True)  # type: ignore[arg-type]
    lines = [f"{t:g},{sp:.5g},{pv:.5g},{op:.5g}\n" for t, sp, pv, op in columns]
    half = len(lines) // 2
    for name, part in {"sticky": lines, "FIC12_day1": lines[:half], "FIC12_day2": lines[half:]}.items():
        (folder / f"{name}.csv").write_text("time,SP,PV,OP\n" + "".join(part))
    hidden(folder / "hidden.csv")
    (folder / "model.py").write_text(MODEL)
    (folder / "plant").mkdir()
    (folder / "plant" / "FIC101.csv").write_text(export)
    (folder / "plant" / "FIC9.csv").write_text("time,PV,OP\n0,four,5\n")
    for day in ("FIC12_day1.csv", "FIC12_day2.csv"):
        (folder / "plant" / day).write_text((folder / day).read_text())


def hidden(file: Path) -> None:
    """Write two levels, of which another tag shows that the valve of one slips."""
    import numpy as np
    from stickslip.detect.stem.stick import stick
    from stickslip.logs import Log, LoopSignals

    t = np.arange(3000.0)
    u = 50 + 4 * np.sin(t / 50) + 2 * np.sin(t / 31)
    signals = {"u": u, "p": np.cos(t / 90), "v": u[::-1], "q": np.sin(t / 70), "f": stick(u, 4.0, 1.5)}
    loops = {"LC1": LoopSignals("p", "u"), "LC2": LoopSignals("q", "v")}
    Log(t, signals, spans={"u": (0, 100), "v": (0, 100)}, loops=loops).to_csv(file)


def shape(value: Any, key: str = "") -> Any:
    """The shape of a document: names of types, a list of one shape, a dict of shapes; all of ``OPEN`` are one."""
    if isinstance(value, dict):
        parts = {name: shape(part, name) for name, part in value.items()}
        return {"<name>": _all(list(parts.values()))} if key in OPEN and parts else parts
    if isinstance(value, list):
        return [_all([shape(part, key) for part in value])] if value else []
    if value is None:
        return "null"
    return {bool: "true or false", str: "text"}.get(type(value), "number")


def together(one: Any, other: Any) -> Any:
    """One shape that two documents of a schema have.

    >>> together({"a": "null", "b": ["text"]}, {"a": "number", "b": []})
    {'a': 'number or null', 'b': ['text']}
    """
    if one == other:
        return one
    if isinstance(one, dict) and isinstance(other, dict):
        return {name: _all([side[name] for side in (one, other) if name in side]) for name in {**one, **other}}
    if isinstance(one, list) and isinstance(other, list):
        return [_all([*one, *other])] if one or other else []
    if "null" in (one, other) and not (isinstance(one, str) and isinstance(other, str)):
        return other if one == "null" else one
    words = [word for side in (one, other) if isinstance(side, str) for word in side.split(" or ") if word != "false"]
    found = [word for word in dict.fromkeys(words) if word != "null"] + ["null"] * ("null" in words)
    return " or ".join(found).replace("true", "true or false")


def _all(shapes: Sequence[Any]) -> Any:
    found = shapes[0] if shapes else []
    for one in shapes[1:]:
        found = together(found, one)
    return found


def written(found: Any, depth: int = 0) -> str:
    """The shape as lines of text."""
    space = "  " * (depth + 1)
    if isinstance(found, dict):
        inside = ",\n".join(f"{space}{name}: {written(part, depth + 1)}" for name, part in found.items())
        return "{\n" + inside + "\n" + "  " * depth + "}"
    if isinstance(found, list):
        return f"[{written(found[0], depth)}, ...]" if found else "[...]"
    return str(found)


def documents(name: str, run: Callable[[Sequence[str]], Any]) -> list[Any]:
    """The documents of one entry of ``LINES``; ``run`` runs a command line and returns its document."""
    return [run(line) for line in LINES[name]]


def run(line: Sequence[str]) -> Any:
    """The document that a command writes, run in the present folder."""
    done = CliRunner().invoke(cli, [*line, "--json", "found.json"], catch_exceptions=False)
    if done.exit_code not in (0, 1):
        raise RuntimeError(f"{' '.join(line)}: {done.output}")
    return json.loads(Path("found.json").read_text())


def sections(names: Sequence[str]) -> dict[str, str]:
    """The section of the page for each of these entries of ``LINES``."""
    found = {}
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            inputs(Path(folder))
            for name in names:
                made = documents(name, run)
                form = _all([shape(document) for document in made])
                found[name] = f"## {name}: `{made[0]['schema']}`\n\n```\n{written(form)}\n```\n"
        finally:
            os.chdir(here)
    return found


if __name__ == "__main__":
    PAGE.write_text("\n".join([HEAD, *sections(list(LINES)).values()]))
