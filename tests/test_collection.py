"""What happens before the first test: collecting them is quick, because nothing runs as a file of tests is loaded."""

import pytest

from tests.conftest import COMPILED


def test_nothing_is_compiled_as_tests_are_collected(request: pytest.FixtureRequest) -> None:
    """Each worker collects all tests, so what a file of tests computes as it is loaded is computed by all of them."""
    assert request.config.stash[COMPILED] == []
