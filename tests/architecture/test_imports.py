"""The import directions of the house, read from the sources."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from tests.architecture.house import (
    CONTRIBUTING,
    FILES,
    PACKAGES,
    ROOMS,
    ROOT,
    imported,
    module_of,
    offenders,
    parsed,
    room_of,
)

HEAVY = {"control", "numba", "llvmlite"}
MAY_IMPORT_HEAVY = {
    "control": {"blocks", "diagram", "benchmarks"},
    "numba": {"engine", "benchmarks", "logs"},  # in logs: compiled.py, from which all other rooms have njit
    "llvmlite": {"engine"},
}


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


def rooms_inside(room: str) -> dict[str, set[str]]:
    """Return the rooms inside a room, with those that the files of each import, pictures and what starts it apart.

    A file of the room itself stands alone where a room inside imports it; the others are the front, named as the room.
    """
    places = {
        module_of(path): path.parent.relative_to(ROOT / room).as_posix()
        for _, path in FILES
        if path.is_relative_to(ROOT / room) and path.name != "__init__.py" and "figures" not in path.parts
    }
    used = {name: imported(path) & set(places) for _, path in FILES if (name := module_of(path)) in places}
    lone = {other for name, others in used.items() if places[name] != "." for other in others if places[other] == "."}
    node = {name: name.rpartition(".")[2] + ".py" if name in lone else place for name, place in places.items()}
    node = {name: room if place == "." else place for name, place in node.items()}
    drawing: dict[str, set[str]] = {}
    for name, others in used.items():
        drawing.setdefault(node[name], set()).update({node[other] for other in others} - {node[name]})
    return drawing


def test_the_rooms_of_detection_use_each_other_one_way_as_they_are_drawn() -> None:
    inside = rooms_inside("detect")
    assert {"signals", "stem", "health", "oscillation", "half_waves", "prepare", "methods", "judge"} <= set(inside)
    assert f"```\n{drawn(inside)}\n```" in CONTRIBUTING, f"put this into it:\n{drawn(inside)}"
    with pytest.raises(CycleError):
        drawn({**inside, "signals": inside["signals"] | {"prepare"}})


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
