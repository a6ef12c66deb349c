"""Files that the generator of benchmarks/hostile does not make: read rightly, or refused with the reason."""

import datetime as dt
import gzip
import os
import zipfile

import numpy as np
import polars as pl
import pytest
from stickslip.logs import ReadError, read_loop

N = 400
T = np.arange(N)
PV, OP = 50.0 + np.sin(T / 8), 40.0 + np.cos(T / 8)
TEXT = "time,PV,OP\n" + "\n".join(f"{t},{pv:.4f},{op:.4f}" for t, pv, op in zip(T, PV, OP, strict=True))


def german(x):
    return f"{x:,.3f}".translate(str.maketrans(",.", ".,"))


def test_mark_semicolon_decimal_comma_and_thousands_dot(tmp_path):
    lines = [f"{t};{german(1000 * pv)};{german(1000 * op)}" for t, pv, op in zip(T, PV, OP, strict=True)]
    (tmp_path / "a.csv").write_bytes(b"\xef\xbb\xbf" + "\n".join(["time;PV;OP", *lines]).encode())
    record = read_loop(tmp_path / "a.csv")
    np.testing.assert_allclose(record.pv, 1000 * PV, atol=1e-3)
    np.testing.assert_allclose(record.op, 1000 * OP, atol=1e-3)
    assert any("thousands" in note for note in record.notes)


def frame():
    start = dt.datetime(2024, 1, 1)
    return pl.DataFrame({"time": [start + dt.timedelta(seconds=int(t)) for t in T], "PV": PV, "OP": OP})


@pytest.mark.parametrize(
    "changed",
    [
        pl.col("time").dt.replace_time_zone("Europe/Oslo").dt.cast_time_unit("ns"),
        pl.col("PV").cast(pl.Decimal(18, 4)),
        (pl.col("time") - pl.datetime(2024, 1, 1)).alias("time"),
        pl.col("time").dt.time(),
        pl.struct("PV", "OP").alias("pair"),
        pl.concat_list("PV", "OP").alias("list"),
    ],
)
def test_columns_of_parquet_of_every_type(changed, tmp_path):
    frame().with_columns(changed).write_parquet(tmp_path / "a.parquet")
    record = read_loop(tmp_path / "a.parquet")
    np.testing.assert_allclose(record.t, T, atol=1e-9)
    np.testing.assert_allclose(record.pv, PV, atol=1e-4)
    np.testing.assert_allclose(record.op, OP, atol=1e-4)


def zip_of_nothing(path):
    zipfile.ZipFile(path, "w").close()


def folder(path):
    path.mkdir()


def link_to_itself(path):
    os.symlink(path.name, path)


@pytest.mark.parametrize(
    ("name", "make", "words"),
    [
        ("a.zip", zip_of_nothing, "the zip archive is empty"),
        ("a.csv.gz", lambda p: p.write_bytes(gzip.compress(TEXT.encode())[:-800]), "gzip archive is damaged"),
        ("a.csv", folder, "this is a folder"),
        ("a.csv", link_to_itself, "symbolic links"),
        ("a.csv", lambda p: p.write_bytes(TEXT.encode()[:5000] + bytes(40) + TEXT.encode()[5000:]), "zero bytes"),
        ("a.csv", lambda p: p.write_text("PV\n1\n2\n"), "only one column"),
        ("a.csv", lambda p: p.write_text("time,PV,OP\n"), "no rows"),
        ("a.csv", lambda p: p.write_text("   \n \n"), "only blank"),
        ("a.csv", lambda p: p.write_text(TEXT.replace(",4", ",٤")), "is not a number"),
        ("a.parquet", lambda p: frame().clear().write_parquet(p), "no rows"),
        ("a.parquet", lambda p: frame().select("time", pl.struct("PV", "OP").alias("v")).write_parquet(p), "'v'"),
        ("a.parquet", lambda p: frame().with_columns(pl.concat_list("OP").alias("OP")).write_parquet(p), "not numbers"),
        (
            "a.csv",
            lambda p: p.write_text("time," + ",".join(f"T{i}" for i in range(10_000)) + "\n" + "0" + ",1" * 10_000),
            "no column is plainly the PV",
        ),
    ],
)
def test_what_cannot_be_read_is_refused_with_the_reason(name, make, words, tmp_path):
    make(tmp_path / name)
    with pytest.raises(ReadError, match=words) as refused:
        read_loop(tmp_path / name)
    assert len(str(refused.value)) < 1000


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with a name on this system")
def test_a_pipe_that_nobody_fills_does_not_hold_up_a_scan(tmp_path):
    from stickslip.scan.sources import source_of

    (tmp_path / "FIC1.csv").write_text(TEXT)
    os.mkfifo(tmp_path / "FIC2.csv")
    assert source_of(tmp_path, tmp_path / "kept").count == 1
