"""Fixtures for all tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of sample data beside the checkout (or ``SCURO_SHARED``); skips without it."""
    default = Path(__file__).parents[1].parent / "shared" / "data"
    folder = Path(os.environ.get("SCURO_SHARED", default))
    if not folder.is_dir():
        pytest.skip(f"no sample data: {folder} is not there (set SCURO_SHARED)")
    return folder
