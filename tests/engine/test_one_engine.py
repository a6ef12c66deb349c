"""The engine is compiled once: what calls it by its name would be compiled with all of it inside."""

import ast
from pathlib import Path

from stickslip.engine import advance

ENGINE = Path(advance.__file__).parent


def test_only_its_cache_knows_the_engine_by_name() -> None:
    naming = {
        path.name
        for path in ENGINE.glob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ImportFrom) and node.module == advance.__name__
        if any(alias.name == "advance" for alias in node.names)
    }
    assert naming == {"cache.py"}
