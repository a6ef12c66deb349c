"""The same study from a Dask cluster of two workers on this machine, also when one of them is killed."""

import os
import signal

import pytest
from stickslip.logs.files.resumable import parquet
from stickslip.plant.loops import integrating_loop
from stickslip.study import StudyError, study

pytest.importorskip("distributed")

GRID = {"valve.F_s": [1750.0, 2000.0, 2250.0], "controller.K_p": [0.1, 0.2, 0.4]}
OPTIONS = {"start": {"process.PV": [0.5]}, "kicks": 2, "duration": 400.0, "every": 1.0}


@pytest.fixture(scope="module")
def local():
    return parquet(study(integrating_loop(), GRID, progress=False, workers=1, **OPTIONS).table)


def test_the_same_bytes_as_on_this_machine(cluster, local):
    found = study(integrating_loop(), GRID, progress=False, cluster=cluster.scheduler_address, **OPTIONS)
    assert found.complete and parquet(found.table) == local


def test_a_worker_that_is_killed_changes_nothing(cluster, local, tmp_path):
    killed = []

    def kill(done, runs):
        if done and not killed:
            victim = next(iter(cluster.workers.values()))
            killed.append(victim.pid)
            os.kill(victim.pid, signal.SIGKILL)

    found = study(
        integrating_loop(), GRID, progress=kill, cluster=cluster.scheduler_address, out=tmp_path / "study", **OPTIONS
    )
    assert killed and parquet(found.table) == local


def test_a_study_begun_here_goes_on_there(cluster, local, tmp_path, monkeypatch):
    from stickslip.study import run as running

    monkeypatch.setattr(running, "PART_SECONDS", 1e-9)
    monkeypatch.setattr(running, "FIRST_PART", 1)
    monkeypatch.setattr(running, "stop_asked", lambda: __import__("contextlib").nullcontext(lambda: True))
    begun = study(integrating_loop(), GRID, progress=False, workers=1, out=tmp_path / "study", **OPTIONS)
    assert not begun.complete and 0 < len(begun) < 18
    monkeypatch.undo()
    found = study(
        integrating_loop(), GRID, progress=False, cluster=cluster.scheduler_address, out=tmp_path / "study", **OPTIONS
    )
    assert parquet(found.table) == local


def test_no_scheduler_at_that_address(monkeypatch):
    monkeypatch.setattr("stickslip.logs.cluster.ANSWER_S", 1)
    with pytest.raises(StudyError, match="no Dask scheduler answers"):
        study(integrating_loop(), GRID, progress=False, cluster="tcp://127.0.0.1:1", **OPTIONS)
