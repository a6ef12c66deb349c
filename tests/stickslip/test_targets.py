"""Files are written whole or not at all, and what cannot be written is refused before the work."""

import os
import stat
from pathlib import Path

import pytest

from stickslip.commands import targets
from stickslip.commands.targets import check_targets, write_whole


def test_replaces_and_leaves_nothing_beside(tmp_path):
    path = tmp_path / "x.json"
    path.write_text("old")
    write_whole(path, b"new")
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_keeps_the_old_file_whole(tmp_path, monkeypatch):
    path = tmp_path / "x.json"
    path.write_text("old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(targets.os, "replace", full)
    with pytest.raises(ValueError, match=r"x\.json cannot be written \(No space left on device\); choose"):
        write_whole(path, b"new")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_keeps_pointing_where_it_did(tmp_path):
    path, link = tmp_path / "x.json", tmp_path / "link.json"
    path.write_text("old")
    link.symlink_to(path)
    write_whole(link, b"new")
    assert link.is_symlink() and path.read_bytes() == b"new"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on this system")
def test_a_pipe_is_written_to_not_replaced(tmp_path):
    # A device, e.g. /dev/null, takes the same way; it must never be renamed over.
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        check_targets({"--json": path})
        write_whole(path, b"content")
        assert os.read(reader, 100) == b"content"
    finally:
        os.close(reader)
    assert stat.S_ISFIFO(path.stat().st_mode)
    with pytest.raises(ValueError, match="is a device or a pipe; name an ordinary file"):
        check_targets({"--out": path}, {"--out": ("",)})


def test_new_files_follow_the_umask(tmp_path):
    old = os.umask(0o027)
    try:
        write_whole(tmp_path / "x", b"")
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "x").stat().st_mode) == 0o640


def test_endings_in_capitals_are_fine(tmp_path):
    check_targets({"--out": tmp_path / "X.CSV", "--json": None}, {"--out": (".csv",)})
    check_targets({"--json": "-"})


def test_two_names_of_one_file(tmp_path):
    (tmp_path / "data.csv").write_text("x")
    (tmp_path / "link").symlink_to(tmp_path / "data.csv")
    with pytest.raises(ValueError, match="link would overwrite the file that is read; name another"):
        check_targets({"--json": tmp_path / "link"}, source=tmp_path / "data.csv")


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="no /proc here: nothing is known that root cannot write to")
def test_a_place_that_takes_no_files_is_refused_before_the_work(call):
    """Permissions do not tell: root may write to /proc, and cannot."""
    for arguments in (["demo", "--out", "/proc/page"], ["simulate", "ideal_high", "--out", "/proc/log.csv"]):
        done = call(*arguments)
        assert done.exit_code == 2 and "nothing can be written in '/proc'" in done.stderr
        assert "compiling" not in done.stderr and not done.stdout
