"""Lists of blocks and cases are kept until a source changes."""

import json
import os

import pytest

from stickslip.commands.kept import ROOMS, kept


@pytest.fixture
def root(tmp_path, monkeypatch):
    """A house of empty rooms, whose lists may be kept."""
    monkeypatch.setattr("sys.dont_write_bytecode", False)
    for name in ROOMS:
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("")
    return tmp_path


def test_it_is_made_once_and_again_after_a_source_has_changed(root):
    made = []

    def make():
        made.append(len(made))
        return [{"times made": len(made)}]

    assert kept("list", make, [str(root)]) == kept("list", make, [str(root)]) == [{"times made": 1}]
    changed = root / "blocks" / "__init__.py"
    changed.write_text("new = 1")
    assert kept("list", make, [str(root)]) == [{"times made": 2}]
    facts = changed.stat()  # as long as before, one nanosecond later
    os.utime(changed, ns=(facts.st_atime_ns, facts.st_mtime_ns + 1))
    assert kept("list", make, [str(root)]) == [{"times made": 3}]
    (root / "cases" / "deep").mkdir()
    (root / "cases" / "deep" / "new.py").write_text("")
    assert kept("list", make, [str(root)]) == kept("list", make, [str(root)]) == [{"times made": 4}]


@pytest.mark.parametrize("content", ["", "{", "[]", "null", '{"stamp": 1}', "\udcff"])
def test_a_broken_file_is_made_again(root, content):
    assert kept("list", lambda: [1], [str(root)]) == [1]
    (file,) = (root / "__pycache__").glob("*.json")
    file.write_bytes(content.encode(errors="surrogateescape"))
    assert kept("list", lambda: [2], [str(root)]) == [2]
    assert json.loads(file.read_text())["content"] == [2]


def test_where_nothing_can_be_kept_it_is_made_each_time(root, monkeypatch):
    (root / "__pycache__").write_text("a file in its place")
    assert kept("list", lambda: [1], [str(root)]) == [1] and kept("list", lambda: [2], [str(root)]) == [2]
    (root / "__pycache__").unlink()
    monkeypatch.setattr("sys.dont_write_bytecode", True)
    assert kept("list", lambda: [1], [str(root)]) == [1] and kept("list", lambda: [2], [str(root)]) == [2]
    assert not (root / "__pycache__").exists()


@pytest.mark.parametrize("command", [("blocks",), ("simulate", "--list")])
def test_a_list_that_is_kept_loads_no_simulator(shell, command):
    """By the modules that Python says it loads; the first run may have to make the list."""
    for _ in range(2):
        done = shell(*command, environment={"PYTHONPROFILEIMPORTTIME": "1", "PYTHONDONTWRITEBYTECODE": ""})
        loaded = {line.rpartition(b"|")[2].strip() for line in done.stderr.splitlines()}
    assert done.returncode == 0 and b"click" in loaded
    assert not loaded & {b"control", b"numpy", b"numba", b"matplotlib", b"stickslip.blocks", b"stickslip.cases"}
