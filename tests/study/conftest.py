"""What tests of studies share: the small study in one go, and parts of a few runs."""

import pytest
from stickslip.study import run as running

from tests.study.small_study import small


@pytest.fixture(scope="session")
def whole():
    """The small study made in one go."""
    return small(workers=1)


@pytest.fixture
def short_parts(monkeypatch):
    """Parts of a few runs, so that a small study has several."""
    monkeypatch.setattr(running, "PART_SECONDS", 1e-9)
    monkeypatch.setattr(running, "FIRST_PART", 1)
