"""What tests of many blocks ask in the same way."""

import pytest
from stickslip.blocks.ports import BlockError


@pytest.fixture
def refuses():
    """Check that an attempt raises ``BlockError``, and that its message has all the words."""

    def check(attempt, words):
        with pytest.raises(BlockError) as caught:
            attempt()
        assert [word for word in words if word not in str(caught.value)] == [], str(caught.value)

    return check
