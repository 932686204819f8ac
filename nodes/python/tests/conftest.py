"""Pictures to work on, and where things are."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parents[3]
"""The repository."""


@pytest.fixture(scope="session")
def scene() -> np.ndarray:
    """A picture of the demo scene, RGB of 8 bits."""
    return np.asarray(Image.open(ROOT / "tests/data/scene.png").convert("RGB"))


@pytest.fixture(scope="session")
def small(scene: np.ndarray) -> np.ndarray:
    """A part of it, of odd size."""
    return np.ascontiguousarray(scene[20:83, 31:150])


@pytest.fixture(scope="session")
def host() -> Path:
    """The sample host."""
    named = os.environ.get("ISOPHOTE_HOST")
    assert named, "ISOPHOTE_HOST names no program; run the tests by `cargo xtask test python`"
    return Path(named)
