"""A study on a Dask cluster: parts of it are made where there is a worker, and their rows are the same as here."""

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from stickslip.logs.cluster import LOST, ClusterError, on_cluster
from stickslip.study.axes import StudyError

if TYPE_CHECKING:
    import polars as pl

PARTS = 64  # of a study, at most: so much of it is lost with a worker
SMALLEST = 4  # runs in a part


def parts_of(missing: Sequence[int], most: int) -> list[list[int]]:
    """Return the runs that are to be made, in parts of at most ``most`` runs.

    >>> [len(part) for part in parts_of(range(10), 1000)]
    [4, 4, 2]
    """
    size = min(most, max(SMALLEST, -(-len(missing) // PARTS)))
    return [list(missing[i : i + size]) for i in range(0, len(missing), size)]


def made_on_cluster(make: Callable[[], Any], parts: Sequence[Sequence[int]], address: str) -> "Iterator[pl.DataFrame]":
    """Return the rows of each part, in the order in which they are finished.

    ``make``: returns what makes the rows of some runs, ``made.part(runs, done)``; it is sent to the workers once and
    called there.  Raises ``StudyError`` if the cluster cannot be reached, or a part brings down every worker.
    """
    try:
        import cloudpickle

        content = cloudpickle.dumps(make)
        for number, rows in on_cluster(_part, [(content, list(part)) for part in parts], address):
            if rows is LOST:
                first, last = parts[number][0], parts[number][-1]
                raise StudyError(
                    f"runs {first} to {last} bring down every worker that has them; look at its memory, or leave "
                    "them out. The others are kept, and the same request goes on"
                )
            yield rows
    except ImportError:
        raise StudyError("a cluster needs Dask, which is not installed: pip install 'stickslip[cluster]'") from None
    except ClusterError as fault:
        raise StudyError(str(fault)) from None


def _part(content: bytes, runs: list[int]) -> "pl.DataFrame":
    rows: pl.DataFrame = _made(content).part(runs, 0)
    return rows


@lru_cache(maxsize=2)
def _made(content: bytes) -> Any:
    """Return what makes rows, once for each study that a worker has a part in."""
    import pickle

    return pickle.loads(content)()
