"""The certificates reach every line and every branch of the checker."""

from __future__ import annotations

import pytest

from tests.checker.branches import unreached


@pytest.mark.slow
def test_every_line_and_branch_of_the_checker_is_reached():
    assert unreached() == []
