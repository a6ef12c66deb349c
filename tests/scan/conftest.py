"""A small plant of four loops, written in every form in which historians give it."""

from datetime import datetime, timedelta

import numpy as np
import polars as pl
import pytest

N, EVERY = 600, 5
TAGS = ("FIC101", "LIC102", "PIC103", "TIC104")


def signals() -> dict[str, np.ndarray]:
    """PV and OP of four loops: two that swing, one that stands still, one that only drifts."""
    t = np.arange(N) * float(EVERY)
    found = {}
    for i, tag in enumerate(TAGS):
        period = 100.0 + 40.0 * i
        wave = np.sin(2.0 * np.pi * t / period)
        noise = np.random.default_rng(i).normal(0.0, 0.02, N)
        found[f"{tag}.PV"] = 10.0 * (i + 1) + (wave if i < 2 else 0.0 * t) + (0.001 * t if i == 3 else 0.0) + noise
        found[f"{tag}.OP"] = 50.0 + 3.0 * np.cos(2.0 * np.pi * t / period) * (i != 2) + noise
        found[f"{tag}.SP"] = np.full(N, 10.0 * (i + 1))
    return found


@pytest.fixture(scope="session")
def wide() -> pl.DataFrame:
    clock = [datetime(2024, 5, 6) + timedelta(seconds=EVERY * i) for i in range(N)]
    return pl.DataFrame({"time": clock, **signals()})


@pytest.fixture(scope="session")
def forms(wide, tmp_path_factory) -> dict[str, str]:
    """Name of the form -> source."""
    folder = tmp_path_factory.mktemp("plant")
    wide.write_parquet(folder / "wide.parquet")
    wide.write_csv(folder / "wide.csv")
    long = wide.unpivot(index="time", variable_name="tag", value_name="value").sort("time", "tag")
    long.write_parquet(folder / "long.parquet")
    (folder / "loops").mkdir()
    (folder / "tags").mkdir()
    for tag in TAGS:
        wide.select("time", *(f"{tag}.{part}" for part in ("PV", "OP", "SP"))).write_csv(
            folder / "loops" / f"{tag}.csv"
        )
        for part in ("PV", "OP", "SP"):
            wide.select("time", pl.col(f"{tag}.{part}").alias("value")).write_csv(folder / "tags" / f"{tag}.{part}.csv")
    return {
        "wide": str(folder / "wide.parquet"),
        "text": str(folder / "wide.csv"),
        "long": str(folder / "long.parquet"),
        "folder": str(folder / "loops"),
        "tags": str(folder / "tags"),
        "query": f"duckdb:SELECT * FROM '{folder}/wide.parquet'",
    }
