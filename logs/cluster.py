"""Jobs on a Dask cluster given by the address of its scheduler: what a scan and a study share."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

__all__ = ["LOST", "ClusterError", "on_cluster"]

LOST = object()  # stands for the result of a job whose workers were lost again and again
RETRIES = 2
ANSWER_S = 10  # s within which a scheduler answers


class ClusterError(ValueError):
    """A cluster cannot be reached."""


def on_cluster(
    function: Callable[..., Any], jobs: Sequence[tuple[Any, ...]], address: str
) -> Iterator[tuple[int, Any]]:
    """Yield the number and the result of each job, ``function(*job)``, in the order in which they are finished.

    Parameters: ``function`` and ``jobs`` must be of what every machine of the cluster has installed; ``address`` of the
    scheduler, e.g. "tcp://10.0.0.5:8786". A job whose worker is lost goes to another; one that takes its workers down
    again and again gives ``LOST``.

    Raises ClusterError if Dask is missing or the scheduler does not answer, and what a job raises.
    """
    try:
        from distributed import Client, as_completed
        from distributed.scheduler import KilledWorker
    except ImportError:
        raise ClusterError("a cluster needs Dask, which is not installed: pip install 'stickslip[cluster]'") from None
    try:
        client = Client(address, timeout=ANSWER_S)  # type: ignore[no-untyped-call]
    except (OSError, TimeoutError, ValueError) as fault:
        raise ClusterError(
            f"no Dask scheduler answers at {address} ({fault}); start one, or leave the address out"
        ) from None
    with client:
        futures = [client.submit(function, *job, pure=False, retries=RETRIES) for job in jobs]
        numbers = {future.key: number for number, future in enumerate(futures)}
        waiting = as_completed(futures)  # type: ignore[no-untyped-call]
        del futures  # a future that is held keeps its result on the cluster
        for future in waiting:
            failed = future.exception()
            if failed is not None and not isinstance(failed, KilledWorker):
                raise failed
            yield numbers[future.key], LOST if failed is not None else future.result()
            future.release()
