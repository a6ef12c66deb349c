"""What is in one file only, and what a file keeps to itself."""

import ast
import re
from collections.abc import Iterator
from typing import get_args

import pytest
from stickslip.detect.words import Word

from tests.architecture.house import FILES, ROOT, offenders, parsed

DOCUMENTED = {"_replace", "_cache"}  # of a named tuple, public by its documentation; of a numba function, no public way


def private_fields(source: str) -> list[str]:
    """Return where a file reads or writes a private field of anything but an object of the class it is in.

    That is ``self``, ``cls``, ``super()``, and ``other`` where a method made it as a copy of itself.
    """
    found = []
    for function in ast.walk(parsed(source)):
        if not isinstance(function, ast.FunctionDef | ast.Module):
            continue
        own = [
            node
            for node in _own_nodes(function)
            if isinstance(node, ast.Attribute) and node.attr.startswith("_") and not node.attr.startswith("__")
        ]
        if not own:
            continue
        copies = {
            node.targets[0].id
            for node in ast.walk(function)
            if isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and ast.unparse(node.value).startswith(("self._copy()", "copy.copy(self)", "type(self)(", "super()."))
        }
        for node in own:
            if node.attr not in DOCUMENTED:
                base = ast.unparse(node.value)
                found += [] if base in {"self", "cls", "super()"} | copies else [ast.unparse(node)]
    return found


def _own_nodes(function: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of a function, or of a module, without those of the functions in it."""
    for child in ast.iter_child_nodes(function):
        if not isinstance(child, ast.FunctionDef):
            yield child
            yield from _own_nodes(child)


def test_how_many_cores_there_are_is_asked_in_one_file() -> None:
    # what the machine has is more than a process may use, where it is kept to some of its cores
    asking = offenders(lambda path: re.findall(r"cpu_count|sched_getaffinity", path.read_text()))
    assert set(asking) == {"logs/processes.py"}


def test_no_file_touches_the_private_fields_of_another() -> None:
    assert offenders(lambda path: private_fields(path.read_text())) == {}


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("def f(diagram):\n    diagram._plan = 1", ["diagram._plan"]),
        ("class A:\n    def f(self, block):\n        return block._out(0.0)", ["block._out"]),
        ("class A:\n    def f(self, other):\n        return other._plan", ["other._plan"]),
        ("class A:\n    def f(self):\n        other = self._copy()\n        other._plan = self._plan", []),
        ("x = y._hidden", ["y._hidden"]),
    ],
)
def test_the_rule_of_private_fields_can_fail(line: str, found: list[str]) -> None:
    assert private_fields(line) == found


def slots(source: str) -> list[str]:
    """Return where a file knows a place in the engine's arrays: it imports their layout, or takes an item of them."""
    found = []
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [alias.name for alias in node.names]
            module = getattr(node, "module", None) or ""
            if "stickslip.engine.layout" in [*names, module] or (module == "stickslip.engine" and "layout" in names):
                found.append(ast.unparse(node))
        elif isinstance(node, ast.Subscript):
            array = getattr(node.value, "attr", getattr(node.value, "id", ""))
            found += [ast.unparse(node)] if array in ("I", "W") else []
    return found


def test_no_slot_of_the_engine_is_addressed_outside_it() -> None:
    found = offenders(lambda path: slots(path.read_text()))
    assert {name: uses for name, uses in found.items() if not name.startswith("engine/")} == {}
    assert "engine/advance.py" in found  # the engine itself addresses them


@pytest.mark.parametrize(
    "line",
    [
        "from stickslip.engine import layout as at", "from stickslip.engine.layout import T", "W[places[b]]",
        "outcome.W[0]", "I[at.STEPS]",
    ],
)  # fmt: skip
def test_the_rule_of_slots_can_fail(line: str) -> None:
    assert slots(line)


def test_no_test_replaces_a_private_function_by_its_name() -> None:
    patched = re.compile(r"""(?:setattr|patch)\(\s*["'][\w.]*\._\w+["']""")
    tests = {path: path.read_text() for path in (ROOT / "tests").rglob("*.py")}
    assert [str(path.relative_to(ROOT)) for path, source in tests.items() if patched.search(source)] == []
    assert patched.search("monkeypatch.setattr(" + '"gap.explanations.pairs._fits", 1)')


ONE_PLACE = {
    "difflib": "logs/hint.py",  # did you mean ...
    "os.replace(": "logs/files/write.py",  # whole files
}


@pytest.mark.parametrize(("text", "place"), ONE_PLACE.items())
def test_one_place_for_each_thing(text: str, place: str) -> None:
    assert [str(p.relative_to(ROOT)) for _, p in FILES if text in p.read_text()] == [place]


def verdict_words(source: str) -> list[str]:
    """Return where a file says something of its own for each word of a verdict: a mapping over the words, or a loop.

    A mapping whose keys are other things too (reason codes, the events of a method) is none.
    """
    found = []
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.Dict):
            keys = {key.value for key in node.keys if isinstance(key, ast.Constant)}
            if len(node.keys) > 1 and keys <= set(get_args(Word)) and len(keys) == len(node.keys):
                found.append(ast.unparse(node))
        elif isinstance(node, ast.Call):
            spelled = ast.unparse(node)
            if spelled.startswith("get_args(Word)") or re.match(r"\S*(verdict|combined|word)\.replace\(", spelled):
                found.append(spelled)
    return found


def test_the_words_of_a_verdict_are_in_one_file() -> None:
    found = {str(p.relative_to(ROOT)) for _, p in FILES if verdict_words(p.read_text())}
    assert found == {"detect/words.py"}


@pytest.mark.parametrize("line", ["A = {'stiction': 1, 'no_stiction': 2}", "v.verdict.replace('_', ' ')", 
                                  "{w: w for w in get_args(Word)}"])  # fmt: skip
def test_the_rule_of_verdict_words_can_fail(line: str) -> None:
    assert verdict_words(line) and not verdict_words("A = {'stiction': 1, 'manual_mode': 2}")


def test_every_colour_of_the_house_is_in_one_file() -> None:
    found = {str(p.relative_to(ROOT)) for _, p in FILES if re.search(r"#[0-9a-fA-F]{6}\b", p.read_text())}
    assert found == {"logs/style.py"}


def test_schemas_are_distinct() -> None:
    stated = re.compile(r'(?:= |"schema": )"(stickslip\.[a-z-]+/\d+)"')
    names = [name for _, path in FILES for name in stated.findall(path.read_text())]
    assert len(names) > 6 and len(set(names)) == len(names)


def test_one_name_for_plain_values() -> None:
    methods = {
        node.name
        for _, path in FILES
        for node in ast.walk(parsed(path.read_text()))
        if isinstance(node, ast.FunctionDef) and re.fullmatch(r"(to|as)_?(dict|plain|json|values)", node.name)
    }
    assert methods == {"to_dict"}
