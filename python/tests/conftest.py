"""Fixtures: paths of the repository, and the program for comparisons."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

#: True in `cargo xtask full`: everything, however long it takes.
FULL = "PAPILIO_DOCS_ALL" in os.environ


@pytest.fixture
def scenarios() -> Path:
    return ROOT / "scenarios"


@pytest.fixture
def program() -> Path:
    """The program `papilio`, built from the same sources; `cargo xtask python` sets its path."""
    named = os.environ.get("PAPILIO")
    if named is None:
        pytest.fail("the variable PAPILIO names no program: run `cargo xtask python`")
    return Path(named)
