"""A thinned line covers the ground of the whole one."""

import numpy as np
import pytest
from stickslip.logs import Log
from stickslip.logs.thinned import thinned


@pytest.mark.parametrize("n", [10, 4_000, 4_001, 123_457])
def test_extremes_ends_and_order_stay(n) -> None:
    t = np.sort(np.random.default_rng(n).uniform(0, 1e4, n))
    x = np.cumsum(np.random.default_rng(n + 1).normal(size=n))
    few_t, few = thinned(t, x)
    assert len(few) <= 4_002 and np.all(np.diff(few_t) >= 0)
    assert few.min() == x.min() and few.max() == x.max()
    assert (few_t[0], few_t[-1]) == (t[0], t[-1])
    assert np.isin(few, x).all()


def test_a_gap_stays_a_gap() -> None:
    x = np.sin(np.arange(50_000.0) / 30)
    x[20_000:20_400] = np.nan
    t, few = thinned(np.arange(50_000.0), x)
    inside = (t >= 20_000) & (t < 20_400)
    assert np.isnan(few[inside]).all() and inside.any()


def test_the_picture_of_half_a_million_rows_is_small(tmp_path) -> None:
    n = 500_000
    log = Log(t=np.arange(n), signals={"PV": np.random.default_rng(0).normal(size=n)})
    file = tmp_path / "long.svg"
    log.plot().savefig(file)
    assert file.stat().st_size < 500_000
