"""The import directions of the house, read from the sources."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

MAY_IMPORT = {
    "records": set(),
    "detect": {"records"},
    "blocks": set(),
    "engine": set(),
    "plant": {"blocks", "engine", "records"},
    "online": {"blocks", "detect", "records"},
    "cases": {"blocks", "detect", "online", "plant", "records"},
    "stickslip": {"blocks", "cases", "detect", "online", "plant", "records"},
    "benchmarks": {"blocks", "cases", "detect", "engine", "online", "plant", "records", "stickslip"},
}
HEAVY = {"control", "numba", "llvmlite"}
MAY_IMPORT_HEAVY = {
    "control": {"blocks", "plant", "benchmarks"},
    "numba": {"engine", "benchmarks"},
    "llvmlite": {"engine"},
}
FILES = [(package, path) for package in MAY_IMPORT for path in sorted((ROOT / package).rglob("*.py"))]


def imported(path: Path) -> set[str]:
    """Return the top-level names a file imports, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module.split(".")[0])
    return found


@pytest.mark.parametrize(("package", "path"), FILES, ids=[str(p.relative_to(ROOT)) for _, p in FILES])
def test_imports_follow_the_arrows(package: str, path: Path) -> None:
    names = imported(path)
    assert names & set(MAY_IMPORT) <= MAY_IMPORT[package] | {package}
    for heavy in names & HEAVY:
        assert package in MAY_IMPORT_HEAVY[heavy], f"{package} must not import {heavy}"


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
    assert packages == set(MAY_IMPORT)


def test_the_rule_can_fail(tmp_path: Path) -> None:
    page = tmp_path / "page.py"
    page.write_text("def f():\n    from diagram.diagram import wire\n    import control\n")
    assert imported(page) == {"plant", "control"}
