"""The same table from a Dask cluster of two workers on this machine, also when one of them is killed."""

import os
import signal
import threading
from pathlib import Path

import pytest
from stickslip.logs import ReadError
from stickslip.scan import scan

pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def plant(forms, tmp_path_factory) -> Path:
    """Three jobs of eight files, one of them not a record."""
    folder = tmp_path_factory.mktemp("plant")
    content = (Path(forms["folder"]) / "TIC104.csv").read_bytes()
    for i in range(23):
        (folder / f"TIC104_{i:02d}.csv").write_bytes(content)
    (folder / "FIC900.csv").write_bytes(b"\x00\x01\x02" * 50)
    return folder


@pytest.fixture(scope="module")
def local(plant, tmp_path_factory) -> bytes:
    out = tmp_path_factory.mktemp("local")
    scan(plant, out, workers=1)
    return (out / "scan.parquet").read_bytes()


def test_the_same_bytes_as_on_this_machine(cluster, plant, local, tmp_path) -> None:
    scan(plant, tmp_path, cluster=cluster.scheduler_address)
    assert (tmp_path / "scan.parquet").read_bytes() == local


def test_a_worker_that_is_killed_changes_nothing(cluster, plant, local, tmp_path) -> None:
    killed = []

    def kill(done: int, total: int) -> None:
        if done and not killed:
            victim = next(iter(cluster.workers.values()))
            killed.append(victim.pid)
            os.kill(victim.pid, signal.SIGKILL)

    scan(plant, tmp_path, cluster=cluster.scheduler_address, tell=kill)
    assert killed and (tmp_path / "scan.parquet").read_bytes() == local


def test_no_scheduler_at_that_address(plant, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("stickslip.logs.cluster.ANSWER_S", 1)
    with pytest.raises(ReadError, match="no Dask scheduler answers"):
        scan(plant, tmp_path, cluster="tcp://127.0.0.1:1")
    assert threading.active_count() < 50
