"""Fixtures of all tests."""

from __future__ import annotations

import os
import shutil
import sysconfig
from pathlib import Path

import numpy as np
import pytest

import contrapposto

REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def woman() -> contrapposto.Model:
    return contrapposto.Model.adult(sex="female", stature=1.65, mass=60)


@pytest.fixture(scope="session")
def program() -> str:
    """The program: CONTRAPPOSTO_PROGRAM, or the one that was installed with the package."""
    found = os.environ.get("CONTRAPPOSTO_PROGRAM") or shutil.which("contrapposto", path=sysconfig.get_path("scripts"))
    assert found, "the program `contrapposto` is not installed; CONTRAPPOSTO_PROGRAM names another one"
    return found


@pytest.fixture(scope="session")
def random_postures(woman: contrapposto.Model) -> np.ndarray:
    """10,000 postures within the ranges, from a fixed seed."""
    low, high = woman.ranges.T
    return np.random.default_rng(20).uniform(low, high, (10_000, len(low)))
