"""The import directions of the house, read from the sources."""

import ast
import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text()
ROOMS = {
    room: set(re.findall(r"`([a-z/]+)`", allowed))
    for room, allowed in re.findall(r"^\| `([a-z/]+)/` \|.*\| ([^|]*) \|$", CONTRIBUTING, re.M)
}


def room_of(module: str) -> str | None:
    """Return the room that a module is in, a room inside another before that one.

    >>> room_of("detect.blocks.detector"), room_of("detect.card"), room_of("numpy")
    ('detect/blocks', 'detect', None)
    """
    path = module.replace(".", "/") + "/"
    return max((room for room in ROOMS if path.startswith(f"{room}/")), key=len, default=None)


HEAVY = {"control", "numba", "llvmlite"}
MAY_IMPORT_HEAVY = {
    "control": {"blocks", "diagram", "benchmarks"},
    "numba": {"engine", "benchmarks"},
    "llvmlite": {"engine"},
}
PACKAGES = sorted({room.split("/")[0] for room in ROOMS})
FILES = [
    (room_of(".".join(path.relative_to(ROOT).with_suffix("").parts)), path)
    for package in PACKAGES
    for path in sorted((ROOT / package).rglob("*.py"))
]


def imported(path: Path) -> set[str]:
    """Return the modules that a file imports, anywhere in it; of ``from a import b`` both a and a.b."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


@pytest.mark.parametrize(("room", "path"), FILES, ids=[str(p.relative_to(ROOT)) for _, p in FILES])
def test_imports_follow_the_arrows(room: str, path: Path) -> None:
    modules = imported(path)
    entered = {room_of(module) for module in modules} - {None, room}
    assert entered <= ROOMS[room]
    for heavy in {module.split(".")[0] for module in modules} & HEAVY:
        assert room.split("/")[0] in MAY_IMPORT_HEAVY[heavy], f"{room} must not import {heavy}"


def loaded(path: Path) -> set[str]:
    """Return the modules, by their full names, that a file imports as it is loaded."""
    found = set()
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def test_no_two_files_need_each_other_to_load() -> None:
    modules = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts): path for _, path in FILES if path.name != "__init__.py"
    }
    needs = {name: (loaded(path) & set(modules)) - {name} for name, path in modules.items()}
    assert sum(map(len, needs.values())) > 300  # it does read them
    assert len(list(TopologicalSorter(needs).static_order())) == len(modules)
    with pytest.raises(CycleError):
        list(TopologicalSorter({**needs, "engine.layout": {"engine.advance"}}).static_order())


def test_every_package_is_listed() -> None:
    packages = {p.parent.name for p in ROOT.glob("*/__init__.py")} - {"tests"}
    assert packages == set(PACKAGES)
    assert ROOMS["logs"] == set() and "diagram" in ROOMS["plant"]  # the table was read


def test_the_rule_can_fail(tmp_path: Path) -> None:
    page = tmp_path / "page.py"
    page.write_text("def f():\n    from diagram.diagram import wire\n    import control\n")
    assert {room_of(module) for module in imported(page)} == {"diagram", None}
    assert "control" in imported(page) and "diagram" not in ROOMS["detect"]
