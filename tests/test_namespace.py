"""Everything that is installed is inside ``stickslip``: one name for each module, and a front door that shows it."""

import ast
import re
import sys
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

import stickslip as ss
from tests.architecture.house import parsed

ROOT = Path(__file__).resolve().parents[1]
WHEEL = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]["targets"]["wheel"]
ROOMS = set(WHEEL["sources"])


def bare_imports(source: str) -> list[str]:
    """Return the imports of a file that name a room without ``stickslip``, those in its strings and examples too."""
    found = []
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names if alias.name.split(".")[0] in ROOMS]
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found += [str(node.module)] if str(node.module).split(".")[0] in ROOMS else []
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            found += bare_in_text(node.value)
    return found


def bare_in_text(text: str) -> list[str]:
    """Return the statements of a text that import a room without ``stickslip``.

    >>> bare_in_text("from blocks.pi import PI"), bare_in_text("import sys, detect; print()"), bare_in_text("from logs")
    (['from blocks.pi import'], ['import sys, detect'], [])
    """
    rooms = "|".join(sorted(ROOMS))
    one, several = (
        rf"from (?:{rooms})(?:\.[\w.]+)? import\b",
        rf"\bimport (?:[\w.]+, )*(?:{rooms})(?:\.[\w.]+)*(?=$|[;,])",
    )
    return re.findall(rf"(?:^|[;>]|\.\.\.) *({one}|{several})", text, re.M)


def sources() -> Iterator[tuple[str, list[str]]]:
    """Yield every file of the repository that may import a room, with the imports that it must not have."""
    for path in sorted(
        path for path in ROOT.rglob("*.py") if not path.relative_to(ROOT).parts[0].startswith((".", "build"))
    ):
        yield str(path.relative_to(ROOT)), bare_imports(path.read_text())
    for path in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / ".github").rglob("*.md")]:
        yield str(path.relative_to(ROOT)), bare_in_text(path.read_text())


def test_nothing_imports_a_room_by_its_bare_name() -> None:
    found = dict(sources())
    assert len(found) > 1000  # it does read them
    mine = str(Path(__file__).relative_to(ROOT))
    assert {name: imports for name, imports in found.items() if imports and name != mine} == {}


@pytest.mark.parametrize(
    "line",
    [
        "import blocks",
        "import sys, gap.effects",
        "from logs.log import Log",
        "'from plant import SETS'",
        'f"import scan"',
    ],
)
def test_the_rule_can_fail(line: str) -> None:
    assert bare_imports(line)
    assert not bare_imports(
        "from stickslip.blocks import PI; import stickslip.gap; 'from logs of plants'; from .logs import a"
    )


def test_no_module_of_the_house_is_loaded_twice() -> None:
    names = defaultdict(set)
    for name, module in [*sys.modules.items()]:
        file = getattr(module, "__file__", None)
        if file and Path(file).is_relative_to(ROOT) and not Path(file).is_relative_to(sys.prefix):
            names[file].add((name, id(module)))
    assert len(names) > 10
    assert {file: found for file, found in names.items() if len(found) > 1} == {}
    loaded = {name for found in names.values() for name, _ in found}
    assert {name for name in loaded if name.split(".")[0] in ROOMS} == set()
    assert {
        name for name in loaded if re.match(r"stickslip\.(stickslip|tests|benchmarks|docs|conftest)\b", name)
    } == set()


def test_the_wheel_has_every_room_below_one_name() -> None:
    packages = {path.parent.name for path in ROOT.glob("*/__init__.py")} - {"tests", "benchmarks"}
    assert packages == {*WHEEL["only-include"]} == {*ROOMS, "stickslip"}
    assert {room: place for room, place in WHEEL["sources"].items() if place != f"stickslip/{room}"} == {}
    assert all((ROOT / name).is_file() for name in WHEEL["exclude"])


def test_nothing_that_the_wheel_has_imports_what_it_lacks() -> None:
    lacking = {f"stickslip.{name.removesuffix('.py').replace('/', '.')}" for name in WHEEL["exclude"]} | {
        "benchmarks",
        "tests",
    }
    for room in WHEEL["only-include"]:
        for path in (ROOT / room).rglob("*.py"):
            if str(path.relative_to(ROOT)) not in WHEEL["exclude"]:
                names = set()
                for node in ast.walk(parsed(path.read_text())):
                    if isinstance(node, ast.ImportFrom):
                        names |= {str(node.module)} | {f"{node.module}.{alias.name}" for alias in node.names}
                    elif isinstance(node, ast.Import):
                        names |= {alias.name for alias in node.names}
                assert not {name for name in names if name in lacking or name.split(".")[0] in lacking}, path


def test_the_front_door_gives_what_it_lists() -> None:
    assert {name for name in dir(ss) if not name.startswith("_")} == set(ss.__all__)
    for name in ss.__all__:
        assert getattr(ss, name) is not None, name
    assert ss.wire is ss.diagram.wire and ss.gap.diagnose is not ss.diagnose
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        ss.simulat  # noqa: B018
    shown = re.sub(r"``ss\.|[^\w]", " ", str(ss.__doc__)).split()
    assert {name for name in ss.__all__ if name not in shown} <= {
        "Diagram",
        "Log",
        "LoopRecord",
        "Settings",
        "read_log",
        "read_loops",
    }
    assert (ROOT / "stickslip" / "py.typed").is_file()
