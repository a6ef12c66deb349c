"""What tests of the calibration share."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import pytest


class Here:
    """Does at once, in this process, what is submitted, so that what a test has changed holds."""

    def __init__(self, *_: object, **__: object) -> None:
        pass

    def __enter__(self) -> "Here":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def submit(self, work: Callable[..., Any], *args: Any) -> "Future[Any]":
        """Return what has been done."""
        done: Future[Any] = Future()
        done.set_result(work(*args))
        return done


@pytest.fixture
def here() -> type[Here]:
    """A pool of processes that has none."""
    return Here
