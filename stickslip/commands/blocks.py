"""``stickslip blocks``: every block with its ports, parameters and source, and the page of one of them."""

import inspect
import math
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import Speaker, json_option, user_errors
from stickslip.commands.kept import kept

if TYPE_CHECKING:
    from stickslip.blocks.block import Block

TEXTBOOK = "textbook"
STEM = "thesis eqs. 4.4 and 4.5"
SELECTIVE = "Seborg, Edgar and Mellichamp 2004"
SAMPLED = "Astrom and Wittenmark 1997"
SLUGS = "thesis sections 1.3 and 5.1.3"

# group -> block -> source in short; the block's page has it in full
BLOCKS: Mapping[str, Mapping[str, str]] = {
    "Signals and boundary conditions": {
        "Constant": TEXTBOOK, "Step": TEXTBOOK, "Ramp": TEXTBOOK, "Sine": SLUGS, "Square": TEXTBOOK,
        "Triangle": TEXTBOOK, "Slug": SLUGS, "Staircase": TEXTBOOK, "Recorded": TEXTBOOK, "Noise": "L'Ecuyer 1999",
        "PRBS": "Ljung 1999", "Chirp": TEXTBOOK, "Pin": TEXTBOOK, "Historian": TEXTBOOK,
    },
    "Controllers": {
        "PI": "Astrom and Hagglund 2006", "PID": "Astrom and Hagglund 2006", "SampledPI": SAMPLED,
        "SampledPID": SAMPLED, "GapPI": "Shinskey 1996", "RelayTuner": "Astrom and Hagglund 1984",
        "AntiSurge": "thesis section 3.5.1, table 5.1", "Flare": "thesis section 3.5.4, table 5.1",
    },
    "Against stick: controller to valve": {
        "Knocker": "Hagglund 2002", "ConstantReinforcement": "Ivan and Lakshminarayanan 2009",
        "TwoMove": "Srinivasan and Rengaswamy 2008",
    },
    "Valve stems: OP to MV": {
        "StickSlip": STEM, "StribeckStem": "Olsson 1998", "LuGreStem": "Canudas de Wit 1995", "QuasiStaticStem": STEM,
        "RestingStem": "He 2007",
        "KanoValve": "Kano 2004", "ChoudhuryValve": "Choudhury 2005",
        "HeValve": "He 2007", "ChenValve": "Chen 2008", "StenmanValve": "Stenman 2003",
        "Deadband": TEXTBOOK, "IdealValve": TEXTBOOK, "Positioner": "Merritt 1967",
    },
    "Valve bodies and pipes: MV to flow": {
        "ControlValveFlow": "thesis eqs. 4.1 and 4.2, table A.2", "GasValveFlow": "IEC 60534-2-1:2011",
        "Characteristic": "IEC 60534-2-4", "CheckValve": TEXTBOOK, "FlowResistance": "thesis eq. 4.2",
    },
    "Plant": {
        "Separator": "thesis eqs. 3.1 to 3.5, table A.1", "Scrubber": "thesis section 3.3",
        "Plenum": "thesis eqs. 3.8 and 3.9", "Compressor": "thesis eq. 3.10", "Shaft": "thesis eq. 3.11",
        "GasTurbine": "Rowen 1983; thesis section 3.5.2",
    },
    "Processes of test loops": {
        "FirstOrder": TEXTBOOK, "SecondOrder": TEXTBOOK, "Integrator": TEXTBOOK, "DeadTime": TEXTBOOK,
        "VariableDelay": TEXTBOOK, "Tank": "Schoukens and Noel 2017", "Overflow": "mass balance",
    },
    "Sensors": {"Sensor": TEXTBOOK, "SampledSensor": TEXTBOOK},
    "Arithmetic": {
        "Sum": TEXTBOOK, "Gain": TEXTBOOK, "Product": TEXTBOOK, "Divide": TEXTBOOK, "Lookup1D": TEXTBOOK,
        "Lookup2D": TEXTBOOK,
    },
    "Any system": {
        "StateSpace": TEXTBOOK, "TransferFunction": TEXTBOOK, "Equations": TEXTBOOK, "SampledFunction": TEXTBOOK,
    },
    "Limits and switches": {
        "Saturation": TEXTBOOK, "DeadZone": "Khalil 2002", "Quantiser": TEXTBOOK, "RateLimiter": TEXTBOOK,
        "Relay": "Astrom and Hagglund 1984", "Switch": TEXTBOOK,
        "MinSelect": SELECTIVE, "MaxSelect": SELECTIVE,
    },
    "Compensators and filters": {
        "LeadLag": "Seborg, Edgar and Mellichamp 2004", "SampledFilter": SAMPLED,
        "Biquad": "Oppenheim and Schafer 2010", "ZeroOrderHold": SAMPLED, "ResetIntegrator": TEXTBOOK,
    },
}  # fmt: skip

# what a block cannot be built without, where 1 will not do; the values serve to show its ports
NEEDED: Mapping[str, Mapping[str, Any]] = {
    **{name: {"signal": "out"} for name in ("Constant", "Ramp", "Sine", "Square", "Triangle", "Slug")},
    "Step": {"signal": "out"},
    "Staircase": {"signal": "out", "levels": [0.0, 1.0], "dwell": 1.0},
    "Recorded": {"signal": "out", "t": [0.0, 1.0], "values": [0.0, 1.0]},
    "Noise": {"signal": "out"},
    "Pin": {"t": [0.0, 1.0], "values": [0.0, 1.0]},
    "Historian": {"signals": ["in"]},
    "HeValve": {"f_s": 0.04, "f_d": 0.02},
    "GapPI": {"dt": 1.0},
    "Knocker": {"period": 3.0, "width": 1.0},
    "Sum": {"signal": "out", "weights": {"in_1": 1.0, "in_2": 1.0}},
    "Gain": {"signal": "out", "source": "in"},
    "StateSpace": {"A": [[-1.0]], "B": [[1.0]], "C": [[1.0]]},
    "TransferFunction": {"num": [1.0], "den": [1.0, 1.0]},
    "Equations": {"name": "yours", "out": lambda u: u, "inputs": "u", "outputs": "y"},
    "SampledFunction": {"name": "yours", "step": lambda u: u, "inputs": "u", "outputs": "y"},
    "Saturation": {"signal": "out", "source": "in", "low": 0.0},
    "DeadZone": {"signal": "out", "source": "in", "low": 0.0},
    **{
        name: {"signal": "out", "source": "in"}
        for name in ("Quantiser", "RateLimiter", "Relay", "LeadLag", "SampledFilter", "ZeroOrderHold")
    },
    "Biquad": {"signal": "out", "source": "in", "b": [1.0, 0.0, 0.0], "a": [0.0, 0.0]},
    **{name: {"signal": "out", "sources": ["in_1", "in_2"]} for name in ("Product", "MinSelect", "MaxSelect")},
    **{name: {"signal": "out"} for name in ("PRBS", "Chirp")},
    "Lookup2D": {
        "signal": "out",
        "first": "in_1",
        "second": "in_2",
        "x": [0.0, 1.0],
        "y": [0.0, 1.0],
        "z": [[0.0, 1.0], [1.0, 2.0]],
    },
    "ResetIntegrator": {"signal": "out", "source": "in", "reset": "reset"},
    "VariableDelay": {"signal": "out", "source": "in", "theta": "theta"},
    "Divide": {"signal": "out", "numerator": "in_1", "denominator": "in_2"},
    "Switch": {"signal": "out", "control": "control", "above": "in_1", "below": "in_2"},
    "Lookup1D": {"signal": "out", "source": "in", "x": [0.0, 1.0], "y": [0.0, 1.0]},
}

HEAD = """# The blocks

One line a block; ``stickslip blocks NAME`` shows its page: equation, parameters with units, limits, an example.
Ports without a unit take any. Source ``textbook``: no single source. ``stickslip blocks --markdown`` prints this page.
"""


@dataclass(frozen=True)
class Entry:
    """One block: what it does, its ports and parameters, its source in short, what its class and its page say."""

    name: str
    group: str
    what: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    parameters: Mapping[str, float | None]  # name -> default, None where it must be given
    states: tuple[str, ...]
    modes: tuple[str, ...]
    source: str
    signature: str
    about: str
    page: str
    example: str
    file: str


@lru_cache(maxsize=1)
def entries() -> tuple[Entry, ...]:
    """Return all blocks, in the order of the groups.

    >>> [entry.outputs for entry in entries() if entry.name == "Shaft"]
    [('w [rad/s]',)]
    """
    found = kept("blocks", lambda: [vars(entry) for entry in _built()])
    return tuple(_as_entry(facts) for facts in found)


def find(name: str) -> Entry:
    """Return one block by its name or that of its file; raise ``BlockError`` with the nearest one if there is none.

    >>> find("stick_slip").name, find("gasturbine").name
    ('StickSlip', 'GasTurbine')
    """
    wanted = name.lower().removesuffix(".py")
    for entry in entries():
        if wanted in (entry.name.lower(), entry.file.removeprefix("blocks/").removesuffix(".py")):
            return entry
    from stickslip.blocks.ports import BlockError, nearest

    raise BlockError(f"there is no block '{name}'; {nearest(name, [entry.name for entry in entries()])}")


def markdown() -> str:
    """Return the page of all blocks, a table per group."""
    lines = [HEAD]
    for group in BLOCKS:
        lines += [f"## {group}\n", "| block | what | in | out | parameters | source |", "|---|---|---|---|---|---|"]
        for entry in entries():
            if entry.group == group:
                cells = (
                    f"[{entry.name}](../{entry.file})", entry.what, ", ".join(entry.inputs), ", ".join(entry.outputs),
                    ", ".join(entry.parameters), entry.source,
                )  # fmt: skip
                lines.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |")
        lines.append("")
    return "\n".join(lines)


@click.command("blocks")
@click.argument("name", required=False)
@click.option("--markdown", "as_markdown", is_flag=True, help="Print the table of all blocks as Markdown.")
@json_option
@user_errors
def command(name: str | None, as_markdown: bool, json_file: str | None) -> None:
    """List all blocks with their ports, or show the page of the block NAME.

    \b
    Examples:
      stickslip blocks
      stickslip blocks GasTurbine
      stickslip blocks --markdown > blocks.md

    \b
    Exit codes: 0 done, 2 there is no such block.
    """
    say = Speaker(json_file)
    if as_markdown:
        say(markdown(), nl=False)
    elif name is None:
        for group in BLOCKS:
            say(group, bold=True)
            found = [entry for entry in entries() if entry.group == group]
            rows = [[e.name, e.what, ", ".join(e.inputs), ", ".join(e.outputs)] for e in found]
            say.table(["block", "what", "in", "out"], rows)
        say("stickslip blocks NAME shows one of them: equation, parameters, limits, an example")
    else:
        _show(find(name), say)
    shown = entries() if name is None else (find(name),)
    say.document(
        {
            "schema": "stickslip.blocks/1",
            "blocks": [dict(vars(entry), parameters=_finite(entry.parameters)) for entry in shown],
        }
    )


def _show(entry: Entry, say: Speaker) -> None:
    say(f"{entry.name} ({entry.file})", bold=True)
    say()
    say(entry.page)
    say()
    parameters = ", ".join(k if value is None else f"{k} = {value:.6g}" for k, value in entry.parameters.items())
    facts = {
        "in": ", ".join(entry.inputs), "out": ", ".join(entry.outputs), "parameters": parameters,
        "states": ", ".join(entry.states), "modes": ", ".join(entry.modes),
    }  # fmt: skip
    for key, fact in facts.items():
        if fact:
            say(f"{key:<12}{fact}")
    say()
    say(entry.signature)
    say(entry.about)
    if entry.example:
        say()
        say(entry.example)


def _as_entry(facts: Mapping[str, Any]) -> Entry:
    values: dict[str, Any] = {key: tuple(fact) if isinstance(fact, list) else fact for key, fact in facts.items()}
    return Entry(**values)


def _built() -> Iterator[Entry]:
    for group, names in BLOCKS.items():
        for name, short in names.items():
            yield _entry(group, name, short)


def _entry(group: str, name: str, short: str) -> Entry:
    from stickslip import blocks

    made: type[Block] = getattr(blocks, name)
    signature = inspect.signature(made)
    missing = _missing(signature)
    block = made(**dict.fromkeys(missing, 1.0) | dict(NEEDED.get(name, {})))
    doc = inspect.getdoc(made) or ""
    page = inspect.getdoc(sys.modules[made.__module__]) or ""
    listed = [getattr(blocks, other).__module__ for names in BLOCKS.values() for other in names]
    alone = listed.count(made.__module__) == 1
    return Entry(
        name=name, group=group, what=_sentence(page if alone else doc), source=short, about=_sentence(doc), page=page,
        inputs=_ports(block, block.ports_in), outputs=_ports(block, block.ports_out),
        parameters={
            key: None if key in missing else float(block.p[i]) for i, key in enumerate(block.param_names)
        },
        states=block.state_names, modes=tuple(block.modes), signature=_call(name, signature),
        example="\n".join(re.findall(r"^(?:>>>|\.\.\.).*(?:\n(?!>>>|\.\.\.).+)*", doc, re.MULTILINE)),
        file=f"{made.__module__.removeprefix('stickslip.').replace('.', '/')}.py",
    )  # fmt: skip


def _missing(signature: inspect.Signature) -> list[str]:
    """Return the arguments without a default."""
    kinds = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return [key for key, p in signature.parameters.items() if p.default is p.empty and p.kind in kinds]


def _call(name: str, signature: inspect.Signature) -> str:
    bare = [p.replace(annotation=inspect.Parameter.empty) for p in signature.parameters.values()]
    return f"{name}{signature.replace(parameters=bare, return_annotation=inspect.Signature.empty)}"


def _sentence(doc: str) -> str:
    """Return the first line without its full stop, in plain words."""
    return doc.partition("\n")[0].removesuffix(".").replace("``", "")


def _ports(block: "Block", ports: tuple[Any, ...]) -> tuple[str, ...]:
    units = block.units
    return tuple(f"{port.name} [{units[port.name]}]" if units[port.name] else port.name for port in ports)


def _finite(values: Mapping[str, float | None]) -> dict[str, float | str | None]:
    """Return numbers that JSON can carry: infinite ones as words."""
    return {key: value if value is None or math.isfinite(value) else str(value) for key, value in values.items()}
