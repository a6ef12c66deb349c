"""The rules of the house share the syntax trees of its files."""

from pathlib import Path

from tests.architecture.house import parsed


def pytest_runtest_teardown(item, nextitem):
    """Forget the syntax trees of the house (200 MB) once a worker has checked its rules."""
    if nextitem is None or Path(__file__).parent not in nextitem.path.parents:
        parsed.cache_clear()
