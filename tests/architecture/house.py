"""The files of the house and what each of them imports, read once for all rules."""

import ast
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text()
ROOMS = {
    room: set(re.findall(r"`([a-z/]+)`", allowed))
    for room, allowed in re.findall(r"^\| `([a-z/]+)/` \|.*\| ([^|]*) \|$", CONTRIBUTING, re.M)
}
TOOLS = {"benchmarks"}  # of developers: not installed


def room_of(module: str) -> str | None:
    """Return the room that a module is in, the inner one of two; a module of the command line is in ``stickslip``.

    >>> [room_of(f"stickslip.{module}") for module in ("detect.blocks.detector", "detect.card", "commands.check")]
    ['detect/blocks', 'detect', 'stickslip']
    >>> room_of("benchmarks.plant"), room_of("numpy"), room_of("detect")
    ('benchmarks', None, None)
    """
    first, _, rest = module.partition(".")
    if first != "stickslip":
        return first if first in TOOLS else None
    path = rest.replace(".", "/") + "/"
    return max((room for room in ROOMS if path.startswith(f"{room}/")), key=len, default="stickslip" if rest else None)


def module_of(path: Path) -> str:
    """Return the name by which a file of the house is imported.

    >>> module_of(ROOT / "blocks" / "pi.py"), module_of(ROOT / "stickslip" / "__main__.py")
    ('stickslip.blocks.pi', 'stickslip.__main__')
    """
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts if parts[0] in {*TOOLS, "stickslip"} else ("stickslip", *parts)).removesuffix(".__init__")


PACKAGES = sorted({room.split("/")[0] for room in ROOMS})
FILES = [
    (room_of(module_of(path)) or "stickslip", path)
    for package in PACKAGES
    for path in sorted((ROOT / package).rglob("*.py"))
]


def offenders(fault: Callable[[Path], object]) -> dict[str, object]:
    """Return every file in which ``fault`` finds something, by its path from the root, with what it finds."""
    found = {str(path.relative_to(ROOT)): fault(path) for _, path in FILES}
    assert len(found) > 500  # it does read them
    return {name: faults for name, faults in found.items() if faults}


@cache
def parsed(source: str) -> ast.Module:
    """Return the syntax tree of a source, parsed once for all rules."""
    return ast.parse(source)


def imported(path: Path) -> set[str]:
    """Return the modules that a file imports, anywhere in it; of ``from a import b`` both a and a.b."""
    found = set()
    for node in ast.walk(parsed(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found
