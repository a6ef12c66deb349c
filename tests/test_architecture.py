"""The import directions of the house, read from the sources."""

import ast
import re
from collections.abc import Callable, Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import get_args

import pytest
from stickslip.detect.words import Word

ROOT = Path(__file__).resolve().parent.parent

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


HEAVY = {"control", "numba", "llvmlite"}
MAY_IMPORT_HEAVY = {
    "control": {"blocks", "diagram", "benchmarks"},
    "numba": {"engine", "benchmarks", "logs"},  # in logs: compiled.py, from which all other rooms have njit
    "llvmlite": {"engine"},
}
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


@pytest.fixture(scope="module", autouse=True)
def trees_are_let_go() -> Iterator[None]:
    """Forget the syntax trees of the house (200 MB) once its rules are checked."""
    yield
    parsed.cache_clear()


def imported(path: Path) -> set[str]:
    """Return the modules that a file imports, anywhere in it; of ``from a import b`` both a and a.b."""
    found = set()
    for node in ast.walk(parsed(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def upward(room: str, modules: set[str]) -> set[str]:
    """Return the rooms and the heavy libraries among ``modules`` that a file of ``room`` may not import."""
    rooms = {entered for module in modules if (entered := room_of(module)) is not None} - {room}
    heavy = {module.split(".")[0] for module in modules} & HEAVY
    return (rooms - ROOMS[room]) | {name for name in heavy if room.split("/")[0] not in MAY_IMPORT_HEAVY[name]}


def test_imports_follow_the_arrows() -> None:
    rooms = {path: room for room, path in FILES}
    assert offenders(lambda path: upward(str(rooms[path]), imported(path))) == {}
    assert upward("detect", {"stickslip.diagram.wire", "control.matlab", "stickslip.logs.log", "numpy"}) == {
        "diagram",
        "control",
    }


def used_rooms() -> dict[str, set[str]]:
    """Return, for each room, the rooms that its files import."""
    used: dict[str, set[str]] = {room: set() for room in ROOMS}
    for room, path in FILES:
        used[str(room)] |= {entered for module in imported(path) if (entered := room_of(module)) not in (None, room)}
    return used


def drawn(used: dict[str, set[str]]) -> str:
    """Return the rooms from top to bottom, each with those that it stands on directly.

    >>> print(drawn({"logs": set(), "blocks": {"logs"}, "gap": {"blocks", "logs"}}))
    gap     stands on  blocks
    blocks  stands on  logs
    logs
    """
    order = list(TopologicalSorter(used).static_order())
    below: dict[str, set[str]] = {}
    for room in order:
        below[room] = used[room].union(*(below[other] for other in used[room]))
    height: dict[str, int] = {}
    for room in order:
        height[room] = 1 + max((height[other] for other in used[room]), default=0)
    width = max(map(len, used))
    lines = []
    for room in sorted(used, key=lambda room: (-height[room], room)):
        direct = used[room].difference(*(below[other] for other in used[room]))
        lines.append(f"{room:{width}}  stands on  {', '.join(sorted(direct))}" if direct else room)
    return "\n".join(lines)


def test_the_drawing_of_the_rooms_is_that_of_the_imports() -> None:
    assert f"```\n{drawn(used_rooms())}\n```" in CONTRIBUTING, f"put this into it:\n{drawn(used_rooms())}"


def test_no_room_has_a_permission_that_it_does_not_use() -> None:
    used = used_rooms()
    assert {room: allowed - used[room] for room, allowed in ROOMS.items() if allowed - used[room]} == {}


def loaded(path: Path) -> set[str]:
    """Return the modules, by their full names, that a file imports as it is loaded."""
    found = set()
    for node in parsed(path.read_text()).body:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def test_no_two_files_need_each_other_to_load() -> None:
    modules = {module_of(path): path for _, path in FILES if path.name != "__init__.py"}
    needs = {name: (loaded(path) & set(modules)) - {name} for name, path in modules.items()}
    assert sum(map(len, needs.values())) > 300  # it does read them
    assert len(list(TopologicalSorter(needs).static_order())) == len(modules)
    with pytest.raises(CycleError):
        list(TopologicalSorter({**needs, "stickslip.engine.layout": {"stickslip.engine.advance"}}).static_order())


def test_the_rooms_of_the_gap_use_each_other_one_way() -> None:
    needs: dict[str, set[str]] = {}
    for path in (ROOT / "gap").glob("*/*.py"):
        used = {name.split(".")[2] for name in imported(path) if name.startswith("stickslip.gap.")}
        needs.setdefault(path.parent.name, set()).update(used - {path.parent.name})
    assert len(needs) > 10
    assert needs["answers"] <= set()
    assert len(list(TopologicalSorter(needs).static_order())) >= len(needs)  # raises where two rooms need each other


A_LOG_AND_ITS_LOOP = ("stickslip.logs.log", "stickslip.logs.loop")  # a log gives its loop, and a loop holds its log


def circles(needs: dict[str, set[str]]) -> list[str]:
    """Return a circle of files, wherever in them they import each other; a result may import its picture."""
    plain = {name: {other for other in others if "figures" not in other} for name, others in needs.items()}
    plain = {name: others - {A_LOG_AND_ITS_LOOP[1]} if name == A_LOG_AND_ITS_LOOP[0] else others
             for name, others in plain.items() if "figures" not in name}  # fmt: skip
    try:
        list(TopologicalSorter(plain).static_order())
    except CycleError as found:
        return list(found.args[1])
    return []


def test_no_circle_of_files_but_a_result_and_its_picture() -> None:
    modules = {module_of(path): path for _, path in FILES if path.name != "__init__.py"}
    needs = {name: (imported(path) & set(modules)) - {name} for name, path in modules.items()}
    assert sum(map(len, needs.values())) > 500  # it does read them
    assert circles(needs) == []
    assert circles({**needs, "stickslip.diagram.changes": {"stickslip.diagram.diagram"}}) != []
    assert circles({"a.result": {"a.figures.result"}, "a.figures.result": {"a.result"}}) == []


def test_every_package_is_listed() -> None:
    packages = {p.parent.name for p in ROOT.glob("*/__init__.py")} - {"tests"}
    assert packages == set(PACKAGES)
    assert ROOMS["logs"] == set() and "diagram" in ROOMS["plant"]  # the table was read


def test_the_rule_can_fail(tmp_path: Path) -> None:
    page = tmp_path / "page.py"
    page.write_text("def f():\n    from stickslip.diagram.diagram import wire\n    import control\n")
    assert {room_of(module) for module in imported(page)} == {"diagram", None}
    assert "control" in imported(page) and "diagram" not in ROOMS["detect"]


DOCUMENTED = {"_replace", "_cache"}  # of a named tuple, public by its documentation; of a numba function, no public way


def private_fields(source: str) -> list[str]:
    """Return where a file reads or writes a private field of anything but an object of the class it is in.

    That is ``self``, ``cls``, ``super()``, and ``other`` where a method made it as a copy of itself.
    """
    found = []
    for function in ast.walk(parsed(source)):
        if not isinstance(function, ast.FunctionDef | ast.Module):
            continue
        copies = {
            node.targets[0].id
            for node in ast.walk(function)
            if isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and ast.unparse(node.value).startswith(("self._copy()", "copy.copy(self)", "type(self)(", "super()."))
        }
        for node in _own_nodes(function):
            private = isinstance(node, ast.Attribute) and node.attr.startswith("_") and not node.attr.startswith("__")
            if private and node.attr not in DOCUMENTED:
                base = ast.unparse(node.value)
                found += [] if base in {"self", "cls", "super()"} | copies else [ast.unparse(node)]
    return found


def _own_nodes(function: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of a function, or of a module, without those of the functions in it."""
    for child in ast.iter_child_nodes(function):
        if not isinstance(child, ast.FunctionDef):
            yield child
            yield from _own_nodes(child)


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
        elif isinstance(node, ast.Subscript) and getattr(node.value, "attr", getattr(node.value, "id", "")) in (
            "I",
            "W",
        ):
            found.append(ast.unparse(node))
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


METAPHORS = {"cast", "crew", "company", "casting", "books", "portfolio", "member", "members", "layer", "layers"}


def words_of(source: str) -> set[str]:
    """Return the words that a file's own names are made of: functions, classes, arguments, variables, fields."""
    names = set()
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.arg):
            names.add(node.arg)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            names.add(node.attr)
    return {word for name in names for word in re.findall(r"[A-Z]?[a-z]+", name) for word in [word.lower()]}


def test_names_are_no_metaphors() -> None:
    assert (
        offenders(lambda path: (words_of(path.read_text()) | set(re.findall(r"[a-z]+", path.stem))) & METAPHORS) == {}
    )


def test_the_rule_of_names_can_fail() -> None:
    assert words_of("class _Crew:\n    def cast(self, members): self.books = 1") >= {"crew", "cast", "members", "books"}


def hidden(init: str, package: str, modules: set[str]) -> set[str]:
    """Return the modules of a package that something else of their name, imported in its ``__init__``, hides."""
    found = set()
    for node in parsed(init).body:
        if isinstance(node, ast.ImportFrom) and node.module != package:
            found |= {alias.asname or alias.name for alias in node.names} & modules
    return found


def test_no_function_hides_a_module_of_its_name() -> None:
    found = {}
    for package in {path.parent for _, path in FILES}:
        modules = {p.stem for p in package.glob("*.py")} | {p.parent.name for p in package.glob("*/__init__.py")}
        own = module_of(package / "__init__.py")
        found[own] = hidden((package / "__init__.py").read_text(), own, modules)
    assert len(found) > 20
    assert {own: names for own, names in found.items() if names} == {}


def test_the_rule_of_hidden_modules_can_fail() -> None:
    assert hidden("from a.slopes import slopes", "a", {"slopes"}) == {"slopes"}
    assert hidden("from a import slopes", "a", {"slopes"}) == set()


def test_files_are_short() -> None:
    lengths = sorted(len(path.read_text().splitlines()) for _, path in FILES)
    assert lengths[-1] < 400 and lengths[len(lengths) * 9 // 10] < 300


def test_no_room_is_above_a_quarter_of_the_house():
    lines = dict.fromkeys(PACKAGES, 0)
    for room, path in FILES:
        assert room is not None
        lines[room.split("/")[0]] += len(path.read_text().splitlines())
    largest = max(lines, key=lambda room: lines[room])
    assert lines[largest] <= 0.25 * sum(lines.values()), (largest, lines)


def test_no_test_replaces_a_private_function_by_its_name() -> None:
    patched = re.compile(r"""(?:setattr|patch)\(\s*["'][\w.]*\._\w+["']""")
    tests = {path: path.read_text() for path in (ROOT / "tests").rglob("*.py")}
    assert [str(path.relative_to(ROOT)) for path, source in tests.items() if patched.search(source)] == []
    assert patched.search("monkeypatch.setattr(" + '"gap.explanations.pairs._fits", 1)')
