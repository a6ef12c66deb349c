"""One dialect of docstrings in the whole house, and a unit for every number that a block is built with."""

import ast
import inspect
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from stickslip import blocks
from stickslip.commands.blocks import BLOCKS
from tests.architecture.house import parsed

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("logs", "blocks", "engine", "diagram", "plant", "study", "detect", "gap", "cases", "stickslip", "benchmarks")
FILES = [p for room in ROOMS for p in sorted((ROOT / room).rglob("*.py"))]
WORDS = {
    "action",
    "anti_windup",
    "beyond",
    "control",
    "hold",
    "integral",
    "map",
    "check_valve",
    "params",
    "rule",
}  # texts, switches and groups: no numbers
COMMON = {"name", "inputs", "outputs", "units", "spans", "labels", "signal", "signals", "unit", "seed", "source", "law"}


def docstrings(source: str) -> Iterator[tuple[str, str]]:
    """Yield name and docstring of a file and of what is in it."""
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (text := ast.get_docstring(node)):
            yield getattr(node, "name", "the file"), text


def faults(source: str) -> list[str]:
    """Return what breaks the dialect: a name between single backticks, a section underlined, an end without a stop."""
    found = []
    for name, text in docstrings(source):
        if re.search(r"(?<!`)`(?!`)[^`]+(?<!`)`(?!`)", text):
            found.append(f"{name}: a name between single backticks; write ``name``")
        if re.search(r"^\s*-{4,}\s*$", text, re.M):
            found.append(f"{name}: an underlined section; write Parameters: ``name`` ...; Raises ``Error`` ...")
        if text.split("\n\n")[0].rstrip()[-1] not in ".:?)":
            found.append(f"{name}: the first paragraph is no full sentence")
    return found


def offenders(fault: Callable[[str], list[str]]) -> dict[str, list[str]]:
    """Return every file in whose source ``fault`` finds something, with what it finds."""
    found = {str(path.relative_to(ROOT)): fault(path.read_text()) for path in FILES}
    assert len(found) > 500  # it does read them
    return {name: faults for name, faults in found.items() if faults}


def test_one_dialect() -> None:
    assert offenders(faults) == {}


@pytest.mark.parametrize("text", ["Return `x`.", "Do.\n\n    Parameters\n    ----------\n    x : int", "Return x"])
def test_the_rule_can_fail(text: str) -> None:
    assert faults(f'def f():\n    """{text}\n    """')


def undocumented(source: str) -> list[str]:
    """Return the public functions and classes of a file that have no docstring."""
    public = [n for n in parsed(source).body if isinstance(n, ast.ClassDef | ast.FunctionDef)]
    return [n.name for n in public if not n.name.startswith("_") and not ast.get_docstring(n)]


def test_everything_public_has_a_docstring() -> None:
    assert offenders(undocumented) == {}
    assert undocumented("def f():\n    return 1\n\n\ndef _g():\n    return 1") == ["f"]


def without_unit(name: str) -> list[str]:
    """Return the numbers that a block is built with and whose unit its page does not give within a line or so."""
    made = getattr(blocks, name)
    page = f"{inspect.getdoc(sys.modules[made.__module__])} {inspect.getdoc(made)}".replace("\n", " ")
    wanted = [key for key, p in inspect.signature(made).parameters.items() if p.kind is not p.VAR_KEYWORD]
    return [
        key
        for key in wanted
        if key not in WORDS | COMMON
        and not any("[" in m.group(1) for m in re.finditer(rf"(?<![\w.]){re.escape(key)}(?!\w)(.{{0,120}})", page))
    ]


def test_every_parameter_of_every_block_has_a_unit() -> None:
    found = {name: without_unit(name) for names in BLOCKS.values() for name in names}
    assert len(found) > 60
    assert {name: keys for name, keys in found.items() if keys} == {}
