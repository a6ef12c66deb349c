"""Studies that are interrupted, and their folders: equal bytes whatever happened on the way."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import polars as pl
import pytest
from stickslip.logs.files.resumable import RowsFolder, parquet
from stickslip.plant.loops import integrating_loop
from stickslip.study import StudyError, study
from stickslip.study import run as running

from tests.study.small_study import GRID, OPTIONS, small

ROOT = Path(__file__).resolve().parents[2]


def test_workers_do_not_change_a_byte(whole, short_parts):
    assert parquet(small(workers=3).table) == parquet(whole.table)


def test_an_interrupted_study_goes_on_and_gives_the_same_bytes(whole, tmp_path, monkeypatch, short_parts):
    small(out=tmp_path / "one", workers=1)
    kept, add = [], RowsFolder.add

    def breaks_down(self, table):
        if len(kept) == 3:
            raise RuntimeError("the machine is gone")
        kept.append(table)
        add(self, table)

    monkeypatch.setattr(RowsFolder, "add", breaks_down)
    with pytest.raises(RuntimeError, match="gone"):
        small(out=tmp_path / "two", workers=2)
    monkeypatch.setattr(RowsFolder, "add", add)
    assert not (tmp_path / "two" / "study.parquet").exists()
    made = []
    split = running.Points.split
    monkeypatch.setattr(running.Points, "split", lambda self, runs: made.extend(runs) or split(self, runs))
    small(out=tmp_path / "two", workers=1)
    assert len(made) == len(whole) - sum(map(len, kept))  # nothing is made twice
    one, two = ((tmp_path / name / "study.parquet").read_bytes() for name in ("one", "two"))
    assert one == two
    assert not (tmp_path / "two" / "parts").exists()
    assert pl.read_parquet(tmp_path / "two" / "study.parquet").equals(whole.table)


def test_ctrl_c_keeps_what_is_finished(whole, tmp_path, monkeypatch, short_parts):
    calls, ensemble = [], running.ensemble

    def stopped(*arguments, **keywords):
        calls.append(1)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return ensemble(*arguments, **keywords)

    monkeypatch.setattr(running, "ensemble", stopped)
    part = small(out=tmp_path, workers=1)
    assert not part.complete and 0 < len(part) < len(whole)
    assert '"interrupted"' in (tmp_path / "study.json").read_text()
    again = small(out=tmp_path, workers=1)
    assert again.complete and again.table.equals(whole.table)


def test_kill_9_loses_nothing_but_the_last_part(tmp_path):
    code = (
        "from stickslip.study import run as running\n"
        "from tests.study.small_study import small\n"
        "running.PART_SECONDS, running.FIRST_PART = 1e-9, 1\n"
        f"small(out={str(tmp_path / 'killed')!r}, workers=1, kicks=60, duration=2000.0)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", code], cwd=ROOT)
    parts, deadline = tmp_path / "killed" / "parts", time.monotonic() + 90.0
    while time.monotonic() < deadline and process.poll() is None and len(list(parts.glob("0*.parquet"))) < 5:
        time.sleep(0.01)
    assert process.poll() is None, "the study ended before it could be killed"
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert len(list(parts.glob("0*.parquet"))) >= 5
    small(out=tmp_path / "killed", workers=2, kicks=60, duration=2000.0)
    small(out=tmp_path / "quiet", workers=1, kicks=60, duration=2000.0)
    killed, quiet = ((tmp_path / name / "study.parquet").read_bytes() for name in ("killed", "quiet"))
    assert killed == quiet


def test_a_part_that_cannot_be_read_is_made_again(whole, tmp_path, monkeypatch, short_parts):
    monkeypatch.setattr(RowsFolder, "finish", lambda *_: pytest.fail("stop here"))
    with pytest.raises(pytest.fail.Exception):
        small(out=tmp_path)
    monkeypatch.undo()
    first = sorted((tmp_path / "parts").glob("*.parquet"))[0]
    first.write_bytes(first.read_bytes()[:50])
    assert small(out=tmp_path).table.equals(whole.table)


def test_another_request_in_the_same_folder_is_refused(tmp_path):
    small(out=tmp_path)
    before = (tmp_path / "study.parquet").read_bytes()
    for changes, words in (
        ({"seed": 7}, "seed: there 2009, now 7"),
        ({"duration": 500.0}, "duration: there 400.0, now 500.0"),
        ({"start": {"process.PV": [0.6]}}, r"start process.PV: there \[0.5\], now \[0.6\]"),
    ):
        with pytest.raises(StudyError, match=words):
            small(out=tmp_path, **changes)
    with pytest.raises(StudyError, match="diagram itself"):
        study(integrating_loop(K=2.9), GRID, out=tmp_path, **OPTIONS)
    with pytest.raises(StudyError, match="order of the axes"):
        study(integrating_loop(), dict(reversed(GRID.items())), out=tmp_path, **OPTIONS)
    assert (tmp_path / "study.parquet").read_bytes() == before
    assert small(out=tmp_path).complete  # the same request still answers
    assert len(small(out=tmp_path, kicks=1, fresh=True)) == 9


def test_two_studies_do_not_share_a_folder(tmp_path):
    from filelock import FileLock

    with FileLock(tmp_path / ".lock"), pytest.raises(StudyError, match="another study is at work"):
        small(out=tmp_path)


def test_a_folder_that_cannot_be_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match="cannot be a study's folder"):
        small(out=tmp_path / "file")
    for content in ("{}", "{", "[]", '{"request": 3}', '{"request": {"vary": 3}}'):
        (tmp_path / "study.json").write_text(content)
        with pytest.raises(StudyError, match=r"cannot be read as a study|holds another study"):
            small(out=tmp_path)


@pytest.mark.parametrize("content", [b"", b"PAR1", b"PAR1" + bytes(100)])
def test_a_damaged_table_is_named(content, tmp_path):
    small(out=tmp_path)
    (tmp_path / "study.parquet").write_bytes(content)
    with pytest.raises(StudyError, match=r"study.parquet' is damaged; fresh starts anew \(--fresh\)"):
        small(out=tmp_path)
    assert small(out=tmp_path, fresh=True).complete
