"""Numba compiles a function anew for an argument that is a literal: no caller may ask for a second engine so."""

import ast
from importlib import import_module
from itertools import chain
from pathlib import Path

import pytest
from stickslip.engine import advance

ENGINE = Path(advance.__file__).parent
WITH_AN_ENGINE = {"advance", "run_branch", "run_from"}  # what is compiled with all of the engine inside


def literals(source: str, known: dict[str, object]) -> list[str]:
    """Return the arguments of calls of ``WITH_AN_ENGINE`` that numba takes for literals, by what names stand for."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in WITH_AN_ENGINE:
            either = [(one.body, one.orelse) if isinstance(one, ast.IfExp) else (one,) for one in node.args]
            for given in chain.from_iterable(either):
                value = known.get(given.id) if isinstance(given, ast.Name) else getattr(given, "value", None)
                found += [ast.unparse(given)] if type(value) in (bool, int) else []
    return found


def test_no_literal_asks_for_a_second_engine() -> None:
    sources = {path: path.read_text() for path in ENGINE.glob("*.py")}
    calling = {path: source for path, source in sources.items() if "advance(ints" in source}
    assert len(calling) >= 3
    modules = {path: vars(import_module(f"stickslip.engine.{path.stem}")) for path in calling}
    assert {path.name: literals(source, modules[path]) for path, source in calling.items()} == {
        path.name: [] for path in calling
    }


@pytest.mark.parametrize(
    ("source", "found"),
    [("advance(I, W, False)", ["False"]), ("run_from(I, k if own else OWN)", ["OWN"]), ("advance(I, t)", [])],
)
def test_the_rule_can_fail(source: str, found: list[str]) -> None:
    assert literals(source, {"OWN": -1, "t": None}) == found
